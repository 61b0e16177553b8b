r"""LU of the band of :mod:`.banded_jacobian`, split between ranks.

Each rank factors the part A of its own groups with LAPACK. What couples the parts, and what borders the band,
enters through few unknowns w (Polizzi & Sameh 2006: SPIKE),

.. math:: y = A^{-1}b - G\,w,

the solution in the groups beside the cuts, for both ends of the mesh what the band lacks of their deflection,
and h00. The columns of G are solved for with every matrix; w obeys a small system that every rank holds.
"""

import numpy as np
from scipy.linalg.lapack import dgbtrf, dgetrf, dgetrs

from ehlpetsc.nonlinear.exchange import everywhere
from ehlpetsc.nonlinear.preconditioner.substitution import (
    is_close,
    solve_scattered,
    substitute,
    tips,
    without,
)

BORDER = 3  # far deflection of the first and of the last node, h00
CLOSE = 0.1  # of a Reynolds row's largest entry: smaller changes cost a fraction of a Krylov iteration


class SpikeLU:
    """Factors and solves.

    Parameters
    ----------
    band : banded_jacobian.BandedJacobian
        Of this rank's nodes.
    end_scale : float
        What h00 counts in the end nodes' deflection rows, negative.
    ranks : mpi4py communicator
    """

    def __init__(self, band, end_scale, ranks):
        self.band, self.end_scale, self.ranks = band, end_scale, ranks
        size, last = band.size, ranks.size - 1
        self.inner = 2 * size * last  # of w, beside the cuts: groups to the left and to the right of each
        self.of_rank = [self._numbers(rank) for rank in range(ranks.size)]
        self.widest = max(len(unknowns) for unknowns, _, _ in self.of_rank)
        self.y, self.tips = np.zeros((1, band.order)), np.zeros((1, 2 * size + BORDER))

    def _numbers(self, rank):
        """What a rank has to do with w: columns of its G, its outer groups in w, and these in its tips."""
        size, last = self.band.size, self.ranks.size - 1
        left, right = self.band.beside
        before = [self.inner] if rank == 0 else 2 * size * (rank - 1) + left
        after = [self.inner + 1] if rank == last else 2 * size * rank + size + right
        first, others = (size if rank == 0 else 0), (size if rank == last else 2 * size)
        own = 2 * size * (rank - 1) + size + np.arange(first, others)
        return np.concatenate([before, after]).astype(int), own, slice(first, others)

    def factor(self, entries, dropped, anew=True):
        """Factor for one state; unless `anew`, not where the last factors are nearly its own; collective.

        Other arguments as of :meth:`.banded_jacobian.BandedJacobian.fill`.
        """
        if not anew and everywhere(self.ranks, self._still_good(entries, dropped)):
            return
        self.factored = dropped, entries.reynolds_derivatives
        e = self.band
        matrix, left, right = e.fill(entries, dropped)
        self.lu, self.pivots, singular = dgbtrf(matrix, e.half, e.half, overwrite_ab=True)
        if singular:
            _never_zero(self.lu[2 * e.half])
        g = self._columns(left, right)
        tips_of_g = np.zeros((self.widest, 2 * e.size + BORDER))
        tips(g, e.groups_at_ends, e.place, e.dense, tips_of_g[: len(g)])
        self._couple(tips_of_g)
        self.spread = g[:, e.place]

    def _columns(self, left, right):
        """G of this rank, from what its outer groups take from their neighbours, or from the mesh's ends."""
        e = self.band
        first, last = e.groups_at_ends
        if self.ranks.rank == 0:
            left = (first == e.place[0])[:, None]
        if self.ranks.rank == self.ranks.size - 1:
            right = (last == e.place[-2])[:, None]
        parts = []
        for columns, group in ((left, first), (right, last)):
            part = np.zeros((columns.shape[1], e.order))
            part[:, group] = columns.T
            substitute(self.lu.T, self.pivots, part, group.min())
            parts.append(part)
        return np.concatenate(parts)

    def _still_good(self, entries, dropped):
        """Whether this rank's factors are nearly those of the given state."""
        held, rows = self.factored
        return (
            np.array_equal(dropped, held)
            and entries.same_deflection(self.band.entries)
            and is_close(entries.reynolds_derivatives, rows, CLOSE)
        )

    def _everyone(self, mine):
        """The same array of every rank."""
        if self.ranks.size == 1:
            return mine[None]
        gathered = np.empty((self.ranks.size, *mine.shape))
        self.ranks.Allgather(mine, gathered)
        return gathered

    def _couple(self, columns):
        """Factor the system of w from every rank's tips of G."""
        order = self.inner + BORDER
        matrix = np.zeros((order, order), order="F")
        matrix.flat[:: order + 1] = 1.0
        matrix[-1, -1] = 0.0
        matrix[self.inner : -1, -1] = -self.end_scale
        for (unknowns, own, outer), theirs in zip(self.of_rank, self._everyone(columns), strict=True):
            theirs = theirs[: len(unknowns)].T
            matrix[own[:, None], unknowns] += theirs[outer]
            matrix[self.inner :, unknowns] += theirs[-BORDER:]
        self.coupled, self.coupled_pivots, singular = dgetrf(matrix, overwrite_a=True)
        if singular:
            _never_zero(np.einsum("ii->i", self.coupled))

    def solve(self, b, kept, load):
        """Solution of the local (q, h, q, h, ...), shape (2 nodes,), and h00; collective.

        Parameters
        ----------
        b : ndarray
            Right-hand side of the rows `kept` (of 2 nodes); that of all others is zero.
        kept : ndarray of int
        load : float
            Right-hand side of the load's row, where it is local.
        """
        e, y, mine = self.band, self.y, self.tips
        solve_scattered(self.lu.T, self.pivots, e.place, kept, b, y)
        tips(y, e.groups_at_ends, e.place, e.dense, mine)
        mine[0, -1] -= load
        everyone = self._everyone(mine[0])
        right = np.zeros(self.inner + BORDER)
        for (_, own, outer), part in zip(self.of_rank, everyone, strict=True):
            right[own] = part[outer]
        right[self.inner :] = everyone[:, -BORDER:].sum(axis=0)
        w = dgetrs(self.coupled, self.coupled_pivots, right, overwrite_b=True)[0]
        solution = np.empty(len(e.place))
        without(y[0], e.place, w[self.of_rank[self.ranks.rank][0]], self.spread, solution)
        return solution, w[-1]


def _never_zero(diagonal):
    """A preconditioner may be off where the operator is singular, but must not be infinite."""
    diagonal[diagonal == 0.0] = np.abs(diagonal).max(initial=0.0) or 1.0
