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
from math import asin, cos, sqrt

import numpy as np

from ehlpetsc.base.compiled import compiled
from ehlpetsc.post.criteria.planes import Criteria
from ehlpetsc.post.fatigue.accumulate import evaluate
from ehlpetsc.post.fatigue.cycles import equivalent_points, history_of, in_double_precision

MAX_ROUNDS = 200  # of the search for the smallest ball
BALL_TOLERANCE = 1e-9  # of the radius: points this far outside count as inside
DEGENERATE = 1e-10  # pivot over the first of the products of edges: corners on a line, in a plane ...


# Loops over axes in place of expressions of arrays, which take ten times as long to compile.


@compiled(nogil=True)
def _circumcentre(corners: np.ndarray, basis: np.ndarray, centre: np.ndarray) -> None:
    """Set the centre of the smallest sphere through corners (count, axes); nan or infinite if degenerate.

    `basis`: space of as many numbers as corners has.
    """
    count, axes = corners.shape
    for axis in range(axes):
        centre[axis] = corners[0, axis]
    for k in range(1, count):
        for axis in range(axes):
            basis[k, axis] = corners[k, axis] - corners[0, axis]
        for j in range(1, k):
            along = 0.0
            for axis in range(axes):
                along += basis[k, axis] * basis[j, axis]
            for axis in range(axes):
                basis[k, axis] -= along * basis[j, axis]
        square = outer = inner = 0.0
        for axis in range(axes):
            square += basis[k, axis] ** 2
            outer += (corners[k, axis] - centre[axis]) ** 2
            inner += (corners[0, axis] - centre[axis]) ** 2
        height = np.sqrt(square)
        for axis in range(axes):
            basis[k, axis] /= height
            centre[axis] += (outer - inner) / (2 * height) * basis[k, axis]


@compiled(nogil=True)
def _around(support: np.ndarray, count: int, corners: np.ndarray, centre: np.ndarray) -> tuple[int, float]:
    """Set corners and centre of the smallest ball about support[:count] and a point outside their ball.

    The point, corners[count], is on its surface. Returns the number of corners and the radius.
    """
    axes = centre.size
    new, about = corners[count].copy(), centre.copy()
    trial, basis = np.empty((count + 1, axes)), np.empty((count + 1, axes))
    number, best = 1, np.inf
    for mask in range(1 << count):
        n = 1
        for axis in range(axes):
            trial[0, axis] = new[axis]
        for k in range(count):
            if mask >> k & 1:
                for axis in range(axes):
                    trial[n, axis] = support[k, axis]
                n += 1
        if n > axes + 1:
            continue
        _circumcentre(trial[:n], basis, about)
        largest = 0.0
        for k in range(count + 1):
            away = 0.0
            for axis in range(axes):
                place = support[k, axis] if k < count else new[axis]
                away += (place - about[axis]) ** 2
            if not away <= largest:  # nan as well
                largest = away
        if np.sqrt(largest) < best:
            number, best = n, np.sqrt(largest)
            for axis in range(axes):
                centre[axis] = about[axis]
                for k in range(n):
                    corners[k, axis] = trial[k, axis]
    return number, best


@compiled(error_model="python", nogil=True)
def _barycentric(points: np.ndarray, system: np.ndarray, weights: np.ndarray) -> bool:
    """Set weights (n,) of points (n, axes) in the centre of the smallest sphere through them.

    False if the points are degenerate. `system`: space of n x n numbers.
    """
    n, axes = points.shape[0] - 1, points.shape[1]
    for i in range(n):
        for j in range(n):
            system[i, j] = 0.0
            for axis in range(axes):
                edge = points[i + 1, axis] - points[0, axis]
                system[i, j] += edge * (points[j + 1, axis] - points[0, axis])
        weights[i + 1] = system[i, i] / 2
    for k in range(n):
        if system[k, k] <= DEGENERATE * system[0, 0]:
            return False
        for i in range(k + 1, n):
            factor = system[i, k] / system[k, k]
            weights[i + 1] -= factor * weights[k + 1]
            for j in range(k, n):
                system[i, j] -= factor * system[k, j]
    weights[0] = 1.0
    for k in range(n - 1, -1, -1):
        for j in range(k + 1, n):
            weights[k + 1] -= system[k, j] * weights[j + 1]
        weights[k + 1] /= system[k, k]
        weights[0] -= weights[k + 1]
    return True


@compiled(error_model="python", nogil=True)
def _reduced(corners: np.ndarray, count: int, centre: np.ndarray, work: tuple) -> tuple[int, float]:
    """Set the centre of the smallest ball about corners[:count], the last of which is on its surface.

    Corners inside the ball are removed as long as their weight in the centre is negative. A centre within
    the hull of corners on its surface is that of the smallest ball if no removed corner is outside, which is
    checked. Returns the number of corners that remain and the squared radius; 0 corners: not found.
    """
    system, weights, all_corners = work
    every, axes = count, centre.size
    for k in range(every):
        for axis in range(axes):
            all_corners[k, axis] = corners[k, axis]
    while True:
        if not _barycentric(corners[:count], system, weights):
            return 0, 0.0
        least = 0
        for k in range(1, count):
            least = k if weights[k] < weights[least] else least
        if weights[least] >= 0.0:
            break
        if least == count - 1:
            return 0, 0.0
        count -= 1
        for k in range(least, count):
            for axis in range(axes):
                corners[k, axis] = corners[k + 1, axis]
    squared = largest = 0.0
    for axis in range(axes):
        centre[axis] = 0.0
        for k in range(count):
            centre[axis] += weights[k] * corners[k, axis]
        squared += (corners[count - 1, axis] - centre[axis]) ** 2
    for k in range(every):
        away = 0.0
        for axis in range(axes):
            away += (all_corners[k, axis] - centre[axis]) ** 2
        largest = max(largest, away)
    return (count, squared) if largest <= squared * (1 + BALL_TOLERANCE) else (0, 0.0)


