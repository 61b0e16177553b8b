"""Hertz' gap is the deflected parabola; film formulas against films computed independently."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad
from support import CASES, published_values

from ehlpetsc.case.loading import load
from ehlpetsc.physics import film_formulas
from ehlpetsc.physics import scales as hertz
from ehlpetsc.physics.scales import Scales, hertz_line, moes_groups, reduced_modulus

E = reduced_modulus((207e9, 207e9), (0.3, 0.3))
R = 0.0191
LOAD = 527e3
A, P0 = hertz_line(LOAD, R, E)


def deflection(pressure, x, a):
    """Deflection at x [m] less that at 0: minus 4/(pi E') times the integral of p(s) ln|(x-s)/s|."""
    cuts = sorted({-a, 0.0, min(max(x, -a), a), a})

    def integrand(s):
        return pressure(s) * np.log(abs((x - s) / s))

    parts = [quad(integrand, b, e, epsabs=0, epsrel=1e-10, limit=400)[0] for b, e in pairwise(cuts)]
    return -4.0 / (np.pi * E) * sum(parts)


@pytest.mark.parametrize("ratio", [0.2, 0.7, 1.0, 1.3, 2.5])
def test_hertz_gap_is_the_deflected_parabola(ratio):
    x = ratio * A
    gap = x**2 / (2 * R) + deflection(lambda s: hertz.hertz_pressure(s, A, P0), x, A)
    assert gap == pytest.approx(hertz.hertz_gap(x, A, R), abs=1e-7 * A**2 / R)


def test_hertz_gap_at_the_inlet():
    assert hertz.hertz_gap(-2.5 * A, A, R) == pytest.approx(12.27534e-6, rel=1e-6)
    np.testing.assert_array_equal(hertz.hertz_gap(np.linspace(-A, A, 5), A, R), 0.0)


def test_moes_fit_approximates_films_and_its_asymptotes():
    for point in published_values.MOES_POINTS:
        assert film_formulas.moes_central_film(point.M, point.L) == pytest.approx(point.h_central, rel=0.04)
    assert film_formulas.moes_central_film(1e-4, 1e-6) == pytest.approx(3e4, rel=0.01)
    elastic = 1.311 * 1e5**-0.125 * 30**0.75
    assert film_formulas.moes_central_film(1e5, 30.0) == pytest.approx(elastic, rel=0.1)


def test_expected_films_within_four_percent():
    """Of the compressible Table 1 oil, and of the incompressible Barus one; further films by a/400."""
    for film in published_values.SMOOTH_FILMS:
        given = ["motion.slide_roll_ratio=0.25", f"fluid.viscosity={film.viscosity}"]
        case = load(CASES / "table1_smooth.toml", [*given, f"motion.entrainment_speed={film.speed}"])
        scales = Scales.of(case)
        central, minimum = film_formulas.smooth_films(case.fluid, scales.E, scales.conditions)
        assert central * 1e6 == pytest.approx(film.h_central, rel=0.025)
        assert minimum * 1e6 == pytest.approx(film.h_min, rel=0.04)
    for viscosity, speed, h_min, h_central in (  # computed on a/400
        (0.005, 1.0, 0.04698, 0.05328),
        (0.02, 20.0, 0.94910, 1.10198),
    ):
        given = [f"fluid.viscosity={viscosity}", f"motion.entrainment_speed={speed}"]
        case = load(CASES / "table1_smooth.toml", given)
        scales = Scales.of(case)
        central, minimum = film_formulas.smooth_films(case.fluid, scales.E, scales.conditions)
        assert central * 1e6 == pytest.approx(h_central, rel=0.025)
        assert minimum * 1e6 == pytest.approx(h_min, rel=0.04)
    for point in published_values.MOES_POINTS:
        film = film_formulas.moes_central_film(point.M, point.L)
        assert film_formulas.MIN_OVER_CENTRAL_FILM * film == pytest.approx(point.h_min, rel=0.04)


def test_smooth_films_are_below_the_moes_fit_by_less_than_a_quarter():
    """Table 1 films are thinner than the fit, by shear thinning and density, but by less than a quarter."""
    for film in published_values.SMOOTH_FILMS:
        m, length = moes_groups(film.viscosity, film.speed, 11.1e-9, LOAD, R, E)
        scale = R * np.sqrt(2 * film.viscosity * film.speed / (E * R)) * 1e6
        assert 0.75 < film.h_central / (film_formulas.moes_central_film(m, length) * scale) < 1.0
