"""Roughness parameters of profiles (ISO 21920-2) and areal surfaces (ISO 25178-2), correlation, spectrum."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ehlpetsc.surfaces.filters import SPACING_TOLERANCE, deviations

SECTIONS = 5  # section lengths of a profile without a cut-off
CORE_FRACTION = 0.4  # of the material ratio, over which the core has its smallest slope
SLOPE_WEIGHTS = np.array([-1.0, 9.0, -45.0, 0.0, 45.0, -9.0, 1.0]) / 60.0  # at seven points
MIN_POINTS = 50
BINS_PER_DECADE = 12  # of the averaged spectrum


class CoreParameters(NamedTuple):
    """Parameters of the core, peaks and valleys by the material ratio curve.

    `rpk`, `rk`, `rvk`: reduced peak height, core height, reduced valley depth [m].
    `mr1`, `mr2`: material ratios at the upper and lower end of the core.
    `top`: height of the upper end of the core [m].
    """

    rpk: float
    rk: float
    rvk: float
    mr1: float
    mr2: float
    top: float


class ProfileParameters(NamedTuple):
    """Parameters of heights minus their mean.

    `ra`, `rq`, `rz`: arithmetic mean and root mean square height, mean maximum height of the sections [m].
    `rsk`, `rku`: skewness and kurtosis.
    `rdq`: root mean square slope.
    `correlation_length`: lag at which the autocorrelation falls to 1/e [m]; nan where it does not.
    """

    ra: float
    rq: float
    rz: float
    rsk: float
    rku: float
    core: CoreParameters
    rdq: float
    correlation_length: float

    @classmethod
    def of(cls, z: np.ndarray, dx: float, section: float | None = None) -> ProfileParameters:
        """Parameters of heights that are dx apart; `section`: section length [m], the cut-off."""
        z = deviations(z)
        rq = float(np.sqrt(np.mean(z**2)))
        skewness, kurtosis = (float(np.mean((z / rq) ** k)) if rq > 0 else np.nan for k in (3, 4))
        return cls(
            ra=float(np.abs(z).mean()),
            rq=rq,
            rz=mean_maximum_height(z, dx, section),
            rsk=skewness,
            rku=kurtosis,
            core=core_parameters(z),
            rdq=float(np.sqrt(np.mean(slopes(z, dx) ** 2))),
            correlation_length=correlation_length(z, dx),
        )


def equally_spaced(x: np.ndarray, z: np.ndarray) -> tuple[float, np.ndarray, bool]:
    """Mean spacing [m], heights at it, and whether they were interpolated, by the spline of a run."""
    from scipy.interpolate import CubicSpline

    step = (x[-1] - x[0]) / (x.size - 1)
    if np.ptp(np.diff(x)) <= 2 * SPACING_TOLERANCE * step:
        return step, z, False
    return step, CubicSpline(x, z, bc_type="clamped")(np.linspace(x[0], x[-1], x.size)), True


def mean_maximum_height(z: np.ndarray, dx: float, section: float | None = None) -> float:
    """Rz: mean over sections of maximum minus minimum, by default five; `section`: their length [m]."""
    count = SECTIONS if section is None else max(int(z.size * dx / section * (1 + 1e-9)), 1)
    return float(np.mean([np.ptp(part) for part in np.array_split(z, min(count, z.size))]))


def core_parameters(z: np.ndarray) -> CoreParameters:
    """Rpk, Rk, Rvk by the equivalent line of ISO 21920-2 (ISO 13565-2).

    The line is the least-squares one over the 40 % of the material ratio curve whose secant falls least; at
    material ratios 0 and 1 it gives the ends of the core. Triangles with the areas of the peaks above it and
    the valleys below have the heights Rpk and Rvk. Also for heights of an areal surface (Spk, Sk, Svk).
    """
    heights, ratio = np.sort(z, axis=None)[::-1], (np.arange(z.size) + 0.5) / z.size
    width = max(int(round(CORE_FRACTION * z.size)), 1)
    first = int(np.argmin(heights[:-width] - heights[width:]))
    core = slice(first, first + width + 1)
    fall, top = np.polyfit(ratio[core], heights[core], 1)
    bottom = top + fall
    peaks, valleys = np.maximum(heights - top, 0.0), np.maximum(bottom - heights, 0.0)
    mr1, below = float((heights > top).mean()), float((heights < bottom).mean())
    rpk = 2.0 * peaks.mean() / mr1 if mr1 else 0.0
    rvk = 2.0 * valleys.mean() / below if below else 0.0
    return CoreParameters(float(rpk), 0.0 - float(fall), float(rvk), mr1, 1.0 - below, float(top))


def slopes(z: np.ndarray, dx: float) -> np.ndarray:
    """Local slopes along the last axis by the seven-point formula of ISO 21920-2, shape (..., n - 6).

    Central differences of fewer than seven points, shape (..., n).
    """
    from scipy.ndimage import correlate1d

    half = len(SLOPE_WEIGHTS) // 2
    if z.shape[-1] <= 2 * half:
        return np.gradient(z, dx, axis=-1)
    return correlate1d(z, SLOPE_WEIGHTS)[..., half:-half] / dx


def correlation_length(z: np.ndarray, dx: float) -> float:
    """Lag [m] at which the autocorrelation of heights of mean 0 falls to 1/e; nan: not within half of them.

    The autocorrelation is the mean product of all pairs of points with a lag, over the mean square.
    """
    from scipy.fft import irfft, next_fast_len, rfft

    lags = np.arange(z.size // 2)
    length = next_fast_len(2 * z.size, real=True)
    products = irfft(np.abs(rfft(z, length)) ** 2, length)[lags] / (z.size - lags)
    below = products < products[0] / np.e
    if not below.any():
        return np.nan
    k = int(below.argmax())
    return float(dx * (k - (products[0] / np.e - products[k]) / (products[k - 1] - products[k])))


def power_spectrum(z: np.ndarray, dx: float) -> tuple[np.ndarray, np.ndarray]:
    r"""Power spectral density C of heights of mean 0 along the last axis, with a Hann window.

    Normalised by :math:`R_q^2=\frac1\pi\int_0^\infty C\,dq` (Jacobs, Junge and Pastewka, Surf. Topogr.:
    Metrol. Prop. 5 (2017) 013001).

    Returns q [rad/m] above 0 and C [m^3], the mean over other axes.
    """
    n = z.shape[-1]
    window = np.hanning(n + 1)[:-1]
    amplitude = np.fft.rfft(z * window).reshape(-1, n // 2 + 1)[:, 1:]
    q = 2.0 * np.pi * np.fft.rfftfreq(n, dx)[1:]
    return q, dx * np.mean(np.abs(amplitude) ** 2, axis=0) / np.sum(window**2)


def binned(q: np.ndarray, density: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Means of wavenumbers and densities in bins of equal width of log q."""
    number = np.floor(BINS_PER_DECADE * np.log10(q / q[0]) + 1e-9).astype(int)
    count = np.bincount(number)
    used = count > 0
    sums = np.bincount(number, weights=q), np.bincount(number, weights=density)
    return sums[0][used] / count[used], sums[1][used] / count[used]


