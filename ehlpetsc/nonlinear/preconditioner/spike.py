r"""LU of the band of :mod:`.banded_jacobian`, split between ranks.

Each rank factors the part A of its own groups with LAPACK. What couples the parts, and what borders the band,
enters through few unknowns w (Polizzi & Sameh 2006: SPIKE),

.. math:: y = A^{-1}b - G\,w,

the solution in the groups beside the cuts, for both ends of the mesh what the band lacks of their deflection,
and h00. The columns of G are solved for with every matrix; w obeys a small system that every rank holds.
"""

import numpy as np
from scipy.linalg.lapack import dgbtrf, dgetrf, dgetrs

from ehlpetsc.nonlinear.preconditioner.substitution import substitute

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
        self.b = np.zeros((1, band.order))

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
        if not anew and self.ranks.allreduce(self._still_good(entries, dropped), min):
            return
        derivatives = entries.reynolds_derivatives
        self.factored = dropped, derivatives, CLOSE * np.abs(derivatives).max(axis=1, keepdims=True)
        e = self.band
        matrix, left, right = e.fill(entries, dropped)
        self.lu, self.pivots, singular = dgbtrf(matrix, e.half, e.half, overwrite_ab=True)
        if singular:
            _never_zero(self.lu[2 * e.half])
        if self.ranks.rank == 0:
            left = _unit(e.size, e.place[0])
        if self.ranks.rank == self.ranks.size - 1:
            right = _unit(e.size, e.place[-2] - (e.order - e.size))
        g = np.zeros((left.shape[1] + right.shape[1], e.order))
        from_left, from_right = g[: left.shape[1]], g[left.shape[1] :]
        from_left[:, : e.size], from_right[:, -e.size :] = left.T, right.T
        self._own_solve(from_left, 0, e.size)
        self._own_solve(from_right, e.order - e.size, e.order)
        tips = np.zeros((self.widest, 2 * e.size + BORDER))
        tips[: len(g)] = self._tips_of(g)
        self._couple(tips)
        self.spread = g[:, e.place]

    def _still_good(self, entries, dropped):
        """Whether this rank's factors are nearly those of the given state."""
        held, rows, change = self.factored
        return (
            np.array_equal(dropped, held)
            and entries.same_deflection(self.band.entries)
            and bool((np.abs(entries.reynolds_derivatives - rows) <= change).all())
        )

    def _own_solve(self, b, first, last):
        """Solve in place for right-hand sides (any number, order) that are zero but in first .. last-1."""
        e = self.band
        if not e.backwards:
            return substitute(self.lu.T, self.pivots, b, first)
        turned = b[:, ::-1].copy()
        substitute(self.lu.T, self.pivots, turned, e.order - last)
        b[:] = turned[:, ::-1]

    def _tips_of(self, y):
        """What the others need of local solutions: both outer groups, and their part of the dense rows."""
        e = self.band
        return np.hstack([y[:, : e.size], y[:, -e.size :], y[:, e.place[::2]] @ e.dense.T])

    def _everyone(self, tips):
        """The same array of every rank."""
        if self.ranks.size == 1:
            return tips[None]
        gathered = np.empty((self.ranks.size, *tips.shape))
        self.ranks.Allgather(tips, gathered)
        return gathered

    def _couple(self, columns):
        """Factor the system of w from every rank's tips of G."""
        order = self.inner + BORDER
        matrix = np.zeros((order, order), order="F")
        matrix.flat[:: order + 1] = 1.0
        matrix[-1, -1] = 0.0
        matrix[self.inner : -1, -1] = -self.end_scale
        for (unknowns, own, outer), tips in zip(self.of_rank, self._everyone(columns), strict=True):
            tips = tips[: len(unknowns)].T
            matrix[own[:, None], unknowns] += tips[outer]
            matrix[self.inner :, unknowns] += tips[-BORDER:]
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
        e = self.band
        self.b[:] = 0.0
        y = self.b[0]
        y[e.place[kept]] = b
        self._own_solve(self.b, 0, e.order)
        tips = self._tips_of(self.b)[0]
        tips[-1] -= load
        everyone = self._everyone(tips)
        right = np.zeros(self.inner + BORDER)
        for (_, own, outer), part in zip(self.of_rank, everyone, strict=True):
            right[own] = part[outer]
        right[self.inner :] = everyone[:, -BORDER:].sum(axis=0)
        w = dgetrs(self.coupled, self.coupled_pivots, right, overwrite_b=True)[0]
        return y[e.place] - w[self.of_rank[self.ranks.rank][0]] @ self.spread, w[-1]


def _unit(size, place):
    column = np.zeros((size, 1))
    column[place] = 1.0
    return column


def _never_zero(diagonal):
    """A preconditioner may be off where the operator is singular, but must not be infinite."""
    diagonal[diagonal == 0.0] = np.abs(diagonal).max(initial=0.0) or 1.0
