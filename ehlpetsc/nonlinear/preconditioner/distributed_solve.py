"""Coupling of the ranks' factors of :mod:`.distributed_lu` and solves with them, with one collective each."""

from typing import NamedTuple

import numpy as np

from ehlpetsc.compiled import compiled
from ehlpetsc.nonlinear.collectives import exchange
from ehlpetsc.nonlinear.preconditioner.block_lu import CUT, FAST, LINE, backward, forward


class RankFactors(NamedTuple):
    """Factors on one rank, as compiled solves take them.

    Attributes
    ----------
    place : tuple
        :func:`.collectives.collective`, the rank, and whether it is the first or the last one of several.
    lu : tuple
        Factors of a `BlockLU`.
    cuts : tuple of ndarray
        Numbers of the unknowns at the cuts that other ranks take; columns G, or of an outer rank W, shape
        (unknowns taken of others, width), under the last `width` unknowns; dense rows (BORDER, size);
        :meth:`.reduced_system.ReducedSystem.rows_of_inverse`.
    border : tuple of ndarray
        Numbers of the unknowns of the local nodes; columns z, shape (2, size); inverse of the system of three
        unknowns, (BORDER, BORDER).
    room : tuple of ndarray
        Shape (size,), and messages (ranks, CUT + BORDER).
    """

    place: tuple
    lu: tuple
    cuts: tuple
    border: tuple
    room: tuple


@compiled
def begin(is_outer, lu, interface, dense, y, first, message):
    """Begin to solve in place for y, zero before group `first`, and fill in the message to the others."""
    forward(lu, y, first)
    if not is_outer:
        backward(lu, y)
    message[CUT:] = np.dot(dense, y)
    for i in range(len(interface)):
        message[i] = y[interface[i]]


@compiled
def finish(is_outer, lu, cuts, y, everyone):
    """Finish with the messages of all ranks.

    Returns
    -------
    ndarray, shape (BORDER,)
        Products of the dense rows with the solution.
    """
    _, g, _, rows = cuts
    taken, width = g.shape
    w = np.dot(rows, everyone.ravel())
    if taken > 0:
        y[-width:] -= np.dot(w[:taken], g)
    if is_outer:
        backward(lu, y)
    return w[taken:]


@compiled
def begin_coupling(place, lu, interface, g, dense, ends, end_dofs, messages):
    """Begin to solve for the columns z and exchange the coefficients of the reduced system; collective.

    Parameters
    ----------
    place, lu, interface, g, dense, ends
        As of `RankFactors`, with the first `cuts` one by one, and the columns z.
    end_dofs : ndarray, shape (2,)
        Numbers of the unknowns at the end nodes of the mesh; -1: on another rank.
    messages : ndarray, shape (ranks, CUT + 2, CUT + BORDER)
    """
    (collective, rank, is_outer), (taken, width), (_, size) = place, g.shape, ends.shape
    mine = messages[rank]
    for k in range(taken):
        for i in range(len(interface)):
            mine[k, i] = g[k, interface[i] - size + width]
        for row in range(len(dense)):
            mine[k, CUT + row] = 0.0
            for i in range(width):
                mine[k, CUT + row] += dense[row, size - width + i] * g[k, i]
    ends[:] = 0.0
    for k in range(2):
        first = size // LINE
        if end_dofs[k] >= 0:
            ends[k, end_dofs[k]], first = 1.0, end_dofs[k] // LINE
        begin(is_outer, lu, interface, dense, ends[k], first, mine[CUT + k])
    exchange(collective, messages)


@compiled
def finish_coupling(place, lu, cuts, ends, messages, coefficient, inverse):
    """Finish the columns z, and fill in the inverse of the system of three unknowns.

    Parameters
    ----------
    place, lu, cuts, ends, messages
        As of :func:`begin_coupling`.
    coefficient : float
        Of h00 in the deflection rows of the end nodes.
    inverse : ndarray, shape (BORDER, BORDER)
    """
    matrix = np.array([[1.0, 0.0, -coefficient], [0.0, 1.0, -coefficient], [0.0, 0.0, 0.0]])
    for k in range(2):
        matrix[:, k] += finish(place[2], lu, cuts, ends[k], messages[:, CUT + k].copy())
    for i in range(3):
        for j in range(3):
            a, b, c, d = (i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3
            inverse[j, i] = matrix[a, c] * matrix[b, d] - matrix[a, d] * matrix[b, c]
    determinant = np.dot(matrix[0], inverse[:, 0].copy())
    if determinant != 0.0:  # a preconditioner may be off where the operator is singular, but not infinite
        inverse /= determinant


@compiled
def solve(place, lu, cuts, border, room, b, units, solution):
    """Fill in the solution of the local (q, h, q, h, ...), and h00 on the last rank; collective.

    Parameters
    ----------
    place, lu, cuts, border, room : tuple
        Of `RankFactors`.
    b : ndarray
        Right-hand side, zero in the rows that are not in the system.
    units : ndarray, shape (2, nodes, 2)
        Unknowns of the solution by each of both of the band, at each node.
    solution : ndarray
    """
    (collective, rank, is_outer), (dofs, ends, inverse), (y, everyone) = place, border, room
    y[:] = 0.0
    for i in range(len(dofs)):
        y[dofs[i]] = b[i]
    begin(is_outer, lu, cuts[0], cuts[2], y, 0, everyone[rank])
    if len(b) > len(dofs):
        everyone[rank, -1] -= b[-1]
    exchange(collective, everyone)
    sums = finish(is_outer, lu, cuts, y, everyone)
    combine(y, ends, np.dot(inverse, sums), dofs, units, solution)


@compiled(fastmath=FAST)
def combine(y, ends, border, dofs, units, solution):
    """Fill in the solution from those of the band and of the border."""
    for i in range(units.shape[1]):
        k, m = dofs[2 * i], dofs[2 * i + 1]
        first = y[k] - border[0] * ends[0, k] - border[1] * ends[1, k]
        second = y[m] - border[0] * ends[0, m] - border[1] * ends[1, m]
        solution[2 * i] = units[0, i, 0] * first + units[1, i, 0] * second
        solution[2 * i + 1] = units[0, i, 1] * first + units[1, i, 1] * second
    if len(solution) > len(dofs):
        solution[-1] = border[2]
