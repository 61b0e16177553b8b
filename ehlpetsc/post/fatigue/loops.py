r"""Closed loop of a counted cycle and its width in stress space.

A cycle is closed by the counted scalar. Its loop consists of all instants around its two reversals at which
the scalar is within the range of the cycle: the path between the reversals, and the paths on which the scalar
returns. It does not depend on the direction of time. In a repeated history the loop of the largest cycle is
the whole history.

In plane strain the von Mises distance of two instants is the Euclidean one of the points

.. math::
    \big((1-2\nu)\tfrac{\sigma_x+\sigma_z}{2},\ \sqrt3\,\tfrac{\sigma_x-\sigma_z}{2},\ \sqrt3\,\tau_{xz}\big)

for which :math:`\sigma_y=\nu(\sigma_x+\sigma_z)`.
"""

from math import sqrt

import numpy as np

from ehlpetsc.compiled import ZERO, compiled

POINTS_PER_BALL = 16  # successive points of a path with a common bound


@compiled(error_model="python", nogil=True)
def loop_of(series, size, i, j, closed):
    """First sample and number of samples of the loop of the cycle between samples i and j of series[:size].

    `closed`: the history repeats, so that a loop may extend across its end, as from i to j < i.
    """
    low, high = min(series[i], series[j]), max(series[i], series[j])
    count = (j - i if j >= i else j - i + size) + 1
    first = i
    while count < size:
        before = first - 1
        if before < 0:
            if not closed:
                break
            before += size
        if not low <= series[before] <= high:
            break
        first = before
        count += 1
    last = (first + count - 1) % size
    while count < size:
        after = last + 1
        if after == size:
            if not closed:
                break
            after = 0
        if not low <= series[after] <= high:
            break
        last = after
        count += 1
    return first, count


@compiled(error_model="python", nogil=True)
def equivalent_points(stress, nu, points):
    """Set points (3, samples), whose distances are von Mises stresses, from stress (3, samples)."""
    root = sqrt(3.0)
    for k in range(stress.shape[1]):
        sx, sz = float(stress[0, k]), float(stress[1, k])
        points[0, k] = (1 - 2 * nu) * (sx + sz) / 2
        points[1, k] = root * (sx - sz) / 2
        points[2, k] = root * float(stress[2, k])


@compiled(error_model="python", nogil=True)
def repeat_points(points, size):
    """Repeat points[:, :size], so that a loop across the end of a history is one slice."""
    for component in range(3):
        for k in range(size):
            points[component, size + k] = points[component, k]


@compiled(error_model="python", nogil=True)
def _squared_distance(x, y, z, i, j):
    return (x[i] - x[j]) ** 2 + (y[i] - y[j]) ** 2 + (z[i] - z[j]) ** 2


@compiled(error_model="python", nogil=True)
def _farthest(x, y, z, i):
    best, index = -1.0, i
    for k in range(x.size):
        squared = _squared_distance(x, y, z, k, i)
        if squared > best:
            best, index = squared, k
    return best, index


@compiled(error_model="python", nogil=True)
def _widest_of_few(x, y, z):
    best = 0.0
    for i in range(1, x.size):
        for j in range(i):
            best = max(best, _squared_distance(x, y, z, i, j))
    return best


@compiled(error_model="python", nogil=True)
def _balls(x, y, z, indices):
    """Middle point and radius of each `POINTS_PER_BALL` successive points of the path, by indices."""
    count = -(-indices.size // POINTS_PER_BALL)
    middles, radii = np.empty(count, np.int64), np.empty(count)
    for m in range(count):
        block = indices[m * POINTS_PER_BALL : (m + 1) * POINTS_PER_BALL]
        middles[m], squared = block[block.size // 2], 0.0
        for i in block:
            squared = max(squared, _squared_distance(x, y, z, i, middles[m]))
        radii[m] = sqrt(squared)
    return middles, radii


@compiled(error_model="python", nogil=True)
def _far_from(x, y, z, middle, best):
    """Indices of the points that can have a squared distance above `best`."""
    squared, largest = np.empty(x.size), 0.0
    for k in range(x.size):
        squared[k] = (x[k] - middle[0]) ** 2 + (y[k] - middle[1]) ** 2 + (z[k] - middle[2]) ** 2
        largest = max(largest, squared[k])
    min_distance = max(sqrt(best) - sqrt(largest), 0.0)
    return np.flatnonzero(squared >= min_distance * min_distance * (1 - 1e-12))


@compiled(error_model="python", nogil=True)
def widest(points, first, count):
    """Largest squared distance between two of points[:, first:first + count].

    Two searches for the farthest point yield a distance close to the maximum. Only points far enough from its
    midpoint can have a larger distance; of these, pairs of points are compared in blocks whose balls are far
    enough apart.
    """
    last = first + count
    x, y, z = points[0, first:last], points[1, first:last], points[2, first:last]
    if count <= POINTS_PER_BALL:
        return _widest_of_few(x, y, z)
    _, a = _farthest(x, y, z, ZERO)
    best, b = _farthest(x, y, z, a)
    middle = (x[a] + x[b]) / 2, (y[a] + y[b]) / 2, (z[a] + z[b]) / 2
    far = _far_from(x, y, z, middle, best)
    middles, radii = _balls(x, y, z, far)
    for m in range(radii.size):
        for n in range(m + 1):
            distance = sqrt(_squared_distance(x, y, z, middles[m], middles[n]))
            if distance + radii[m] + radii[n] <= sqrt(best):
                continue
            for i in far[m * POINTS_PER_BALL : (m + 1) * POINTS_PER_BALL]:
                for j in far[n * POINTS_PER_BALL : (n + 1) * POINTS_PER_BALL]:
                    best = max(best, _squared_distance(x, y, z, i, j))
    return best
