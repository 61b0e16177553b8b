"""SPIKE's reduced system: the few unknowns w by which the ranks' parts of a band and its border are coupled.

In the order of the cuts it is banded, but for three rows and columns of the border; its cost grows as the
number of ranks. Every rank factors it, and keeps of the inverse the rows of those w that it needs.
"""

import numpy as np
from scipy.linalg.lapack import dgbtrf, dgbtrs, dgetrf, dgetrs

BORDER = 3  # far deflection of the first and of the last node, h00


class ReducedSystem:
    """Where w stands, and what a rank needs of its solutions.

    Parameters
    ----------
    left, right : int
        Unknowns beside a cut that the other side takes: of the last group before it, of the first one behind.
    rank, ranks : int
    end_scale : float
        What h00 counts in the end nodes' deflection rows, negative.

    Attributes
    ----------
    widest : int
        Most columns G of a rank.
    """

    def __init__(self, left, right, rank, ranks, end_scale):
        self.left, self.right, self.last, self.end_scale = left, right, ranks - 1, end_scale
        self.cut = left + right
        self.inner = self.cut * self.last
        self.below, self.above = self.cut + left - 1, self.cut + right - 1
        self.of_rank = [self._places(one) for one in range(ranks)]
        self.widest = max(len(columns) for columns, _, _ in self.of_rank)
        wanted = np.append(self.of_rank[rank][0], self.inner + BORDER - 1)
        self.wanted = np.zeros((self.inner + BORDER, len(wanted)), order="F")
        self.wanted[wanted, np.arange(len(wanted))] = 1.0

    def _places(self, rank):
        """In w of a rank's columns G and of its own unknowns; which of its tips beside the cuts these are."""
        before, behind = self.cut * (rank - 1), self.cut * rank
        columns = [
            [self.inner] if rank == 0 else before + np.arange(self.left),
            [self.inner + 1] if rank == self.last else behind + self.left + np.arange(self.right),
        ]
        shown = slice(self.right if rank == 0 else 0, self.right if rank == self.last else self.cut)
        own = before + self.left + np.arange(self.cut)[shown]
        return np.concatenate(columns).astype(int), own, shown

    def rows_of_inverse(self, tips):
        """What the w of this rank's columns, and h00, take of every rank's tips.

        Parameters
        ----------
        tips : ndarray, shape (ranks, columns, left + right + BORDER)
            Of every rank's G; rows of a rank with fewer columns than others are not looked at.

        Returns
        -------
        ndarray, shape (columns + 1, ranks (left + right + BORDER))
        """
        band, beyond, border = self._matrix(tips)
        inner = self.inner
        of_cuts, of_border = self.wanted[:inner], self.wanted[inner:]
        if inner:
            lu, pivots, singular = dgbtrf(band, self.below, self.above, overwrite_ab=True)
            if singular:
                never_zero(lu[self.below + self.above])
            solved = dgbtrs(lu, self.below, self.above, beyond, pivots)[0]
            of_border = of_border - solved.T @ of_cuts
            border[:, inner:] -= border[:, :inner] @ solved
        schur, order, singular = dgetrf(border[:, inner:], overwrite_a=False)
        if singular:
            never_zero(np.einsum("ii->i", schur))
        of_border = dgetrs(schur, order, of_border, trans=1)[0]
        if inner:
            right = of_cuts - border[:, :inner].T @ of_border
            of_cuts = dgbtrs(lu, self.below, self.above, right, pivots, trans=1)[0]
        rows = np.zeros((self.wanted.shape[1], len(self.of_rank), self.cut + BORDER))
        rows[:, :, self.cut :] = of_border.T[:, None]
        for rank, (_, own, shown) in enumerate(self.of_rank):
            rows[:, rank, shown] = of_cuts[own].T
        return rows.reshape(len(rows), -1)

    def _matrix(self, tips):
        """The band with room for its factors, what the border adds to its rows, and the border's rows."""
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
        return band, beyond, border


def never_zero(diagonal):
    """A preconditioner may be off where the operator is singular, but must not be infinite."""
    diagonal[diagonal == 0.0] = np.abs(diagonal).max(initial=0.0) or 1.0
