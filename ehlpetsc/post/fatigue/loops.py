r"""The closed loop of a counted cycle and how wide it is in stress space.

A cycle is closed by the counted scalar. Its loop are all instants about its two reversals, on either side,
at which the scalar stays within the cycle's range: the way from the one to the other, and the ways on which
the scalar comes back. It is the same whether time runs forwards or backwards. In a repeated history the loop
of the largest cycle is the whole history.

In plane strain the von Mises distance of two instants is the Euclidean one of the points

.. math::
    \big((1-2\nu)\tfrac{\sigma_x+\sigma_z}{2},\ \sqrt3\,\tfrac{\sigma_x-\sigma_z}{2},\ \sqrt3\,\tau_{xz}\big)

for which :math:`\sigma_y=\nu(\sigma_x+\sigma_z)`.
"""

from math import sqrt

import numpy as np

from ehlpetsc.compiled import compiled

BLOCK = 16  # points of a path that are bounded together


@compiled(error_model="python", nogil=True)
def loop_of(series, size, i, j, closed):
    """First sample and number of samples of the loop of the cycle between samples i and j of series[:size].

    `closed`: the history repeats, so that a loop may go on across its end, as from i to j < i.
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
    """Fill points (3, samples) whose distances are the von Mises ones, from stress (3, samples)."""
    root = sqrt(3.0)
    for k in range(stress.shape[1]):
        sx, sz = float(stress[0, k]), float(stress[1, k])
        points[0, k] = (1 - 2 * nu) * (sx + sz) / 2
        points[1, k] = root * (sx - sz) / 2
        points[2, k] = root * float(stress[2, k])


@compiled(error_model="python", nogil=True)
def _squared_distance(points, i, x, y, z):
    return (points[0, i] - x) ** 2 + (points[1, i] - y) ** 2 + (points[2, i] - z) ** 2


@compiled(error_model="python", nogil=True)
def _farthest(points, size, first, count, i):
    best, place = -1.0, i
    for k in range(first, first + count):
        squared = _squared_distance(points, k % size, points[0, i], points[1, i], points[2, i])
        if squared > best:
            best, place = squared, k % size
    return best, place


@compiled(error_model="python", nogil=True)
def _balls(points, places):
    """Middle (x, y, z) and radius of each BLOCK of points[:, places], which follow each other on the path."""
    balls = np.empty((-(-places.size // BLOCK), 4))
    for m in range(balls.shape[0]):
        block = places[m * BLOCK : (m + 1) * BLOCK]
        middle = block[block.size // 2]
        squared = 0.0
        for i in block:
            squared = max(
                squared, _squared_distance(points, i, points[0, middle], points[1, middle], points[2, middle])
            )
        balls[m] = points[0, middle], points[1, middle], points[2, middle], sqrt(squared)
    return balls


@compiled(error_model="python", nogil=True)
def widest(points, size, first, count):
    """Largest squared distance between two of points[:, first:first + count], counted round at `size`.

    Two sweeps to the farthest point give a distance close to the largest. Only points that lie far enough
    from the middle of it can belong to a larger one; of these, blocks whose balls come close enough are tried
    pair by pair.
    """
    _, a = _farthest(points, size, first, count, first)
    best, b = _farthest(points, size, first, count, a)
    x, y = (points[0, a] + points[0, b]) / 2, (points[1, a] + points[1, b]) / 2
    z = (points[2, a] + points[2, b]) / 2
    radius = np.empty(count)
    for k in range(count):
        radius[k] = sqrt(_squared_distance(points, (first + k) % size, x, y, z))
    far = (first + np.flatnonzero(radius > sqrt(best) - radius.max())) % size
    balls = _balls(points, far)
    for m in range(balls.shape[0]):
        for n in range(m + 1):
            apart = sqrt(
                (balls[m, 0] - balls[n, 0]) ** 2
                + (balls[m, 1] - balls[n, 1]) ** 2
                + (balls[m, 2] - balls[n, 2]) ** 2
            )
            if apart + balls[m, 3] + balls[n, 3] <= sqrt(best):
                continue
            for i in far[m * BLOCK : (m + 1) * BLOCK]:
                for j in far[n * BLOCK : (n + 1) * BLOCK]:
                    best = max(best, _squared_distance(points, j, points[0, i], points[1, i], points[2, i]))
    return best
