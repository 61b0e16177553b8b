r"""Fatemi and Socie's criterion on the critical plane of a history, the plane of maximum damage.

Planes in three dimensions: the normal of a plane has the angle :math:`\theta` from x towards z in the section
and the tilt :math:`\varphi` out of it; a direction in the plane the angle :math:`\psi` from the section's:

.. math::
    n = (\cos\varphi\cos\theta,\ \sin\varphi,\ \cos\varphi\sin\theta), \quad
    t = \cos\psi\,(-\sin\theta,\ 0,\ \cos\theta)
        + \sin\psi\,(-\sin\varphi\cos\theta,\ \cos\varphi,\ -\sin\varphi\sin\theta)

With :math:`\sigma_y=\nu(\sigma_x+\sigma_z)` and no shear out of the section, shear stress
:math:`t\cdot\sigma n` and normal stress :math:`n\cdot\sigma n` are sums of the three in-plane stresses.
Planes tilted by opposite angles are equivalent, so that tilts from 0 to 90 degrees suffice.

The cycles of the shear stress are counted; the maximum normal stress of a cycle is that in its closed loop.
First all planes of a coarse grid are evaluated on the samples at which the path turns, in the order of their
widest range, until no other plane can reach the maximum damage so far. The best two planes are then improved
by a pattern search, and the damage of the best plane is counted on all samples.
"""

from __future__ import annotations

from functools import partial
from math import asin, atan2, cos, exp, log, pi, sin, sqrt
from typing import NamedTuple

import numpy as np

from ehlpetsc.base.compiled import ZERO, compiled
from ehlpetsc.post.criteria.laws import Criteria
from ehlpetsc.post.criteria.turning_samples import turning_samples
from ehlpetsc.post.fatigue.accumulate import evaluate
from ehlpetsc.post.fatigue.cycles import RESIDUALS, equivalent_points, find_cycles, loop_of, workspace
from ehlpetsc.post.fatigue.strain_life import DEFAULT_STRAIN, Material, interpolate, shear_tables

GRID_STEP = pi / 12  # between the planes and directions of the coarse grid


@compiled(error_model="python", nogil=True)
def plane_weights(theta: float, phi: float, psi: float, nu: float) -> tuple[tuple, tuple, float]:
    """Weights (3,) of sx, sz, txz in shear and normal stress on a plane, of residual stress in the latter."""
    x, y, z = cos(phi) * cos(theta), sin(phi), cos(phi) * sin(theta)
    c, s = cos(psi), sin(psi)
    tx = -c * sin(theta) - s * sin(phi) * cos(theta)
    ty = s * cos(phi)
    tz = c * cos(theta) - s * sin(phi) * sin(theta)
    shear = x * tx + nu * y * ty, z * tz + nu * y * ty, x * tz + z * tx
    return shear, (x * x + nu * y * y, z * z + nu * y * y, 2 * x * z), x * x + y * y


@compiled(error_model="python", nogil=True)
def tensor_weights(theta: float, phi: float, psi: float) -> tuple[tuple, tuple, float]:
    """Weights (6,) of sx, sz, txz, sy, txy, tyz as those of :func:`plane_weights`."""
    x, y, z = cos(phi) * cos(theta), sin(phi), cos(phi) * sin(theta)
    c, s = cos(psi), sin(psi)
    tx = -c * sin(theta) - s * sin(phi) * cos(theta)
    ty = s * cos(phi)
    tz = c * cos(theta) - s * sin(phi) * sin(theta)
    shear = x * tx, z * tz, x * tz + z * tx, y * ty, x * ty + y * tx, y * tz + z * ty
    return shear, (x * x, z * z, 2 * x * z, y * y, 2 * x * y, 2 * y * z), x * x + y * y


