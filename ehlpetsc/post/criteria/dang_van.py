r"""Dang Van's criterion: utilisation of the fatigue limit in every grain.

.. math::
    U = \max_t \frac{\tau(t) + a\,\max(\sigma_H(t), 0)}{\tau_w}, \qquad
    a = 3\Big(\frac{\tau_w}{\sigma_w}-\frac12\Big)

:math:`\tau(t)` is half the difference of the largest and smallest principal values of the deviator minus the
centre of the smallest ball about its path (the stress in a grain after shakedown), :math:`\sigma_H`
the hydrostatic stress with the residual stress, :math:`\tau_w` and :math:`\sigma_w` the fatigue limits in
reversed torsion and reversed bending. Up to U = 1 no crack starts; the margin is 1/U.

Dang Van, Griveau & Message (1989), *On a new multiaxial fatigue limit criterion*, in Biaxial and Multiaxial
Fatigue, EGF 3; constants from the two limits. The smallest ball of the deviator corresponds to the smallest
circle of the shear stress on a plane (Bernasconi & Papadopoulos (2005), Computational Materials Science 34).
Under the pressure of a rolling contact the linear criterion would allow unlimited shear; here compressive
hydrostatic stress counts as zero, which is conservative.
"""

from math import sqrt

import numpy as np

from ehlpetsc.base.compiled import ZERO, compiled

MAX_ROUNDS = 200  # of the search for the smallest ball
BALL_TOLERANCE = 1e-9  # of the radius: points this far outside count as inside


@compiled(error_model="python", nogil=True)
def _centre(points: np.ndarray, corners: np.ndarray, count: int) -> tuple[bool, np.ndarray]:
    """Centre of the smallest sphere through 1 to 4 points; False if they are degenerate."""
    centre = points[:, corners[0]].copy()
    n = count - 1
    if n == 0:
        return True, centre
    edges = np.empty((n, 3))
    for k in range(n):
        edges[k] = points[:, corners[k + 1]] - centre
    system = np.empty((n, n + 1))
    for k in range(n):
        for m in range(n):
            system[k, m] = 2 * np.sum(edges[k] * edges[m])
        system[k, n] = np.sum(edges[k] ** 2)
    for k in range(n):  # elimination with the largest pivot of the Gram matrix
        pivot = k
        for m in range(k + 1, n):
            if abs(system[m, k]) > abs(system[pivot, k]):
                pivot = m
        if abs(system[pivot, k]) <= 1e-12 * system[:, n].max():
            return False, centre
        for m in range(n + 1):
            system[k, m], system[pivot, m] = system[pivot, m], system[k, m]
        for m in range(n):
            if m != k:
                factor = system[m, k] / system[k, k]
                for q in range(k, n + 1):
                    system[m, q] -= factor * system[k, q]
    for k in range(n):
        centre += system[k, n] / system[k, k] * edges[k]
    return True, centre


@compiled(error_model="python", nogil=True)
def _max_distance(points: np.ndarray, corners: np.ndarray, count: int, centre: np.ndarray) -> float:
    reach = 0.0
    for k in range(count):
        reach = max(reach, np.sum((points[:, corners[k]] - centre) ** 2))
    return sqrt(reach)


@compiled(error_model="python", nogil=True)
def _smallest_of_few(
    points: np.ndarray, indices: np.ndarray, count: int
) -> tuple[float, np.ndarray, np.ndarray, int]:
    """Smallest ball about up to 5 points, and the subset of points that defines it."""
    best, best_centre = np.inf, points[:, indices[0]].copy()
    best_subset, best_count = indices.copy(), count
    subset = np.empty(5, np.int64)
    for mask in range(1, 1 << count):
        size = ZERO
        for k in range(count):
            if mask >> k & 1:
                subset[size] = indices[k]
                size += 1
        if size > 4:
            continue
        has_ball, centre = _centre(points, subset, size)
        if not has_ball:
            continue
        radius = _max_distance(points, subset, size, centre)
        if radius < best and _max_distance(points, indices, count, centre) <= radius * (1 + BALL_TOLERANCE):
            best, best_centre, best_count = radius, centre, int(size)
            best_subset[:size] = subset[:size]
    return best, best_centre, best_subset, best_count


@compiled(error_model="python", nogil=True)
def smallest_ball(points: np.ndarray) -> tuple[np.ndarray, float]:
    """Centre (3,) and radius of the smallest ball about points (3, n).

    The farthest point outside is added to the points that define the ball until no point is outside; the
    radius increases in every round, so that no subset occurs twice.
    """
    indices = np.zeros(5, np.int64)
    count, radius, centre = 1, 0.0, points[:, 0].copy()
    for _ in range(MAX_ROUNDS):
        farthest, squared = 0, -1.0
        for k in range(points.shape[1]):
            away = (
                (points[0, k] - centre[0]) ** 2
                + (points[1, k] - centre[1]) ** 2
                + (points[2, k] - centre[2]) ** 2
            )
            if away > squared:
                farthest, squared = k, away
        if sqrt(squared) <= radius * (1 + BALL_TOLERANCE):
            break
        indices[count] = farthest
        larger, new_centre, indices, count = _smallest_of_few(points, indices, count + 1)
        if not larger > radius:
            break
        radius, centre = larger, new_centre
    return centre, radius


@compiled(error_model="python", nogil=True)
def utilisation(
    stress: np.ndarray, points: np.ndarray, nu: float, residual: float, slope: float, limit: float
) -> float:
    """U of a history (3, samples) with its `points` of :mod:`ehlpetsc.post.fatigue.cycles`; `slope` is a."""
    centre, _ = smallest_ball(points)
    root, largest = sqrt(3.0), 0.0
    for k in range(stress.shape[1]):
        u = abs(points[0, k] - centre[0])
        d, t = (points[1, k] - centre[1]) / root, (points[2, k] - centre[2]) / root
        inside = sqrt(d * d + t * t)  # the deviator is (u/3 + d, -2u/3, u/3 - d) and t
        shear = max(inside, (u + inside) / 2)
        hydrostatic = ((1 + nu) * (float(stress[0, k]) + float(stress[1, k])) + 2 * residual) / 3
        largest = max(largest, shear + slope * max(hydrostatic, 0.0))
    return largest / limit
