r"""LU of the band of :mod:`.banded_jacobian` on one or several ranks, and of what borders the band.

The first rank eliminates its groups from the left end of the mesh towards the cut, the last one from the
right end (twisted factorisation, :mod:`.block_lu`): what is left at the cut couples the outer groups alone,

.. math:: x_i=y_i-W_ix_{i+1}.

Ranks between have two cuts; they solve for the columns :math:`G=A^{-1}C` of what their outer groups take of
others (Polizzi & Sameh 2006: SPIKE), :math:`x=y-Gw`. The unknowns w at the cuts obey :mod:`.reduced_system`.

Three dense rows d border the band: the whole deflection of both end nodes, and the load. They enter by two
columns :math:`z=A^{-1}e`, e the rows of the end nodes, and a system of three unknowns: what the band lacks of
both rows, and h00. The products :math:`d\cdot x=U^{-T}d\cdot y` need no substitution before, so that ranks
exchange them with the values at the cuts: once a solve.
"""

import numpy as np
from scipy.linalg.lapack import dgetrf, dgetrs

from ehlpetsc.compiled import compiled, unsigned
from ehlpetsc.discretisation.finite_volumes import STENCIL
from ehlpetsc.nonlinear.collectives import all_ranks, collective, exchange
from ehlpetsc.nonlinear.preconditioner.block_lu import (
    AT_LEFT,
    AT_RIGHT,
    CUT,
    LEFT,
    LINE,
    SIZE,
    BlockLU,
)
from ehlpetsc.nonlinear.preconditioner.distributed_solve import RankFactors, begin, finish, solve
from ehlpetsc.nonlinear.preconditioner.reduced_system import BORDER, ReducedSystem, regularise_pivots

CLOSE = 0.1  # of a Reynolds row's largest entry: smaller changes cost a fraction of a Krylov iteration
IDENTITY = np.eye(BORDER)
ENTRIES = 2 * STENCIL  # of a Reynolds row


class DistributedLU:
    """Factors and solves.

    Parameters
    ----------
    band : banded_jacobian.BandedJacobian
        Of the nodes of this rank.
    approach_coefficient : float
        Of h00 in the deflection rows of the end nodes.
    ranks : mpi4py communicator

    Attributes
    ----------
    factors : distributed_solve.RankFactors
        There from the first factorisation on.
    """

    def __init__(self, band, approach_coefficient, ranks):
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
        self._rows = self._reduced.rows_of_inverse([])
        self._place = collective(ranks), ranks.rank, self._is_outer
        self._ends, self._room = (
            np.zeros((2, band.size)),
            (np.zeros(band.size), np.zeros((ranks.size, CUT + BORDER))),
        )
        self._factored = None

    def factor(self, entries, inactive_nodes, anew=True):
        """Factor for one state; unless `anew`, not where the last factors are nearly its own; collective.

        Other arguments as of :meth:`.banded_jacobian.BandedJacobian.fill`.
        """
        if not anew and all_ranks(self.ranks, self._is_still_good(entries, inactive_nodes)):
            return
        self._factored = inactive_nodes, entries.reynolds_derivatives
        columns = self.band.fill(entries, inactive_nodes)
        self._lu.factor(columns)
        dense = self.band.dense
        if self._is_outer:
            dense = dense.copy()
            self._lu.backward_transposed(dense)
        g = self._columns_at_cuts(columns[0, :LEFT], columns[-1, LEFT + SIZE :])
        self._ends[:] = 0.0
        self._couple(dense, g)
        cuts, border = (
            (self._interface, g, dense, self._rows),
            (self.band.dofs, self._ends, self._border_inverse),
        )
        self.factors = RankFactors(self._place, self._lu.factors, cuts, border, self._room)

    def _columns_at_cuts(self, left, right):
        """G of an inner rank, W of the group at the cut of an outer one."""
        if self.ranks.size == 1:
            return np.zeros((0, LINE))
        if self._is_outer:
            return np.ascontiguousarray(self._lu.upper[-1][self._in_mesh_order])
        g = np.zeros((CUT, self.band.groups, LINE))
        g[:LEFT, 0], g[LEFT:, -1] = left, right
        g = g.reshape(CUT, -1)
        for k, column in enumerate(g):
            self._lu.solve(column, 0 if k < LEFT else self.band.groups - 1)
        return g

    def _couple(self, dense, g):
        """Reduced system and border, with one message."""
        band, c, mine, (taken, width) = (
            self.band,
            self._approach_coefficient,
            self._messages[self.ranks.rank],
            g.shape,
        )
        parts = self._is_outer, self._lu.factors
        if taken:
            mine[:taken, :taken] = g[:, self._interface - band.size + width]
            mine[:taken, CUT:] = g @ dense[:, -width:].T
        for k, (rank, dof) in enumerate(((0, band.dofs[0]), (self.ranks.size - 1, band.dofs[-2]))):
            first = band.groups
            if self.ranks.rank == rank:
                self._ends[k, dof], first = 1.0, dof // LINE
            begin(*parts, (self._interface, g, dense, self._rows), self._ends[k], first, mine[CUT + k])
        exchange(self._place[0], self._messages)
        self._rows = self._reduced.rows_of_inverse(self._messages)
        matrix, cuts = (
            np.array([[1.0, 0.0, -c], [0.0, 1.0, -c], [0.0, 0.0, 0.0]]),
            (self._interface, g, dense, self._rows),
        )
        for k in range(2):
            everyone = np.ascontiguousarray(self._messages[:, CUT + k])
            matrix[:, k] += finish(*parts, cuts, self._ends[k], everyone)
        lu, pivots, singular = dgetrf(matrix)
        if singular:
            regularise_pivots(np.einsum("ii->i", lu))
        self._border_inverse = np.ascontiguousarray(dgetrs(lu, pivots, IDENTITY)[0])

    def _is_still_good(self, entries, inactive_nodes):
        """Whether the factors of this rank are nearly those of the given state."""
        before, rows = self._factored
        return (
            np.array_equal(inactive_nodes, before)
            and entries.same_deflection(self.band.entries)
            and is_close(entries.reynolds_derivatives, rows, CLOSE)
        )

    def solve(self, b, units, solution):
        """:func:`solve` with the last factors."""
        solve(*self.factors, b, units, solution)


@compiled
def is_close(derivatives, before, tolerance):
    """Whether no entry is off by more than a fraction of the largest one of its row."""
    for i in range(unsigned(len(before))):
        largest = change = 0.0
        for k in range(unsigned(ENTRIES)):
            largest = max(largest, abs(before[i, k]))
            change = max(change, abs(derivatives[i, k] - before[i, k]))
        if not change <= tolerance * largest:
            return False
    return True
