r"""Sparse matrix of the reduced system of a contact in the plane, for PETSc's preconditioners (compiled).

The deflection is a full matrix. Where the pressure flow through a node is weaker than the change of film by its own
pressure, the unknown of the node is u, which changes the pressures of the node and its four neighbours,

.. math:: p=Wu,\qquad (Wu)_i=u_i-\tfrac14\sum_{j\sim i}u_j .

The deflection by u then decays as the third power of the distance: :math:`DW` is cut beyond two nodes, of which the
outer ones make up for a part of what is cut.
"""

from __future__ import annotations

import numpy as np

from ehlpetsc.base.compiled import compiled
from ehlpetsc.nonlinear.plane.reduction import BOUND, CONTACT, VOID

REACH = 2  # nodes of the deflection on either side
NEIGHBOUR = -0.25  # weight of the neighbours in W
KEPT = 0.2  # part of the sum of the cut deflection that is left
SIZE_X, SIZE_Y, CENTRE_X, CENTRE_Y = 11, 9, 6, 4  # of the patch of columns of a row, its own node in it


def near_deflections(kernel: np.ndarray) -> np.ndarray:
    """Deflection by a pressure and by a distributed one at nearby nodes, shape (2, 5, 5).

    `kernel`: of the deflection at distances 0 .. REACH + 1 nodes, (n_y, n_x).
    """
    distances = np.abs(np.arange(-REACH - 1, REACH + 2))
    whole = kernel[np.ix_(distances, distances)]
    inner = slice(1, -1)
    neighbours = whole[:-2, inner] + whole[2:, inner] + whole[inner, :-2] + whole[inner, 2:]
    near = np.stack([whole[inner, inner], whole[inner, inner] + NEIGHBOUR * neighbours])
    ring = np.ones(near[1].shape, dtype=bool)
    ring[1:-1, 1:-1] = False
    near[1, ring] -= (1.0 - KEPT) * near[1].sum() / ring.sum()
    return near


@compiled
def number_unknowns(
    kind: np.ndarray, first: int, last: int, start: int, p_column: np.ndarray, r_column: np.ndarray
) -> int:
    """Number the unknowns of the nodes first .. last - 1 from `start` on; -1: no such unknown. Return the next."""
    for i in range(first, last):
        p_column[i] = r_column[i] = -1
        if kind[i] != VOID:
            p_column[i] = start
            start += 1
        if kind[i] == VOID or kind[i] == CONTACT:
            r_column[i] = start
            start += 1
    return start


@compiled
def distributed(
    kind: np.ndarray,
    derivatives: np.ndarray,
    h_s: np.ndarray,
    own_deflection: float,
    n_x: int,
    periodic: bool,
    out: np.ndarray,
) -> None:
    """Fill in the mask of the nodes whose pressure is distributed; derivatives of all rows, (n, 12)."""
    n = len(kind)
    for i in range(n):
        out[i] = False
        x = i % n_x
        if kind[i] == VOID or x == 0 or x == n_x - 1 or (not periodic and (i < n_x or i >= n - n_x)):
            continue
        by, lacks = derivatives[i], False
        for neighbour in (i - 1, i + 1, (i - n_x) % n, (i + n_x) % n):
            lacks |= kind[neighbour] == VOID or neighbour % n_x == 0
        flow = abs(by[6]) + abs(by[8]) + abs(by[10])
        transport = abs(by[5]) * own_deflection
        if kind[i] == CONTACT or kind[i] == BOUND:
            flow = 0.0
        out[i] = flow < transport and not lacks


