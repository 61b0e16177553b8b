"""Hertz scales, speeds and mesh; Hertz' gap, and film formulas against films computed independently."""

import math
import tomllib
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import quad
from support import CASES, one_fault, published_values
from support.exact_solutions import hertz_gap
from support.published_values import Film

from ehlpetsc.case import loading as case
from ehlpetsc.case.keys import template
from ehlpetsc.elasticity.bodies import reduced_modulus
from ehlpetsc.physics import film_formulas
from ehlpetsc.physics.contact import films
from ehlpetsc.physics.contact.geometry import line_groups
from ehlpetsc.physics.contact.hertz import hertz_ellipse, hertz_line, hertz_pressure
from ehlpetsc.physics.operation import Conditions, ConstantOperation
from ehlpetsc.physics.scales import Scales


def scales(name, *overrides):
    return Scales.of(case.load(CASES / name, overrides))


def test_moes_case_has_the_groups_of_its_title_which_fix_the_barus_exponent():
    s = scales("moes.toml")
    assert (s.moes_m, s.moes_l) == pytest.approx((20, 10), rel=1e-9)
    s = scales("moes.toml", "contact.load=2.09915459e6", "fluid.viscosity=0.01014206817")
    assert (s.moes_m, s.moes_l) == pytest.approx((100, 11), rel=1e-9)
    s = scales("waviness.toml")
    assert (s.moes_m, s.moes_l) == pytest.approx((100, 11), rel=1e-9)
    # alpha p0 = L sqrt(M / 2 pi), whatever the modulus: the exponent depends on the two groups alone
    alpha, load, radius, modulus = 2e-8, 1e5, 0.01, 2e11
    m, oil = line_groups(0.01, 1.0, alpha, load, radius, modulus, 1.0)
    p0 = modulus * math.sqrt(load / (modulus * radius) / (2 * math.pi))
    assert oil * math.sqrt(m / (2 * math.pi)) == pytest.approx(alpha * p0, rel=1e-12)


@pytest.mark.parametrize("ratio", [1e5, 1e9, 1e11])
def test_ellipse_of_radii_in_any_ratio_that_the_keys_allow(ratio):
    """Of a slender ellipse K = ln(4/k), E = 1: the ratio of the radii is 1/(k^2 (ln(4/k) - 1))."""
    along, across = (
        hertz_ellipse(20.0, 1e-9 * ratio, 1e-9, 2e11),
        hertz_ellipse(20.0, 1e-9, 1e-9 * ratio, 2e11),
    )
    k = along.b / along.a
    assert 1.0 / (k**2 * (math.log(4.0 / k) - 1.0)) == pytest.approx(ratio, rel=1e-4)
    assert 2.0 / 3.0 * math.pi * along.p0 * along.a * along.b == pytest.approx(20.0, rel=1e-12)
    assert across == along._replace(a=along.b, b=along.a)


def test_point_with_radii_of_a_ratio_of_a_thousand_million_is_refused_for_its_nodes():
    tables = tomllib.loads(template("point"))
    assert "000 in all" in one_fault(case.load, tables, {"contact.radius": [1e-7, 100.0]})


@pytest.mark.parametrize(("xi", "u1", "u2"), [(0.25, 5.625, 4.375), (2, 10, 0), (-4, -5, 15), (0, 5, 5)])
def test_speeds_of_both_surfaces(xi, u1, u2):
    s = scales("table1_smooth.toml", f"motion.slide_roll_ratio={xi}")
    assert (s.u1, s.u2, s.u_max) == pytest.approx((u1, u2, max(abs(u1), abs(u2))))


def test_time_step_duration_and_nodes():
    s = scales("table1_rough.toml")
    assert s.dt * s.u == pytest.approx(s.a / 200)
    assert s.duration * s.u1 == pytest.approx(6 * s.a)
    backwards = scales("table1_rough.toml", "motion.slide_roll_ratio=-4")
    # surfaces that move against each other pass the film faster than it moves
    assert 0.5 * backwards.dt * (backwards.u2 - backwards.u1) == pytest.approx(s.a / 200)
    operation = ConstantOperation(Conditions(s.load, s.R, backwards.u1, backwards.u2), 6 * s.a)
    assert operation.duration == operation.remaining(0.0, (0.0, 0.0)) == 6 * s.a / abs(backwards.u2)
    s = scales("table1_rough.toml")
    assert s.nx == s.x.size == 801
    assert (s.x[0], s.x[-1]) == (-2.5, 1.5)
    assert np.ptp(np.diff(s.x)) < 1e-12
    assert s.spacing == pytest.approx(s.a / 200)
    s = scales("dry_hertz.toml")
    assert (s.eta0, s.moes_m, s.moes_l, s.dt, s.duration) == (None,) * 5
    assert (s.u, s.u1, s.u2) == (0, 0, 0)


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
    gap = x**2 / (2 * R) + deflection(lambda s: hertz_pressure(s, A, P0), x, A)
    assert gap == pytest.approx(hertz_gap(x, A, R), abs=1e-7 * A**2 / R)


def test_table_1_modulus_half_width_pressure_and_gap():
    assert hertz_gap(-2.5 * A, A, R) == pytest.approx(12.27534e-6, rel=1e-6)
    np.testing.assert_array_equal(hertz_gap(np.linspace(-A, A, 5), A, R), 0.0)
    s = scales("table1_smooth.toml")
    assert s.E == pytest.approx(227.4725e9, rel=1e-6)
    assert s.a == pytest.approx(0.335682e-3, rel=2e-6)
    assert s.p0 == pytest.approx(0.999455e9, rel=1e-6)
    s = scales("table1_smooth.toml")
    assert math.pi / 2 * s.a * s.p0 == pytest.approx(s.load, rel=1e-14)
    assert reduced_modulus((207e9, 1e30), (0.3, 0.3)) == pytest.approx(2 * 207e9 / 0.91, rel=1e-12)


def test_expected_films_within_four_percent():
    further = Film(0.005, 1.0, 0.25, 0.04698, 0.05328), Film(0.02, 20.0, 0.25, 0.94910, 1.10198)  # on a/400
    for film in (*published_values.SMOOTH_FILMS, *further):
        keys = f"fluid.viscosity={film.viscosity}", f"motion.entrainment_speed={film.speed}"
        given = case.load(CASES / "table1_smooth.toml", keys)
        s = Scales.of(given)
        central, minimum = film_formulas.smooth_films(s, given.fluid, s.conditions)
        assert central * 1e6 == pytest.approx(film.h_central, rel=0.025)
        assert minimum * 1e6 == pytest.approx(film.h_min, rel=0.04)
    for point in published_values.MOES_POINTS:
        film = films.moes_central_film(point.M, point.L)
        assert films.MIN_OVER_CENTRAL_FILM * film == pytest.approx(point.h_min, rel=0.04)
    for point in published_values.MOES_POINTS:
        assert films.moes_central_film(point.M, point.L) == pytest.approx(point.h_central, rel=0.04)
    assert films.moes_central_film(1e-4, 1e-6) == pytest.approx(3e4, rel=0.01)
    elastic = 1.311 * 1e5**-0.125 * 30**0.75
    assert films.moes_central_film(1e5, 30.0) == pytest.approx(elastic, rel=0.1)
