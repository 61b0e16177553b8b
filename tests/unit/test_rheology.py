"""Flow of an Eyring film: check values, and derivatives against the complex step."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import brentq

from ehlpetsc.base.compiled import address_of
from ehlpetsc.physics import traction
from ehlpetsc.physics.oil import rheology, tabulated_flow

STEP = 1e-30
OIL = SimpleNamespace(viscosity=0.005, eyring_stress=10e6)


@pytest.mark.parametrize(
    "sigma, zeta, factor",
    [
        (0.0, 10.0, 10.04987562),
        (1.0, 0.0, 1.103638324),
        (1.0, 3.0, 3.025771941),
        (5.0, 0.0, 7.124316769),
        (5.0, 3.0, 7.268422125),
        (20.0, 1e6, 1734265.348),
    ],
)
def test_eyring_factor(sigma, zeta, factor):
    fluid, h, eta = OIL, 1e-7, 0.5
    gradient = 2.0 * fluid.eyring_stress * sigma / h
    sliding = zeta * fluid.eyring_stress * h / eta
    law = fluid.eyring_stress, sliding / fluid.eyring_stress
    for side, values in enumerate(rheology.mobilities(h, gradient, 1.0 / eta, 1.0 / eta, *law)):
        assert values[0] * 12.0 * eta / h**3 == pytest.approx(factor, rel=1e-9), side


CARREAU = (rheology.CARREAU, 0.45, 1.5)


def cross_factor(kind, sigma, zeta, h=1e-7, eta=0.5):
    """Flow across a sliding film over that of a Newtonian oil without sliding, for two oils in one gap."""
    stress = OIL.eyring_stress
    table = tabulated_flow.cross_flow_table(*kind)
    state = h, 2.0 * stress * sigma / h, 1.0 / eta, 0.1 / eta, stress, zeta * h / eta
    return tabulated_flow.tabulated_mobilities(*state, table)[0][0] * 12.0 * eta / h**3


@pytest.mark.parametrize("zeta", [0.1, 10.0, 1e4, 1e9])
@pytest.mark.parametrize(
    "sigma, tolerance", [(1e-4, 1e-5), (0.1, 1e-5), (1.0, 1e-4), (3.0, 1e-4), (6.0, 1e-4), (12.0, 3e-3)]
)
def test_flow_across_a_sliding_eyring_film(zeta, sigma, tolerance):
    """By midpoints of 4000 cells; the secant law alone is 20 and 45 % too low at Sigma = 3 and 6."""
    across = 2.0 * sigma * ((np.arange(4000) + 0.5) / 4000 - 0.5)

    def rate(along):
        total = np.hypot(along, across)
        return np.sinh(total) / total

    along = brentq(lambda tau: (rate(tau) * tau).mean() - zeta, 1e-9, 40.0, xtol=1e-13)
    exact = 12.0 * (((across / (2.0 * sigma)) ** 2) * rate(along)).mean()
    assert cross_factor((rheology.EYRING, 1.0, 2.0), sigma, zeta) == pytest.approx(exact, rel=tolerance)


def test_limits_of_the_flow_across_a_sliding_film():
    assert tabulated_flow.cross_flow_table(rheology.NEWTON, 1.0, 2.0).size == 0
    assert cross_factor((rheology.EYRING, 1.0, 2.0), 5.0, 0.0) == pytest.approx(7.124316769, rel=1e-4)
    thinned = (1.0 + 50.0**1.5) ** (0.55 / 1.5)  # viscosity over that of the sliding film, the secant
    assert cross_factor(CARREAU, 1e-4, 50.0) == pytest.approx(thinned, rel=1e-4)
    both = [
        tabulated_flow.tabulated_mobilities(1e-7, 4e14, 2.0, 0.3, 1e7, 0.0, table)[0][0]
        for table in (tabulated_flow.cross_flow_table(*CARREAU), tabulated_flow.flow_table(*CARREAU))
    ]
    assert both[0] == pytest.approx(both[1], rel=2e-4)  # at rest both ways are alike


def test_wall_shear():
    fluid = OIL
    ln_eta = np.log([0.5 / fluid.viscosity])
    (lower,), (upper,) = traction.wall_shear(np.array([0.2e-6]), 2e14, ln_eta, fluid, 1.25, np.array([1e9]))
    np.testing.assert_allclose((lower, upper), [-18.285163e6, 21.714837e6], rtol=1e-7)


@pytest.mark.parametrize("stress, limit", [(1e6, 5e7), (5e7, 5e7), (9e8, 5e7), (1e6, 1.2e6)])
def test_limited_shear(stress, limit, uncompiled):
    value, by_stress, by_limit = rheology.limited_shear(stress, limit)
    assert value <= min(stress, limit)
    if max(stress, limit) >= 1.2 * min(stress, limit):
        assert value == pytest.approx(min(stress, limit), rel=0.0015)
    assert value >= 0.9659 * min(stress, limit)
    stepped = (stress + STEP * 1j, limit), (stress, limit + STEP * 1j)
    for arguments, slope in zip(stepped, (by_stress, by_limit), strict=True):
        assert rheology.limited_shear(*arguments)[0].imag / STEP == pytest.approx(slope, rel=1e-12)


@pytest.mark.parametrize("stress", [10e6, np.inf])
@pytest.mark.parametrize("sliding", [0.0, 1.25, 6.0])
def test_derivatives_of_mobility(stress, sliding, uncompiled):
    def mobility(h, gradient, fluidity, stress, slip):
        other = 3.0 * fluidity  # the oil on the other side must not matter
        both = np.vectorize(lambda *at: rheology.mobilities(*at, stress, slip)[0])
        return both(h, gradient, fluidity, other)

    rng = np.random.default_rng(3)
    h, ln_eta = 10.0 ** rng.uniform(-8, -6, 200), rng.uniform(0.0, 20.0, 200)
    slope = 10.0 ** rng.uniform(11, 14.5, 200) * rng.choice([-1.0, 1.0], 200)
    fluidity, slip = np.exp(-ln_eta) / 0.005, sliding / stress
    value, *exact = mobility(h, slope, fluidity, stress, slip)
    if stress == np.inf:
        np.testing.assert_allclose(value, h**3 * fluidity / 12.0, rtol=1e-14)
    step = 1j * STEP
    stepped = (
        mobility(h + step, slope + 0j, fluidity + 0j, stress, slip),
        mobility(h + 0j, slope + step, fluidity + 0j, stress, slip),
        mobility(h + 0j, slope + 0j, fluidity * (1.0 - step), stress, slip),  # of ln(eta)
    )
    for derivative, values in zip(exact, stepped, strict=True):
        step = values[0].imag / STEP
        np.testing.assert_allclose(derivative, step, rtol=2e-7, atol=1e-9 * np.abs(step).max())


# ---- Carreau ----

STRESS, FILM, ETA = 6e6, 0.4e-6, 5.0


def carreau(n, a):
    return rheology.FlowLaw(rheology.CARREAU, STRESS, n, a)


@pytest.mark.parametrize("n, a", [(0.45, 2.0), (0.35, 5.0)])
def test_rate_inverts_the_stress_of_carreaus_law(n, a):
    for x in np.linspace(-15.0, 15.0, 31):
        stress, by_x, _ = rheology.flow_stress(x, carreau(n, a), np.inf)
        rate, slope = tabulated_flow.rate_of_stress(-stress / STRESS, carreau(n, a))
        assert -rate == pytest.approx(np.exp(x), rel=1e-12)
        assert slope == pytest.approx(-rate * STRESS / by_x, rel=1e-9)


@pytest.mark.parametrize("n, a", [(0.45, 2.0), (0.35, 5.0), (0.8, 1.0)])
@pytest.mark.parametrize("sliding", [0.0, 0.3, 5.0])
@pytest.mark.parametrize("drop", [0.0, 0.1, 1.0, 4.0, 60.0])
def test_flow_of_carreaus_law_across_a_film(n, a, sliding, drop):
    """Mobility and stress by the table, against 2,000 points across the film."""
    gradient = drop * STRESS / FILM
    flow = carreau(n, a)
    table = tabulated_flow.flow_table(*flow[:1], n, a)
    state = FILM, gradient, 1.0 / ETA, 1.0, STRESS, sliding / STRESS
    (mobility, *_), _ = tabulated_flow.tabulated_mobilities(*state, table)
    fluid = SimpleNamespace(viscosity=ETA, carreau_stress=STRESS, carreau_exponent=n, carreau_width=a)
    zero = np.zeros(1)
    (lower,), (upper,) = traction.wall_shear(np.full(1, FILM), gradient, zero, fluid, sliding, zero)
    z = (np.arange(2000) + 0.5) / 2000 - 0.5
    gamma = ETA * sliding / FILM / STRESS
    stress = 0.5 * (lower + upper) / STRESS
    rate = np.array([tabulated_flow.rate_of_stress(stress + at * drop, flow)[0] for at in z])
    assert rate.mean() == pytest.approx(gamma, rel=5e-4, abs=1e-12)
    if drop:
        moment = 12.0 * (z * rate).mean() / drop
        assert mobility * 12.0 * ETA / FILM**3 == pytest.approx(moment, rel=2e-4)
    elif not sliding:
        assert mobility == pytest.approx(FILM**3 / (12.0 * ETA), rel=1e-6)


def sinh_law(x, stress):
    """Eyring's law as one of the user."""
    e = np.exp(x)
    root = np.sqrt(1.0 + e * e)
    return stress * (np.log(e + root) if x > -2.0 else np.arcsinh(e)), stress * e / root


