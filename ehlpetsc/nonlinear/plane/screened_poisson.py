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
STENCIL, OWN = 6, 2  # nodes i-2 .. i+1, below, above of a row; index of i


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
    """Fill in the rows of the nodes first .. last - 1; return the number of blocks.

    `reduction`: kind, r_p, r_s, h_p, h_s, s_p of all nodes.
    `derivatives`: of the local Reynolds rows, (last - first, 12).
    `terms`: c_j, squares of s_j.
    `scales`: of the deflection rows; dy; dx.
    `mesh`: n_x, nodes, first, last, whether periodic.
    `csr`: row pointers, columns, blocks of a pair of nodes; zeros.
    `by_pressure`, `by_separation`: of the local Reynolds rows by v and by the separation at the nodes of
        their stencil, (last - first, 6).
    `border`: of the local rows by h00, (last - first, unknowns of a node).
    """
    (kind, r_p, r_s, h_p, h_s, s_p), (c, s_2), (row_scale, dy, dx) = reduction, terms, scales
    (n_x, n, first, last, periodic), (pointers, columns, blocks) = mesh, csr
    count, unknowns = 0, blocks.shape[1]
    for i in range(first, last):
        x, row, begin = i % n_x, i - first, count
        touches = kind[i] == CONTACT or kind[i] == BOUND
        for k in range(STENCIL):
            near = i + (k - OWN if k < 4 else (2 * k - 9) * n_x)
            along, inside = (k == 1 and x > 0) or (k == 3 and x < n_x - 1), 0 <= near < n
            across = k >= 4 and (periodic or inside)
            poisson = -dy / dx if along else -dx / dy if across else 0.0
            by_r, by_h = derivatives[row, 2 * k], derivatives[row, 2 * k + 1]
            if k != OWN and poisson == 0.0 and by_r == 0.0 and by_h == 0.0:
                continue
            near, at = near % n, begin
            while at < count and columns[at] != near:  # both neighbours across in a period of two rows
                at += 1
            if at == count:
                columns[at], count = near, count + 1
            block = blocks[at]
            for j in range(TERMS):
                block[j, j] += poisson
            if k == OWN:
                for j in range(TERMS):
                    block[j, j] += 2.0 * dy / dx + 2.0 * dx / dy + s_2[j] * dx * dy
                    block[j, TERMS] -= 0.0 if kind[i] == VOID else dx * dy
                    if touches:  # the row of the deflection is that of v
                        block[TERMS, j] -= row_scale * c[j]
                if touches:
                    block[TERMS, TERMS] += row_scale * s_p[i]
                    border[row, TERMS] = -row_scale
                if kind[i] != CONTACT and unknowns > TERMS + 1:
                    block[TERMS + 1, TERMS + 1] += 1.0
            if kind[i] == BOUND:
                continue
            r, by_v, gamma = TERMS + int(touches), 0.0, 0.0
            if kind[near] == CONTACT:
                by_v = by_h * h_p[near]
                block[r, TERMS + 1] += by_r
            elif kind[near] == VOID:
                by_v, gamma = by_r + by_h * h_p[near], by_h * h_s[near]
            else:
                by_v, gamma = by_r * r_p[near] + by_h * h_p[near], by_r * r_s[near] + by_h * h_s[near]
            block[r, TERMS] += by_v
            for j in range(TERMS):
                block[r, j] += gamma * c[j]
            by_pressure[row, k], by_separation[row, k] = by_v, gamma
            border[row, r] += gamma
        pointers[row + 1] = count
    return count
