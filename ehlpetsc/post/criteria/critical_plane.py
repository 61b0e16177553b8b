r"""Critical plane of a history: plane of maximum damage in three dimensions.

A criterion is a quantity whose cycles are counted on a plane and a parameter P of each cycle (laws in
:mod:`ehlpetsc.post.criteria.laws`). The largest normal stress of a cycle is that within its closed loop.

First all planes of a coarse grid are evaluated on the samples at which the path turns, in the order of their
widest range, until no other plane can reach the largest damage so far. The best two planes are then improved
by a pattern search, and the damage of the best plane is counted on all samples.

Reduction of a history to the samples at which its path in stress space turns.

The stress on a plane is a weighted sum of the three stresses. Samples at which one of 13 such sums reverses
by more than a tolerance are kept, and between them samples off the straight line; the path between kept
samples is straight and monotone, so that the stress on any plane has no larger reversal between them than
about the tolerance. The reduced history serves to find the worst plane; its damage is counted on all
samples.
"""

from math import exp, log, pi, sqrt

import numpy as np

from ehlpetsc.base.compiled import ZERO, compiled
from ehlpetsc.post.criteria.planes import (
    GRID_STEP,
    normal_weights,
    residual_share,
    shear_weights,
    strain_weights,
)
from ehlpetsc.post.fatigue.cycles import equivalent_points, find_cycles, loop_of
from ehlpetsc.post.fatigue.strain_life import interpolate

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
def _mark_reversals(
    points: np.ndarray, size: int, direction: np.ndarray, tolerance: float, is_kept: np.ndarray
) -> None:
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
def _off_line(points: np.ndarray, first: int, last: int) -> tuple[int, float]:
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
def turning_samples(points: np.ndarray, size: int, indices: np.ndarray) -> int:
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


SHEAR, FATEMI_SOCIE, SWT = 0, 1, 2
STARTS = 2  # planes of the coarse grid that are improved
MIN_ANGLE_STEP = pi / 180 * 0.9  # rad; 1 - cos(2 x 0.9 degrees) is 0.05 % of a stress range
NEGLIGIBLE_RANGE = (
    0.2  # of the widest range: smaller cycles, ignored in the search, have less than 1e-7 of its damage
)


@compiled(error_model="python", nogil=True)
def _sum(weights: tuple, scale: float, offset: float, stress: np.ndarray, out: np.ndarray) -> None:
    a, b, c = weights
    for k in range(stress.shape[1]):
        value = a * float(stress[0, k]) + b * float(stress[1, k]) + c * float(stress[2, k])
        out[k] = offset + scale * value


@compiled(error_model="python", nogil=True)
def _on_plane(kind: int, angles: np.ndarray, stress: np.ndarray, law: tuple, work: tuple) -> None:
    """Fill in the counted series (as an equivalent stress) and, if required, the normal stress."""
    (theta, phi, psi), nu = angles, law[0]
    if kind == SWT:
        _sum(strain_weights(theta, phi, nu), 1.0, 0.0, stress, work[2])
    else:
        _sum(shear_weights(theta, phi, psi, nu), 3**0.5, 0.0, stress, work[2])
    if kind != SHEAR:
        _sum(normal_weights(theta, phi, nu), 1.0, law[1] * residual_share(theta, phi), stress, work[3])


@compiled(error_model="python", nogil=True)
def _cycle_damage(kind: int, width: float, normal: float, law: tuple) -> float:
    """1/N of a cycle with a range and a maximum normal stress."""
    _, _, _, sensitivity, curve, lives = law
    if kind == SWT and normal <= 0 or width <= 0:
        return 0.0
    parameter = interpolate(2 * log(width), curve)
    if kind == SWT:
        parameter += log(normal)
    elif kind == FATEMI_SOCIE and normal > 0:
        parameter += log(1 + sensitivity * normal)
    return exp(min(interpolate(parameter, lives), 700.0))


