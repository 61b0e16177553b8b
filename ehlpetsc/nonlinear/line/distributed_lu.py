r"""LU of the band of :mod:`.banded_jacobian` on one or several ranks, and of what borders the band.

The first rank eliminates its groups from the left end of the mesh towards the cut, the last one from the
right end (twisted factorisation, :mod:`.block_lu`): what is left at the cut couples the outer groups alone,

.. math:: x_i=y_i-W_ix_{i+1}.

Ranks between have two cuts; they solve for the columns :math:`G=A^{-1}C` of what their outer groups take of
others (Polizzi & Sameh 2006: SPIKE), :math:`x=y-Gw`. The unknowns w at the cuts obey :mod:`.block_lu`.

Three dense rows d border the band: the whole deflection of both end nodes, and the load. They enter by two
columns :math:`z=A^{-1}e`, e the rows of the end nodes, and a system of three unknowns: what the band lacks of
both rows, and the border's. The products :math:`d\cdot x=U^{-T}d\cdot y` need no substitution before, so that
ranks exchange them with the values at the cuts: once a solve.
"""

from __future__ import annotations

import numpy as np
from mpi4py import MPI

from ehlpetsc.base.compiled import ZERO, compiled, unsigned
from ehlpetsc.nonlinear.line.banded_jacobian import BandedJacobian
from ehlpetsc.nonlinear.line.block_lu import (
    AT_LEFT,
    AT_RIGHT,
    BORDER,
    CUT,
    FAST,
    LEFT,
    SIZE,
    STRIDE,
    BlockLU,
    ReducedSystem,
    backward,
    backward_transposed,
    forward,
)
from ehlpetsc.nonlinear.line.exchange import collective, exchange
from ehlpetsc.nonlinear.line.node_pairs import BandEntries, same_deflection
from ehlpetsc.nonlinear.ranks import all_ranks

CLOSE = 0.1  # of a Reynolds row's largest entry: smaller changes cost a fraction of a Krylov iteration


