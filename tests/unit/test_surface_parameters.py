"""Roughness parameters of profiles and the command that prints them; self-affine roughness."""

from functools import cache

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import ndtr, ndtri
from support import CASES, refused

from ehlpetsc.base.errors import ProfileError
from ehlpetsc.commands.surface import main
from ehlpetsc.surfaces.parameters import (
    binned,
    core_parameters,
    correlation_length,
    power_spectrum,
    profile_parameters,
)
from ehlpetsc.surfaces.synthetic import Spectrum, ground, random_heights

ALICONA = CASES / "profiles" / "alicona_meander_profile.csv"


def test_parameters_of_a_sine():
    amplitude, wavelength, dx = 1e-7, 100e-6, 0.5e-6
    z = amplitude * np.sin(2 * np.pi * dx * np.arange(10_000) / wavelength)
    found = profile_parameters(z, dx)
    assert found["Ra"] == pytest.approx(2 * amplitude / np.pi, rel=1e-4)
    assert found["Rq"] == pytest.approx(amplitude / np.sqrt(2), rel=1e-9)
    assert found["Rz"] == pytest.approx(2 * amplitude, rel=1e-9)
    assert (found["Rsk"], found["Rku"]) == pytest.approx((0.0, 1.5), abs=1e-9)
    assert found["Rdq"] == pytest.approx(np.sqrt(2) * np.pi * amplitude / wavelength, rel=5e-3)
    assert found["l"] == pytest.approx(np.arccos(1 / np.e) / (2 * np.pi) * wavelength, rel=5e-3)
    z = np.zeros(1000)
    z[[50, 250]] = 1.0, 3.0
    assert profile_parameters(z, 1e-6)["Rz"] == pytest.approx((1 + 3) / 5)
    assert profile_parameters(z, 1e-6, 100e-6)["Rz"] == pytest.approx((1 + 3) / 10)
    assert np.isnan(correlation_length(np.full(100, 0.0), 1e-6))


def test_waves_of_a_ground_profile_have_their_correlation_length():
    x, z = ground(0.3e-6, 25e-6, 0.0, 2)
    found = profile_parameters(z, x[1])
    assert found["Ra"] == pytest.approx(0.3e-6, rel=1e-9)
    assert found["l"] == pytest.approx(25e-6, rel=0.1)
    assert found["Rdq"] == pytest.approx(np.sqrt(2) * found["Rq"] / 25e-6, rel=0.05)
    x, z = ground(0.3e-6, 25e-6, -1.5, 2)
    one, other = (profile_parameters(sign * z, x[1]) for sign in (1, -1))
    assert one["Rsk"] == pytest.approx(-1.5, abs=1e-6) and other["Rsk"] == pytest.approx(1.5, abs=1e-6)
    assert one["Rvk"] == pytest.approx(other["Rpk"], rel=1e-6)
    assert one["Rvk"] > 3 * one["Rpk"]


def test_core_of_a_profile_of_three_processes_and_of_gaussian_heights():
    """A ramp with peaks over a tenth and valleys over a fifth of the length, triangles of known height."""
    ratio = (np.arange(100_000) + 0.5) / 100_000
    z = 1.0 - ratio
    z[ratio < 0.1] = 1.0 + 0.7 * (1.0 - ratio[ratio < 0.1] / 0.1)
    z[ratio > 0.8] = -2.0 * (ratio[ratio > 0.8] - 0.8) / 0.2
    found = core_parameters(np.random.default_rng(0).permutation(z))
    core = [found[name] for name in ("pk", "k", "vk", "mr1", "mr2")]
    assert core == pytest.approx((0.7, 1.0, 2.0, 0.1, 0.8), abs=1e-3)
    z = ndtri((np.arange(100_000) + 0.5) / 100_000)
    found = profile_parameters(np.random.default_rng(0).permutation(z), 1e-6)
    assert (found["Rq"], found["Rsk"], found["Rku"]) == pytest.approx((1.0, 0.0, 3.0), abs=2e-3)
    slope = quad(lambda ratio: (ratio - 0.5) * ndtri(ratio), 0.3, 0.7)[0] / (0.4**3 / 12)
    assert found["Rk"] == pytest.approx(slope, rel=1e-3)
    assert found["Rpk"] == pytest.approx(found["Rvk"], rel=1e-3)
    assert found["Rmr1"] == pytest.approx(ndtr(-slope / 2), abs=1e-4)


def test_spectrum_integrates_to_rq_and_falls_as_it_was_made():
    z = random_heights((16_000,), (1e-6,), Spectrum(0.2e-6, 0.8, 80e-6, 8e-6), 5)
    q, density = power_spectrum(z, 1e-6)
    assert np.sqrt(density.sum() * q[0] / np.pi) == pytest.approx(0.2e-6, rel=0.05)
    mean_q, mean_density = binned(q, density)
    falling = (mean_q > 2 * np.pi / 70e-6) & (mean_q < 2 * np.pi / 10e-6)
    slope = np.polyfit(np.log(mean_q[falling]), np.log(mean_density[falling]), 1)[0]
    assert slope == pytest.approx(-2.6, abs=0.15)


