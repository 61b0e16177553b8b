"""Reduction of a history to the samples where its path in stress space turns.

A plane sees a sum of the three stresses. Samples at which one of 13 such sums turns back by more than a
tolerance are kept, and between them those that lie off the straight line; the path between kept samples is
straight and runs one way, so that no plane sees a reversal there that is larger than about the tolerance.
The few samples serve to find the worst plane; its damage is counted on all of them.
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
def _mark_reversals(points, size, direction, tolerance, kept):
    """Keep the samples from which the path turns back along a direction by more than the tolerance."""
    high = low = direction[0] * points[0, 0] + direction[1] * points[1, 0] + direction[2] * points[2, 0]
    top = bottom = way = 0
    for k in range(1, size):
        value = direction[0] * points[0, k] + direction[1] * points[1, k] + direction[2] * points[2, k]
        if way >= 0:
            if value > high:
                high, top = value, k
            elif high - value > tolerance:
                kept[top] = True
                way, low, bottom = -1, value, k
        if way <= 0:
            if value < low:
                low, bottom = value, k
            elif value - low > tolerance:
                kept[bottom] = True
                way, high, top = 1, value, k
    if way > 0:
        kept[top] = True
    if way < 0:
        kept[bottom] = True


@compiled(error_model="python", nogil=True)
def _off_line(points, first, last):
    """Sample between two that is farthest from the straight line through them, and its distance."""
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
    kept = np.zeros(size, np.bool_)
    kept[0] = kept[size - 1] = True
    for direction in DIRECTIONS:
        _mark_reversals(points, size, direction, tolerance, kept)
    count, first = 0, ZERO
    ends = np.empty(size, np.int64)
    for last in range(size):
        if not kept[last]:
            continue
        ends[0], open_ends = last, 1
        while open_ends:  # stretches still to be looked at end here, the next one first
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
