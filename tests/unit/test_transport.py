"""Fields carried along the path of the film: mass, sign, accuracy; what a face lets through."""

import numpy as np
import pytest

from ehlpetsc.discretisation.finite_volumes import face_film, face_mean
from ehlpetsc.discretisation.transport import carried, carried_with

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


def test_there_and_back_is_symmetric():
    rows = RNG.uniform(0.5, 1.0, (1, 60))
    np.testing.assert_allclose(carried(rows, 0.3)[:, ::-1], carried(rows[:, ::-1], -0.3), rtol=1e-14)


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


def test_a_temperature_is_carried_with_its_oil():
    mass = RNG.uniform(0.1, 1.0, (1, 50))
    even = np.full((1, 50), 363.0)
    np.testing.assert_allclose(carried_with(mass, even, 0.4, 363.0), 363.0, rtol=1e-14)
    warm = 363.0 + RNG.uniform(0.0, 30.0, (1, 50))
    found = carried_with(mass, warm, 0.4, 363.0)
    assert found.min() >= 363.0 and found.max() <= warm.max()
    np.testing.assert_array_equal(carried_with(mass, warm, 1.0, 363.0)[:, 1:], warm[:, :-1])


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
    """Mean over the pressure of a fluidity exponential in it, and its derivatives."""
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