def planes_and_directions(step: float = GRID_STEP, components: int = 3) -> np.ndarray:
    """Angles (count, 3) in radians of planes and directions in them, both about `step` apart.

    Of three components, planes without tilt have shear only in the direction of the section, the plane of the
    section has none, and tilts both ways are equivalent.
    """
    degrees, rows = np.degrees(step), []
    in_section = components == 3
    for tilt in np.arange(0.0 if in_section else degrees - 90.0, 90.0, degrees):
        count = max(1, round(180 / degrees * np.cos(np.radians(tilt))))
        directions = np.arange(0.0, 180.0, degrees) if tilt or not in_section else (0.0,)
        rows += [(theta, tilt, psi) for theta in 180 / count * np.arange(count) for psi in directions]
    return np.radians(rows)


MIN_SOUGHT = 200  # points of a depth whose planes are always sought
MAX_SOUGHT = 3  # shares
JACOBI_SWEEPS = 4
FAR_PAIRS, SHEAR_PAIRS = 3, 2  # of samples, whose planes of maximum shear are tried
MIN_ANGLE_STEP = pi / 180 * 0.9  # rad; 1 - cos(2 x 0.9 degrees) is 0.05 % of a stress range
ROUNDING = 1e-9  # of a bound
NEGLIGIBLE_RANGE = 0.2  # of the widest: smaller cycles, which the search ignores, have < 1e-7 of its damage


@compiled(error_model="python", nogil=True)
def _on_plane(angles: np.ndarray, stress: np.ndarray, law: tuple, work: tuple) -> None:
    """Fill in the shear stress, as an equivalent stress, and the normal stress."""
    size = stress.shape[1]
    if stress.shape[0] == 3:
        shear, normal, share = plane_weights(angles[0], angles[1], angles[2], law[0])
        a, b, c = shear
        work[2][:size] = 3**0.5 * (a * stress[0] + b * stress[1] + c * stress[2])
        a, b, c = normal
        work[3][:size] = law[1] * share + (a * stress[0] + b * stress[1] + c * stress[2])
        return
    in_shear, across, share = tensor_weights(angles[0], angles[1], angles[2])
    root, residual = 3**0.5, law[1] * share
    for i in range(size):
        along, normal = 0.0, residual
        for k in range(6):
            along += root * in_shear[k] * stress[k, i]
            normal += across[k] * stress[k, i]
        work[2][i], work[3][i] = along, normal


@compiled(error_model="python", nogil=True)
def _cycle_damage(width: float, normal: float, law: tuple) -> float:
    """1/N of a cycle with a range and a maximum normal stress."""
    _, _, sensitivity, curve, lives, _ = law
    if width <= 0:
        return 0.0
    parameter = interpolate(2 * log(width), curve)
    if normal > 0:
        parameter += log(1 + sensitivity * normal)
    return exp(min(interpolate(parameter, lives), 700.0))


@compiled(error_model="python", nogil=True)
def plane_damage(angles: np.ndarray, stress: np.ndarray, law: tuple, threshold: float, work: tuple) -> float:
    """Damage on one plane, without cycles below `threshold` of the widest range."""
    stack, cycles, series, normal = work
    size = stress.shape[1]
    _on_plane(angles, stress, law, work)
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
        total += (1.0 if k < full else 0.5) * _cycle_damage(width, highest, law)
    return total


@compiled(error_model="python", nogil=True)
def _bound(series: np.ndarray, highest: float, law: tuple) -> float:
    """Upper bound of the damage of a shear stress with a maximum normal stress."""
    low, high, way = series[0], series[0], abs(series[-1] - series[0])
    for k in range(1, series.size):
        way += abs(series[k] - series[k - 1])
        low, high = min(low, series[k]), max(high, series[k])
    # ranges of the cycles sum up to half the way, and damage rises faster than the range
    cycles = max(0.5 * way / (high - low), 1.0) if high > low else 1.0
    return cycles * _cycle_damage(high - low, highest, law)