@compiled(error_model="python", nogil=True)
def plane_damage(
    kind: int, angles: np.ndarray, stress: np.ndarray, law: tuple, threshold: float, work: tuple
) -> float:
    """Damage on one plane, without cycles below `threshold` of the widest range."""
    stack, cycles, series, normal = work
    size, closed = stress.shape[1], law[2]
    _on_plane(kind, angles, stress, law, work)
    n, full = find_cycles(series[:size], closed, stack, cycles)
    min_range = 0.0
    if threshold > 0:
        min_range = threshold * (series[:size].max() - series[:size].min())
    total = 0.0
    for k in range(n):
        i, j = cycles[k, 0], cycles[k, 1]
        width = abs(series[i] - series[j])
        if width <= min_range:
            continue
        highest = 0.0
        if kind != SHEAR:
            start, count = loop_of(series, size, i, j, closed)
            for m in range(start, start + count):
                highest = max(highest, normal[m if m < size else m - size])
        total += (1.0 if k < full else 0.5) * _cycle_damage(kind, width, highest, law)
    return total


@compiled(error_model="python", nogil=True)
def _coarse(
    kind: int, grid: np.ndarray, stress: np.ndarray, law: tuple, work: tuple
) -> tuple[np.ndarray, np.ndarray]:
    """Angles (STARTS, 3) and damage of the best planes of the grid, in falling order."""
    size, bounds = stress.shape[1], np.empty(grid.shape[0])
    _, _, series, normal = work
    for g in range(grid.shape[0]):
        _on_plane(kind, grid[g], stress, law, work)
        width = series[:size].max() - series[:size].min()
        bounds[g] = _cycle_damage(kind, width, normal[:size].max() if kind != SHEAR else 0.0, law)
    best, angles = np.full(STARTS, -1.0), np.zeros((STARTS, 3))
    for g in np.argsort(-bounds):
        if (size // 2 + 1) * bounds[g] <= best[STARTS - 1]:
            break
        damage = plane_damage(kind, grid[g], stress, law, NEGLIGIBLE_RANGE, work)
        rank = STARTS
        while rank > 0 and damage > best[rank - 1]:
            rank -= 1
        for k in range(STARTS - 1, rank, -1):
            best[k], angles[k] = best[k - 1], angles[k - 1]
        if rank < STARTS:
            best[rank], angles[rank] = damage, grid[g]
    return angles, best


@compiled(error_model="python", nogil=True)
def _improve(
    kind: int, angles: np.ndarray, damage: float, stress: np.ndarray, law: tuple, work: tuple
) -> None:
    """Pattern search over the angles, from half the coarse step down to `MIN_ANGLE_STEP`."""
    step = GRID_STEP * pi / 180 / 2
    trial = angles.copy()
    while step > MIN_ANGLE_STEP:
        better = False
        for axis in range(2 if kind == SWT else 3):
            for change in (-step, step):
                trial[:] = angles
                trial[axis] += change
                trial_damage = plane_damage(kind, trial, stress, law, NEGLIGIBLE_RANGE, work)
                if trial_damage > damage:
                    damage, better = trial_damage, True
                    angles[:] = trial
                    break
        if not better:
            step /= 2


@compiled(error_model="python", nogil=True)
def worst_plane(
    kind: int, grid: np.ndarray, stress: np.ndarray, law: tuple, work: tuple, spare: tuple
) -> tuple[float, float, float]:
    """Damage on the worst plane of stress (3, samples), theta and phi of its normal [rad].

    The plane is sought on the samples at which the path turns; `spare` holds arrays for their search.
    """
    points, indices = spare
    equivalent_points(stress, law[0], points)
    count = turning_samples(points, stress.shape[1], indices)
    few = np.empty((3, count))
    for k in range(count):
        for component in range(3):
            few[component, k] = stress[component, indices[k]]
    starts, damages = _coarse(kind, grid, few, law, work)
    worst, theta, phi = 0.0, 0.0, 0.0
    for k in range(STARTS):
        if damages[k] <= 0:
            continue
        _improve(kind, starts[k], damages[k], few, law, work)
        damage = plane_damage(kind, starts[k], stress, law, 0.0, work)
        if damage > worst:
            worst, theta, phi = damage, starts[k, 0], starts[k, 1]
    return worst, theta, phi