class DistributedLU:
    """Factors and solves.

    `band`: of the nodes of this rank.
    `approach_coefficient`: of the border's unknown in the deflection rows of the end nodes.

    `factors`: from the first factorisation on, for compiled solves:

        * place: :func:`.exchange.collective`, the rank, whether it is the first or the last of several;
        * factors of a `BlockLU`;
        * cuts: numbers of the unknowns at the cuts that other ranks take; dense rows (BORDER, size); columns
          G, or of an outer rank W, shape (unknowns taken of others, width), under the last `width` unknowns;
          :meth:`.block_lu.ReducedSystem.rows_of_inverse`;
        * border: numbers of the unknowns of the local nodes; columns z, shape (2, size); inverse of the
          system of three unknowns, (BORDER, BORDER);
        * room: shape (size,); messages (ranks, CUT + BORDER); `units`.
    `units`: unknowns of the solution by each of both of the band, at each node, shape (2, nodes, 2).
    """

    def __init__(self, band: BandedJacobian, approach_coefficient: float, ranks: MPI.Comm):
        self.band, self.ranks = band, ranks
        self._approach_coefficient = approach_coefficient
        self._lu = BlockLU(band.groups)
        is_inner = 0 < ranks.rank < ranks.size - 1
        self._is_outer = ranks.size > 1 and not is_inner
        first, last = band.end_groups
        interface = np.concatenate([first[AT_LEFT], last[AT_RIGHT]]) if is_inner else last[AT_RIGHT]
        self._in_mesh_order = slice(None, None, -1 if band.is_mirrored else 1)  # the last rank counts back
        interface = interface[self._in_mesh_order] if ranks.size > 1 else interface[:0]
        self._interface = np.ascontiguousarray(interface)
        self._reduced = ReducedSystem(LEFT, CUT - LEFT, ranks.rank, ranks.size)
        self._messages = np.zeros((ranks.size, CUT + 2, CUT + BORDER))
        self._place = collective(ranks), ranks.rank, self._is_outer
        self._ends = np.zeros((2, band.size))
        is_end = np.array([ranks.rank == 0, ranks.rank == ranks.size - 1])
        self._end_dofs = np.where(is_end, band.dofs[[0, -2]], -1)
        self.units = np.empty((2, len(band.nodes), 2))
        self._room = np.zeros(band.size), np.zeros((ranks.size, CUT + BORDER)), self.units
        self._inactive_nodes = None

    def factor(self, entries: BandEntries, inactive_nodes: np.ndarray, anew: bool = True) -> None:
        """Factor for one state; unless `anew`, not where the last factors are nearly its own; collective.

        Other arguments as of :meth:`.banded_jacobian.BandedJacobian.fill`.
        """
        if not anew and all_ranks(self.ranks, self._is_still_good(entries, inactive_nodes)):
            return
        self._inactive_nodes = inactive_nodes
        columns = self.band.fill(entries, inactive_nodes)
        self._lu.factor(columns)
        dense = self.band.dense
        if self._is_outer:
            dense = dense.copy()
            backward_transposed(self._lu.factors[2], dense)
        g = self._columns_at_cuts(columns[0, :LEFT], columns[-1, LEFT + SIZE :])
        place, lu, begun = self._place, self._lu.factors, (self._interface, dense, g)
        begin_coupling(place, lu, begun, self._ends, self._end_dofs, self._messages)
        cuts = *begun, self._reduced.rows_of_inverse(self._messages)
        inverse = finish_coupling(place, lu, cuts, self._ends, self._messages, self._approach_coefficient)
        self.factors = place, lu, cuts, (self.band.dofs, self._ends, inverse), self._room

    def _columns_at_cuts(self, left: int, right: int) -> tuple:
        """G of an inner rank, W of the group at the cut of an outer one."""
        if self.ranks.size == 1:
            return np.zeros((0, STRIDE))
        if self._is_outer:
            return np.ascontiguousarray(self._lu.upper[-1][self._in_mesh_order])
        g = np.zeros((CUT, self.band.groups, STRIDE))
        g[:LEFT, 0], g[LEFT:, -1] = left, right
        g = g.reshape(CUT, -1)
        for k, column in enumerate(g):
            self._lu.solve(column, 0 if k < LEFT else self.band.groups - 1)
        return g

    def _is_still_good(self, entries: BandEntries, inactive_nodes: np.ndarray) -> bool:
        """Whether the factors of this rank are nearly those of the given state."""
        is_same_system = np.array_equal(inactive_nodes, self._inactive_nodes)
        return is_same_system and are_close(tuple(entries), tuple(self.band.entries), CLOSE)


@compiled
def are_close(entries: np.ndarray, before: np.ndarray, tolerance: float) -> bool:
    """Whether entries of the deflection rows are the same and those of Reynolds rows nearly so.

    `entries`, `before`: fields of a `node_pairs.BandEntries`.
    `tolerance`: of each entry, as a fraction of the largest one of its row.
    """
    rows, old_rows = entries[3], before[3]
    if not same_deflection(entries[:3], before[:3]):
        return False
    for i in range(unsigned(len(rows))):
        largest = change = 0.0
        for k in range(unsigned(rows.shape[1])):
            largest = max(largest, abs(old_rows[i, k]))
            change = max(change, abs(rows[i, k] - old_rows[i, k]))
        if not change <= tolerance * largest:
            return False
    return True


@compiled
def begin(is_outer: bool, lu: tuple, sent: tuple, y: np.ndarray, first: int, message: np.ndarray) -> None:
    """Begin to solve in place for y, zero before group `first`, and fill in the message to the others.

    `sent` are the first two of `cuts` of `DistributedLU.factors`.
    """
    forward(lu, y, first)
    if not is_outer:
        backward(lu, y)
    interface, dense = sent
    message[CUT:] = np.dot(dense, y)
    for i in range(len(interface)):
        message[i] = y[interface[i]]


