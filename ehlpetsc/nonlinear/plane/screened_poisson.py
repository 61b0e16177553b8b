r"""Sparse form of a contact in the plane, of which a preconditioner has factors (compiled).

The deflection, :math:`2\pi C/|k|` over the wave numbers k, is a full matrix; the screened Poisson term

.. math:: \frac{2\pi C}{|k|}\approx\frac c{k^2+s^2},\qquad D\,p\approx cu,\quad(-\nabla^2+s^2)\,u=p

is a sparse one, of another unknown a node with a five-point stencil, zero beyond the mesh. Longer waves than
1/s are those of the coarse correction, beside which a second term saves no iteration.

Unknowns of a node: u and v, the pressure; in a cavity, and where solids touch, v is the unknown of the
Reynolds equation. The pressure of asperities in a cavity, :math:`p=p_s\,\delta s`, and that of solids that
touch, whose row of the deflection sets u, follow from u.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ehlpetsc.base.compiled import compiled, unsigned
from ehlpetsc.discretisation.finite_volumes import STENCIL
from ehlpetsc.elasticity.kernel import Kernel
from ehlpetsc.nonlinear.plane.reduction import BOUND, CONTACT, PRESSURE, STIFF, VOID

SCREENED, SHORTEST_COARSE = 0.2, 0.15  # s and the smallest fitted k, in the largest wave number of the mesh
UNKNOWNS, V = 2, 1  # of a node; place of v among them, behind u
ONE = unsigned(1)
MIDDLE = 2  # index of i in the nodes of a Reynolds row, i-2 .. i+1, below, above


def fitted_term(stiffness: float, spacings: Sequence[float], kernel: Kernel) -> tuple[float, float]:
    r"""Coefficient c and square of s; relative errors of the deflection by waves count the same.

    `stiffness`: C of the deflection, :math:`2\pi C/|k|` times the softening of the kernel.
    """
    dy, dx = spacings
    largest = np.pi / min(dx, dy)
    s_2 = (SCREENED * largest) ** 2
    k_2 = np.geomspace((SHORTEST_COARSE * largest) ** 2, 4.0 / dx**2 + 4.0 / dy**2, 200)  # of the stencil
    ratio = np.sqrt(k_2) / (k_2 + s_2) / (2.0 * np.pi * stiffness) / kernel.softening(np.sqrt(k_2))
    return float(ratio.sum() / (ratio @ ratio)), float(s_2)


@compiled
def fill_right_side(
    kind: np.ndarray, p_s: np.ndarray, scales: tuple, rows: tuple[np.ndarray, np.ndarray], b: np.ndarray
) -> None:
    """Fill in the right-hand side, shape (nodes, 2).

    `scales`: dx dy; of the deflection rows. `rows`: Reynolds rows, separation besides the deflection.
    """
    (cell, row_scale), (reynolds, separation) = scales, rows
    for i in range(len(kind)):
        of_deflection = row_scale * separation[i]
        b[i, 0] = of_deflection if kind[i] == CONTACT else cell * p_s[i] * separation[i]
        b[i, V] = of_deflection if kind[i] == BOUND else reynolds[i]


@compiled
def taken(
    kind: np.ndarray,
    p_s: np.ndarray,
    term: tuple,
    spacings: tuple,
    separation: np.ndarray,
    u: np.ndarray,
    own: tuple,
) -> tuple[np.ndarray, np.ndarray]:
    """Pressures and Reynolds unknowns of a solution of the right-hand side by :func:`fill_right_side`.

    `term`: c, square of s. `spacings`: dy, dx.
    `u`: solution at the nodes of the rank and in rows beyond. `own`: nodes in a row; first node of the rank.
    """
    (c, s_2), (dy, dx), (n_x, first) = term, spacings, own
    pressure, r, mesh = np.empty(len(kind)), np.empty(len(kind)), (n_x, len(u), False)
    for i in range(len(kind)):
        node = first + i
        pressure[i] = r[i] = u[node, V]
        if kind[i] == VOID or kind[i] == STIFF:
            pressure[i] = p_s[i] * (separation[i] + c * u[node, 0])
        elif kind[i] == CONTACT:
            pressure[i] = 0.0
            for k in range(1, STENCIL):
                near = neighbour(node, k, mesh)
                if near >= 0:
                    pressure[i] += poisson(k, dy, dx, s_2) * u[near, 0] / (dx * dy)
    return pressure, r


@compiled
def poisson(k: int, dy: float, dx: float, s_2: float) -> float:
    """Coefficient of node k of the stencil in the screened Poisson equation, times dx dy."""
    if k == MIDDLE:
        return 2.0 * dy / dx + 2.0 * dx / dy + s_2 * dx * dy
    return 0.0 if k == 0 else -dx / dy if k > MIDDLE + 1 else -dy / dx


@compiled
def neighbour(i: int, k: int, mesh: tuple) -> int:
    """Node k of the stencil of node i; -1: beyond the mesh. `mesh`: n_x, nodes, whether periodic."""
    n_x, n, periodic = mesh
    if k < MIDDLE + 2:
        x = i % n_x + k - MIDDLE
        return i + k - MIDDLE if 0 <= x < n_x else -1
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
    n_x: int,
    rows: tuple,
    blocks: np.ndarray,
    by: np.ndarray,
) -> None:
    """Fill in the blocks of consecutive rows.

    `reduction`: kind, r_v, r_s, h_v, h_s, p_s of the nodes.
    `derivatives`: of the Reynolds rows of the nodes, (nodes, 12).
    `term`: c, square of s.
    `scales`: of the deflection rows; dy; dx.
    `n_x`: nodes in a row.
    `rows`: first and last node of the rows; pointers to their blocks; places of the stencil among them.
    `blocks`: of these rows, each by columns as PETSc stores it.
    `by`: derivatives of these Reynolds rows by v and separation at the nodes of their stencil, (rows, 12).
    """
    (kind, r_v, r_s, h_v, h_s, p_s), (c, s_2), (row_scale, dy, dx) = reduction, term, scales
    begin, end, pointers, places = rows
    along, across = dy / dx, dx / dy
    laplacian = 0.0, -along, 2.0 * (along + across) + s_2 * dx * dy, -along, -across, -across
    offsets = -2, -1, 0, 1, -n_x, n_x
    for row in range(unsigned(end - begin)):
        i, first = row + unsigned(begin), unsigned(pointers[row])
        has_poisson, has_reynolds = 0.0 if kind[i] == CONTACT else 1.0, 0.0 if kind[i] == BOUND else 1.0
        for b in range(first, unsigned(pointers[row + ONE])):
            blocks[b, 0, 0] = blocks[b, 0, V] = blocks[b, V, 0] = blocks[b, V, V] = 0.0
        for k in range(STENCIL):
            by_v = gamma = 0.0
            if places[row, k] >= 0:
                b, near = first + unsigned(places[row, k]), i + unsigned(offsets[k])
                by_r, by_h = derivatives[i, 2 * k], derivatives[i, 2 * k + 1]
                by_v = has_reynolds * (by_r * r_v[near] + by_h * h_v[near])
                gamma = has_reynolds * (by_r * r_s[near] + by_h * h_s[near])
                blocks[b, V, V] += by_v
                blocks[b, 0, V] += gamma * c
                blocks[b, 0, 0] += has_poisson * laplacian[k]
            by[row, 2 * k], by[row, 2 * k + 1] = by_v, gamma
        b = first + unsigned(places[row, MIDDLE])
        if kind[i] == PRESSURE:
            blocks[b, V, 0] -= dx * dy
        elif kind[i] == CONTACT:  # its row of the deflection is that of u
            blocks[b, 0, 0] -= row_scale * c
        elif kind[i] == BOUND:  # and here that of v
            blocks[b, V, 0] -= dx * dy
            blocks[b, 0, V] -= row_scale * c
        else:
            blocks[b, 0, 0] -= p_s[i] * c * dx * dy
