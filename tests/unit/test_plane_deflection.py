"""Kernel of the deflection in the plane: quadrature, the line contact, periods."""

import numpy as np
import pytest
from scipy.integrate import dblquad
from support.convergence import observed_order

from ehlpetsc.discretisation.line.deflection import deflection_kernel
from ehlpetsc.discretisation.plane.deflection import (
    NEAR,
    Convolution,
    Deflection,
    Transposition,
    cell_potential,
    differences_of_primitive,
    free_kernel,
    periodic_kernel,
)

DX, DY = 0.03, 0.05
CIRCLE = 2.0 / np.pi**2  # C of a circular contact


def test_kernel_is_the_integral_over_a_cell():
    def integrand(t, s):
        return (1.0 - abs(s) / DX) / np.hypot(3 * DX - s, 2 * DY - t)

    parts = (dblquad(integrand, *ends, -DY / 2, DY / 2, epsabs=1e-14)[0] for ends in ((-DX, 0.0), (0.0, DX)))
    assert free_kernel(8, 8, DX, DY)[2, 3] == pytest.approx(sum(parts), abs=1e-15)


def test_expansion_and_differences_meet():
    exact = differences_of_primitive(NEAR + 20, NEAR + 20, DX, DY)
    expansion = cell_potential(np.arange(NEAR + 20) * DX, np.arange(NEAR + 20) * DY, DX, DY)
    np.testing.assert_allclose(expansion[NEAR - 1 :, NEAR - 1 :], exact[NEAR - 1 :, NEAR - 1 :], rtol=1e-12)


def test_strip_sums_to_the_line():
    line = -2.0 * DX * -(deflection_kernel(100) - np.log(DX))
    np.testing.assert_allclose(periodic_kernel(100, 24, DX, DY).sum(axis=0), line, rtol=0, atol=1e-15)


def test_strip_is_a_sum_over_many_periods():
    n_y, periods = 20, 200
    whole = free_kernel(30, (periods + 1) * n_y + 1, DX, DY)
    rows = np.abs(np.arange(n_y)[:, None] + np.arange(-periods, periods + 1) * n_y)
    summed = whole[rows].sum(axis=1)
    strip = periodic_kernel(30, n_y, DX, DY)
    waves, expected = (values - values.mean(axis=0) for values in (strip, summed))
    np.testing.assert_allclose(waves, expected, rtol=0, atol=2e-5 * expected.max())  # ~ 1/periods^2


def test_film_of_hertz_pressure_is_flat_to_second_order():
    spreads, approaches = [], []
    for points in (16, 32, 64):
        x = np.arange(-2 * points, 2 * points + 1) / points
        square = x**2 + x[:, None] ** 2
        deflection = Deflection((len(x), len(x)), (1 / points, 1 / points), CIRCLE, 1.0, False, slice(None))
        film = deflection.integral(np.sqrt(np.maximum(1.0 - square, 0.0)).ravel()) + 0.5 * square.ravel()
        inside = film[square.ravel() < 0.81]
        spreads.append(inside.std())
        approaches.append(inside.mean() - 1.0)
    assert spreads[-1] < 6e-5 and abs(approaches[-1]) < 4e-4
    assert observed_order(spreads) > 1.8


@pytest.mark.parametrize("periodic", (False, True))
def test_convolution_has_the_precision_of_its_argument(periodic):
    product = Convolution(
        (periodic_kernel if periodic else free_kernel)(33, 24, DX, DY), periodic, Transposition()
    )
    pressure = np.random.default_rng(5).random(24 * 33)
    exact, single = product(pressure), product(pressure.astype(np.float32))
    assert single.dtype == np.float32
    assert 1e-9 < np.abs(single - exact).max() / np.abs(exact).max() < 1e-6
