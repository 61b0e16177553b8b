r"""Sparse form of a contact in the plane for PETSc's preconditioners (compiled).

The deflection, :math:`2\pi C/|k|` over the wave numbers k, is a full matrix; the sum

.. math:: \frac{2\pi C}{|k|}\approx\sum_j\frac{c_j}{k^2+s_j^2},\qquad
   D\,p\approx\sum_jc_ju_j,\quad(-\nabla^2+s_j^2)\,u_j=p

is a sparse one, of three more unknowns a node that obey screened Poisson equations (five-point stencils,
zero beyond the mesh). The weights are positive and fit to 10 to 20 %.

Unknowns of a node, in this order: u_1, u_2, u_3, v, and r where solids touch anywhere. v is the pressure, in
a cavity the unknown of the Reynolds equation.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ehlpetsc.base.compiled import compiled
from ehlpetsc.nonlinear.plane.reduction import BOUND, CONTACT, VOID

TERMS = 3
LONGEST = 1.0  # smallest s_j, in 1/a
MAX_ROW = 6 * (TERMS + 2)  # entries of a Reynolds row


def fitted_terms(stiffness: float, spacings: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
    """Coefficients c_j and squares of s_j for C of the deflection, shape (TERMS,) each.

    Relative errors of 2 pi C/|k| count the same in each octave. The spectrum of a finite mesh, of the
    logarithm of a strip above all, swings about it and through zero.
    """
    from scipy.optimize import nnls

    dy, dx = spacings
    s_2 = np.geomspace(LONGEST, np.pi / min(dx, dy), TERMS) ** 2
    k_2 = np.geomspace(LONGEST**2, 4.0 / dx**2 + 4.0 / dy**2, 200)  # the largest of the five-point stencil
    matrix = np.sqrt(k_2)[:, None] / (k_2[:, None] + s_2) / (2.0 * np.pi * stiffness)
    return nnls(matrix, np.ones(len(k_2)))[0], s_2


@compiled
def end_row(pointers: np.ndarray, columns: np.ndarray, values: np.ndarray, row: int, count: int) -> int:
    """End a row of a sparse matrix after `count` entries, its columns sorted; return the next row."""
    for k in range(pointers[row] + 1, count):
        column, value, to = columns[k], values[k], k
        while to > pointers[row] and columns[to - 1] > column:
            columns[to], values[to] = columns[to - 1], values[to - 1]
            to -= 1
        columns[to], values[to] = column, value
    pointers[row + 1] = count
    return row + 1


@compiled
def fill(
    reduction: tuple,
    derivatives: np.ndarray,
    terms: tuple,
    scales: tuple,
    mesh: tuple,
    csr: tuple,
    by_pressure: np.ndarray,
    by_separation: np.ndarray,
    border: np.ndarray,
) -> int:
    """Fill in the rows of the nodes first .. last - 1; return the number of entries.

    `reduction`: kind, r_p, r_s, h_p, h_s, s_p of all nodes.
    `derivatives`: of the local Reynolds rows, (last - first, 12).
    `terms`: c_j, squares of s_j.
    `scales`: of the deflection rows; dy; dx.
    `mesh`: n_x, nodes, first, last, whether periodic, unknowns of a node.
    `csr`: row pointers, columns, values.
    `by_pressure`, `by_separation`: of the local Reynolds rows by v and by the separation at the nodes of
        their stencil, (last - first, 6).
    `border`: of the local rows by h00.
    """
    (kind, r_p, r_s, h_p, h_s, s_p), (c, s_2), (row_scale, dy, dx) = reduction, terms, scales
    (n_x, n, first, last, periodic, block), (pointers, columns, values) = mesh, csr
    count, row = 0, 0
    pointers[0] = 0
    for i in range(first, last):
        x = i % n_x
        for j in range(TERMS):
            columns[count], values[count] = block * i + j, 2.0 * dy / dx + 2.0 * dx / dy + s_2[j] * dx * dy
            count += 1
            if kind[i] != VOID:
                columns[count], values[count] = block * i + TERMS, -dx * dy
                count += 1
            for k in range(4):
                near = i + (1 if k == 0 else -1 if k == 1 else n_x if k == 2 else -n_x)
                if k == 0 and x == n_x - 1 or k == 1 and x == 0:
                    continue
                if near < 0 or near >= n:
                    if not periodic:
                        continue
                    near = near % n
                columns[count], values[count] = block * near + j, -dy / dx if k < 2 else -dx / dy
                count += 1
            row = end_row(pointers, columns, values, row, count)
        touches = kind[i] == CONTACT or kind[i] == BOUND
        if touches:  # the row of the deflection is that of v
            columns[count], values[count] = block * i + TERMS, row_scale * s_p[i]
            count += 1
            for j in range(TERMS):
                columns[count], values[count] = block * i + j, -row_scale * c[j]
                count += 1
            border[row] = -row_scale
            row = end_row(pointers, columns, values, row, count)
        if kind[i] == BOUND:
            if block > TERMS + 1:
                columns[count], values[count] = block * i + TERMS + 1, 1.0
                count += 1
                row = end_row(pointers, columns, values, row, count)
            continue
        by = derivatives[i - first]
        edge = 0.0
        for k in range(6):
            near = (i + (k - 2 if k < 4 else (2 * k - 9) * n_x)) % n
            by_r, by_h = by[2 * k], by[2 * k + 1]
            by_pressure[i - first, k] = by_separation[i - first, k] = 0.0
            if by_r == 0.0 and by_h == 0.0 and near != i:
                continue
            at = block * near
            gamma, by_v = 0.0, 0.0
            if kind[near] == VOID:
                by_v, gamma = by_r + by_h * h_p[near], by_h * h_s[near]
            elif kind[near] == CONTACT:
                by_v = by_h * h_p[near]
                columns[count], values[count] = at + TERMS + 1, by_r
                count += 1
            else:
                by_v, gamma = by_r * r_p[near] + by_h * h_p[near], by_r * r_s[near] + by_h * h_s[near]
            columns[count], values[count] = at + TERMS, by_v
            count += 1
            if gamma != 0.0:
                for j in range(TERMS):
                    columns[count], values[count] = at + j, gamma * c[j]
                    count += 1
            by_pressure[i - first, k], by_separation[i - first, k] = by_v, gamma
            edge += gamma
        border[row] = edge
        row = end_row(pointers, columns, values, row, count)
        if block > TERMS + 1 and kind[i] != CONTACT:
            columns[count], values[count] = block * i + TERMS + 1, 1.0
            count += 1
            row = end_row(pointers, columns, values, row, count)
    return count
