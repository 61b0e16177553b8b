r"""Sparse form of a contact in the plane for PETSc's preconditioners (compiled).

The deflection, :math:`2\pi C/|k|` over the wave numbers k, is a full matrix; the screened Poisson term

.. math:: \frac{2\pi C}{|k|}\approx\frac c{k^2+s^2},\qquad D\,p\approx cu,\quad(-\nabla^2+s^2)\,u=p

is a sparse one, of another unknown a node with a five-point stencil, zero beyond the mesh. Longer waves than
1/s are those of the coarse correction, beside which a second term saves no iteration.

Unknowns of a node, in this order: u, v, and r where solids touch anywhere. v is the pressure, in
a cavity the unknown of the Reynolds equation; the pressure of asperities in it, :math:`p=p_s\,\delta s`,
follows from u.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ehlpetsc.base.compiled import compiled
from ehlpetsc.nonlinear.plane.reduction import BOUND, CONTACT, STIFF, VOID

SCREENED, SHORTEST_COARSE = 0.2, 0.15  # s and the smallest fitted k, in the largest wave number of the mesh
V, R = 1, 2  # places of v and r among the unknowns of a node, behind u
STENCIL, OWN = 6, 2  # nodes i-2 .. i+1, below, above of a row; index of i


def fitted_term(stiffness: float, spacings: Sequence[float]) -> tuple[float, float]:
    """Coefficient c and square of s for C of the deflection; relative errors of 2 pi C/|k| count the same."""
    dy, dx = spacings
    largest = np.pi / min(dx, dy)
    s_2 = (SCREENED * largest) ** 2
    k_2 = np.geomspace((SHORTEST_COARSE * largest) ** 2, 4.0 / dx**2 + 4.0 / dy**2, 200)  # of the stencil
    ratio = np.sqrt(k_2) / (k_2 + s_2) / (2.0 * np.pi * stiffness)
    return float(ratio.sum() / (ratio @ ratio)), float(s_2)


@compiled
def put(
    kind: np.ndarray, p_s: np.ndarray, scales: tuple, rows: tuple[np.ndarray, np.ndarray], b: np.ndarray
) -> None:
    """Fill in the right-hand side, shape (nodes, unknowns of a node).

    `scales`: dx dy; of the deflection rows. `rows`: Reynolds rows, separation besides the deflection.
    """
    (cell, row_scale), (reynolds, separation) = scales, rows
    for i in range(len(kind)):
        b[i, :] = 0.0
        b[i, 0] = cell * p_s[i] * separation[i]
        b[i, V] = row_scale * separation[i] if kind[i] == CONTACT or kind[i] == BOUND else reynolds[i]
        if kind[i] == CONTACT:
            b[i, R] = reynolds[i]


@compiled
def taken(
    kind: np.ndarray, p_s: np.ndarray, c: float, separation: np.ndarray, u: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Pressures and Reynolds unknowns of a solution of the right-hand side by :func:`put`."""
    pressure, r = np.empty(len(kind)), np.empty(len(kind))
    for i in range(len(kind)):
        is_void = kind[i] == VOID or kind[i] == STIFF
        pressure[i] = p_s[i] * (separation[i] + c * u[i, 0]) if is_void else u[i, V]
        r[i] = u[i, R] if kind[i] == CONTACT else u[i, V]
    return pressure, r


@compiled
def neighbour(i: int, k: int, mesh: tuple) -> int:
    """Node k of the stencil of node i; -1: beyond the mesh. `mesh`: n_x, nodes, whether periodic."""
    n_x, n, periodic = mesh
    if k < OWN + 2:
        x = i % n_x + k - OWN
        return i + k - OWN if 0 <= x < n_x else -1
    near = i + (2 * k - 9) * n_x
    return near % n if periodic or 0 <= near < n else -1