def test_surface_prints_parameters_and_writes_spectrum_and_picture(tmp_path, capsys):
    path = tmp_path / "p.csv"
    table = np.loadtxt(ALICONA, delimiter=",")
    np.savetxt(path, 1e6 * table + (0.0, 1.0), delimiter=";")
    words = [str(path), "--set", "unit=um", "--set", 'cutoff="0.3 mm"', "--csv", str(tmp_path / "psd.csv")]
    assert main(words) == 0
    printed = capsys.readouterr().out
    assert "1.712 mm long, 3425 points 0.5 um apart" in printed
    values = {line.split()[0]: float(line.split()[1]) for line in printed.splitlines() if line[:1] in "Rl"}
    assert list(values) == "Ra Rq Rz Rsk Rku Rpk Rk Rvk Rdq l".split()
    assert values["Ra"] == pytest.approx(0.156, abs=0.002)
    assert (tmp_path / "p.surface.png").stat().st_size > 10_000
    wavelength, q, density = np.loadtxt(tmp_path / "psd.csv", delimiter=",", skiprows=1).T
    np.testing.assert_allclose(wavelength * q, 2 * np.pi)
    assert np.sqrt(density.sum() * q[0] / np.pi) == pytest.approx(1e-6 * values["Rq"], rel=0.05)


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--set", "cutof=1e-3"], "cutof = 0.001: unknown key; did you mean"),
        (["--set", "cutoff"], "--set cutoff: allowed: KEY=VALUE, as in unit=um"),
        (["--set", 'cutoff="1 kg"'], 'cutoff = "1 kg": not a unit of this key'),
        (["--set", "surface.1.unit=mil", "--set", "columns=[3]"], "columns = [3]: the file has 2"),
        (["-o", "a.txt"], "a.txt: allowed for -o: a name that ends in .png"),
        (["--csv", str(ALICONA)], "is read by this run"),
    ],
)
def test_invalid_words_are_refused_in_one_line(tmp_path, monkeypatch, capsys, words, message):
    monkeypatch.chdir(tmp_path)
    assert message in refused(capsys, main, ALICONA, *words)
    assert list(tmp_path.iterdir()) == []


def test_profile_of_few_points_has_no_parameters(tmp_path, capsys):
    path = tmp_path / "p.csv"
    path.write_text("0,0\n1e-6,1e-7\n2e-6,0\n3e-6,1e-7\n4e-6,0\n")
    assert "5 points; allowed for parameters: at least 50" in refused(capsys, main, path)


SPECTRUM = Spectrum(0.2e-6, 0.8, 80e-6, 8e-6)


@cache
def mean_power(shape, spacing, spectrum, seeds=40):
    surfaces = (random_heights(shape, spacing, spectrum, seed) for seed in range(seeds))
    return np.mean([np.abs(np.fft.fftn(z)) ** 2 for z in surfaces], axis=0)


def slope(q, power, band):
    inside = (q > band[0]) & (q < band[1])
    return np.polyfit(np.log(q[inside]), np.log(power[inside]), 1)[0]


@pytest.mark.parametrize(("shape", "exponent"), [((4096,), -2.6), ((256, 256), -3.6)])
def test_spectrum_falls_with_its_hurst_exponent_between_roll_off_and_cutoff(shape, exponent):
    power = mean_power(shape, (1e-6,) * len(shape), SPECTRUM).copy()
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
    q = np.fft.fftfreq(256)
    moment_y, moment_x = (power * q[:, None] ** 2).sum(), (power * q**2).sum()
    assert np.sqrt(moment_y / moment_x) == pytest.approx(0.5, rel=0.03)
    q = np.fft.fftfreq(256, 1e-6)
    assert power[0, q > 1 / 7.9e-6].max() < 1e-20 * power.max()
    assert power[q > 1 / 15.8e-6, 0].max() < 1e-20 * power.max()


@pytest.mark.parametrize("peklenik", [0.01, 0.2, 3.0])
def test_a_stretched_surface_keeps_the_spectrum_along_x(peklenik):
    spectra = (SPECTRUM._replace(peklenik=lay) for lay in (1.0, peklenik))
    isotropic, stretched = (mean_power((100, 1000), (1e-6, 1e-6), one).mean(axis=0) for one in spectra)
    bands = [np.add.reduceat(p[2:140], [0, 8, 16, 32, 64]) / p.sum() for p in (isotropic, stretched)]
    assert bands[1] == pytest.approx(bands[0], rel=0.12)


@pytest.mark.parametrize("spacing", [5e-6, 1e-8])
def test_unresolved_short_cutoff_is_refused_with_its_limits(spacing):
    with pytest.raises(ProfileError, match="short_cutoff = 8e-06 m; allowed: at least two spacings, .* m$"):
        random_heights((500,), (spacing,), SPECTRUM, 1)
