"""Difference of two maps of one part, as before and after a test."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ehlpetsc.base.errors import ProfileError
from ehlpetsc.surfaces.filters import SPACING_TOLERANCE
from ehlpetsc.surfaces.topography import Topography

MIN_CORRELATION = 0.5  # of both maps: less is chance
MIN_OVERLAP = 0.25  # of the points of the smaller map


def difference(before: Topography, after: Topography) -> Topography:
    """Heights of a map minus those of another one of the same place, on the points of the first.

    The second is moved in x and y to where both correlate best, by fractions of a spacing with cubic splines,
    and is not turned. The result has the points that both have.

    Raises
    ------
    ProfileError
        Profiles, other spacings, or maps that correlate nowhere.
    """
    if before.is_ridge or after.is_ridge:
        raise ProfileError("a profile; allowed for a difference: maps")
    if not np.allclose(after.spacings, before.spacings, rtol=SPACING_TOLERANCE, atol=0.0):
        found, asked = (" x ".join(f"{1e6 * step:.4g}" for step in of.spacings) for of in (after, before))
        raise ProfileError(
            f"points {found} um apart; allowed for a difference: {asked} um, as of the first map"
        )
    from scipy.ndimage import shift

    moved, correlation = displacement(before.z, after.z)
    if correlation < MIN_CORRELATION:
        raise ProfileError(
            f"correlates with the first map by {correlation:.2f} at most; allowed for a difference: "
            f"{MIN_CORRELATION:g} or more, of the same place, not turned"
        )
    whole = np.rint(moved).astype(int)
    begin = np.maximum(whole, 0)
    end = np.minimum(before.z.shape, after.z.shape + whole)
    own, other = (
        tuple(slice(first, last) for first, last in zip(begin - by, end - by, strict=True))
        for by in (np.zeros(2, int), whole)
    )
    z = before.z[own] - shift(after.z, moved - whole, order=3, mode="mirror")[other]
    x, y = 1e6 * moved[1] * before.dx, 1e6 * moved[0] * before.dy
    note = (
        f"second map moved by {x:.2f} um along its rows and {y:.2f} um across, correlation {correlation:.3f}"
    )
    X, Y = before.X[own[1]] - before.X[begin[1]], before.Y[own[0]] - before.Y[begin[0]]
    notes = *before.notes, *after.notes, note
    return replace(before, X=X, Y=Y, z=z - z.mean(), middle=0.5 * float(Y[-1]), notes=notes)


def displacement(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, float]:
    """Rows and columns by which b is moved to fit a best, and the correlation of both on their overlap.

    Correlation of all displacements with enough overlap by FFT; between points its parabola.
    """
    from scipy.fft import irfft2, next_fast_len, rfft2

    shape = [next_fast_len(m + n - 1, real=True) for m, n in zip(a.shape, b.shape, strict=True)]

    def products(first: np.ndarray, second: np.ndarray) -> np.ndarray:
        return irfft2(rfft2(first, shape) * np.conj(rfft2(second, shape)), shape)

    scale = max(a.std(), b.std()) or 1.0
    a, b, in_a, in_b = a / scale, b / scale, np.ones(a.shape), np.ones(b.shape)
    count = np.rint(products(in_a, in_b))
    squares = products(a * a, in_b) * products(in_a, b * b)
    enough = count >= max(MIN_OVERLAP * min(a.size, b.size), 1.0)
    tiny = np.finfo(float).eps * squares.max() + np.finfo(float).tiny
    correlation = np.where(enough, products(a, b) / np.sqrt(np.maximum(squares, tiny)), -1.0)
    best = np.unravel_index(correlation.argmax(), correlation.shape)
    moved = np.array(best, float)
    for axis, (k, n) in enumerate(zip(best, shape, strict=True)):
        low, middle, high = np.take(
            np.take(correlation, [k - 1, k, (k + 1) % n], axis), best[1 - axis], 1 - axis
        )
        curvature = low - 2.0 * middle + high
        moved[axis] += 0.5 * (low - high) / curvature if curvature < 0.0 and min(low, high) > -1.0 else 0.0
        moved[axis] -= n if k >= a.shape[axis] else 0
    return moved, float(correlation[best])
