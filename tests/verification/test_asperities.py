"""The law of the compliant layer against the integral of Persson's theory, evaluated numerically."""

import numpy as np
import pytest
from scipy.integrate import cumulative_trapezoid, trapezoid
from scipy.special import erf

from ehlpetsc.physics.contact.asperities import (
    FULL_CONTACT,
    GAMMA,
    MAX_DECAYS,
    LayerLaw,
    asperity_pressures,
    asperity_separations,
    asperity_stiffness,
    flow_factor,
    real_area_fraction,
)

ENERGY = (
    0.45  # of the elastic energy of complete contact over the patches in contact, Yang and Persson (2008)
)


def separations(pressure, hurst, decades, nodes=1500):
    r"""Mean separation over rms height by Persson's theory, pressure in E*, wavenumbers in 1/h_rms.

    .. math:: u(p)=\sqrt\pi\int_{q_0}^{q_1}q^2C(q)w(q)\int_p^\infty\frac{dp'}{p'}
       [\gamma+3(1-\gamma)P^2]e^{-(wp'/E^*)^2},\quad w=\Big(\pi\int_{q_0}^qq'^3C\,dq'\Big)^{-1/2},

    P = erf(w p'/E*), C the isotropic spectrum of a self-affine surface without roll-off, q_0 = 1.
    """
    q = np.geomspace(1.0, 10.0**decades, nodes)
    spectrum = q ** (-2.0 * (1.0 + hurst))
    spectrum /= 2.0 * np.pi * trapezoid(q * spectrum, q)
    moment = q**3 * spectrum
    w = (np.pi * np.cumsum(0.5 * (moment[1:] + moment[:-1]) * np.diff(q))) ** -0.5
    x = np.geomspace(1e-12, 30.0, 30_000)  # the inner integral depends on w p/E* alone
    inner = (ENERGY + 3.0 * (1.0 - ENERGY) * erf(x) ** 2) * np.exp(-(x**2))
    inner = cumulative_trapezoid(inner[::-1], -np.log(x[::-1]), initial=0.0)[::-1]
    inner = np.interp(np.log(np.outer(pressure, w)), np.log(x), inner)
    return np.sqrt(np.pi) * trapezoid(q[1:] ** 2 * spectrum[1:] * w * inner, q[1:])


@pytest.mark.parametrize("hurst, decades", [(0.5, 1), (0.7, 2), (0.8, 1), (0.8, 3), (0.9, 2)])
def test_decay_and_prefactor_are_within_the_stated_range(hurst, decades):
    light = np.geomspace(1e-6, 1e-4, 8)
    slope, ln_beta = np.polyfit(separations(light, hurst, decades), np.log(light), 1)
    assert 0.43 < -1.0 / slope < 0.55
    assert 1.35 < np.exp(ln_beta) < 2.45  # times q_0 h_rms, which is 1 here
    moderate = np.geomspace(1e-3, 1.0, 40)
    u = separations(moderate, hurst, decades)
    some = (u > 0.5) & (u < 3.0)
    slope, ln_beta = np.polyfit(u[some], np.log(moderate[some]), 1)
    assert abs(-1.0 / slope / GAMMA - 1.0) < 0.12
    assert 0.98 < np.exp(ln_beta) < 1.7


LAWS = {
    "elastic": LayerLaw(1e-3, 100.0),
    "adsorbed film": LayerLaw(1e-3, 100.0, 0.0, 2e-3),
    "hard": LayerLaw(1e-3, 100.0, 1e-3, 2e-3),  # hardness 1000
    "soft": LayerLaw(1e-3, 100.0, 125.0),  # hardness 20
}


@pytest.mark.parametrize("name", LAWS)
def test_pressure_and_separation_are_inverse_and_smooth(name):
    law = LAWS[name]
    pressure = np.geomspace(1e-9, 0.99 * hardness(law), 200)
    h = asperity_separations(pressure, law)
    assert (h > law.full_contact).all()
    found, slope = asperity_pressures(h, law)
    np.testing.assert_allclose(found, pressure, rtol=1e-11)
    step = 1e-6 * (h - law.full_contact)
    forward, backward = (asperity_pressures(h + k * step, law)[0] for k in (1, -1))
    np.testing.assert_allclose(slope, (forward - backward) / (2.0 * step), rtol=1e-4)


def hardness(law):
    return law.prefactor * law.closed ** (-1.0 / 3.0) if law.closed else 10.0 * law.prefactor


@pytest.mark.parametrize("name", LAWS)
def test_law_is_exponential_far_out(name):
    law = LAWS[name]
    h = law.full_contact + law.decay * np.array(
        [14.0, MAX_DECAYS * (1 - 1e-9), MAX_DECAYS * (1 + 1e-9), 200.0]
    )
    found, slope = asperity_pressures(h, law)
    expected = law.prefactor * np.exp(-(h - law.full_contact) / law.decay)
    np.testing.assert_allclose(found, expected, rtol=1e-13)
    np.testing.assert_allclose(slope, -expected / law.decay, rtol=1e-13)


