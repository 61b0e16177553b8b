"""Reynolds' rows and their derivatives; fields carried along the path of the film; flow through a face."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import petsc4py
import pytest

petsc4py.init([])

from ehlpetsc.case.loading import load
from ehlpetsc.discretisation.contact.node_state import AMBIENT_TOLERANCE
from ehlpetsc.discretisation.film_history import FilmHistory
from ehlpetsc.discretisation.finite_volumes import face_film, face_mean, flux_through, positive_extrapolation
from ehlpetsc.discretisation.reynolds import NoOil, Reynolds
from ehlpetsc.discretisation.step_inputs import IsothermalOil, StepInputs
from ehlpetsc.discretisation.transport import carried, carried_with, downstream_weights
from ehlpetsc.discretisation.unknowns import Share
from ehlpetsc.nonlinear.line.jacobian import reynolds_columns
from ehlpetsc.physics.contact.grid import Grid
from ehlpetsc.physics.contact.shape import CYLINDER
from ehlpetsc.physics.scales import Scales

CASE = Path(__file__).parents[2] / "cases" / "table1_smooth.toml"
MESH = ["mesh.points_per_half_width=32", "mesh.inlet=-1.5", "mesh.outlet=1.3"]
FILM = 5e-4  # a^2/R


def part_of_line(first, last, n, start=0):
    return Share(first, last, slice(start, n), slice(first - start, last - start))


def rows_of(extra, first=0, last=None):
    case = load(CASE, MESH + extra)
    scales = Scales.of(case)
    oil, film = IsothermalOil(case.fluid, scales), case.fluid.inlet_film
    inputs = StepInputs(np.zeros(scales.nx), None, oil, film and film / scales.h, scales.conditions)
    share = part_of_line(first, last or scales.nx, scales.nx)
    return Reynolds(scales, FILM, share), inputs, scales.nx


def state(n):
    """Oil with a cavity behind, an uneven film, a past with a limited slope here and there."""
    rng = np.random.default_rng(5)
    q = 0.6 * rng.uniform(0.2, 1.0, n)
    q[3 * n // 4 :] = rng.uniform(-0.8, -0.1, n)[3 * n // 4 :]
    return q, FILM * rng.uniform(0.3, 3.0, n)


def with_history(inputs, reynolds, q, h):
    rng = np.random.default_rng(6)
    m = reynolds.mass_per_area(q, h, inputs.fluid)
    history = FilmHistory(m * rng.uniform(0.6, 1.6, len(m)), m * rng.uniform(0.6, 1.6, len(m)), 0.01, 0.012)
    return replace(inputs, history=history)


def test_a_face_has_the_flux_of_its_nodes_and_rounding_no_effect():
    reynolds, inputs, n = rows_of([])
    at = reynolds.properties(*state(n), inputs.oil)
    order = np.random.default_rng(1).permutation(n + 1)
    mixed, place = np.ascontiguousarray(at[:, order]), np.argsort(order)
    table, law = inputs.flow_table, reynolds.face_law(inputs, reynolds.dx)
    for nodes in ((0, 0, 1), (0, 1, 2), (19, 20, 21), (n - 2, n - 1, n)):
        there, here = (
            np.array(at, np.uint64) for at in (place[list(nodes)], nodes)
        )  # as the solver has them
        assert flux_through(mixed, *there, table, law) == flux_through(at, *here, table, law)
    reynolds, inputs, n = rows_of([])
    q, h = state(n)
    rows = []
    for rounding in (2.0 * AMBIENT_TOLERANCE, 0.0, 1e-20, -0.5 * AMBIENT_TOLERANCE):
        q[0] = rounding
        rows.append(reynolds.evaluate(q, h, inputs)[1])
    np.testing.assert_allclose(rows[1], rows[0], rtol=1e-9)
    np.testing.assert_allclose(rows[2], rows[1], rtol=1e-12)
    np.testing.assert_allclose(rows[3], rows[1], rtol=1e-9)


PRESSED = ["fluid.eyring_stress_pressure=1e-9"]
CARREAU = [("fluid.eyring_stress", None), "fluid.carreau_stress=6e6", "fluid.carreau_exponent=0.45"]


@pytest.mark.parametrize("transient", [False, True], ids=["steady", "transient"])
@pytest.mark.parametrize(
    "extra",
    [[], ["fluid.law=barus"], ["fluid.inlet_film=1e-8"], PRESSED, CARREAU],
    ids=["roelands", "barus", "starved", "Eyring stress of p", "carreau"],
)
def test_derivatives(extra, transient):
    reynolds, inputs, n = rows_of(extra)
    q, h = state(n)
    if transient:
        inputs = with_history(inputs, reynolds, q, h)
    values = reynolds.evaluate(q, h, inputs)[1]
    for side, vector in enumerate((q, h)):
        for column in range(n):
            step = 1e-6 * abs(vector[column])
            changed = []
            for sign in (1, -1):
                kept, vector[column] = vector[column], vector[column] + sign * step
                changed.append(reynolds.evaluate(q, h, inputs)[0])
                vector[column] = kept
            expected = (changed[0] - changed[1]) / (2 * step)
            found = np.zeros(n)
            for i in range(max(column - 1, 0), min(column + 3, n)):
                if i or column == 0:
                    found[i] = values[i, 2 * (column - i + 2) + side]
            np.testing.assert_allclose(found, expected, rtol=2e-6, atol=1e-7 * np.abs(values[column]).max())


def test_reynolds_rows_of_a_part_equal_the_whole_with_and_without_oil():
    reynolds, inputs, n = rows_of([])
    q, h = state(n)
    inputs = with_history(inputs, reynolds, q, h)
    residual, values = reynolds.evaluate(q, h, inputs)
    for first, last in ((0, 20), (20, 44), (44, n)):
        part = rows_of([], first, last)[0]
        some, entries = part.evaluate(q, h, inputs)
        np.testing.assert_array_equal(some, residual[first:last])
        np.testing.assert_array_equal(entries, values[first:last])
        columns = reynolds_columns(first, last, n)
        np.testing.assert_array_equal(columns, reynolds_columns(0, n, n)[first:last])
    q = np.random.default_rng(7).uniform(-1.0, 1.0, 40)
    grid = Grid((np.arange(40.0),), (1.0,), (1.0,), (CYLINDER,), 1.0)
    whole, part = (NoOil(grid, part_of_line(*ends)) for ends in ((0, 40, 40), (12, 30, 40, 10)))
    (rows, entries), (some, of_part) = whole.evaluate(q, q, None), part.evaluate(q[10:], q[10:], None)
    np.testing.assert_array_equal(some, rows[12:30])
    np.testing.assert_array_equal(of_part, entries[12:30])


RNG = np.random.default_rng(4)


@pytest.mark.parametrize("nodes", [3.0, -2.0, 0.0, 1.0 + 1e-12])
def test_whole_nodes_are_carried_exactly(nodes):
    rows = RNG.uniform(0.0, 1.0, (2, 40))
    expected = rows.take(np.arange(40) - round(nodes), axis=1, mode="clip")
    np.testing.assert_array_equal(carried(rows, nodes), expected)


@pytest.mark.parametrize("nodes", [0.3, 0.5, 2.7, -0.3, -1.6])
def test_a_fraction_of_a_node_keeps_mass_and_sign(nodes):
    """Of a film with jumps by a factor of 1e4; what enters and leaves at the ends is known."""
    rows = np.ones((3, 200))
    rows[:, 30:170] = 10.0 ** RNG.uniform(-4.0, 0.0, (3, 140))
    moved = carried(rows, nodes)
    assert abs(moved.sum() - rows.sum()) < 1e-12 * rows.sum()
    assert moved.min() > 0.0
    near = np.min([rows.take(np.arange(200) - k, axis=1, mode="clip") for k in range(-3, 4)], axis=0)
    assert (moved >= 0.5 * near - 1e-15).all()


def test_there_and_back_is_symmetric_and_temperatures_go_with_the_oil():
    rows = RNG.uniform(0.5, 1.0, (1, 60))
    np.testing.assert_allclose(carried(rows, 0.3)[:, ::-1], carried(rows[:, ::-1].copy(), -0.3), rtol=1e-14)
    mass = RNG.uniform(0.1, 1.0, (1, 50))
    even = np.full((1, 50), 363.0)
    np.testing.assert_allclose(carried_with(mass, even, 0.4, 363.0), 363.0, rtol=1e-14)
    warm = 363.0 + RNG.uniform(0.0, 30.0, (1, 50))
    found = carried_with(mass, warm, 0.4, 363.0)
    assert found.min() >= 363.0 and found.max() <= warm.max()
    np.testing.assert_array_equal(carried_with(mass, warm, 1.0, 363.0)[:, 1:], warm[:, :-1])


@pytest.mark.parametrize("per_wave, loss", [(6, 1.3e-3), (8, 1.5e-4), (16, 1e-6)])
def test_a_wave_keeps_its_amplitude(per_wave, loss):
    """Half a node: the worst fraction. Upwind differences of second order lose 4 % at eight nodes."""
    x = np.arange(40 * per_wave)
    wave = 1.0 + 0.1 * np.cos(2.0 * np.pi * x / per_wave)
    moved = carried(wave[None], 0.5)[0]
    inside, e = slice(10 * per_wave, 30 * per_wave), np.exp(-2j * np.pi * x / per_wave)
    left = (moved * e)[inside].sum() / (wave * e)[inside].sum()
    assert 0.0 < 1.0 - abs(left) < loss
    assert np.angle(left) == pytest.approx(-np.pi / per_wave, abs=1e-9)


@pytest.mark.parametrize("t", [0.1, 0.5, 0.83])
def test_part_of_a_cell_is_exact_for_polynomials_of_degree_14(t):
    """Order 15 of the integral: contents of cells of x^n, of which (-t)^(n+1) leaves cell 0 by its face."""
    faces = np.arange(-8.0, 8.0) / 8.0
    weights = downstream_weights(t)
    for degree in (13, 14, 15):
        contents = np.diff(faces ** (degree + 1) / (degree + 1))
        error = abs(weights @ contents + (-t / 8.0) ** (degree + 1) / (degree + 1))
        assert (error < 1e-18) == (degree < 15)


def test_balance_of_unequal_steps_is_exact_for_a_film_quadratic_in_time():
    for dt, older in ((1.0, 1.0), (0.5, 1.0), (1.0, 0.4)):
        now, *levels = (np.array([1.0 + 0.3 * t + 0.2 * t * t]) for t in (0.0, -dt, -dt - older))
        history = FilmHistory(*levels, dt, older)
        rate = positive_extrapolation(now[0], history.m[0], history.k)[0] - history.extrapolated[0]
        assert rate == pytest.approx(0.3 * dt, rel=1e-12)


@pytest.mark.parametrize("left, right", [(1.0, 1.0), (1.0, 0.3), (0.02, 1.0), (1e-6, 1.0)])
def test_face_has_the_resistance_of_a_linear_film(left, right):
    """Integral of h^-3 between the nodes, by Gauss points of each decade."""
    film, by_left, by_right = face_film(left, right, False)
    x = (np.polynomial.legendre.leggauss(20)[0] + 1.0) / 2.0
    weights = np.polynomial.legendre.leggauss(20)[1] / 2.0
    ratio = np.log(right / left)
    h = left * np.exp(ratio * x)  # in ln(h), where the integrand is smooth
    resistance = (weights * h**-2).sum() * ratio / (right - left) if left != right else left**-3
    tolerance = 1e-10 if abs(ratio) < 5.0 else 1e-6
    assert film**-3 == pytest.approx(resistance, rel=tolerance)
    step = 1e-6
    for k, by in enumerate((by_left, by_right)):
        ends = [
            face_film(left * (1 + s * (k == 0)), right * (1 + s * (k == 1)), False)[0] for s in (step, -step)
        ]
        assert by * (left, right)[k] == pytest.approx((ends[0] - ends[1]) / (2 * step), rel=1e-7)


@pytest.mark.parametrize("ratio", [1.0, 1.0 + 1e-9, 1.03, 1.05, 3.0, 1e9, 1e90])
def test_face_has_the_flow_of_barus_law(ratio):
    mean, by_left, by_right = face_mean(1.0, ratio, False)
    exact = (ratio - 1.0) / np.log(ratio) if abs(ratio - 1.0) > 1e-6 else 0.5 * (1.0 + ratio)
    assert mean == pytest.approx(exact, rel=1e-12)
    step = 1e-6
    for k, by in enumerate((by_left, by_right)):
        if (1.0, ratio)[k] < 1e-90 * ratio:
            continue
        ends = [face_mean(1.0 + s * (k == 0), ratio * (1.0 + s * (k == 1)), False)[0] for s in (step, -step)]
        expected = (ends[0] - ends[1]) / (2 * step)
        assert 0.5 * by * (1.0, ratio)[k] == pytest.approx(expected, rel=1e-5, abs=1e-9 * mean)


def test_a_closed_node_lets_nothing_through_unless_faces_leak():
    assert face_film(0.0, 1.0, False) == (0.0, 0.0, 0.0)
    assert face_film(0.0, 1.0, True)[0] == 0.5
    assert face_mean(0.0, 0.0, False)[0] == 0.0
    assert face_mean(1.0, 3.0, True) == (2.0, 1.0, 1.0)
