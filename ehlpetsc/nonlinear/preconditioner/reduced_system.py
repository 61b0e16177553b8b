"""Reduced system of the unknowns w at the cuts, by which the ranks' parts of a band are coupled.

In the order of the cuts it is banded; its cost grows as the number of ranks. Every rank factors it, and keeps
of the inverse the rows of those w that it needs, and those of sums over the solution.
"""

import numpy as np
from scipy.linalg.lapack import dgbtrf, dgbtrs

BORDER = 3  # sums over the solutions of all ranks


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
        self._taken = self._of_rank[rank][0]

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
        return np.array(taken, dtype=int), np.array(own, dtype=int)

    def rows_of_inverse(self, values):
        """Coefficients of the unknowns that this rank takes, and of the sums over all ranks.

        Parameters
        ----------
        values : ndarray, shape (ranks, left + right, left + right + BORDER)
            Of every rank, by each unknown taken of others: the rank's own unknowns at its cuts, and its sums.

        Returns
        -------
        ndarray, shape (taken + BORDER, ranks (left + right + BORDER))
            Of the values at the cuts and the sums that every rank has without the others.
        """
        rows = np.zeros((len(self._taken) + BORDER, len(self._of_rank), self._cut + BORDER))
        if len(values) > 1:
            inverse = self._inverse(values)
            for rank, (_, own) in enumerate(self._of_rank):
                rows[:, rank, : len(own)] = inverse[own].T
        for k in range(-BORDER, 0):
            rows[k, :, k] = 1.0
        return rows.reshape(len(rows), -1)

    def _inverse(self, values):
        diagonal = self._below + self._above
        band = np.zeros((diagonal + self._below + 1, self._size), order="F")
        band[diagonal] = 1.0
        wanted = np.zeros((self._size, len(self._taken) + BORDER), order="F")
        wanted[self._taken, np.arange(len(self._taken))] = 1.0
        for (taken, own), of_rank in zip(self._of_rank, values, strict=True):
            band[diagonal + own - taken[:, None], taken[:, None]] += of_rank[: len(taken), : len(own)]
            wanted[taken, -BORDER:] = -of_rank[: len(taken), self._cut :]
        lu, pivots, singular = dgbtrf(band, self._below, self._above, overwrite_ab=True)
        if singular:
            regularise_pivots(lu[diagonal])
        return dgbtrs(lu, self._below, self._above, wanted, pivots, trans=1)[0]


def regularise_pivots(diagonal):
    """Replace zero pivots: a preconditioner may be off where the operator is singular, but not infinite."""
    diagonal[diagonal == 0.0] = np.abs(diagonal).max(initial=0.0) or 1.0