@pytest.fixture(scope="module")
def own():
    return address_of(sinh_law, 1, 1)


@pytest.mark.parametrize("zeta", [1e-30, 0.3, 5.0, 1e6])
@pytest.mark.parametrize("sigma", [0.0, 0.5, 2.0, 10.0])
def test_flow_of_a_users_law_is_that_of_the_same_law_built_in(own, sigma, zeta):
    table, closed = tabulated_flow.flow_table(own, 1.0, 2.0), tabulated_flow.flow_table(rheology.EYRING, 1, 2)
    slip = zeta * FILM / ETA
    state = FILM, 2.0 * STRESS * sigma / FILM, 1.0 / ETA, 3.0 / ETA, STRESS, slip
    found = tabulated_flow.tabulated_mobilities(*state, table)
    for side, expected in zip(found, rheology.mobilities(*state), strict=True):
        assert side[0] == pytest.approx(expected[0], rel=1e-5)
        relative = np.array([FILM, state[1], 1.0]) / expected[0]
        np.testing.assert_allclose(relative * side[1:], relative * expected[1:], rtol=0.0, atol=3e-3)
    x = np.log(zeta)
    spread = tabulated_flow.stress_spread(sigma, x, table)
    assert spread == pytest.approx(tabulated_flow.stress_spread(sigma, x, closed), abs=1e-6)
    assert rheology.flow_stress(x, rheology.FlowLaw(own, STRESS), 5e7)[:2] == pytest.approx(
        rheology.flow_stress(x, rheology.FlowLaw(rheology.EYRING, STRESS), 5e7)[:2], rel=1e-12
    )


