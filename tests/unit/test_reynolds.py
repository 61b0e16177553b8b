"""Reynolds' rows: their derivatives, and that a part of the mesh has the rows of the whole."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import petsc4py
import pytest

petsc4py.init([])

from ehlpetsc.case.loading import load
from ehlpetsc.discretisation.contact.node_state import AMBIENT_TOLERANCE
from ehlpetsc.discretisation.finite_volumes import flux_through
from ehlpetsc.discretisation.reynolds import NoOil, Reynolds
from ehlpetsc.discretisation.step_inputs import FilmHistory, IsothermalOil, StepInputs
from ehlpetsc.discretisation.unknowns import Share
from ehlpetsc.nonlinear.line.jacobian import reynolds_columns
from ehlpetsc.physics.contact.grid import Grid
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


def test_a_face_has_the_flux_of_its_nodes_wherever_they_are():
    reynolds, inputs, n = rows_of([])
    at = reynolds.properties(*state(n), inputs.oil)
    order = np.random.default_rng(1).permutation(n + 1)
    mixed, place = np.ascontiguousarray(at[:, order]), np.argsort(order)
    table, law = inputs.flow_table, reynolds.face_law(inputs, reynolds.dx)
    for nodes in ((0, 0, 1), (0, 1, 2), (19, 20, 21), (n - 2, n - 1, n)):
        assert flux_through(mixed, *place[list(nodes)], table, law) == flux_through(at, *nodes, table, law)


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


def test_reynolds_rows_of_a_part_equal_the_whole():
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


def test_reynolds_rows_of_a_part_without_oil_equal_the_whole():
    q = np.random.default_rng(7).uniform(-1.0, 1.0, 40)
    grid = Grid((np.arange(40.0),), (1.0,), (1.0,), (1.0,), 1.0)
    whole, part = (NoOil(grid, part_of_line(*ends)) for ends in ((0, 40, 40), (12, 30, 40, 10)))
    (rows, entries), (some, of_part) = whole.evaluate(q, q, None), part.evaluate(q[10:], q[10:], None)
    np.testing.assert_array_equal(some, rows[12:30])
    np.testing.assert_array_equal(of_part, entries[12:30])


def test_derivatives_do_not_depend_on_the_sign_of_rounding():
    """At ambient pressure, give or take rounding, a node is full of oil: derivatives as from above."""
    reynolds, inputs, n = rows_of([])
    q, h = state(n)
    rows = []
    for rounding in (2.0 * AMBIENT_TOLERANCE, 0.0, 1e-20, -0.5 * AMBIENT_TOLERANCE):
        q[0] = rounding
        rows.append(reynolds.evaluate(q, h, inputs)[1])
    np.testing.assert_allclose(rows[1], rows[0], rtol=1e-9)
    np.testing.assert_allclose(rows[2], rows[1], rtol=1e-12)
    np.testing.assert_allclose(rows[3], rows[1], rtol=1e-9)
