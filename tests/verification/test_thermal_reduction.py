"""Thermal reduction of film and friction against published formulas."""

import numpy as np
import pytest
import thermal_reduction as published
from scipy.integrate import solve_bvp


@pytest.mark.parametrize("point", published.ROLLING)
def test_film_in_pure_rolling(point):
    cold, warm = (published.solve(*point, heated, 50) for heated in (False, True))
    load, found = published.thermal_load(*point[:2]), warm.film / cold.film
    assert found == pytest.approx(published.wilson_sheu(load, 0.0), rel=0.015)
    assert found == pytest.approx(published.murch_wilson(load), rel=0.02)


@pytest.mark.slow
@pytest.mark.parametrize("point", published.POINTS)
def test_friction_and_minimum_film(point):
    """At 25 m/s the film's own heating and what its inlet carries in, left out by theory, count most."""
    cold, warm = (published.solve(*point, heated, 50) for heated in (False, True))
    theory = published.friction_by_theory(cold, False), published.friction_by_theory(warm, True)
    assert cold.friction == pytest.approx(theory[0], rel=0.1)
    assert warm.friction == pytest.approx(theory[1], rel=0.1)
    least = published.hsu_lee(published.thermal_load(*point[:2]), point[2], cold.simulation)
    assert warm.least / cold.least == pytest.approx(least, rel=0.08)


def test_stress_of_a_heated_film_solves_the_heat_equation_across_it():
    viscosity, film, sliding = 50.0, 0.3e-6, 4.0
    stress = published.film_stress(viscosity, film, sliding)

    def slopes(y, values, unknown):
        rise, flux, _ = values
        rate = published.EYRING / viscosity * np.sinh(unknown[0] / published.EYRING)
        local = rate * np.exp(published.BETA * rise)
        return np.array([flux, -unknown[0] * local * film**2 / published.OIL, local * film])

    def ends(a, b, unknown):
        return np.array([a[0], b[0], a[2], b[2] - sliding])

    y = np.linspace(0.0, 1.0, 101)
    begin = np.array([80.0 * y * (1.0 - y), 80.0 * (1.0 - 2.0 * y), sliding * y])
    found = solve_bvp(slopes, ends, y, begin, [0.5 * published.isothermal_stress(viscosity, film, sliding)])
    assert found.success and stress == pytest.approx(found.p[0], rel=1e-3)
    assert stress < 0.8 * published.isothermal_stress(viscosity, film, sliding)
