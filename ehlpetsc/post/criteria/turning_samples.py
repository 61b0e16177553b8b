"""Samples of a history at which the path of its stress turns.

The stress on a plane is a weighted sum of the three stresses. Samples at which one of 13 such sums reverses
by more than a tolerance are kept, and between them samples off the straight line; the path between kept
samples is straight and monotone, so that the stress on any plane has no larger reversal between them than
about the tolerance.
"""

from __future__ import annotations

from itertools import product
from math import sqrt

import numpy as np

from ehlpetsc.base.compiled import ZERO, compiled

AXIS_TOLERANCE = 0.02  # of the widest of the three axes


def _directions(axes: int) -> np.ndarray:
    """Unit vectors (count, axes) along the edges and diagonals of a cube, one of each opposite pair."""
    ways = np.array([way for way in product((-1.0, 0.0, 1.0), repeat=axes) if way > (0.0,) * axes])
    return ways / np.linalg.norm(ways, axis=1)[:, None]


DIRECTIONS, DIRECTIONS_OF_SIX = _directions(3), _directions(5)


@compiled(error_model="python", nogil=True)
def _mark_reversals(values: np.ndarray, tolerance: float, is_kept: np.ndarray) -> None:
    """Mark the samples at which a series reverses by more than the tolerance."""
    top = bottom = sign = 0
    for k in range(1, values.size):
        if sign >= 0:
            if values[k] > values[top]:
                top = k
            elif values[top] - values[k] > tolerance:
                is_kept[top] = True
                sign, bottom = -1, k
        if sign <= 0:
            if values[k] < values[bottom]:
                bottom = k
            elif values[k] - values[bottom] > tolerance:
                is_kept[bottom] = True
                sign, top = 1, k
    if sign:
        is_kept[top if sign > 0 else bottom] = True


@compiled(error_model="python", nogil=True)
def _off_line(points: np.ndarray, first: int, last: int) -> tuple[int, float]:
    """Sample with the maximum distance from the straight line between two samples, and this distance."""
    axes, length = points.shape[0], 0.0
    for axis in range(axes):
        length += (points[axis, last] - points[axis, first]) ** 2
    index, largest = first, 0.0
    for k in range(first + 1, last):
        along = 0.0
        for axis in range(axes):
            step = points[axis, last] - points[axis, first]
            along += (points[axis, k] - points[axis, first]) * step
        along = min(max(along / length, 0.0), 1.0) if length > 0 else 0.0
        away = 0.0
        for axis in range(axes):
            step = points[axis, last] - points[axis, first]
            away += (points[axis, k] - points[axis, first] - along * step) ** 2
        if away > largest:
            index, largest = k, away
    return index, sqrt(largest)


@compiled(error_model="python", nogil=True)
def turning_samples(points: np.ndarray, size: int, indices: np.ndarray) -> int:
    """Write the indices of the samples to keep of points (3 or 5, :size); return their number."""
    extent = 0.0
    for k in range(points.shape[0]):
        extent = max(extent, points[k, :size].max() - points[k, :size].min())
    tolerance = AXIS_TOLERANCE * extent
    is_kept = np.zeros(size, np.bool_)
    is_kept[0] = is_kept[size - 1] = True
    directions = DIRECTIONS if points.shape[0] == 3 else DIRECTIONS_OF_SIX
    along = np.empty(size)
    for way in directions:
        along[:] = 0.0
        for axis in range(points.shape[0]):
            if way[axis] != 0.0:
                for k in range(size):
                    along[k] += way[axis] * points[axis, k]
        _mark_reversals(along, tolerance, is_kept)
    count, first = 0, ZERO
    ends = np.empty(size, np.int64)
    for last in range(size):
        if not is_kept[last]:
            continue
        ends[0], open_ends = last, 1
        while open_ends:  # stack of the ends of the remaining intervals
            end = ends[open_ends - 1]
            index, away = _off_line(points, first, end)
            if away > tolerance:
                ends[open_ends] = index
                open_ends += 1
            else:
                indices[count] = end
                count += 1
                first = end
                open_ends -= 1
    return count