@pytest.mark.parametrize("name", ["hard", "soft"])
def test_contact_is_full_at_the_hardness(name):
    """No gap but the adsorbed film, all of the area in contact; the pressure is bounded until then."""
    law = LAWS[name]
    limit = hardness(law)
    assert asperity_separations(np.array([limit]), law)[0] == pytest.approx(law.full_contact, abs=1e-15)
    assert real_area_fraction(np.array([limit]), 1e4, limit)[0] == 1.0
    open_gaps = law.full_contact + law.decay * np.geomspace(1e-9, 100.0, 200)
    assert (asperity_pressures(open_gaps, law)[0] <= limit).all()
    beyond = np.array([1.1, 2.0]) * limit  # an elastic body carries more, on a film that stays positive
    h = asperity_separations(beyond, law)
    assert (h > law.full_contact - FULL_CONTACT * law.decay).all()
    np.testing.assert_allclose(asperity_pressures(h, law)[0], beyond, rtol=1e-9)
    elastic = law._replace(closed=0.0)
    light = np.array([1e-3]) * limit
    np.testing.assert_allclose(
        asperity_separations(light, law), asperity_separations(light, elastic), rtol=1e-9
    )


def test_slope_of_the_law_equals_its_complex_step():
    h = np.geomspace(1e-4, 12.0, 60)
    for closed in (0.0, 1e-3):
        complex_step = np.imag((np.exp(3.0 * (h + 1e-30j)) - 1.0 + closed) ** (-1.0 / 3.0)) / 1e-30
        law = LayerLaw(1.0, 1.0, closed)
        np.testing.assert_allclose(asperity_pressures(h, law)[1], complex_step, rtol=1e-10)


@pytest.mark.parametrize(
    "hurst, decades", [(0.7, 1), (0.7, 2), (0.8, 1), (0.8, 2), (0.8, 3), (0.9, 1), (0.9, 2)]
)
def test_law_with_the_default_stiffness_is_that_of_the_theory(hurst, decades):
    """From first touch to flattened asperities, in rms heights; 0.3 is a factor of 1.8 in pressure."""
    pressure = np.geomspace(3e-3, 30.0, 40)
    beta = asperity_stiffness(1.0, 2.0 * np.pi)  # wavenumbers in 1/h_rms, q_0 = 1
    expected = separations(pressure, hurst, decades)
    found = asperity_separations(pressure, LayerLaw(GAMMA, beta))
    assert np.abs(found - expected).max() < 0.3
    assert found[-1] < 1e-4 and expected[-1] < 1e-4  # flattened


def test_flow_through_the_layer_percolates():
    """Beside the factors computed for isotropic elastic roughness; 1e-4 is left of closed channels."""
    gaps, expected = (2.39, 1.96, 1.42, 0.88, 0.337, 0.118), (0.852, 0.794, 0.661, 0.441, 0.019, 0.0)
    assert [flow_factor(h, 1.0)[0] for h in gaps] == pytest.approx(expected, abs=0.035)
    assert flow_factor(0.0, 2.0)[0] == pytest.approx(1e-4, rel=0.01)
    assert flow_factor(1e3, 2.0)[0] == 1.0
    for h in (0.1, 0.6, 3.0):
        forward, backward = (flow_factor(h + step, 2.0)[0] for step in (1e-5, -1e-5))
        assert flow_factor(h, 2.0)[1] == pytest.approx((forward - backward) / 2e-5, rel=1e-5)


def test_real_area_is_complete_at_the_hardness_and_bounds_the_pressure():
    pressure = np.linspace(1e-3, 1.0, 200)
    for slope_modulus in (0.1, 0.5, 1.0, 2.0, 20.0):
        area = real_area_fraction(pressure, slope_modulus, 1.0)
        assert area[-1] == 1.0 and (np.diff(area) > -1e-12).all()
        assert (pressure <= area * (1.0 + 1e-9)).all()
        assert (area >= real_area_fraction(pressure, slope_modulus) - 1e-12).all()
    np.testing.assert_allclose(real_area_fraction(pressure, 50.0, 1.0), pressure, rtol=1e-9)
    light = 0.2 * pressure
    elastic = real_area_fraction(light, 0.2)
    np.testing.assert_allclose(real_area_fraction(light, 0.2, 1.0), elastic, rtol=1e-9)


def test_real_area_is_linear_at_light_load_and_complete_at_heavy_load():
    light, heavy = real_area_fraction(np.array([1e-4, 100.0]), 1.0)
    assert light == pytest.approx(2.0e-4, rel=1e-6)
    assert heavy == 1.0