@compiled
def pattern(
    mesh: tuple, first: int, last: int, pointers: np.ndarray, columns: np.ndarray, places: np.ndarray
) -> int:
    """Blocks of the rows of the nodes first .. last - 1, in PETSc's order; return their number.

    `pointers`, `columns`: of the blocks, for `STENCIL` in each row.
    `places`: of the stencil's nodes among the blocks of a row, -1: none; shape (last - first, STENCIL).
    """
    count = 0
    for i in range(first, last):
        row, begin = i - first, count
        pointers[row] = begin
        for k in range(STENCIL):
            near, at = neighbour(i, k, mesh), begin
            while at < count and columns[at] < near:
                at += 1
            if near < 0 or at < count and columns[at] == near:  # both across in a period of two rows
                continue
            for behind in range(count, at, -1):
                columns[behind] = columns[behind - 1]
            columns[at], count = near, count + 1
        for k in range(STENCIL):
            near, places[row, k] = neighbour(i, k, mesh), -1
            for at in range(begin, count):
                if columns[at] == near:
                    places[row, k] = at - begin
    pointers[last - first] = count
    return count


@compiled
def fill(
    reduction: tuple,
    derivatives: np.ndarray,
    term: tuple,
    scales: tuple,
    mesh: tuple,
    rows: tuple,
    blocks: np.ndarray,
    by: np.ndarray,
) -> None:
    """Fill in the blocks of some rows.

    `reduction`: kind, r_p, r_s, h_p, h_s, p_s of all nodes.
    `derivatives`: of the local Reynolds rows, (local nodes, 12).
    `term`: c, square of s.
    `scales`: of the deflection rows; dy; dx.
    `mesh`: as of :func:`neighbour`.
    `rows`: first local node; first and last node of the rows; pointers and places of the :func:`pattern`.
    `blocks`: of these rows, each by columns as PETSc stores it; zeros.
    `by`: derivatives of the local Reynolds rows by v and separation at the nodes of their stencil, (local
        nodes, 12).
    """
    (kind, r_p, r_s, h_p, h_s, p_s), (c, s_2), (row_scale, dy, dx) = reduction, term, scales
    first, begin, end, pointers, places = rows
    unknowns = blocks.shape[1]
    for i in range(begin, end):
        row = i - first
        touches = kind[i] == CONTACT or kind[i] == BOUND
        r = V + int(touches)
        for k in range(STENCIL):
            by[row, 2 * k], by[row, 2 * k + 1] = 0.0, 0.0
            if places[row, k] < 0:
                continue
            near = neighbour(i, k, mesh)
            b = pointers[row] - pointers[begin - first] + places[row, k]  # a view of the block takes longer
            poisson = 0.0 if k == 0 else -dx / dy if k >= 4 else -dy / dx
            if k == OWN:
                blocks[b, 0, 0] += 2.0 * dy / dx + 2.0 * dx / dy + (s_2 - p_s[i] * c) * dx * dy
                blocks[b, V, 0] -= 0.0 if kind[i] == VOID or kind[i] == STIFF else dx * dy
                if touches:  # the row of the deflection is that of v
                    blocks[b, 0, V] -= row_scale * c
                if kind[i] != CONTACT and unknowns > R:
                    blocks[b, R, R] += 1.0
            else:
                blocks[b, 0, 0] += poisson
            if kind[i] == BOUND:
                continue
            by_r, by_h, by_v, gamma = derivatives[row, 2 * k], derivatives[row, 2 * k + 1], 0.0, 0.0
            if kind[near] == CONTACT:
                blocks[b, R, r] += by_r
            elif kind[near] == VOID or kind[near] == STIFF:
                by_v, gamma = by_r + by_h * h_p[near], by_h * h_s[near]
            else:
                by_v, gamma = by_r * r_p[near] + by_h * h_p[near], by_r * r_s[near] + by_h * h_s[near]
            blocks[b, V, r] += by_v
            blocks[b, 0, r] += gamma * c
            by[row, 2 * k], by[row, 2 * k + 1] = by_v, gamma
