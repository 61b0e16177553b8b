"""Differences of two maps of one part, as before and after a test: alignment, worn volume and depth."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ehlpetsc.base.errors import ProfileError
from ehlpetsc.surfaces.filters import SPACING_TOLERANCE
from ehlpetsc.surfaces.topography import Topography

MIN_CORRELATION = 0.5  # of two maps for a difference: less is chance
MIN_OVERLAP = 0.25  # of the points of the smaller map
NORMAL_MAD = 1.4826  # standard deviation over the median deviation of normal numbers
NOISE = 3.0  # standard deviations of unchanged places: depths beyond them are worn
EDGES = 0.05  # of the largest depth, below which the moved map differs at edges of a groove


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
    own, other = (tuple(map(slice, begin - by, end - by)) for by in (0, whole))
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
        line = np.moveaxis(correlation, axis, 0)[:, best[1 - axis]]
        low, middle, high = line[[k - 1, k, (k + 1) % n]]
        curvature = low - 2.0 * middle + high
        moved[axis] += 0.5 * (low - high) / curvature if curvature < 0.0 and min(low, high) > -1.0 else 0.0
        moved[axis] -= n if k >= a.shape[axis] else 0
    return moved, float(correlation[best])


class Wear(NamedTuple):
    """Volume lost and gained between two maps, against their unchanged level.

    `volume`, `area`: of the places worn deeper than `limit` [m^3], [m^2].
    `depth`: the largest [m].
    `raised`: volume of the places raised by more than `limit` [m^3].
    `limit`: `NOISE` standard deviations of the unchanged places, or `EDGES` of the largest depth [m].
    """

    volume: float
    area: float
    depth: float
    raised: float
    limit: float

    @property
    def text(self) -> str:
        """Two lines in um."""
        mean = self.volume / self.area if self.area else 0.0
        volumes = [f"{1e18 * value:.4g} um^3" for value in (self.volume, self.raised)]
        return (
            f"worn volume {volumes[0]} on {1e12 * self.area:.4g} um^2, raised {volumes[1]}, where heights "
            f"differ by more than {1e6 * self.limit:.3g} um from those of unchanged places\n"
            f"worn depth {1e6 * self.depth:.4g} um at most, {1e6 * mean:.4g} um in the mean of that area"
        )


def wear_of(surface: Topography) -> Wear:
    """Worn and raised volume of a difference of two maps, heights before minus those after.

    The level of unchanged places is the median of the heights, so that more than half of the map must be
    unchanged; their noise is that of the heights below it, of which wear has none.
    """
    depth = surface.z - np.median(surface.z)
    noise = NORMAL_MAD * float(np.median(-depth[depth <= 0.0]))
    limit = max(NOISE * noise, EDGES * float(depth.max()))
    cell, worn, raised = surface.dx * surface.dy, depth[depth > limit], -depth[depth < -limit]
    return Wear(
        cell * float(worn.sum()),
        cell * worn.size,
        float(worn.max(initial=0.0)),
        cell * float(raised.sum()),
        limit,
    )
