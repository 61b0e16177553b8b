r"""Fatemi and Socie's criterion on the critical plane of a history, the plane of maximum damage.

The cycles of the shear stress are counted; the maximum normal stress of a cycle is that in its closed loop.
First all planes of a coarse grid are evaluated on the samples at which the path turns, in the order of their
widest range, until no other plane can reach the maximum damage so far. The best two planes are then improved
by a pattern search, and the damage of the best plane is counted on all samples.
"""

from __future__ import annotations

from functools import partial
from math import cos, pi, sin, sqrt
from typing import NamedTuple

import numpy as np

from ehlpetsc.base.compiled import ZERO, compiled
from ehlpetsc.base.counts import whole_up
from ehlpetsc.post.criteria.planes import (
    GRID_STEP,
    Criteria,
    cycle_damage,
    on_plane,
    planes_and_directions,
    shear_planes,
    turning_samples,
)
from ehlpetsc.post.fatigue.accumulate import evaluate
from ehlpetsc.post.fatigue.cycles import (
    RESIDUALS,
    equivalent_points,
    find_cycles,
    history_of,
    in_double_precision,
    loop_of,
    workspace,
)
from ehlpetsc.post.fatigue.strain_life import DEFAULT_STRAIN, Material, shear_tables

MIN_SOUGHT = 200  # points of a depth whose planes are always sought
MAX_SOUGHT = 3  # shares
PAIRS = 3, 2  # of samples, whose planes of maximum shear are tried: far ones, those of extreme shear
FIRST_PAIRS, FIRST_SHARE = (2, 0), 0.2  # for all points; share of the worst by them, for which all are tried
MIN_ANGLE_STEP = pi / 180 * 0.9  # rad; 1 - cos(2 x 0.9 degrees) is 0.05 % of a stress range
BOUND_ROUNDING = 1e-9  # of a bound
NEGLIGIBLE_RANGE = 0.2  # of the widest: smaller cycles, which the search ignores, have < 1e-7 of its damage


@compiled(error_model="python", nogil=True)
def plane_damage(angles: np.ndarray, stress: np.ndarray, law: tuple, threshold: float, work: tuple) -> float:
    """Damage on one plane, without cycles below `threshold` of the widest range."""
    stack, cycles, series, normal = work
    size = stress.shape[1]
    on_plane(angles, stress, law, work)
    n, full = find_cycles(series[:size], stack, cycles, law[5])
    min_range = threshold * (series[:size].max() - series[:size].min())
    total = 0.0
    for k in range(n):
        i, j = cycles[k, 0], cycles[k, 1]
        width = abs(series[i] - series[j])
        if width <= min_range:
            continue
        highest = 0.0
        start, count = loop_of(series, size, i, j) if k < full else (i, j - i + 1)
        for m in range(start, start + count):
            highest = max(highest, normal[m if m < size else m - size])
        total += (1.0 if k < full else 0.5) * cycle_damage(width, highest, law)
    return total


@compiled(error_model="python", nogil=True)
def _bound(width: float, way: float, highest: float, law: tuple) -> float:
    """Upper bound of the damage of a shear stress: its range, length of its path and maximum normal stress.

    Ranges of the cycles sum up to half the path, and damage rises faster than the range.
    """
    cycles = max(0.5 * way / width, 1.0) if width > 0.0 else 1.0
    return (1 + BOUND_ROUNDING) * (cycles * cycle_damage(width, highest, law))


@compiled(error_model="python", nogil=True)
def _shear_in_plane(
    angles: np.ndarray, stress: np.ndarray, law: tuple, work: tuple, shear: np.ndarray
) -> float:
    """Set shear (2, samples) to the shear stress in two directions of a plane; maximum normal stress."""
    size, turned = stress.shape[1], angles.copy()
    for k in range(2):
        turned[2] = k * pi / 2
        on_plane(turned, stress, law, work)
        shear[k] = work[2][:size]
    return work[3][:size].max()


@compiled(error_model="python", nogil=True)
def _bound_of_plane(highest: float, shear: np.ndarray, law: tuple) -> float:
    """Upper bound of the damage in all directions of a plane: that of the box about the path."""
    way, last = 0.0, shear.shape[1] - 1
    lows, highs = shear[:, last].copy(), shear[:, last].copy()
    for k in range(shear.shape[1]):
        before = k - 1 if k else last
        way += sqrt((shear[0, k] - shear[0, before]) ** 2 + (shear[1, k] - shear[1, before]) ** 2)
        for axis in range(2):
            lows[axis] = min(lows[axis], shear[axis, k])
            highs[axis] = max(highs[axis], shear[axis, k])
    return _bound(sqrt(((highs - lows) ** 2).sum()), way, highest, law)


@compiled(error_model="python", nogil=True)
def _bound_in_direction(psi: float, highest: float, shear: np.ndarray, law: tuple) -> float:
    """Upper bound of the damage in a direction of a plane."""
    c, s, last = cos(psi), sin(psi), shear.shape[1] - 1
    before = c * shear[0, last] + s * shear[1, last]
    low, high, way = before, before, 0.0
    for k in range(shear.shape[1]):
        value = c * shear[0, k] + s * shear[1, k]
        way += abs(value - before)
        low, high, before = min(low, value), max(high, value), value
    return _bound(high - low, way, highest, law)


