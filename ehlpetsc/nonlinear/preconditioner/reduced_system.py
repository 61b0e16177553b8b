"""SPIKE's reduced system: the few unknowns by which the ranks' parts of a band and its border are coupled.

In the order of the cuts it is banded, but for three rows and columns of the border; its cost grows as the
number of ranks. Every rank holds it.
"""

import numpy as np
from scipy.linalg.lapack import dgbtrf, dgbtrs, dgetrf, dgetrs

BORDER = 3  # far deflection of the first and of the last node, h00


class ReducedSystem:
    """Where w stands, its matrix and solutions.

    Parameters
    ----------
    left, right : int
        Unknowns beside a cut that the other side takes: of the last group before it, of the first one behind.
    ranks : int
    end_scale : float
        What h00 counts in the end nodes' deflection rows, negative.

    Attributes
    ----------
    of_rank : list of (columns, own, shown)
        For each rank: places in w that its columns G belong to; places of its own unknowns; and which of its
        tips, right + left beside its cuts, these are.
    """

    def __init__(self, left, right, ranks, end_scale):
        self.left, self.right, self.last, self.end_scale = left, right, ranks - 1, end_scale
        self.cut = left + right
        self.inner = self.cut * self.last
        self.below, self.above = self.cut + left - 1, self.cut + right - 1
        self.of_rank = [self._places(rank) for rank in range(ranks)]

    def _places(self, rank):
        before, behind = self.cut * (rank - 1), self.cut * rank
        columns = [
            [self.inner] if rank == 0 else before + np.arange(self.left),
            [self.inner + 1] if rank == self.last else behind + self.left + np.arange(self.right),
        ]
        shown = slice(self.right if rank == 0 else 0, self.right if rank == self.last else self.cut)
        own = before + self.left + np.arange(self.cut)[shown]
        return np.concatenate(columns).astype(int), own, shown

    def factor(self, tips):
        """Factor, from the tips of every rank's G.

        Parameters
        ----------
        tips : ndarray, shape (ranks, columns, left + right + BORDER)
            Rows of a rank with fewer columns than others are not looked at.
        """
        inner, diagonal = self.inner, self.below + self.above
        band = np.zeros((diagonal + self.below + 1, inner), order="F")
        band[diagonal] = 1.0
        beyond, border = np.zeros((inner, BORDER), order="F"), np.zeros((BORDER, inner + BORDER))
        border[0, inner] = border[1, inner + 1] = 1.0
        border[:2, -1] = -self.end_scale
        for (columns, own, shown), theirs in zip(self.of_rank, tips, strict=True):
            rows = theirs[: len(columns)].T
            border[:, columns] += rows[self.cut :]
            inside = columns < inner
            places = columns[inside]
            band[diagonal + own[:, None] - places, places] += rows[shown][:, inside]
            beyond[own[:, None], columns[~inside] - inner] += rows[shown][:, ~inside]
        self.dense = border[:, :inner]
        if inner:
            self.band, self.band_pivots, singular = dgbtrf(band, self.below, self.above, overwrite_ab=True)
            if singular:
                never_zero(self.band[diagonal])
        self.beyond = self._of_cuts(beyond)
        schur = np.asfortranarray(border[:, inner:] - self.dense @ self.beyond)
        self.schur, self.pivots, singular = dgetrf(schur, overwrite_a=True)
        if singular:
            never_zero(np.einsum("ii->i", self.schur))

    def _of_cuts(self, right):
        """Solution of the banded part alone."""
        if not self.inner:
            return right
        return dgbtrs(self.band, self.below, self.above, right, self.band_pivots)[0]

    def solve(self, tips):
        """The unknowns w.

        Parameters
        ----------
        tips : ndarray, shape (ranks, left + right + BORDER)
            Of every rank's own solution.
        """
        inner = np.zeros(self.inner)
        for (_, own, shown), part in zip(self.of_rank, tips, strict=True):
            inner[own] = part[shown]
        inner = self._of_cuts(inner)
        border = tips[:, self.cut :].sum(axis=0) - self.dense @ inner
        border = dgetrs(self.schur, self.pivots, border)[0]
        return np.concatenate([inner - self.beyond @ border, border])


def never_zero(diagonal):
    """A preconditioner may be off where the operator is singular, but must not be infinite."""
    diagonal[diagonal == 0.0] = np.abs(diagonal).max(initial=0.0) or 1.0