@compiled(error_model="python", nogil=True)
def _bounds(grid: np.ndarray, stress: np.ndarray, law: tuple, work: tuple) -> np.ndarray:
    """Upper bounds of the damage on all planes of a grid, whose directions in a plane follow each other."""
    size, bounds = stress.shape[1], np.empty(grid.shape[0])
    first, across, angles = np.empty(size), np.empty(size), np.empty(3)
    series, normal = work[2][:size], work[3][:size]
    highest = 0.0
    for g in range(grid.shape[0]):
        if g == 0 or grid[g, 0] != grid[g - 1, 0] or grid[g, 1] != grid[g - 1, 1]:
            angles[:2] = grid[g, :2]
            for turn, along in ((0.0, first), (pi / 2, across)):
                angles[2] = turn
                _on_plane(angles, stress, law, work)
                along[:] = series
            highest = normal.max()
        c, s = cos(grid[g, 2]), sin(grid[g, 2])
        for k in range(size):
            series[k] = c * first[k] + s * across[k]
        bounds[g] = (1 + ROUNDING) * _bound(series, highest, law)
    return bounds


@compiled(error_model="python", nogil=True)
def _coarse(grid: np.ndarray, stress: np.ndarray, law: tuple, work: tuple) -> tuple[np.ndarray, np.ndarray]:
    """Angles (2, 3) and damage of the best planes of the grid, in falling order."""
    bounds = _bounds(grid, stress, law, work)
    order, first, second = np.argsort(-bounds), 0, len(bounds) - 1
    damages = np.full(order.size, -1.0)
    for n in range(order.size):
        if bounds[order[n]] <= damages[second]:
            break
        damage = plane_damage(grid[order[n]], stress, law, NEGLIGIBLE_RANGE, work)
        if damage > damages[first]:
            first, second = n, first if n else second
        elif damage > damages[second]:
            second = n
        damages[n] = damage
    best = np.array([first, second])
    return grid[order[best]], damages[best]


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
    grid: np.ndarray, stress: np.ndarray, lengths: np.ndarray, law: tuple, work: tuple, out: np.ndarray
) -> None:
    """Set out (points, 3) to the damage on the worst plane, theta and phi of its normal [rad].

    Planes are sought on the samples at which the path turns.
    """
    axes = 3 if stress.shape[1] == 3 else 5
    points, indices = np.empty((axes, stress.shape[2])), np.empty(stress.shape[2], np.int64)
    for p in range(stress.shape[0]):
        history = stress[p, :, : lengths[p]].copy()
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
def _principal_axes(tensor: np.ndarray, axes: np.ndarray) -> None:
    """Set the columns of axes (3, 3) to principal directions by Jacobi's rotations; tensor gets diagonal."""
    axes[:] = 0.0
    for k in range(3):
        axes[k, k] = 1.0
    for _ in range(JACOBI_SWEEPS):
        for i in range(2):
            for j in range(i + 1, 3):
                if tensor[i, j] == 0.0:
                    continue
                angle = 0.5 * atan2(2 * tensor[i, j], tensor[j, j] - tensor[i, i])
                c, s = cos(angle), sin(angle)
                for k in range(3):
                    a, b = tensor[k, i], tensor[k, j]
                    tensor[k, i], tensor[k, j] = c * a - s * b, s * a + c * b
                    a, b = axes[k, i], axes[k, j]
                    axes[k, i], axes[k, j] = c * a - s * b, s * a + c * b
                for k in range(3):
                    a, b = tensor[i, k], tensor[j, k]
                    tensor[i, k], tensor[j, k] = c * a - s * b, s * a + c * b


@compiled(error_model="python", nogil=True)
def _shear_planes(stress: np.ndarray, begin: int, end: int, angles: np.ndarray) -> None:
    """Angles (2, 3) of both planes of maximum shear between two samples."""
    tensor, axes = np.empty((3, 3)), np.empty((3, 3))
    for row, column, part in ((0, 0, 0), (2, 2, 1), (0, 2, 2), (1, 1, 3), (0, 1, 4), (1, 2, 5)):
        tensor[row, column] = tensor[column, row] = stress[part, end] - stress[part, begin]
    _principal_axes(tensor, axes)
    low, high = 0, 0
    for k in range(3):
        low = k if tensor[k, k] < tensor[low, low] else low
        high = k if tensor[k, k] > tensor[high, high] else high
    for turn in range(2):
        sign = 1.0 - 2.0 * turn
        x, y, z = (axes[:, high] + sign * axes[:, low]) / sqrt(2.0)
        tx, ty, tz = (axes[:, high] - sign * axes[:, low]) / sqrt(2.0)
        theta, phi = atan2(z, x), asin(min(max(y, -1.0), 1.0))
        along = cos(theta) * tz - sin(theta) * tx
        across = cos(phi) * ty - sin(phi) * (cos(theta) * tx + sin(theta) * tz)
        angles[turn] = theta, phi, atan2(across, along)


