"""Lubricant laws: check values and derivatives against the complex step."""

from types import SimpleNamespace

import numpy as np
import pytest

from ehlpetsc.physics import rheology

STEP = 1e-30


def oil(**changes):
    keys = dict(
        viscosity=0.005,
        law="seed",
        pressure_viscosity=11.1e-9,
        kappa=63.2e-6,
        chi=5.1e-9,
        roelands_z=0.68,
        roelands_pressure=0.196e9,
        density="dowson-higginson",
        gamma=2.27e-9,
        lambda_=1.68e-9,
        eyring_stress=10e6,
    )
    return SimpleNamespace(**{**keys, **changes})


GPA = 1e9 * np.array([0.0, 0.5, 1.0, 2.0, 4.0])


@pytest.mark.parametrize(
    "eta0, values",
    [
        (0.005, [0.005, 0.2333503, 2.962664, 132.4506, 33651.48]),
        (0.001, [0.001, 0.113767, 6.14164, 7115.26, 1.63311e9]),
    ],
)
def test_roelands_viscosity_by_reference_constants(eta0, values):
    ln_eta, _ = rheology.viscosity(GPA, oil(viscosity=eta0))
    np.testing.assert_allclose(eta0 * np.exp(ln_eta), values, rtol=5e-6)


def test_dowson_higginson_density():
    rho, _ = rheology.density(GPA, oil())
    np.testing.assert_allclose(rho, [1.0, 1.160326, 1.220149, 1.270642, 1.305699], rtol=5e-7)


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
    fluid, h, eta = oil(), 1e-7, 0.5
    gradient = 2.0 * fluid.eyring_stress * sigma / h
    sliding = zeta * fluid.eyring_stress * h / eta
    law = fluid.eyring_stress, sliding / fluid.eyring_stress
    for side, values in enumerate(rheology.mobilities(h, gradient, 1.0 / eta, 1.0 / eta, *law)):
        assert values[0] * 12.0 * eta / h**3 == pytest.approx(factor, rel=1e-9), side


def test_wall_shear():
    fluid = oil()
    ln_eta = np.array(np.log(0.5 / fluid.viscosity))
    walls = rheology.wall_shear(np.array(0.2e-6), np.array(2e14), ln_eta, fluid, 1.25)
    np.testing.assert_allclose(walls, [-18.285163e6, 21.714837e6], rtol=1e-7)


@pytest.mark.parametrize("law", ["seed", "barus", "roelands"])
def test_derivatives_of_viscosity_and_density(law):
    p = np.linspace(0.0, 3e9, 40)
    for function in (rheology.viscosity, rheology.density):
        exact = function(p, oil(law=law))[1]
        np.testing.assert_allclose(exact, function(p + 1j * STEP, oil(law=law))[0].imag / STEP, rtol=1e-12)


@pytest.mark.parametrize("stress", [10e6, np.inf])
@pytest.mark.parametrize("sliding", [0.0, 1.25, 6.0])
def test_derivatives_of_mobility(stress, sliding):
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