@compiled(error_model="python", nogil=True)
def _coarse(grid: np.ndarray, stress: np.ndarray, law: tuple, work: tuple) -> tuple[np.ndarray, np.ndarray]:
    """Angles (2, 3) and damage of the best planes of the grid, in falling order.

    Directions in a plane follow each other in the grid. Those of a plane are bounded, and then evaluated, in
    the order of the upper bounds, as long as these exceed the second damage so far.
    """
    shear, bounds = np.empty((2, stress.shape[1])), np.full(len(grid), -1.0)
    ends, is_plane = np.empty(len(grid), np.int64), np.zeros(len(grid), np.bool_)
    first = 0
    for g in range(len(grid)):
        if grid[g, 0] != grid[first, 0] or grid[g, 1] != grid[first, 1]:
            first = g
        ends[first], is_plane[first] = g + 1, True
    for g in np.flatnonzero(is_plane):
        highest = _shear_in_plane(grid[g], stress, law, work, shear)
        bounds[g] = _bound_of_plane(highest, shear, law)
    best, damages = np.zeros(2, np.int64), np.full(2, -1.0)
    while True:
        g = bounds.argmax()
        if bounds[g] <= damages[1]:
            return grid[best], damages
        if is_plane[g]:
            highest = _shear_in_plane(grid[g], stress, law, work, shear)
            for k in range(g, ends[g]):
                bounds[k] = _bound_in_direction(grid[k, 2], highest, shear, law)
            is_plane[g] = False
            continue
        bounds[g], damage = -1.0, plane_damage(grid[g], stress, law, NEGLIGIBLE_RANGE, work)
        if damage > damages[0]:
            best[1], damages[1] = best[0], damages[0]
            best[0], damages[0] = g, damage
        elif damage > damages[1]:
            best[1], damages[1] = g, damage


@compiled(error_model="python", nogil=True)
def _improve(angles: np.ndarray, damage: float, stress: np.ndarray, law: tuple, work: tuple) -> None:
    """Pattern search over the angles, from half the coarse step down to `MIN_ANGLE_STEP`."""
    step = GRID_STEP / 2
    trial = angles.copy()
    while step > MIN_ANGLE_STEP:
        better = False
        for axis in range(3):
            for change in (-step, step):
                trial[:] = angles
                trial[axis] += change
                trial_damage = plane_damage(trial, stress, law, NEGLIGIBLE_RANGE, work)
                if trial_damage > damage:
                    damage, better = trial_damage, True
                    angles[:] = trial
                    break
        if not better:
            step /= 2


class PlaneDamage(NamedTuple):
    """Damage of each history on its worst plane, and angles of the plane's normal in degrees.

    `inclination` is from x towards z in the section (90: the plane is parallel to the surface), `tilt` out of
    the section.
    """

    damage: np.ndarray
    inclination: np.ndarray
    tilt: np.ndarray


@compiled(error_model="python", nogil=True)
def _worst_planes(
    grid: np.ndarray, law: tuple, work: tuple, stress: np.ndarray, lengths: np.ndarray, out: np.ndarray
) -> None:
    """Set out (points, 3) to the damage on the worst plane, theta and phi of its normal [rad].

    Planes are sought on the samples at which the path turns.
    """
    axes = 3 if stress.shape[1] == 3 else 5
    points, indices = np.empty((axes, stress.shape[2])), np.empty(stress.shape[2], np.int64)
    for p in range(stress.shape[0]):
        history = history_of(stress, p, lengths[p])
        equivalent_points(history, law[0], points)
        few = history[:, indices[: turning_samples(points, lengths[p], indices)]]
        starts, damages = _coarse(grid, few, law, work)
        out[p] = 0.0
        for k in range(2):
            if damages[k] <= 0:
                continue
            _improve(starts[k], damages[k], few, law, work)
            damage = plane_damage(starts[k], history, law, 0.0, work)
            if damage > out[p, 0]:
                out[p, 0], out[p, 1:] = damage, starts[k, :2]


@compiled(error_model="python", nogil=True)
def _estimates(
    pairs: tuple, law: tuple, work: tuple, stress: np.ndarray, lengths: np.ndarray, out: np.ndarray
) -> None:
    """Set out as `_worst_planes`, to the most damaged of some planes of maximum shear: a lower bound.

    These are the planes between far samples, each of which is the farthest from the one before, then between
    the samples of extreme shear on the worst plane so far.
    """
    far, of_shear = pairs
    points, angles, best = np.empty((5, stress.shape[2])), np.empty((2, 3)), np.empty(3)
    for p in range(stress.shape[0]):
        history = history_of(stress, p, lengths[p])
        equivalent_points(history, law[0], points)
        begin, worst = ZERO, 0.0
        for pair in range(far + of_shear):
            end, largest = begin, -1.0
            if pair < far:
                for k in range(lengths[p]):
                    away = 0.0
                    for axis in range(5):
                        away += (points[axis, k] - points[axis, begin]) ** 2
                    if away > largest:
                        end, largest = k, away
            elif worst > 0.0:
                on_plane(best, history, law, work)
                begin, end = work[2][: lengths[p]].argmin(), work[2][: lengths[p]].argmax()
            shear_planes(history, begin, end, angles)
            is_better = False
            for k in range(2):
                damage = plane_damage(angles[k], history, law, NEGLIGIBLE_RANGE, work)
                if damage > worst:
                    worst, is_better = damage, True
                    best[:] = angles[k]
            if pair >= far and not is_better:
                break
            begin = end
        out[p, 0], out[p, 1:] = worst, best[:2]


