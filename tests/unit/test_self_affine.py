"""Self-affine roughness: spectrum, height, seed, stretch."""

import numpy as np
import pytest

from ehlpetsc.base.errors import ProfileError
from ehlpetsc.surfaces.synthetic import Spectrum, random_heights

SPECTRUM = Spectrum(0.2e-6, 0.8, 80e-6, 8e-6)


def mean_power(shape, spacing, spectrum, seeds=40):
    surfaces = (random_heights(shape, spacing, spectrum, seed) for seed in range(seeds))
    return np.mean([np.abs(np.fft.fftn(z)) ** 2 for z in surfaces], axis=0)


def slope(q, power, band):
    inside = (q > band[0]) & (q < band[1])
    return np.polyfit(np.log(q[inside]), np.log(power[inside]), 1)[0]


@pytest.mark.parametrize(("shape", "exponent"), [((4096,), -2.6), ((256, 256), -3.6)])
def test_spectrum_falls_with_its_hurst_exponent_between_roll_off_and_cutoff(shape, exponent):
    power = mean_power(shape, (1e-6,) * len(shape), SPECTRUM)
    axes = np.meshgrid(*(np.fft.fftfreq(n, 1e-6) for n in shape), indexing="ij")
    q = np.sqrt(sum(axis**2 for axis in axes))
    power[q == 0.0] = 1e-300
    assert slope(q, power, (1 / 79e-6, 1 / 8.1e-6)) == pytest.approx(exponent, abs=0.06)
    assert abs(slope(q, power, (1 / 1e-3, 1 / 82e-6))) < 0.12
    assert power[q > 1 / 7.9e-6].max() < 1e-20 * power.max()


@pytest.mark.parametrize("shape", [(1000,), (121, 130)])
def test_heights_have_their_sq_exactly_and_depend_on_the_seed_alone(shape):
    spacing = (1e-6,) * len(shape)
    z = random_heights(shape, spacing, SPECTRUM, 3)
    assert z.shape == shape
    assert np.sqrt(np.mean(z**2)) == pytest.approx(SPECTRUM.sq, rel=1e-12)
    assert abs(z.mean()) < 1e-12 * SPECTRUM.sq
    np.testing.assert_array_equal(z, random_heights(shape, spacing, SPECTRUM, 3))
    assert np.abs(z - random_heights(shape, spacing, SPECTRUM, 4)).max() > SPECTRUM.sq


def test_peklenik_is_the_ratio_of_waves_along_x_to_those_along_y():
    power = mean_power((256, 256), (1e-6, 1e-6), SPECTRUM._replace(peklenik=0.5))
    moment_y, moment_x = (
        (power * np.fft.fftfreq(256)[at] ** 2).sum() for at in ((slice(None), None), (None, slice(None)))
    )
    assert np.sqrt(moment_y / moment_x) == pytest.approx(0.5, rel=0.03)
    q = np.fft.fftfreq(256, 1e-6)
    assert power[0, q > 1 / 7.9e-6].max() < 1e-20 * power.max()
    assert power[q > 1 / 15.8e-6, 0].max() < 1e-20 * power.max()


@pytest.mark.parametrize("peklenik", [0.01, 0.2, 3.0])
def test_a_stretched_surface_keeps_the_spectrum_along_x(peklenik):
    """Also over a width that is shorter than its waves across."""
    isotropic, stretched = (
        mean_power((100, 1000), (1e-6, 1e-6), SPECTRUM._replace(peklenik=lay)).mean(axis=0)
        for lay in (1.0, peklenik)
    )
    bands = [np.add.reduceat(p[2:140], [0, 8, 16, 32, 64]) / p.sum() for p in (isotropic, stretched)]
    assert bands[1] == pytest.approx(bands[0], rel=0.12)


@pytest.mark.parametrize("spacing", [5e-6, 1e-8])
def test_unresolved_short_cutoff_is_refused_with_its_limits(spacing):
    with pytest.raises(ProfileError, match="short_cutoff = 8e-06 m; allowed: at least two spacings, .* m$"):
        random_heights((500,), (spacing,), SPECTRUM, 1)
