"""Synthetic profiles, processed like measured ones, and self-affine roughness in one and two dimensions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ehlpetsc.base.counts import whole_up
from ehlpetsc.base.errors import ProfileError

if TYPE_CHECKING:
    from ehlpetsc.base.declarations import Values


POINTS_PER_WAVE = 64  # per wavelength: a cubic spline through them is exact to 3e-7 of the amplitude
SKEWED_POINTS = 2001  # of the map of heights to skewed ones
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
    """Random profile with a self-affine spectrum, see :class:`.synthetic.Spectrum`: X, z [m]."""

    spacing = spec.short_cutoff / SHORTEST_WAVE_POINTS
    n = min(whole_up(ROLL_OFFS * spec.roll_off / spacing), MAX_POINTS)
    spectrum = Spectrum(spec.sq, spec.hurst, spec.roll_off, spec.short_cutoff)
    return spacing * np.arange(n), random_heights((n,), (spacing,), spectrum, spec.seed)


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
    """Normal heights mapped by their rank to Pearson III ones with this skewness exactly, of mean 0.

    The map from height to height is a spline through `SKEWED_POINTS` of its points, exact to 1e-10.
    """
    from scipy.interpolate import CubicSpline
    from scipy.optimize import brentq

    normal = (heights - heights.mean()) / heights.std()
    at = np.linspace(normal.min(), normal.max(), SKEWED_POINTS)

    def skewed(parameter: float) -> np.ndarray:
        return CubicSpline(at, _pearson3(at, parameter))(normal)

    z = skewed(brentq(lambda parameter: _skewness(skewed(parameter)) - skewness, -8.0, 8.0, xtol=1e-10))
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


class Spectrum(NamedTuple):
    r"""Power spectrum of isotropic, or stretched, self-affine roughness.

    In d dimensions :math:`C(q)\propto1` up to :math:`q_0=2\pi/` `roll_off`,
    :math:`C(q)\propto(q/q_0)^{-(2H+d)}` from there to :math:`q_1=2\pi/` `short_cutoff`, and 0 beyond
    (Persson, J. Phys.: Condens. Matter 17 (2005) R1).

    `sq`: root mean square height [m].
    `hurst`: H, between 0 and 1.
    `roll_off`, `short_cutoff`: longest self-affine and shortest wavelength along x [m].
    `peklenik`: ratio of the wavelengths along x to those along y, for two dimensions; below 1 the lay is
        along y. The spectrum along x stays the same.
    """

    sq: float
    hurst: float
    roll_off: float
    short_cutoff: float
    peklenik: float = 1.0

    def density(self, q: np.ndarray, dimensions: int) -> np.ndarray:
        """C(q) over its plateau at angular wavenumbers q along x [rad/m]."""
        relative = np.maximum(q * (self.roll_off / (2 * np.pi)), 1.0)
        within = q <= (1 + 1e-12) * 2 * np.pi / self.short_cutoff
        return within * relative ** -(2 * self.hurst + dimensions)


def random_heights(
    shape: Sequence[int],
    spacing: Sequence[float],
    spectrum: Spectrum,
    seed: int,
    direction: float = 0.0,
    rows: float | None = None,
) -> np.ndarray:
    """Periodic heights [m] of one realisation, Gaussian, of mean 0 and root mean square `sq` exactly.

    White noise, see :func:`white_noise`, filtered in Fourier space by the square root of the spectrum.

    `shape`: points, (nx,) or (ny, nx).
    `spacing`: their distances [m], (dx,) or (dy, dx).
    `direction`: of the stretch against x, towards y [degrees].
    `rows`: of :func:`white_noise`.

    ProfileError where the points resolve no wave of the spectrum: `short_cutoff` below two spacings or
    above the period.
    """
    spectrum_spacing = np.array(spacing, float)
    spectrum_spacing[:-1] *= spectrum.peklenik  # across: in lengths along x
    shortest, period = 2 * spectrum_spacing.max(), (spectrum_spacing * shape).max()
    if not shortest * (1 - 1e-12) <= spectrum.short_cutoff <= period:
        raise ProfileError(
            f"short_cutoff = {spectrum.short_cutoff:g} m; allowed: at least two spacings, {shortest:g} m, at "
            f"most the period, {period:g} m"
        )
    along, *across = turned_wavenumbers(shape, spacing, direction)
    q = np.sqrt(sum(np.square(component / spectrum.peklenik) for component in across) + along**2)
    noise = white_noise(shape, seed, rows)
    power = spectrum.density(q, len(shape))
    if across and not direction:
        power *= _same_along(along[0], spectrum, spacing[0] * shape[0])
    noise *= np.sqrt(power)
    noise.flat[0] = 0.0
    z = np.fft.irfftn(noise, s=shape, axes=range(len(shape)))
    return z * (spectrum.sq / np.sqrt(np.mean(z**2)))


def white_noise(shape: Sequence[int], seed: int, rows: float | None = None) -> np.ndarray:
    """Real transform of standard normal numbers on a lattice, each a function of seed and place alone.

    Every row of the lattice has its own stream of random numbers, that a longer row continues; the rows are
    those around y = 0. Where a period holds no whole number of them, the outermost have the weight of their
    cells' parts within it, so that the transform is continuous in the period.

    `shape`: points of one period, (nx,) or (ny, nx).
    `rows`: rows of the lattice in the period, at most ny; None: ny.
    """
    if len(shape) == 1:
        return np.fft.rfft(np.random.default_rng(seed).standard_normal(shape))
    ny, nx = shape
    row = np.fft.fftfreq(ny, 1.0 / ny)
    if rows is None:
        return np.fft.rfft2(_noise_of_rows(row, nx, seed))
    reach = 0.5 * (rows + 1.0)
    at = np.arange(1 - np.ceil(reach), np.ceil(reach))
    weights = np.sqrt(np.minimum(reach - np.abs(at), 1.0))
    noise = np.fft.rfft(weights[:, np.newaxis] * _noise_of_rows(at, nx, seed))
    return np.exp(-2j * np.pi / rows * np.multiply.outer(row, at)) @ noise


def _noise_of_rows(rows: np.ndarray, columns: int, seed: int) -> np.ndarray:
    """Standard normal numbers in rows of a lattice, row 0 at y = 0."""
    streams = np.where(rows < 0, -2 * rows - 1, 2 * rows).astype(int)
    return np.stack([np.random.default_rng((seed, stream)).standard_normal(columns) for stream in streams])


def _same_along(q: np.ndarray, spectrum: Spectrum, period: float) -> np.ndarray:
    """Factor by which a stretched surface has the spectrum along x of an isotropic one of this period across.

    Without it a lay longer than the period would leave only the waves of q_y = 0, a steeper spectrum.

    `q`: angular wavenumbers along x [rad/m].
    `period`: across [m].
    """
    if spectrum.peklenik == 1.0:
        return np.ones_like(q)

    def along(peklenik: float) -> np.ndarray:
        count = whole_up(peklenik * period / spectrum.short_cutoff)
        across = 2 * np.pi / (peklenik * period) * np.arange(-count, count + 1)
        return spectrum.density(np.hypot.outer(across, q), 2).sum(axis=0)

    stretched = along(spectrum.peklenik)
    return np.divide(along(1.0), stretched, out=np.ones_like(q), where=stretched > 0.0)


def turned_wavenumbers(
    shape: Sequence[int], spacing: Sequence[float], direction: float = 0.0
) -> list[np.ndarray]:
    """Angular wavenumbers [rad/m] of a real transform along a direction and, in two dimensions, across it.

    `direction`: against x, towards y [degrees].
    """
    frequencies = [np.fft.fftfreq] * (len(shape) - 1) + [np.fft.rfftfreq]
    axes = [2 * np.pi * f(n, d) for f, n, d in zip(frequencies, shape, spacing, strict=True)]
    x, *y = np.meshgrid(*axes, indexing="ij")[::-1]
    if not y or not direction:
        return [x, *y]
    c, s = np.cos(np.radians(direction)), np.sin(np.radians(direction))
    return [c * x + s * y[0], c * y[0] - s * x]