def _sought(stress: np.ndarray, lengths: np.ndarray, law: tuple, share: float) -> np.ndarray:
    """Results (points, 3) as of `_worst_planes`, sought in the worst share of the points.

    Planes are sought in the order of the estimates until no other point can be among the worst share, if its
    damage exceeds its estimate by no more than that of any point so far; of `MAX_SOUGHT` shares at most.
    """
    grid, work = planes_and_directions(components=stress.shape[1]), plane_workspace(stress.shape[-1])
    seek = partial(_worst_planes, grid, law, work)
    wanted = max(whole_up(share * len(stress)), MIN_SOUGHT)
    if wanted >= len(stress) or stress.shape[1] == 3:
        return in_double_precision(seek, stress, lengths, 3)
    out = in_double_precision(partial(_estimates, FIRST_PAIRS, law, work), stress, lengths, 3)
    worst = np.argsort(-out[:, 0])[: max(int(FIRST_SHARE * len(out)), MAX_SOUGHT * wanted)]
    second = partial(_estimates, PAIRS, law, work)
    out[worst] = in_double_precision(second, stress[worst], lengths[worst], 3)
    estimates = out[:, 0].copy()
    order, done, excess = np.argsort(-estimates), 0, 1.0
    while done < min(len(order), MAX_SOUGHT * wanted):
        if done >= wanted:
            limit = -np.partition(-out[order[:done], 0], wanted - 1)[wanted - 1]
            if excess * estimates[order[done]] <= limit:
                break
        chosen = order[done : done + wanted]
        found = in_double_precision(seek, stress[chosen], lengths[chosen], 3)
        better = found[:, 0] > estimates[chosen]
        out[chosen[better]] = found[better]
        known = estimates[chosen] > 0
        excess = max(excess, np.max(out[chosen, 0][known] / estimates[chosen][known], initial=1.0))
        done += chosen.size
    return out


def plane_law(
    residual: float, material: Material, constants: Criteria, strain: str, cycle_residual: str = "repeat"
) -> tuple:
    """Constants of the compiled functions; residual stress [Pa]."""
    tables, half = shear_tables(material, strain), RESIDUALS.index(cycle_residual) > 0
    return material.poisson_ratio, residual, constants.sensitivity(material), *tables, half


def plane_workspace(samples: int) -> tuple:
    """Arrays of :func:`plane_damage`."""
    return *workspace(samples), np.empty(samples), np.empty(samples)


def count_on_planes(
    stress: np.ndarray,
    lengths: np.ndarray,
    residual: float,
    material: Material,
    constants: Criteria,
    strain: str,
    cycle_residual: str = "repeat",
    share: float = 1.0,
) -> np.ndarray:
    """Results (points, 3) as in PlaneDamage of histories (points, 3 or 6, samples) of these lengths.

    Of six components planes are sought in the worst `share` of the points; others have a lower bound, the
    damage of the worst of six planes of maximum shear.
    """
    law = plane_law(residual, material, constants, strain, cycle_residual)
    damage, theta, phi = _sought(stress, lengths, law, share).T
    x, y, z = np.cos(phi) * np.cos(theta), np.sin(phi), np.cos(phi) * np.sin(theta)
    inclination = np.degrees(np.arctan2(z, x)) % 180.0
    return np.stack([damage, inclination, np.degrees(np.arctan2(abs(y), np.hypot(x, z)))], axis=1)


def critical_plane(
    sx: np.ndarray,
    sz: np.ndarray,
    txz: np.ndarray,
    material: Material,
    constants: Criteria | None = None,
    strain: str = DEFAULT_STRAIN,
    residual_stress: float = 0.0,
) -> PlaneDamage:
    """Damage of one pass of each history by Fatemi and Socie on its worst plane, planes in three dimensions.

    Equation and sources: :mod:`ehlpetsc.post.criteria.planes`.

    `sx`, `sz`, `txz`: stress histories [Pa], shape (..., samples); sigma_y follows by plane strain.
    `strain`: see :func:`ehlpetsc.post.damage`.
    `residual_stress`: residual stress along the surface, equal in x and y, zero in z [Pa]; adds to the normal
        stress of a plane.
    """
    count = partial(count_on_planes, material=material, constants=constants or Criteria(), strain=strain)
    return PlaneDamage(*evaluate(sx, sz, txz, count, residual_stress))
