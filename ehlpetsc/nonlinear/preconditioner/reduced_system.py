"""Reduced system of the unknowns w at the cuts, by which the ranks' parts of a band are coupled.

In the order of the cuts it is banded; its cost grows as the number of ranks. Every rank factors it, and keeps
of the inverse the rows of those w that it needs.
"""

import numpy as np
from scipy.linalg.lapack import dgbtrf, dgbtrs


class ReducedSystem:
    """Indices of w, and what a rank needs of its solutions.

    Parameters
    ----------
    left, right : int
        Unknowns at a cut that the other side takes: of the last group before it, of the first one behind.
    rank, ranks : int
    """

    def __init__(self, left, right, rank, ranks):
        self._left, self._last, self._cut = left, ranks - 1, left + right
        self._size = self._cut * self._last
        self._below, self._above = self._cut + left - 1, self._cut + right - 1
        self._of_rank = [self._indices(one) for one in range(ranks)]
        wanted = self._of_rank[rank][0]
        self._wanted = np.zeros((self._size, len(wanted)), order="F")
        self._wanted[wanted, np.arange(len(wanted))] = 1.0

    def _indices(self, rank):
        """Of the unknowns that a rank takes of others, and of its own at its cuts."""
        before, behind = self._cut * (rank - 1), self._cut * rank
        taken, own = [], []
        if rank > 0:
            taken += range(before, before + self._left)
            own += range(before + self._left, behind)
        if rank < self._last:
            taken += range(behind + self._left, behind + self._cut)
            own += range(behind, behind + self._left)
        return np.array(taken), np.array(own)

    def rows_of_inverse(self, values):
        """Coefficients of the unknowns that this rank takes.

        Parameters
        ----------
        values : ndarray, shape (ranks, left + right, left + right)
            Of every rank: by each unknown taken of others, the rank's own unknowns at its cuts.

        Returns
        -------
        ndarray, shape (taken, ranks (left + right))
            Of the values at the cuts that every rank has without the others.
        """
        diagonal = self._below + self._above
        band = np.zeros((diagonal + self._below + 1, self._size), order="F")
        band[diagonal] = 1.0
        for (taken, own), of_rank in zip(self._of_rank, values, strict=True):
            band[diagonal + own - taken[:, None], taken[:, None]] += of_rank[: len(taken), : len(own)]
        lu, pivots, singular = dgbtrf(band, self._below, self._above, overwrite_ab=True)
        if singular:
            regularise_pivots(lu[diagonal])
        inverse = dgbtrs(lu, self._below, self._above, self._wanted, pivots, trans=1)[0]
        rows = np.zeros((self._wanted.shape[1], len(self._of_rank), self._cut))
        for rank, (_, own) in enumerate(self._of_rank):
            rows[:, rank, : len(own)] = inverse[own].T
        return rows.reshape(len(rows), -1)


def regularise_pivots(diagonal):
    """Replace zero pivots: a preconditioner may be off where the operator is singular, but not infinite."""
    diagonal[diagonal == 0.0] = np.abs(diagonal).max(initial=0.0) or 1.0
