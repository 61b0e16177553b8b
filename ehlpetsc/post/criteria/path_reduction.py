"""Reduction of a history to the samples at which its path in stress space turns.

The stress on a plane is a weighted sum of the three stresses. Samples at which one of 13 such sums reverses
by more than a tolerance are kept, and between them samples off the straight line; the path between kept
samples is straight and monotone, so that the stress on any plane has no larger reversal between them than
about the tolerance. The reduced history serves to find the worst plane; its damage is counted on all
samples.
"""

from math import sqrt

import numpy as np

from ehlpetsc.compiled import ZERO, compiled

TOLERANCE = 0.02  # of the widest of the three axes
DIRECTIONS = np.array(
    [[1, 0, 0], [0, 1, 0], [0, 0, 1]]
    + [[1, s, 0] for s in (1, -1)]
    + [[1, 0, s] for s in (1, -1)]
    + [[0, 1, s] for s in (1, -1)]
    + [[1, s, t] for s in (1, -1) for t in (1, -1)],
    float,
)
DIRECTIONS /= np.linalg.norm(DIRECTIONS, axis=1)[:, None]


@compiled(error_model="python", nogil=True)
def _mark_reversals(points, size, direction, tolerance, is_kept):
    """Mark the samples at which the path reverses along a direction by more than the tolerance."""
    high = low = direction[0] * points[0, 0] + direction[1] * points[1, 0] + direction[2] * points[2, 0]
    top = bottom = sign = 0
    for k in range(1, size):
        value = direction[0] * points[0, k] + direction[1] * points[1, k] + direction[2] * points[2, k]
        if sign >= 0:
            if value > high:
                high, top = value, k
            elif high - value > tolerance:
                is_kept[top] = True
                sign, low, bottom = -1, value, k
        if sign <= 0:
            if value < low:
                low, bottom = value, k
            elif value - low > tolerance:
                is_kept[bottom] = True
                sign, high, top = 1, value, k
    if sign > 0:
        is_kept[top] = True
    if sign < 0:
        is_kept[bottom] = True


@compiled(error_model="python", nogil=True)
def _off_line(points, first, last):
    """Sample with the maximum distance from the straight line between two samples, and this distance."""
    dx, dy = points[0, last] - points[0, first], points[1, last] - points[1, first]
    dz = points[2, last] - points[2, first]
    length = dx * dx + dy * dy + dz * dz
    index, largest = first, 0.0
    for k in range(first + 1, last):
        x, y = points[0, k] - points[0, first], points[1, k] - points[1, first]
        z = points[2, k] - points[2, first]
        along = min(max((x * dx + y * dy + z * dz) / length, 0.0), 1.0) if length > 0 else 0.0
        away = (x - along * dx) ** 2 + (y - along * dy) ** 2 + (z - along * dz) ** 2
        if away > largest:
            index, largest = k, away
    return index, sqrt(largest)


@compiled(error_model="python", nogil=True)
def turning_samples(points, size, indices):
    """Write the indices of the samples of points (3, :size) to keep into `indices`; return their number."""
    extent = 0.0
    for k in range(3):
        extent = max(extent, points[k, :size].max() - points[k, :size].min())
    tolerance = TOLERANCE * extent
    is_kept = np.zeros(size, np.bool_)
    is_kept[0] = is_kept[size - 1] = True
    for direction in DIRECTIONS:
        _mark_reversals(points, size, direction, tolerance, is_kept)
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
