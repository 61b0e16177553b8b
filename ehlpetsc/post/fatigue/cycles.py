r"""Rainflow counting by the four-point method; the residue is counted as that of a repeated history.

A four-point count alone leaves a residue of the largest ranges, which is not conservative to ignore. The
history of a point that passes the contact repeatedly is periodic; hence the residue is closed: it
begins and ends with its largest reversal (ASTM E1049, 5.4.5, repeating histories). Of a history that occurs
once, the ranges of the residue count as half cycles (5.4.4), on request.

Closed loop of a counted cycle, and a history as points whose distances are von Mises stresses.

A cycle is closed by the counted scalar. Its loop consists of all instants around its two reversals at which
the scalar is within the range of the cycle: the path between the reversals, and the paths on which the scalar
returns. It does not depend on the direction of time. In a repeated history the loop of the largest cycle is
the whole history.

In plane strain the von Mises distance of two instants is the Euclidean one of the points

.. math::
    \big((1-2\nu)\tfrac{\sigma_x+\sigma_z}{2},\ \sqrt3\,\tfrac{\sigma_x-\sigma_z}{2},\ \sqrt3\,\tau_{xz}\big)

for which :math:`\sigma_y=\nu(\sigma_x+\sigma_z)`; of six components (sx, sz, txz, sy, txy, tyz) the first is
:math:`(\sigma_x+\sigma_z)/2-\sigma_y`, and root 3 times the other shear stresses are the fourth and fifth.
"""

from collections.abc import Callable
from math import sqrt

import numpy as np

from ehlpetsc.base.compiled import ZERO, compiled

RESIDUALS = ("repeat", "half")
POINTS_AT_ONCE = 64  # whose histories are in double precision at the same time


@compiled(error_model="python", nogil=True)
def _close(series: np.ndarray, stack: np.ndarray, top: int, cycles: np.ndarray, n: int) -> tuple[int, int]:
    """Count and remove closed cycles, whose range is within both neighbouring ranges of four reversals."""
    while top >= 4:
        b, c = series[stack[top - 3]], series[stack[top - 2]]
        inner = abs(c - b)
        if inner > abs(b - series[stack[top - 4]]) or inner > abs(series[stack[top - 1]] - c):
            break
        cycles[n, 0], cycles[n, 1] = stack[top - 3], stack[top - 2]
        n += 1
        stack[top - 3] = stack[top - 1]
        top -= 2
    return top, n


@compiled(error_model="python", nogil=True)
def _count(
    series: np.ndarray, order: np.ndarray, stack: np.ndarray, cycles: np.ndarray, n: int
) -> tuple[int, int]:
    """Count the closed cycles of samples in an order; numbers of reversals left in `stack` and of cycles."""
    last, top, sign = order[0], 1, 0.0
    stack[0] = last
    for new in order[1:]:
        step = series[new] - series[last]
        if sign * step < 0:
            stack[top] = last
            top, n = _close(series, stack, top + 1, cycles, n)
        if step != 0:
            last, sign = new, np.sign(step)
    if sign != 0:
        stack[top] = last
        top, n = _close(series, stack, top + 1, cycles, n)
    return top, n


@compiled(error_model="python", nogil=True)
def find_cycles(series: np.ndarray, stack: np.ndarray, cycles: np.ndarray, half: bool) -> tuple[int, int]:
    """Write the two reversals of each cycle into `cycles`; return their number and that of the full ones.

    `series` must be finite; the arrays are those of :func:`workspace`. The first sample of a plateau is the
    reversal. With `half` the ranges of the residue are half cycles, after the full ones.
    """
    top, n = _count(series, np.arange(series.size), stack, cycles, ZERO)
    if half:
        full = n
        for k in range(top - 1):
            cycles[n, 0], cycles[n, 1] = stack[k], stack[k + 1]
            n += 1
        return n, full
    residue = stack[:top].copy()
    start = series[residue].argmax()
    top, n = _count(series, np.concatenate((residue[start:], residue[: start + 1])), stack, cycles, n)
    if top == 3:  # highest, lowest, highest: one cycle
        cycles[n, 0], cycles[n, 1] = stack[0], stack[1]
        n += 1
    return n, n


def workspace(size: int) -> tuple[np.ndarray, np.ndarray]:
    """Arrays stack and cycles (n, 2) of :func:`find_cycles` for up to `size` samples."""
    return np.empty(size + 2, np.int64), np.empty((size + 2, 2), np.int64)


def rainflow(series: np.ndarray, residual: str = "repeat") -> np.ndarray:
    """Rainflow cycles of one history: range, mean, indices of the two reversals.

    `residual`: "repeat", the history repeats, and a cycle whose second reversal comes before the first
        spans the repetition; "half", it occurs once, and a fifth column is the count, 1 or 0.5.
    """
    series = np.ascontiguousarray(series, dtype=float)
    if series.ndim != 1 or not np.isfinite(series).all():
        raise ValueError("a history must be one row of finite values")
    half = RESIDUALS.index(residual) > 0
    if series.size < 2:
        return np.empty((0, 5 if half else 4))
    stack, cycles = workspace(series.size)
    n, full = find_cycles(series, stack, cycles, half)
    i, j = cycles[:n].T
    columns = [np.abs(series[i] - series[j]), (series[i] + series[j]) / 2, i, j]
    return np.column_stack(columns + [np.where(np.arange(n) < full, 1.0, 0.5)] * half)


@compiled(error_model="python", nogil=True)
def loop_of(series: np.ndarray, size: int, i: int, j: int) -> tuple[int, int]:
    """First sample and number of samples of the loop of the cycle between samples i and j of series[:size].

    The history repeats: a loop may extend across its end, as from i to j < i.
    """
    low, high = min(series[i], series[j]), max(series[i], series[j])
    count, first = (j - i) % size + 1, i
    for step in (-1, 1):
        at = first if step < 0 else first + count - 1
        while count < size:
            at += step
            if not low <= series[at % size] <= high:
                break
            count += 1
            if step < 0:
                first = at % size
    return first, count


def in_double_precision(
    kernel: Callable, stress: np.ndarray, lengths: np.ndarray, columns: int
) -> np.ndarray:
    """Results (points, columns) of kernel(stress, lengths, out), compiled for double precision alone, called
    on a few points at a time.
    """
    out = np.empty((len(stress), columns))
    for begin in range(0, len(stress), POINTS_AT_ONCE):
        part = slice(begin, begin + POINTS_AT_ONCE)
        kernel(stress[part].astype(float), lengths[part], out[part])
    return out


@compiled(error_model="python", nogil=True)
def history_of(stress: np.ndarray, point: int, length: int) -> np.ndarray:
    """First samples (3 or 6, length) of a point's history, contiguous."""
    history = np.empty((stress.shape[1], length))
    history[:] = stress[point, :, :length]
    return history


@compiled(error_model="python", nogil=True)
def equivalent_points(stress: np.ndarray, nu: float, points: np.ndarray) -> None:
    """Set points (3 or 5, samples), whose distances are von Mises stresses, from stress (3 or 6, samples)."""
    root, plane = sqrt(3.0), stress.shape[0] == 3
    for k in range(stress.shape[1]):
        sx, sz = float(stress[0, k]), float(stress[1, k])
        points[0, k] = (1 - 2 * nu) * (sx + sz) / 2 if plane else (sx + sz) / 2 - float(stress[3, k])
        points[1, k] = root * (sx - sz) / 2
        points[2, k] = root * float(stress[2, k])
        if not plane:
            points[3, k], points[4, k] = root * float(stress[4, k]), root * float(stress[5, k])
