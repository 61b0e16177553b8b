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

from __future__ import annotations

from functools import partial
from math import sqrt

import numpy as np

from ehlpetsc.base.compiled import ZERO, compiled
from ehlpetsc.post.criteria.laws import Criteria
from ehlpetsc.post.fatigue.accumulate import evaluate
from ehlpetsc.post.fatigue.cycles import equivalent_points

MAX_ROUNDS = 200  # of the search for the smallest ball
BALL_TOLERANCE = 1e-9  # of the radius: points this far outside count as inside


@compiled(nogil=True)
def _dot(a: tuple, b: tuple) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@compiled(nogil=True)
def _cross(a: tuple, b: tuple) -> tuple:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@compiled(nogil=True)
def _sum(x: float, a: tuple, y: float, b: tuple) -> tuple:
    return x * a[0] + y * b[0], x * a[1] + y * b[1], x * a[2] + y * b[2]


@compiled(nogil=True)
def _from(origin: tuple, points: np.ndarray, k: int) -> tuple:
    return points[0, k] - origin[0], points[1, k] - origin[1], points[2, k] - origin[2]


@compiled(nogil=True)
def _centre(points: np.ndarray, corners: np.ndarray, count: int) -> tuple:
    """Centre of the smallest sphere through 1 to 4 points; nan or infinite if they are degenerate."""
    origin = _from((0.0, 0.0, 0.0), points, corners[0])
    if count == 1:
        return origin
    a = _from(origin, points, corners[1])
    if count == 2:
        return _sum(1.0, origin, 0.5, a)
    b = _from(origin, points, corners[2])
    aa, bb, normal = _dot(a, a), _dot(b, b), _cross(a, b)
    if count == 3:
        return _sum(1.0, origin, 0.5 / _dot(normal, normal), _cross(_sum(aa, b, -bb, a), normal))
    c = _from(origin, points, corners[3])
    far = _sum(1.0, _sum(_dot(c, c), normal, aa, _cross(b, c)), bb, _cross(c, a))
    return _sum(1.0, origin, 0.5 / _dot(normal, c), far)


@compiled(nogil=True)
def _max_distance(points: np.ndarray, corners: np.ndarray, count: int, centre: tuple) -> float:
    reach = 0.0
    for k in range(count):
        away = _from(centre, points, corners[k])
        squared = _dot(away, away)
        if not squared <= reach:  # also nan
            reach = squared
    return sqrt(reach)


@compiled(nogil=True)
def _smallest_of_few(
    points: np.ndarray, indices: np.ndarray, count: int
) -> tuple[float, tuple, np.ndarray, int]:
    """Smallest ball about up to 5 points, and the subset of points that defines it."""
    best, best_centre = np.inf, _centre(points, indices, 1)
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
        centre = _centre(points, subset, size)
        radius = _max_distance(points, indices, count, centre)
        if radius < best:
            best, best_centre, best_count = radius, centre, int(size)
            best_subset[:size] = subset[:size]
    return best, best_centre, best_subset, best_count


@compiled(error_model="python", nogil=True)
def smallest_ball(points: np.ndarray) -> tuple[tuple, float]:
    """Centre and radius of the smallest ball about points (3, n).

    The farthest point outside is added to the points that define the ball until no point is outside; the
    radius increases in every round, so that no subset occurs twice.
    """
    indices = np.zeros(5, np.int64)
    count, radius, centre = 1, 0.0, _centre(points, indices, 1)
    for _ in range(MAX_ROUNDS):
        farthest, squared = 0, 0.0
        for k in range(points.shape[1]):
            away = _from(centre, points, k)
            if _dot(away, away) > squared:
                farthest, squared = k, _dot(away, away)
        if sqrt(squared) <= radius * (1 + BALL_TOLERANCE):
            break
        indices[count] = farthest
        larger, new_centre, indices, count = _smallest_of_few(points, indices, count + 1)
        if not larger > radius:
            break
        radius, centre = larger, new_centre
    return centre, radius


@compiled(error_model="python", nogil=True)
def _utilisations(histories: tuple, nu: float, residual: float, limits: tuple, out: np.ndarray) -> None:
    """Set out (points, 1) to U of histories (points, 3, samples) with their lengths; limits a and tau_w."""
    stresses, lengths = histories
    slope, limit = limits
    root = sqrt(3.0)
    for p in range(stresses.shape[0]):
        stress = stresses[p, :, : lengths[p]].copy()
        points = np.empty(stress.shape)
        equivalent_points(stress, nu, points)
        centre, _ = smallest_ball(points)
        largest = 0.0
        for k in range(stress.shape[1]):
            u = abs(points[0, k] - centre[0])
            d, t = (points[1, k] - centre[1]) / root, (points[2, k] - centre[2]) / root
            inside = sqrt(d * d + t * t)  # the deviator is (u/3 + d, -2u/3, u/3 - d) and t
            hydrostatic = ((1 + nu) * (stress[0, k] + stress[1, k]) + 2 * residual) / 3
            largest = max(largest, max(inside, (u + inside) / 2) + slope * max(hydrostatic, 0.0))
        out[p, 0] = largest / limit


def count_utilisation(
    stress: np.ndarray, lengths: np.ndarray, residual: float, poisson_ratio: float, constants: Criteria
) -> np.ndarray:
    """Dang Van's utilisation (points, 1) of histories (points, 3, samples) of these lengths."""
    out = np.empty((len(stress), 1))
    limits = constants.hydrostatic_slope, constants.torsion_limit
    _utilisations((stress.astype(float, copy=False), lengths), poisson_ratio, residual, limits, out)
    return out


def dang_van(
    sx: np.ndarray,
    sz: np.ndarray,
    txz: np.ndarray,
    poisson_ratio: float,
    constants: Criteria | None = None,
    residual_stress: float = 0.0,
) -> float | np.ndarray:
    """Dang Van's utilisation U of the fatigue limit by each history; no crack for U <= 1, safety 1/U.

    `sx`, `sz`, `txz`: stress histories [Pa], shape (..., samples); sigma_y follows by plane strain.
    `constants`: with the two fatigue limits.
    `residual_stress`: residual stress along the surface, equal in x and y [Pa]; adds to the hydrostatic
        stress.
    """
    count = partial(count_utilisation, poisson_ratio=poisson_ratio, constants=constants or Criteria())
    return evaluate(sx, sz, txz, count, residual_stress)[0]