@compiled(error_model="python", nogil=True)
def _farthest(points: np.ndarray, centre: np.ndarray) -> tuple[int, float]:
    """Index of the point farthest from the centre and its squared distance."""
    index, largest = 0, -1.0
    for k in range(points.shape[1]):
        away = 0.0
        for axis in range(centre.size):
            away += (points[axis, k] - centre[axis]) ** 2
        if away > largest:
            index, largest = k, away
    return index, largest


@compiled(error_model="python", nogil=True)
def smallest_ball(points: np.ndarray) -> tuple[np.ndarray, float]:
    """Centre and radius of the smallest ball about points (axes, n).

    The farthest point outside is added to the points that define the ball until no point is outside; the
    radius increases in every round, so that no subset occurs twice.
    """
    axes = points.shape[0]
    centre, radius, count = points[:, 0].copy(), 0.0, np.int64(1)  # compiled again for a literal 1
    support = np.empty((axes + 2, axes))
    corners, new_centre = support.copy(), centre.copy()
    support[0] = centre
    work = np.empty((axes + 1, axes + 1)), np.empty(axes + 2), support.copy()
    for _ in range(MAX_ROUNDS):
        farthest, away = _farthest(points, centre)
        if sqrt(away) <= radius * (1 + BALL_TOLERANCE):
            break
        for axis in range(axes):
            for k in range(count):
                corners[k, axis] = support[k, axis]
            corners[count, axis] = points[axis, farthest]
        number, squared = _reduced(corners, count + 1, new_centre, work)
        larger = sqrt(squared)
        if number == 0 or number > axes + 1:
            for axis in range(axes):
                corners[count, axis] = points[axis, farthest]
            number, larger = _around(support, count, corners, new_centre)
        if not larger > radius:
            break
        radius, count = larger, number
        for axis in range(axes):
            centre[axis] = new_centre[axis]
            for k in range(count):
                support[k, axis] = corners[k, axis]
    return centre, radius


@compiled(error_model="python", nogil=True)
def _greatest_shear(points: np.ndarray, centre: np.ndarray, k: int, least: float) -> float:
    """Half the difference of the largest and smallest principal values of the deviator from the centre.

    0 where it does not exceed `least` for certain, as it is between 0.87 and 1 times the root of the second
    invariant.
    """
    root = sqrt(3.0)
    if points.shape[0] == 3:
        u = abs(points[0, k] - centre[0])
        d, t = (points[1, k] - centre[1]) / root, (points[2, k] - centre[2]) / root
        inside = sqrt(d * d + t * t)  # the deviator is (u/3 + d, -2u/3, u/3 - d) and t
        return max(inside, (u + inside) / 2)
    u, d = points[0, k] - centre[0], (points[1, k] - centre[1]) / root
    txz, txy = (points[2, k] - centre[2]) / root, (points[3, k] - centre[3]) / root
    tyz = (points[4, k] - centre[4]) / root  # without arrays, whose allocation would take longest
    x, y, z = u / 3 + d, -2 * u / 3, u / 3 - d
    second = (x * x + y * y + z * z) / 2 + txz * txz + txy * txy + tyz * tyz
    third = x * (y * z - tyz * tyz) - txy * (txy * z - tyz * txz) + txz * (txy * tyz - y * txz)
    if second <= max(least, 0.0) ** 2:
        return 0.0
    lode = asin(min(max(-1.5 * root * third / second**1.5, -1.0), 1.0)) / 3
    return sqrt(second) * cos(lode)


@compiled(error_model="python", nogil=True)
def _hydrostatic(stress: np.ndarray, k: int, nu: float, residual: float) -> float:
    if stress.shape[0] == 3:
        return ((1 + nu) * (stress[0, k] + stress[1, k]) + 2 * residual) / 3
    return (stress[0, k] + stress[1, k] + stress[3, k] + 2 * residual) / 3


@compiled(error_model="python", nogil=True)
def _utilisations(
    nu: float, residual: float, limits: tuple, stress: np.ndarray, lengths: np.ndarray, out: np.ndarray
) -> None:
    """Set out (points, 1) to U of histories (points, 3 or 6, samples) with their lengths; limits a, tau_w."""
    slope, limit = limits
    axes = 3 if stress.shape[1] == 3 else 5
    for p in range(stress.shape[0]):
        history = history_of(stress, p, lengths[p])
        points = np.empty((axes, history.shape[1]))
        equivalent_points(history, nu, points)
        centre, _ = smallest_ball(points)
        largest = 0.0
        for k in range(history.shape[1]):
            hydrostatic = _hydrostatic(history, k, nu, residual)
            tension = slope * max(hydrostatic, 0.0)
            largest = max(largest, _greatest_shear(points, centre, k, largest - tension) + tension)
        out[p, 0] = largest / limit


def count_utilisation(
    stress: np.ndarray, lengths: np.ndarray, residual: float, poisson_ratio: float, constants: Criteria
) -> np.ndarray:
    """Dang Van's utilisation (points, 1) of histories (points, 3 or 6, samples) of these lengths."""
    limits = constants.hydrostatic_slope, constants.torsion_limit
    return in_double_precision(partial(_utilisations, poisson_ratio, residual, limits), stress, lengths, 1)


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
