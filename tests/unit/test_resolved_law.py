"""Nodal law of the film's temperature with its profile: closed form, secant, balance, derivatives."""

import numpy as np
import pytest

from ehlpetsc.compiled import compiled
from ehlpetsc.effects.heat.film_law import FilmLaw
from ehlpetsc.effects.heat.resolved_law import resolved_temperature
from ehlpetsc.physics import film_shear, laws

ETA, ALPHA, REFERENCE, CONDUCTIVITY = 0.03, 20e-9, 333.0, 0.14
EXPONENTIAL = laws.EXPONENTIAL, 0.04, 0.0, REFERENCE
ROELANDS = laws.ROELANDS, 1.1, 0.0, REFERENCE
INSIDE = 345.0, 345.0, 0.0, 0.0  # walls of one temperature, whatever their heat


@compiled
def at_node(guess, p, h, left, a, b, g, spread, walls, law):
    return resolved_temperature(guess, p, h, left, a, b, g, spread, walls, law)


def film_law(
    thermal: tuple, sliding: float, eyring: float = 5e6, limit: float = np.inf, conduction: float = 0.0
):
    constants = laws.padded((ALPHA * 1.96e8 / 0.636, 1.96e8, 0.636, *thermal))
    oil = (list(laws.LAWS).index("roelands"), constants, REFERENCE)
    linear = thermal is EXPONENTIAL
    return FilmLaw(oil, linear, ETA, eyring, limit, CONDUCTIVITY, conduction, sliding)


def closed_form(law: FilmLaw, p: float, h: float, beta: float) -> film_shear.FilmStress:
    flow = film_shear.FlowLaw(film_shear.EYRING, law.eyring)
    if law.eyring == np.inf:
        flow = film_shear.FlowLaw(film_shear.NEWTON)
    eta = ETA * np.exp(laws.power_law(p, INSIDE[0], *law.viscosity[1][:7])[0])
    return film_shear.film_stress(h, eta, beta, *INSIDE[:2], CONDUCTIVITY, law.sliding, flow)


@pytest.mark.parametrize("eyring", [5e6, np.inf])
@pytest.mark.parametrize("p", [1e7, 0.5e9, 1e9])
@pytest.mark.parametrize("sliding", [0.05, 2.0, 25.0])
def test_exponential_law_has_the_closed_form(eyring, p, sliding):
    law, h = film_law(EXPONENTIAL, sliding, eyring), 0.5e-6
    t, _, _, q1, q2, heat, _, middle, shear_ln_eta = at_node(
        340.0, p, h, 1.0, 0.0, 0.0, 0.0, 0.0, INSIDE, law
    )
    closed = closed_form(law, p, h, 0.04)
    assert heat == pytest.approx(float(closed.stress) * sliding, rel=1e-7)
    assert (q1, q2) == pytest.approx((0.5 * heat, 0.5 * heat))
    assert (t - 345.0, middle - 345.0) == pytest.approx((float(closed.mean), float(closed.middle)), rel=1e-6)
    flow = film_shear.FlowLaw(
        film_shear.NEWTON if eyring == np.inf else film_shear.EYRING, min(eyring, 1e300)
    )
    scale = 1.0 if eyring == np.inf else eyring
    x = np.log(ETA * sliding / (h * scale)) + shear_ln_eta
    flow = flow._replace(stress=scale)
    assert film_shear.flow_stress(x, flow, np.inf)[0] == pytest.approx(heat / sliding, rel=1e-9)


@pytest.mark.parametrize("sliding", [0.5, 5.0, 20.0])
def test_other_laws_have_the_secant_to_the_middle(sliding):
    law, p, h = film_law(ROELANDS, sliding), 0.8e9, 0.5e-6
    *_, heat, _, middle, _ = at_node(340.0, p, h, 1.0, 0.0, 0.0, 0.0, 0.0, INSIDE, law)
    ln_eta = [laws.power_law(p, T, *law.viscosity[1][:7])[0] for T in (345.0, middle)]
    closed = closed_form(law, p, h, (ln_eta[0] - ln_eta[1]) / (middle - 345.0))
    assert heat == pytest.approx(float(closed.stress) * sliding, rel=1e-8)
    assert middle - 345.0 == pytest.approx(float(closed.middle), rel=1e-7)


