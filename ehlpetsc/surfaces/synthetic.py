"""Synthetic profiles: sampled heights, processed like measured profiles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ehlpetsc.base.declarations import Values

POINTS_PER_WAVE = 64  # per wavelength: a cubic spline through them is exact to 3e-7 of the amplitude
GROUND_POINTS, GROUND_LENGTH = 10, 1000  # points a correlation length, correlation lengths
SHORTEST_WAVE_POINTS = 10  # of a self-affine profile, per short_cutoff
ROLL_OFFS = 200  # length of a self-affine profile, in roll_off
MAX_POINTS = 4_000_000  # of self-affine profiles, which are shorter beyond it
FLANK_WIDTH = 0.1  # of a square wave, in units of the cosine over which the flank rises
SINGLE_FEATURES = ("ridge", "dent")  # do not repeat


def sampled(spec: Values) -> tuple[np.ndarray, np.ndarray, bool]:
    """Samples of a synthetic profile.

    Returns X and z [m], heights positive out of the metal, shape (n,), and whether the profile is continued
    by reflection at its ends, otherwise by height 0. That of a wave is half a wavelength.
    """
    if spec.kind == "ground":
        return *ground(spec.ra, spec.correlation, spec.skewness, spec.seed), True
    if spec.kind == "self-affine":
        return *self_affine(spec), True
    if spec.kind in SINGLE_FEATURES:
        return *bump(spec), False
    is_square = spec.kind == "square"
    x = np.linspace(
        0.0, spec.wavelength / 2, (4 * POINTS_PER_WAVE if is_square else POINTS_PER_WAVE // 2) + 1
    )
    wave = np.cos(2 * np.pi * x / spec.wavelength)
    if is_square:
        wave = np.tanh(wave / FLANK_WIDTH) / np.tanh(1 / FLANK_WIDTH)
    return x, spec.amplitude * wave, True


def self_affine(spec: Values) -> tuple[np.ndarray, np.ndarray]:
    """Random profile with a self-affine spectrum, see :class:`.self_affine.Spectrum`: X, z [m]."""
    from ehlpetsc.surfaces.self_affine import Spectrum, heights

    spacing = spec.short_cutoff / SHORTEST_WAVE_POINTS
    n = int(min(ROLL_OFFS * spec.roll_off / spacing, MAX_POINTS))
    spectrum = Spectrum(spec.sq, spec.hurst, spec.roll_off, spec.short_cutoff)
    return spacing * np.arange(n), heights((n,), (spacing,), spectrum, spec.seed)


def bump(spec: Values) -> tuple[np.ndarray, np.ndarray]:
    r"""Ridge or dent, :math:`z=\pm A\exp[-(2(X-X_c)/w)^2]`, w the full width at 1/e."""
    width, centre = spec.wavelength, bump_centre(spec)
    x = centre + np.linspace(-3 * width, 3 * width, 6 * POINTS_PER_WAVE + 1)
    sign = 1.0 if spec.kind == "ridge" else -1.0
    return x, sign * spec.amplitude * np.exp(-((2 * (x - centre) / width) ** 2))


def bump_centre(spec: Values) -> float:
    """Abscissa of the middle of a ridge or dent [m]."""
    return 2 * spec.wavelength if spec.position is None else spec.position


def ground(ra: float, correlation: float, skewness: float, seed: int) -> tuple[np.ndarray, np.ndarray]:
    r"""Random profile with autocorrelation :math:`\exp[-(X/l)^2]` before its heights are skewed.

    White noise filtered with a Gaussian weight; then each height is mapped by its rank to a gamma
    (Pearson III) distribution with the parameter for which the sample has the prescribed skewness.

    `ra`, `correlation`: m.
    `skewness`: rsk of the profile.

    Returns abscissas and heights [m] of mean 0.
    """
    from scipy.ndimage import gaussian_filter1d

    n = GROUND_LENGTH * GROUND_POINTS
    noise = np.random.default_rng(seed).standard_normal(n)
    z = with_skewness(gaussian_filter1d(noise, GROUND_POINTS / 2, mode="mirror", truncate=6.0), skewness)
    return np.arange(n) * (correlation / GROUND_POINTS), z * (ra / np.abs(z).mean())


def with_skewness(heights: np.ndarray, skewness: float) -> np.ndarray:
    """Normal heights mapped by their rank to Pearson III ones with this skewness exactly, of mean 0."""
    from scipy.optimize import brentq

    normal = (heights - heights.mean()) / heights.std()
    z = _pearson3(normal, brentq(lambda s: _skewness(_pearson3(normal, s)) - skewness, -8.0, 8.0, xtol=1e-10))
    return z - z.mean()


def _pearson3(normal: np.ndarray, skewness: float) -> np.ndarray:
    """Pearson III heights with the ranks of standard normal heights."""
    from scipy.special import gammaincinv, ndtr

    if abs(skewness) < 1e-3:
        return normal
    shape = 4.0 / skewness**2
    return np.sign(skewness) * (gammaincinv(shape, ndtr(np.sign(skewness) * normal)) - shape) / np.sqrt(shape)


def _skewness(z: np.ndarray) -> float:
    deviation = z - z.mean()
    return (deviation**3).mean() / (deviation**2).mean() ** 1.5
