"""Roughness parameters of areal surfaces, ISO 25178-2."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

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
        z = z - z.mean()
        sq = float(np.sqrt(np.mean(z**2)))
        skewness, kurtosis = (float(np.mean((z / sq) ** k)) if sq > 0 else np.nan for k in (3, 4))
        fastest, slowest = correlation_lengths(z, dx, dy) if sq > 0 else (np.nan, np.nan)
        gradient, aspect = rms_gradient(z, dx, dy), fastest / slowest
        return cls(float(np.abs(z).mean()), sq, skewness, kurtosis, gradient, fastest, aspect)


def rms_gradient(z: np.ndarray, dx: float, dy: float) -> float:
    """Sdq: root mean square of the gradient, by central differences."""
    along_y, along_x = np.gradient(z, dy, dx)
    return float(np.sqrt(np.mean(along_x**2 + along_y**2)))


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