@pytest.mark.parametrize("zeta", [1e-30, 1e-6, 1e-4])
def test_stress_of_a_hardly_sliding_film_in_a_steep_pressure_gradient_keeps_its_digits(own, zeta):
    """Rates of 1e7 of both signs across the film have a mean of `zeta`: 6 % off by their sum."""
    tables = tabulated_flow.flow_table(own, 1.0, 2.0), tabulated_flow.flow_table(rheology.EYRING, 1, 2)
    found, exact = (tabulated_flow.stress_spread(20.0, np.log(zeta), table) for table in tables)
    assert found == pytest.approx(exact, abs=1e-6)


@pytest.mark.parametrize("gradient", [1e10, -8e12, 6e13])
@pytest.mark.parametrize("law", ["carreau", "own"])
def test_derivatives_of_a_tabulated_flow(gradient, law, own):
    state = {"h": FILM, "gradient": gradient, "ln_eta": np.log(ETA)}
    constants = (rheology.CARREAU, 0.45) if law == "carreau" else (own, 1.0)
    table = tabulated_flow.flow_table(*constants, 2.0)

    def mobility(values):
        fluidity = np.exp(-values["ln_eta"])
        at = values["h"], values["gradient"], fluidity, fluidity, STRESS, 2.0 / STRESS
        return tabulated_flow.tabulated_mobilities(*at, table)[1]

    value, *derivatives = mobility(state)
    for key, derivative in zip(state, derivatives, strict=True):
        step = 1e-5 * abs(state[key])
        up, down = (mobility(state | {key: state[key] + sign * step})[0] for sign in (1.0, -1.0))
        found = (up - down) / (2.0 * step)
        assert found == pytest.approx(derivative, rel=1e-6, abs=1e-7 * value / abs(state[key]))
