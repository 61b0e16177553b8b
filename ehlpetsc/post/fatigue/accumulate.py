r"""Palmgren-Miner damage of stress histories, :math:`D=\sum1/N_i` (Holmes et al. 2005, eq. (15)).

Mean-stress corrections: the fully reversed range equivalent to a stress range about a mean stress.
With the amplitude :math:`\sigma_a`, the mean :math:`\sigma_m` and :math:`\sigma_{max}=\sigma_a+\sigma_m`:

.. math::
    \text{Goodman:}\quad \sigma_{ar} = \frac{\sigma_a}{1-\sigma_m/\sigma_u} \qquad
    \text{Gerber:}\quad \sigma_{ar} = \frac{\sigma_a}{1-(\max(\sigma_m,0)/\sigma_u)^2}

    \text{Smith, Watson, Topper:}\quad \sigma_{ar} = \sqrt{\sigma_{max}\sigma_a} \qquad
    \text{Walker:}\quad \sigma_{ar} = \sigma_{max}^{1-\gamma}\sigma_a^\gamma

Morrow's subtracts :math:`\sigma_m` from the fatigue strength instead
(:mod:`ehlpetsc.post.fatigue.strain_life`). Gerber's parabola would shorten lives under compression; here
compression has no effect. A cycle that is never in tension has no damage by Smith, Watson and Topper and by
Walker.

Dowling (2004), SAE Technical Paper 2004-01-2227. Estimates without tests: :math:`\sigma_u=3.45\,HB` MPa with
HB from :math:`\sigma_f'` by Roessle and Fatemi (2000); for steels
:math:`\gamma=0.8818-0.0002\,\sigma_u/\mathrm{MPa}` by Dowling, Calhoun and Arcari (2009), Fatigue Fract.
Engng Mater. Struct. 32, 163.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from math import inf, sqrt
from typing import NamedTuple

import numpy as np

from ehlpetsc.base.compiled import compiled
from ehlpetsc.base.materials import MEAN_STRESSES
from ehlpetsc.post.fatigue.cycles import RESIDUALS, find_cycles, workspace
from ehlpetsc.post.fatigue.strain_life import (
    DEFAULT_STRAIN,
    STRAINS,
    Material,
    cycle_damage,
    life_table,
    look_up,
)
from ehlpetsc.post.stresses.half_plane import von_mises_squared

CORRECTIONS = MEAN_STRESSES[2:]  # by a fully reversed range
ROUNDING = 1e-8  # of the widest range of a component: smaller differences count as zero


@compiled(error_model="python", nogil=True)
def reversed_range(number: int, width: float, mean: float, tensile_strength: float, exponent: float) -> float:
    """Fully reversed range of a range and a mean stress [Pa], by the correction with this number in
    `MEAN_STRESSES`; by Goodman and Gerber infinite from the tensile strength on. `exponent`: Walker's gamma.
    """
    if number == 2:
        return width / (1.0 - mean / tensile_strength) if mean < tensile_strength else inf
    if number == 3:
        share = max(mean, 0.0) / tensile_strength
        return width / (1.0 - share * share) if share < 1.0 else inf
    highest = max(width + 2.0 * mean, 0.0)  # twice the maximum stress
    return sqrt(width * highest) if number == 4 else width**exponent * highest ** (1.0 - exponent)


def evaluate(
    sx: np.ndarray, sz: np.ndarray, txz: np.ndarray, count: Callable, residual_stress: float
) -> list[np.ndarray]:
    """Columns of results of each history, shape (...).

    `sx`, `sz`, `txz`: [Pa], shape (..., samples).
    `count`: results (points, columns) of stress (points, 3, samples), lengths (points,) and residual stress.
    """
    stress = np.stack(np.broadcast_arrays(sx, sz, txz), axis=-2).astype(float)
    if not (np.isfinite(stress).all() and np.isfinite(residual_stress)):
        raise ValueError("stress histories and residual_stress must be finite")
    shape, samples = stress.shape[:-2], stress.shape[-1]
    blocks = stress.reshape(-1, 3, samples)
    out = count(blocks, np.full(len(blocks), samples), float(residual_stress))
    return [column.reshape(shape)[()] for column in out.T]


class Damage(NamedTuple):
    """Damage, counted cycles and maximum equivalent range (Pa) of each history."""

    damage: np.ndarray
    cycles: np.ndarray
    peak_range: np.ndarray


_squared = compiled(von_mises_squared, error_model="python", nogil=True)


@compiled(error_model="python", nogil=True)
def _range_and_sum(stress: np.ndarray, i: int, j: int, nu: float) -> tuple[float, float]:
    """Squared equivalent range between two samples and the sum of their normal stresses."""
    xi, xj, zi, zj = float(stress[0, i]), float(stress[0, j]), float(stress[1, i]), float(stress[1, j])
    dsx, dsz, dtxz = xj - xi, zj - zi, float(stress[2, j]) - float(stress[2, i])
    if stress.shape[0] == 3:
        return _squared(dsx, nu * (dsx + dsz), dsz, dtxz), (1 + nu) * (xi + xj + zi + zj)
    yi, yj = float(stress[3, i]), float(stress[3, j])
    dtxy, dtyz = float(stress[4, j]) - float(stress[4, i]), float(stress[5, j]) - float(stress[5, i])
    squared = _squared(dsx, yj - yi, dsz, dtxz) + 3 * (dtxy * dtxy + dtyz * dtyz)
    return squared, xi + xj + zi + zj + yi + yj


@compiled(error_model="python", nogil=True)
def _is_plateau(counted: tuple, k: int) -> bool:
    """Whether a neighbouring sample has the value of reversal k, or that value is zero."""
    series, tolerance = counted
    value, after = series[k], series[k + 1 if k + 1 < series.size else 0]
    return min(abs(value), abs(value - series[k - 1]), abs(value - after)) <= tolerance


@compiled(error_model="python", nogil=True)
def _flank(counted: tuple, i: int, j: int, step: int, repeats: bool) -> tuple[int, int]:
    """Ends of the flank beside reversal j, before it for a `step` of -1, after it for 1.

    They are the last sample with the value of j and the first with that of i; j twice if the component leaves
    the range of the cycle in between, or a history that occurs once ends.
    """
    series, tolerance = counted
    low, high = min(series[i], series[j]) - tolerance, max(series[i], series[j]) + tolerance
    left, at = j, j
    for _ in range(series.size):
        at += step
        if not 0 <= at < series.size:
            if not repeats:
                break
            at %= series.size
        if abs(series[at] - series[i]) <= tolerance:
            return left, at
        if not low <= series[at] <= high:
            break
        if abs(series[at] - series[j]) <= tolerance:
            left = at
    return j, j


@compiled(error_model="python", nogil=True)
def _sum_cycles(
    stress: np.ndarray, counted: tuple, nu: float, cycles: np.ndarray, full: int, law: tuple
) -> tuple[float, float, float]:
    """Damage, number and maximum squared range of the cycles of one history (components, samples).

    Those from number `full` on are half cycles. `counted`: the counted component, and the difference up to
    which two of its values are equal. Reversals of less, as of a component that is zero, are no cycles. On a
    plateau, as of sz where there is no pressure, rounding would choose the sample of the reversal: of the
    flanks on both sides, the one with the larger range counts.
    """
    (correction, rule, residual, limits), constants, table = law
    series, tolerance = counted
    total = number = largest = 0.0
    for k in range(len(cycles)):
        i, j = cycles[k, 0], cycles[k, 1]
        if abs(series[i] - series[j]) <= tolerance:
            continue
        squared, normal = _range_and_sum(stress, i, j, nu)
        if _is_plateau(counted, i) or _is_plateau(counted, j):
            squared = 0.0
            for step in (-1, 1):
                first, last = _flank(counted, i, j, step, full == len(cycles))
                candidate, its_normal = _range_and_sum(stress, first, last, nu)
                if candidate > squared:
                    squared, normal = candidate, its_normal
        if squared <= 0:
            continue
        if correction == 0:
            damage = look_up(squared, table)
        else:
            dsv = sqrt(squared)
            mean = max(normal / 2 + 2 * residual, -dsv / 2)
            if correction == 1:
                damage = cycle_damage(dsv, mean, rule, constants)
            else:
                dsv = reversed_range(correction, dsv, mean, limits[0], limits[1])
                damage = look_up(dsv * dsv, table) if dsv > 0 else 0.0
        share = 1.0 if k < full else 0.5
        total += share * damage
        number += share
        largest = max(largest, squared)
    return total, number, largest


@compiled(error_model="python", nogil=True)
def damage_of_points(
    histories: tuple, nu: float, half: bool, law: tuple, work: tuple, out: np.ndarray
) -> None:
    """Set out (points, 3) from histories: stress (points, components, samples) with lengths[point] samples.

    The counted components are those of a line contact and the two other shear stresses; sy follows them.
    """
    stress, lengths = histories
    stack, cycles, scalar = work
    for point in range(stress.shape[0]):
        history = stress[point, :, : lengths[point]]
        worst, widest = -1.0, 0.0
        for component in history:
            widest = max(widest, float(component.max()) - float(component.min()))
        for channel in range(stress.shape[1]):
            if channel == 3:
                continue
            series = scalar[: lengths[point]]
            series[:] = history[channel]  # copied: counting is compiled once for all kinds
            count, full = find_cycles(series, stack, cycles, half)
            counted = series, ROUNDING * widest
            total, number, largest = _sum_cycles(history, counted, nu, cycles[:count], full, law)
            if total > worst or total == worst and largest > out[point, 2] ** 2:
                worst = total
                out[point, 0], out[point, 1], out[point, 2] = total, number, sqrt(largest)


def count_damage(
    stress: np.ndarray,
    lengths: np.ndarray,
    residual: float,
    material: Material,
    mean_stress: str,
    strain: str,
    cycle_residual: str,
) -> np.ndarray:
    """Damage, cycles and maximum range (points, 3) of histories (points, 3 or 6, samples) of these lengths.

    The residual stress [Pa] acts in both directions along the surface, in the mean-stress term only.
    """
    samples, out = stress.shape[-1], np.empty((len(stress), 3))
    limits = material.mean_stress_constants()
    options = MEAN_STRESSES.index(mean_stress), STRAINS.index(strain), residual, limits
    law = options, material.constants(), life_table(material, strain)
    work = *workspace(samples), np.empty(samples)
    half = RESIDUALS.index(cycle_residual) > 0
    damage_of_points((stress, lengths), material.poisson_ratio, half, law, work, out)
    return out


def damage(
    sx: np.ndarray,
    sz: np.ndarray,
    txz: np.ndarray,
    material: Material,
    mean_stress: str = "none",
    strain: str = DEFAULT_STRAIN,
    residual_stress: float = 0.0,
    residual: str = "repeat",
) -> Damage:
    """Damage of one pass of each history, cycles of the scalar with the maximum damage, shape (...).

    sx, sz and txz are counted separately, and the maximum damage is used, which Holmes et al. do not specify:
    no single component has every cycle (under a ripple sx and sz change together, under a passing asperity
    txz reverses while sz peaks). On a plateau of the counted component, as of sz where there is no
    pressure, the sample next to the flank counts; of the flanks on both sides, that with the larger range.

    `sx`, `sz`, `txz`: stress histories [Pa], shape (..., samples); sigma_y follows by plane strain.
    `mean_stress`: "none" or a correction (:mod:`ehlpetsc.post.fatigue.cycles`) by the mean of
        sigma_x + sigma_y + sigma_z over the two reversals, in uniaxial loading the mean stress; "morrow"
        subtracts it from the fatigue strength. The benefit of compression is limited to
        that of a uniaxial cycle that ends at zero stress: a mean below -dsv/2 counts as -dsv/2. Without this
        limit the contact pressure would increase lives by decades.
    `strain`: use of the elastic range in the cyclic stress-strain curve (13): unchanged, as in the paper, or
        by Neuber's (default) or Glinka's rule (:mod:`ehlpetsc.post.fatigue.strain_life`).
    `residual_stress`: residual stress along the surface, equal in x and y, zero in z [Pa]; enters twice in
        the mean stress, and has no effect without a correction by it.
    `residual`: see :func:`ehlpetsc.post.rainflow`.
    """
    count = partial(
        count_damage, material=material, mean_stress=mean_stress, strain=strain, cycle_residual=residual
    )
    return Damage(*evaluate(sx, sz, txz, count, residual_stress))