@compiled
def fill(
    reduction: tuple,
    numbers: tuple,
    spread: np.ndarray,
    derivatives: np.ndarray,
    near: np.ndarray,
    row_scale: float,
    mesh: tuple,
    csr: tuple,
    by_separation: np.ndarray,
    border: np.ndarray,
    drop: float,
) -> int:
    """Fill in the rows of the nodes first .. last - 1; return the number of entries.

    `reduction`: kind, r_p, r_s, h_p, h_s, s_p of all nodes.
    `numbers`: columns of p and of r of all nodes.
    `spread`: mask of distributed pressures.
    `derivatives`: of the local Reynolds rows, (last - first, 12).
    `near`: of :func:`near_deflections`.
    `mesh`: n_x, nodes, first, last, periodic.
    `csr`: row pointers, columns, values.
    `by_separation`: of the local Reynolds rows by the separation at the nodes of their stencil, (last - first, 6).
    `border`: of the local rows by h00.
    """
    (kind, r_p, r_s, h_p, h_s, s_p), (p_column, r_column) = reduction, numbers
    (n_x, n, first, last, periodic), (pointers, columns, values) = mesh, csr
    patch, other = np.zeros((SIZE_Y, SIZE_X)), np.zeros((SIZE_Y, SIZE_X))
    count, row = 0, 0
    pointers[0] = 0
    for i in range(first, last):
        for equation in range(2):  # deflection, Reynolds
            if equation == 0 and not (kind[i] == CONTACT or kind[i] == BOUND):
                continue
            if equation == 1 and kind[i] == BOUND:
                continue
            patch[:] = 0.0
            other[:] = 0.0
            edge = 0.0
            if equation == 0:
                add_pressure(patch, CENTRE_Y, CENTRE_X, row_scale * s_p[i], i, kind, spread, n_x, n, periodic)
                add_separation(patch, CENTRE_Y, CENTRE_X, -row_scale, i, kind, spread, near, n_x, n, periodic)
                edge = -row_scale
            else:
                by = derivatives[i - first]
                for k in range(6):
                    dx, dy = (k - 2, 0) if k < 4 else (0, 2 * k - 9)
                    j, at_y, at_x = i + dx + dy * n_x, CENTRE_Y + dy, CENTRE_X + dx
                    by_r, by_h = by[2 * k], by[2 * k + 1]
                    by_separation[i - first, k] = 0.0
                    if by_r == 0.0 and by_h == 0.0:
                        continue
                    j = j % n
                    if kind[j] == VOID or kind[j] == CONTACT:
                        other[at_y, at_x] += by_r + (by_h * h_p[j] if kind[j] == VOID else 0.0)
                    if kind[j] == VOID:
                        alpha, gamma = 0.0, by_h * h_s[j]
                    elif kind[j] == CONTACT:
                        alpha, gamma = by_h * h_p[j], 0.0
                    else:
                        alpha, gamma = by_r * r_p[j] + by_h * h_p[j], by_r * r_s[j] + by_h * h_s[j]
                    by_separation[i - first, k] = gamma
                    edge += gamma
                    if alpha != 0.0:
                        add_pressure(patch, at_y, at_x, alpha, j, kind, spread, n_x, n, periodic)
                    if gamma != 0.0:
                        add_separation(patch, at_y, at_x, gamma, j, kind, spread, near, n_x, n, periodic)
            border[row] = edge
            largest = max(np.abs(patch).max(), np.abs(other).max())
            for y in range(SIZE_Y):
                for x in range(SIZE_X):
                    p, r = patch[y, x], other[y, x]
                    is_own = y == CENTRE_Y and x == CENTRE_X
                    if p == 0.0 and r == 0.0 and not is_own:
                        continue
                    j = (i + (x - CENTRE_X) + (y - CENTRE_Y) * n_x) % n
                    if p_column[j] >= 0 and (abs(p) > drop * largest or is_own):
                        columns[count], values[count] = p_column[j], p
                        count += 1
                    if r_column[j] >= 0 and (abs(r) > drop * largest or is_own):
                        columns[count], values[count] = r_column[j], r
                        count += 1
            row += 1
            pointers[row] = count
    return count


@compiled
def add_pressure(
    patch: np.ndarray,
    y: int,
    x: int,
    factor: float,
    i: int,
    kind: np.ndarray,
    spread: np.ndarray,
    n_x: int,
    n: int,
    periodic: bool,
) -> None:
    """Add `factor` times the pressure of node i, in the unknowns u, to a row."""
    if kind[i] == VOID:
        return
    patch[y, x] += factor
    at = i % n_x
    if at > 0 and spread[i - 1]:
        patch[y, x - 1] += NEIGHBOUR * factor
    if at < n_x - 1 and spread[i + 1]:
        patch[y, x + 1] += NEIGHBOUR * factor
    if (periodic or i >= n_x) and spread[(i - n_x) % n]:
        patch[y - 1, x] += NEIGHBOUR * factor
    if (periodic or i < n - n_x) and spread[(i + n_x) % n]:
        patch[y + 1, x] += NEIGHBOUR * factor


@compiled
def add_separation(
    patch: np.ndarray,
    y: int,
    x: int,
    factor: float,
    i: int,
    kind: np.ndarray,
    spread: np.ndarray,
    near: np.ndarray,
    n_x: int,
    n: int,
    periodic: bool,
) -> None:
    """Add `factor` times the separation of node i by the pressures of nearby nodes to a row."""
    at = i % n_x
    for dy in range(-REACH, REACH + 1):
        j_row = i + dy * n_x
        if not periodic and (j_row < 0 or j_row >= n):
            continue
        for dx in range(-REACH, REACH + 1):
            if at + dx < 0 or at + dx >= n_x:
                continue
            j = (j_row + dx) % n
            if kind[j] != VOID:
                patch[y + dy, x + dx] += factor * near[1 if spread[j] else 0, dy + REACH, dx + REACH]


@compiled
def pressures(u: np.ndarray, p_column: np.ndarray, spread: np.ndarray, n_x: int, p: np.ndarray) -> None:
    """Fill in p = W u of all nodes; u by columns."""
    n = len(p)
    for i in range(n):
        p[i] = u[p_column[i]] if p_column[i] >= 0 else 0.0
    for i in range(n):
        if spread[i]:
            part = NEIGHBOUR * u[p_column[i]]
            p[i - 1] += part
            p[i + 1] += part
            p[(i - n_x) % n] += part
            p[(i + n_x) % n] += part
