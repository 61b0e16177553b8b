r"""Closed loop of a counted cycle, and a history as points whose distances are von Mises stresses.

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

from ehlpetsc.compiled import compiled


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
