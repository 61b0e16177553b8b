"""Solves with the factors of :mod:`.distributed_lu`, compiled, with one message."""

from typing import NamedTuple

import numpy as np

from ehlpetsc.compiled import compiled
from ehlpetsc.nonlinear.collectives import exchange
from ehlpetsc.nonlinear.preconditioner.block_lu import CUT, FAST, backward, forward


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
def begin(is_outer, lu, cuts, y, first, message):
    """Begin to solve in place for y, zero before group `first`, and fill in the message to the others."""
    interface, _, dense, _ = cuts
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
    begin(is_outer, lu, cuts, y, 0, everyone[rank])
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
        one = y[k] - border[0] * ends[0, k] - border[1] * ends[1, k]
        two = y[m] - border[0] * ends[0, m] - border[1] * ends[1, m]
        solution[2 * i] = units[0, i, 0] * one + units[1, i, 0] * two
        solution[2 * i + 1] = units[0, i, 1] * one + units[1, i, 1] * two
    if len(solution) > len(dofs):
        solution[-1] = border[2]