@compiled
def finish(is_outer: bool, lu: tuple, cuts: tuple, y: np.ndarray, everyone: np.ndarray) -> np.ndarray:
    """Finish with the messages of all ranks.

    Returns products of the dense rows with the solution, shape (BORDER,).
    """
    _, _, g, rows = cuts
    taken, width = g.shape
    w = np.dot(rows, everyone.ravel())
    if taken > 0:
        y[-width:] -= np.dot(w[:taken], g)
    if is_outer:
        backward(lu, y)
    return w[taken:]


@compiled
def begin_coupling(
    place: tuple, lu: tuple, cuts: tuple, ends: np.ndarray, end_dofs: np.ndarray, messages: np.ndarray
) -> None:
    """Begin to solve for the columns z and exchange the coefficients of the reduced system; collective.

    Parameters
    ----------
    place, lu, cuts, ends
        As of `DistributedLU.factors`, without the rows of the inverse, and the columns z.
    end_dofs : shape (2,)
        Numbers of the unknowns at the end nodes of the mesh; -1: on another rank.
    messages : shape (ranks, CUT + 2, CUT + BORDER)
    """
    (collective, rank, is_outer), (_, size) = place, ends.shape
    mine, (interface, dense, g) = messages[rank], cuts
    taken, width = g.shape
    for k in range(taken):
        for i in range(len(interface)):
            mine[k, i] = g[k, interface[i] - size + width]
        for row in range(len(dense)):
            mine[k, CUT + row] = 0.0
            for i in range(width):
                mine[k, CUT + row] += dense[row, size - width + i] * g[k, i]
    ends[:] = 0.0
    for k in range(2):
        first = size // STRIDE
        if end_dofs[k] >= 0:
            ends[k, end_dofs[k]], first = 1.0, end_dofs[k] // STRIDE
        begin(is_outer, lu, cuts[:2], ends[k], first, mine[CUT + k])
    exchange(collective, messages)


@compiled
def finish_coupling(
    place: tuple, lu: tuple, cuts: tuple, ends: np.ndarray, messages: np.ndarray, coefficient: float
) -> np.ndarray:
    """Finish the columns z; inverse of the system of three unknowns, shape (BORDER, BORDER).

    `place`, `lu`, `cuts`, `ends`, `messages`: as of :func:`begin_coupling`, with the rows of the inverse.
    `coefficient`: of the border's unknown in the deflection rows of the end nodes.
    """
    inverse = np.empty((BORDER, BORDER))
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
    return inverse


@compiled
def solve(factors: tuple, b: np.ndarray, solution: np.ndarray) -> None:
    """Fill in the solution of the local (q, h, q, h, ...), and of the border on the last rank; collective.

    `factors`: of a `DistributedLU`.
    `b`: right-hand side, zero in the rows that are not in the system.
    """
    (collective, rank, is_outer), lu, cuts, (dofs, ends, inverse), (y, everyone, units) = factors
    y[:] = 0.0
    for i in range(len(dofs)):
        y[dofs[i]] = b[i]
    begin(is_outer, lu, cuts[:2], y, ZERO, everyone[rank])
    if len(b) > len(dofs):
        everyone[rank, -1] -= b[-1]
    exchange(collective, everyone)
    sums = finish(is_outer, lu, cuts, y, everyone)
    combine(y, ends, np.dot(inverse, sums), dofs, units, solution)


@compiled(fastmath=FAST)
def combine(
    y: np.ndarray,
    ends: np.ndarray,
    border: np.ndarray,
    dofs: np.ndarray,
    units: np.ndarray,
    solution: np.ndarray,
) -> None:
    """Fill in the solution from those of the band and of the border."""
    for i in range(units.shape[1]):
        k, m = dofs[2 * i], dofs[2 * i + 1]
        first = y[k] - border[0] * ends[0, k] - border[1] * ends[1, k]
        second = y[m] - border[0] * ends[0, m] - border[1] * ends[1, m]
        solution[2 * i] = units[0, i, 0] * first + units[1, i, 0] * second
        solution[2 * i + 1] = units[0, i, 1] * first + units[1, i, 1] * second
    if len(solution) > len(dofs):
        solution[-1] = border[2]