@compiled(error_model="python", nogil=True)
def _estimates(stress: np.ndarray, lengths: np.ndarray, law: tuple, work: tuple, out: np.ndarray) -> None:
    """Set out as `_worst_planes`, to the most damaged of some planes of maximum shear: a lower bound.

    These are the planes between far samples, each of which is the farthest from the one before, then between
    the samples of extreme shear on the worst plane so far.
    """
    points, angles, best = np.empty((5, stress.shape[2])), np.empty((2, 3)), np.empty(3)
    for p in range(stress.shape[0]):
        history = stress[p, :, : lengths[p]].copy()
        equivalent_points(history, law[0], points)
        begin, worst = ZERO, 0.0
        for pair in range(FAR_PAIRS + SHEAR_PAIRS):
            end, largest = begin, -1.0
            if pair < FAR_PAIRS:
                for k in range(lengths[p]):
                    away = 0.0
                    for axis in range(5):
                        away += (points[axis, k] - points[axis, begin]) ** 2
                    if away > largest:
                        end, largest = k, away
            elif worst > 0.0:
                _on_plane(best, history, law, work)
                begin, end = work[2][: lengths[p]].argmin(), work[2][: lengths[p]].argmax()
            _shear_planes(history, begin, end, angles)
            is_better = False
            for k in range(2):
                damage = plane_damage(angles[k], history, law, 0.0, work)
                if damage > worst:
                    worst, is_better = damage, True
                    best[:] = angles[k]
            if pair >= FAR_PAIRS and not is_better:
                break
            begin = end
        out[p, 0], out[p, 1:] = worst, best[:2]


def _sought(stress: np.ndarray, lengths: np.ndarray, law: tuple, share: float) -> np.ndarray:
    """Results (points, 3) as of `_worst_planes`, sought in the worst share of the points.

    Planes are sought in the order of the estimates until no other point can be among the worst share, if its
    damage exceeds its estimate by no more than that of any point so far; of `MAX_SOUGHT` shares at most.
    """
    grid, work = planes_and_directions(components=stress.shape[1]), plane_workspace(stress.shape[-1])
    out = np.empty((len(stress), 3))
    wanted = max(int(np.ceil(share * len(stress))), MIN_SOUGHT)
    if wanted >= len(stress) or stress.shape[1] == 3:
        _worst_planes(grid, stress, lengths, law, work, out)
        return out
    _estimates(stress, lengths, law, work, out)
    estimates = out[:, 0].copy()
    order, done, excess = np.argsort(-estimates), 0, 1.0
    while done < min(len(order), MAX_SOUGHT * wanted):
        if done >= wanted:
            limit = -np.partition(-out[order[:done], 0], wanted - 1)[wanted - 1]
            if excess * estimates[order[done]] <= limit:
                break
        chosen = order[done : done + wanted]
        found = np.empty((chosen.size, 3))
        _worst_planes(grid, stress[chosen], lengths[chosen], law, work, found)
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
    stress = stress.astype(float, copy=False)  # one compiled version for files and arrays
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

    Equation and sources: :mod:`ehlpetsc.post.criteria.laws`.

    `sx`, `sz`, `txz`: stress histories [Pa], shape (..., samples); sigma_y follows by plane strain.
    `strain`: see :func:`ehlpetsc.post.damage`.
    `residual_stress`: residual stress along the surface, equal in x and y, zero in z [Pa]; adds to the normal
        stress of a plane.
    """
    count = partial(count_on_planes, material=material, constants=constants or Criteria(), strain=strain)
    return PlaneDamage(*evaluate(sx, sz, txz, count, residual_stress))