@pytest.mark.parametrize("thermal", [EXPONENTIAL, ROELANDS], ids=["exponential", "roelands"])
def test_balance_and_derivatives_at_random_nodes(thermal):
    rng = np.random.default_rng(7)
    for _ in range(100):
        law = film_law(thermal, 10 ** rng.uniform(-2, 1.5), 5e6, rng.choice([np.inf, 0.06]), 1e-9)
        p, h, left = rng.uniform(1e7, 1.2e9), 10 ** rng.uniform(-7.5, -5.8), rng.choice([1.0, 0.6])
        a, walls = 10 ** rng.uniform(3, 6.5), (rng.uniform(335, 345), 345.0, *10 ** rng.uniform(-8, -6, 2))
        b, g, spread = a * rng.uniform(335, 360), rng.uniform(0, 1e7), rng.uniform(0, 0.3)

        def node(p, h, start=350.0, rest=(left, a, b, g, spread, walls, law)):
            return at_node(start, p, h, *rest)

        t, by_p, by_h, q1, q2, heat, *_ = node(p, h)
        assert abs(a * t - b - g - heat + q1 + q2) < 1e-11 * (abs(a * t - b) + g + heat + abs(q1) + abs(q2))
        scale = max(1.0, abs(by_p * p), abs(by_h * h))
        rise = 1e-5
        for derivative, size, ends in (
            (by_p, p, ((p * (1 + rise), h), (p * (1 - rise), h))),
            (by_h, h, ((p, h * (1 + rise)), (p, h * (1 - rise)))),
        ):
            high, low = (node(*end, t)[0] for end in ends)
            assert (high - low) / (2 * rise) == pytest.approx(derivative * size, abs=1e-4 * scale)


def test_extreme_nodes_keep_the_balance():
    rng = np.random.default_rng(3)
    missing = []
    for i in range(2000):
        thermal, eyring = (ROELANDS, EXPONENTIAL)[i % 2], rng.choice([1e6, 5e6])
        law = film_law(thermal, 10 ** rng.uniform(-4, 2), eyring, rng.choice([np.inf, 0.06]), 1e-9)
        a = rng.choice([0.0, 10 ** rng.uniform(2, 8)])
        b, g = a * rng.uniform(320, 400), rng.choice([0.0, 1e8])
        walls = (rng.uniform(315, 345), 345.0, *10 ** rng.uniform(-9, -5, 2))
        node = rng.uniform(0, 2e9), 10 ** rng.uniform(-9, -5), 1.0
        t, by_p, by_h, q1, q2, heat, *_ = at_node(rng.choice([300.0, 600.0]), *node, a, b, g, 0.5, walls, law)
        assert np.isfinite([t, by_p, by_h]).all() and t > 250.0
        missing.append(abs(a * t - b - heat - g + q1 + q2) / (heat + g + abs(q1) + abs(q2) + abs(b)))
    assert max(missing) < 1e-7 and np.median(missing) < 1e-13


def test_node_that_is_not_sheared():
    law = film_law(EXPONENTIAL, 0.0)
    t, by_p, by_h, q1, q2, heat, _, middle, _ = at_node(
        300.0, 1e9, 1e-6, 1.0, 0.0, 0.0, 1e6, 0.0, INSIDE, law
    )
    assert heat == 0.0 and np.isfinite([by_p, by_h]).all()
    assert (q1, q2) == pytest.approx((0.5e6, 0.5e6))
    assert t == pytest.approx(345.0 + 1e6 * 1e-6 / (12.0 * CONDUCTIVITY)) and middle == pytest.approx(t)


def test_viscosity_without_temperature_dependence_has_the_isothermal_stress():
    law = film_law((laws.EXPONENTIAL, 0.0, 0.0, REFERENCE), 5.0)._replace(is_linear=True)
    *_, heat, _, _, shear_ln_eta = at_node(340.0, 0.6e9, 0.5e-6, 1.0, 1e5, 3.4e7, 0.0, 0.0, INSIDE, law)
    assert shear_ln_eta == laws.power_law(0.6e9, 345.0, *law.viscosity[1][:7])[0]
    assert heat > 0.0