CORRELATION_THRESHOLD = 0.2  # of the autocorrelation, for Sal and Str
DIRECTIONS = 360  # of half a turn, in which the autocorrelation is followed


class ArealParameters(NamedTuple):
    """Parameters of heights minus their mean.

    `sa`, `sq`: arithmetic mean and root mean square height [m].
    `ssk`, `sku`: skewness and kurtosis; nan on a plane.
    `sdq`: root mean square gradient.
    `sal`: autocorrelation length: lag at which the autocorrelation falls to 0.2 soonest, in any direction
        [m]; nan where it stays above up to half the size of the map.
    `str`: texture aspect ratio, `sal` over the lag in the direction in which it falls last: 0 for a lay, 1
        for an isotropic surface; nan where it stays above in some direction.
    """

    sa: float
    sq: float
    ssk: float
    sku: float
    sdq: float
    sal: float
    str: float

    @classmethod
    def of(cls, z: np.ndarray, dx: float, dy: float) -> ArealParameters:
        """Parameters of a map, shape (ny, nx), with spacings [m]."""
        z = deviations(z)
        sq = float(np.sqrt(np.mean(z**2)))
        skewness, kurtosis = (float(np.mean((z / sq) ** k)) if sq > 0 else np.nan for k in (3, 4))
        fastest, slowest = correlation_lengths(z, dx, dy) if sq > 0 else (np.nan, np.nan)
        gradient, aspect = rms_gradient(z, dx, dy), fastest / slowest
        return cls(float(np.abs(z).mean()), sq, skewness, kurtosis, gradient, fastest, aspect)


def rms_gradient(z: np.ndarray, dx: float, dy: float) -> float:
    """Sdq: root mean square of the gradient, by the formula of :func:`slopes` along rows and columns."""
    return float(np.sqrt(np.mean(slopes(z, dx) ** 2) + np.mean(slopes(z.T, dy) ** 2)))


def autocorrelation(z: np.ndarray) -> np.ndarray:
    """Autocorrelation of heights of mean 0, shape (ny, nx), at lags below half the size.

    Mean of the products of all pairs of points with this lag over the mean square; lag 0 is in the middle.

    Returns shape (2 (ny // 2) + 1, 2 (nx // 2) + 1).
    """
    from scipy.fft import irfft2, next_fast_len, rfft2

    shape = [next_fast_len(n + n // 2, real=True) for n in z.shape]
    products = irfft2(np.abs(rfft2(z, shape)) ** 2, shape)
    lags = [np.arange(-(n // 2), n // 2 + 1) for n in z.shape]
    pairs = np.multiply.outer(*(n - np.abs(lag) for n, lag in zip(z.shape, lags, strict=True)))
    return products[np.ix_(*lags)] / pairs / np.mean(z**2)


def correlation_lengths(z: np.ndarray, dx: float, dy: float) -> tuple[float, float]:
    """Lags [m] at which the autocorrelation falls to 0.2 in the direction of its fastest and slowest decay.

    Followed from lag 0 in all directions; nan where it has not fallen at half the size of the map.
    """
    from scipy.ndimage import map_coordinates

    correlation = autocorrelation(z)
    middle = [n // 2 for n in correlation.shape]
    angle = np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    step = 0.5 * min(dx, dy)
    lag = step * np.arange(int(np.hypot(middle[0] * dy, middle[1] * dx) / step) + 1)
    places = [
        middle[0] + np.outer(lag, np.sin(angle)) / dy,
        middle[1] + np.outer(lag, np.cos(angle)) / dx,
    ]
    followed = map_coordinates(correlation, places, order=1, cval=np.nan)
    below = followed < CORRELATION_THRESHOLD
    fallen, falls = np.full(DIRECTIONS, np.nan), np.flatnonzero(below.any(axis=0))
    first = below.argmax(axis=0)[falls]
    after, before = followed[first, falls], followed[first - 1, falls]
    fallen[falls] = lag[first] - step * (CORRELATION_THRESHOLD - after) / (before - after)
    if np.isnan(fallen).all():
        return np.nan, np.nan
    return float(np.nanmin(fallen)), float(fallen.max())
