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

from ehlpetsc.compiled import compiled, unsigned
from ehlpetsc.discretisation.contact.band import same_deflection
from ehlpetsc.discretisation.finite_volumes import STENCIL
from ehlpetsc.nonlinear.collectives import all_ranks, collective
from ehlpetsc.nonlinear.preconditioner.block_lu import (
    AT_LEFT,
    AT_RIGHT,
    CUT,
    LEFT,
    LINE,
    SIZE,
    BlockLU,
    backward_transposed,
)
from ehlpetsc.nonlinear.preconditioner.distributed_solve import RankFactors, begin_coupling, finish_coupling
from ehlpetsc.nonlinear.preconditioner.reduced_system import BORDER, ReducedSystem

CLOSE = 0.1  # of a Reynolds row's largest entry: smaller changes cost a fraction of a Krylov iteration
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
        self._place = collective(ranks), ranks.rank, self._is_outer
        self._ends, self._border_inverse = np.zeros((2, band.size)), np.zeros((BORDER, BORDER))
        is_end = np.array([ranks.rank == 0, ranks.rank == ranks.size - 1])
        self._end_dofs = np.where(is_end, band.dofs[[0, -2]], -1)
        self._room = np.zeros(band.size), np.zeros((ranks.size, CUT + BORDER))
        self._inactive_nodes = None

    def factor(self, entries, inactive_nodes, anew=True):
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
        cuts, coupled = (self._interface, g, dense), (self._place, self._lu.factors)
        begin_coupling(*coupled, *cuts, self._ends, self._end_dofs, self._messages)
        cuts = (*cuts, self._reduced.rows_of_inverse(self._messages))
        coefficient, inverse = self._approach_coefficient, self._border_inverse
        finish_coupling(*coupled, cuts, self._ends, self._messages, coefficient, inverse)
        self.factors = RankFactors(*coupled, cuts, (self.band.dofs, self._ends, inverse), self._room)

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

    def _is_still_good(self, entries, inactive_nodes):
        """Whether the factors of this rank are nearly those of the given state."""
        is_same_system = np.array_equal(inactive_nodes, self._inactive_nodes)
        return is_same_system and are_close(tuple(entries), tuple(self.band.entries), CLOSE)


@compiled
def are_close(entries, before, tolerance):
    """Whether entries of the deflection rows are the same and those of Reynolds rows nearly so.

    Parameters
    ----------
    entries, before : tuple of ndarray
        Fields of a `contact.band.BandEntries`.
    tolerance : float
        Of each entry, as a fraction of the largest one of its row.
    """
    rows, old_rows = entries[3], before[3]
    if not same_deflection(*entries[:3], *before[:3]):
        return False
    for i in range(unsigned(len(rows))):
        largest = change = 0.0
        for k in range(unsigned(ENTRIES)):
            largest = max(largest, abs(old_rows[i, k]))
            change = max(change, abs(rows[i, k] - old_rows[i, k]))
        if not change <= tolerance * largest:
            return False
    return True
