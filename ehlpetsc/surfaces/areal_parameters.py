"""Parameters of areal surfaces (ISO 25178-2) from extremes, gradients, material ratios and directions."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ehlpetsc.base.compiled import compiled
from ehlpetsc.surfaces.filters import deviations
from ehlpetsc.surfaces.parameters import DIRECTIONS, slopes

PRUNED = 0.05  # of Sz: lower hills and dales belong to their neighbours (Wolf pruning)
PEAK_RATIO, VALLEY_RATIO = 0.1, 0.8  # material ratios of Vmp and Vvv
EXTREMES = 5  # peaks, and pits, of S10z


class SurfaceParameters(NamedTuple):
    """Parameters of heights minus their mean.

    `sz`: maximum height [m].
    `s10z`: ten-point height: mean height of the five highest peaks plus mean depth of the five deepest pits,
        or of fewer, if there are fewer; hills and dales of less than 5 % of Sz do not count [m].
    `sdr`: developed interfacial area ratio: area over its projection, minus 1.
    `std`: texture direction: of the lay against the rows, towards y [degrees, 0 to 180]; nan on a plane.
    `vmp`: peak material volume: of the material above a material ratio of 10 %, per area [m].
    `vvv`: valley void volume: of the voids below a material ratio of 80 %, per area [m].
    """

    sz: float
    s10z: float
    sdr: float
    std: float
    vmp: float
    vvv: float

    @classmethod
    def of(cls, z: np.ndarray, dx: float, dy: float) -> SurfaceParameters:
        """Parameters of a map, shape (ny, nx), with spacings [m]."""
        z = deviations(z)
        upper, lower = np.quantile(z, (1.0 - PEAK_RATIO, 1.0 - VALLEY_RATIO))
        return cls(
            sz=float(np.ptp(z)),
            s10z=ten_point_height(z),
            sdr=developed_ratio(z, dx, dy),
            std=texture_direction(z, dx, dy) if z.any() else np.nan,
            vmp=float(np.maximum(z - upper, 0.0).mean()),
            vvv=float(np.maximum(lower - z, 0.0).mean()),
        )


def developed_ratio(z: np.ndarray, dx: float, dy: float) -> float:
    r"""Sdr: mean of :math:`\sqrt{1+z_x^2+z_y^2}-1` where both slopes exist.

    Slopes by :func:`ehlpetsc.surfaces.parameters.slopes`.
    """
    along, across = slopes(z, dx), slopes(z.T, dy).T
    rows, columns = (
        slice(lost // 2, lost // 2 + count)
        for lost, count in (
            (len(along) - len(across), len(across)),
            (across.shape[1] - along.shape[1], along.shape[1]),
        )
    )
    squared = along[rows] ** 2 + across[:, columns] ** 2
    return float(np.mean(squared / (np.sqrt(1.0 + squared) + 1.0)))  # without cancellation


def texture_direction(z: np.ndarray, dx: float, dy: float) -> float:
    r"""Std [degrees]: normal to the direction with the largest :math:`\int r|F(r,\theta)|^2 dr`.

    F is the Fourier transform of the heights in polar coordinates, with a Hann window along x and y.
    """
    from scipy.ndimage import map_coordinates

    window = np.multiply.outer(*(np.hanning(n + 2)[1:-1] for n in z.shape))
    power = np.fft.fftshift(np.abs(np.fft.fft2(z * window)) ** 2)
    steps = [1.0 / (n * step) for n, step in zip(z.shape, (dy, dx), strict=True)]  # of frequencies
    middle = [n // 2 for n in z.shape]
    radius = min(steps) * np.arange(1, int(0.5 / max(dx, dy) / min(steps)) + 1)
    angle = np.pi * np.arange(DIRECTIONS) / DIRECTIONS
    places = [
        middle[0] + np.outer(radius, np.sin(angle)) / steps[0],
        middle[1] + np.outer(radius, np.cos(angle)) / steps[1],
    ]
    along = radius @ map_coordinates(power, places, order=1)
    return float(np.degrees(angle[along.argmax()]) + 90.0) % 180.0


def ten_point_height(z: np.ndarray) -> float:
    """S10z [m] of heights of mean 0."""
    least = PRUNED * np.ptp(z)
    return float(sum(np.sort(peaks(side, least))[-EXTREMES:].mean() for side in (z, -z)))


def peaks(z: np.ndarray, least: float) -> np.ndarray:
    """Heights of the peaks from which every way to a higher one falls by `least` or more."""
    order = np.argsort(-z, axis=None, kind="stable")
    return _peaks(np.ascontiguousarray(z, float), order, float(least))


@compiled()
def _peaks(z: np.ndarray, order: np.ndarray, least: float) -> np.ndarray:
    """Peaks of hills that grow as points are added in falling order and end where they meet higher ones."""
    ny, nx = z.shape
    heights = z.ravel()
    parent = np.full(z.size, -1)
    is_peak = np.zeros(z.size, np.bool_)
    for point in order:
        row, column, best = point // nx, point % nx, -1
        for k in range(9):
            j, i = row + k // 3 - 1, column + k % 3 - 1
            if j < 0 or j >= ny or i < 0 or i >= nx or parent[j * nx + i] < 0:
                continue
            root = j * nx + i
            while parent[root] != root:
                parent[root] = parent[parent[root]]
                root = parent[root]
            if best < 0:
                best = root
            elif root != best:
                lower = root if heights[root] <= heights[best] else best
                best = best if lower == root else root
                is_peak[lower] = heights[lower] - heights[point] >= least
                parent[lower] = best
        parent[point] = point if best < 0 else best
    is_peak[order[0]] = True
    return heights[is_peak]
