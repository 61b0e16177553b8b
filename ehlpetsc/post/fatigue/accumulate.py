r"""Palmgren-Miner damage of stress histories, :math:`D=\sum1/N_i` (Holmes et al. 2005, eq. (15))."""

from math import sqrt
from typing import NamedTuple

import numpy as np

from ehlpetsc.post.fatigue.cycles import RESIDUES, find_cycles, workspace
from ehlpetsc.post.fatigue.life_table import life_table, look_up
from ehlpetsc.post.fatigue.strain_life import cycle_damage
from ehlpetsc.post.jit import njit

CHANNELS = {"max3": (0, 1, 2), "sx": (0,), "sz": (1,), "txz": (2,), "von_mises": (3,)}
RANGES = ("reversals", "window")
MEAN_STRESSES = ("none", "morrow")


class Damage(NamedTuple):
    """Damage, counted cycles and largest equivalent range (Pa) of each history."""

    damage: np.ndarray
    cycles: np.ndarray
    peak_range: np.ndarray


class Counting(NamedTuple):
    """How histories are counted; :func:`damage` says what each choice means."""

    count: str = "max3"
    residue: str = "closed"
    ranges: str = "reversals"
    mean_stress: str = "none"

    def check(self):
        """Raise ValueError for a choice that does not exist."""
        choices = (CHANNELS, RESIDUES, RANGES, MEAN_STRESSES)
        for name, value, known in zip(self._fields, self, choices, strict=True):
            if value not in known:
                raise ValueError(f"{name} = {value!r}: must be one of {', '.join(known)}")
        return self


@njit(cache=True, nogil=True)
def _squared_range(dsx, dsz, dtxz, nu):
    dsy = nu * (dsx + dsz)
    return 0.5 * ((dsx - dsy) ** 2 + (dsy - dsz) ** 2 + (dsz - dsx) ** 2) + 3 * dtxz * dtxz


@njit(cache=True, nogil=True)
def _window(row, i, j):
    """Largest less smallest value from sample i on to sample j, across the repetition if j < i."""
    low = high = float(row[i])
    k = i
    while k != j:
        k = k + 1 if k + 1 < row.size else 0
        value = float(row[k])
        low, high = min(low, value), max(high, value)
    return high - low


@njit(cache=True, nogil=True)
def _sum_cycles(stress, nu, n, first, second, weight, window, morrow, constants, table):
    """Damage, number and largest squared range of n cycles of one history (3, samples)."""
    modulus, hardening, exponent, strength, ductility, b, c = constants
    total = number = largest = 0.0
    for k in range(n):
        i, j = first[k], second[k]
        xi, xj, zi, zj = float(stress[0, i]), float(stress[0, j]), float(stress[1, i]), float(stress[1, j])
        if window:
            squared = _squared_range(
                _window(stress[0], i, j), _window(stress[1], i, j), _window(stress[2], i, j), nu
            )
        else:
            squared = _squared_range(xj - xi, zj - zi, float(stress[2, j]) - float(stress[2, i]), nu)
        if squared <= 0:
            continue
        if morrow:
            mean = (1 + nu) * (xi + xj + zi + zj) / 2
            part = cycle_damage(sqrt(squared), mean, modulus, hardening, exponent, strength, ductility, b, c)
        else:
            part = look_up(squared, table)
        total += weight[k] * part
        number += weight[k]
        largest = max(largest, squared)
    return total, number, largest


@njit(cache=True, nogil=True)
def _fill_von_mises(stress, nu, scalar):
    for k in range(stress.shape[1]):
        scalar[k] = sqrt(_squared_range(float(stress[0, k]), float(stress[1, k]), float(stress[2, k]), nu))


@njit(cache=True, nogil=True)
def damage_of_points(stress, lengths, nu, channels, closed, window, morrow, constants, table, work, out):
    """Fill out (points, 3) from stress (points, 3, samples), of which the first lengths[point] count."""
    stack, first, second, weight, scalar = work
    for point in range(stress.shape[0]):
        history = stress[point, :, : lengths[point]]
        worst = -1.0
        for channel in channels:
            if channel == 3:
                _fill_von_mises(history, nu, scalar)
                n = find_cycles(scalar[: lengths[point]], closed, stack, first, second, weight)
            else:
                n = find_cycles(history[channel], closed, stack, first, second, weight)
            total, number, largest = _sum_cycles(
                history, nu, n, first, second, weight, window, morrow, constants, table
            )
            if total > worst or total == worst and largest > out[point, 2] ** 2:
                worst = total
                out[point, 0], out[point, 1], out[point, 2] = total, number, sqrt(largest)


class Counter:
    """Damage of blocks of histories under one material and one way of counting."""

    def __init__(self, material, counting, samples):
        counting.check()
        self.material = material
        self.options = (
            np.array(CHANNELS[counting.count]),
            counting.residue == "closed",
            counting.ranges == "window",
            counting.mean_stress == "morrow",
        )
        self.table = life_table(material)
        self.work = (*workspace(samples), np.empty(samples))

    def __call__(self, stress, lengths, out):
        """Stress (points, 3, samples), lengths (points,) -> out (points, 3): damage, cycles, peak range."""
        damage_of_points(
            stress,
            lengths,
            self.material.poisson_ratio,
            *self.options,
            self.material.constants(),
            self.table,
            self.work,
            out,
        )


def damage(sx, sz, txz, material, count="max3", residue="closed", ranges="reversals", mean_stress="none"):
    """Damage of one pass of each history.

    Parameters
    ----------
    sx, sz, txz : array_like, shape (..., samples)
        Stress histories, Pa; sigma_y follows by plane strain.
    material : Material
    count : {"max3", "sx", "sz", "txz", "von_mises"}
        The scalar whose reversals are counted, which Holmes et al. leave open. "max3" counts sx, sz and txz
        each for itself and keeps the largest damage: no one component sees every cycle (under a ripple sx and
        sz move together, under a passing asperity txz turns while sz peaks), and the von Mises stress, which
        has no sign, misses a reversal through zero. A von Mises stress signed by the shear is not offered:
        its sign jumps pair nearly equal stress states.
    residue : {"closed", "half"}
        See :func:`ehlpetsc.post.fatigue.cycles.rainflow`.
    ranges : {"reversals", "window"}
        Component ranges of a cycle: the difference between its two reversals, with its sign, or the largest
        less the smallest value of each component from the one to the other.
    mean_stress : {"none", "morrow"}
        Morrow takes the mean of sigma_x + sigma_y + sigma_z over the two reversals (in uniaxial loading the
        mean stress itself) off the fatigue strength.

    Returns
    -------
    Damage
        Arrays of shape (...): damage, cycles (of the scalar with the largest damage), peak_range in Pa.

    Raises
    ------
    ValueError
        Unknown choice, unequal shapes, nan.
    """
    stress = np.stack(np.broadcast_arrays(*(np.asarray(part, float) for part in (sx, sz, txz))), axis=-2)
    if not np.isfinite(stress).all():
        raise ValueError("stress histories must be finite")
    shape, samples = stress.shape[:-2], stress.shape[-1]
    counter = Counter(material, Counting(count, residue, ranges, mean_stress), samples)
    blocks = np.ascontiguousarray(stress).reshape(-1, 3, samples)
    out = np.empty((len(blocks), 3))
    counter(blocks, np.full(len(blocks), samples), out)
    return Damage(*(out[:, k].reshape(shape)[()] for k in range(3)))
