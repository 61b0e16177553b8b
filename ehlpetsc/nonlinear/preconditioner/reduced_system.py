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
        self.left, self.right, self.last = left, right, ranks - 1
        self.cut = left + right
        self.inner = self.cut * self.last
        self.below, self.above = self.cut + left - 1, self.cut + right - 1
        self.of_rank = [self._places(one) for one in range(ranks)]
        self.widest = max(len(columns) for columns, _, _ in self.of_rank)
        self._without_tips(end_scale)
        self._entries_of_tips()
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
        rank, tip = self._beside_cuts
        rows[:, rank, tip] = of_cuts.T
        return rows.reshape(len(rows), -1)

    def _without_tips(self, end_scale):
        """What no state changes: the band with room for its factors, its columns beyond, the border."""
        inner, diagonal = self.inner, self.below + self.above
        self._band = np.zeros((inner, diagonal + self.below + 1)).T
        self._band[diagonal] = 1.0
        self._beyond, self._border = np.zeros((BORDER, inner)).T, np.zeros((BORDER, inner + BORDER))
        self._border[0, inner] = self._border[1, inner + 1] = 1.0
        self._border[:2, -1] = -end_scale

    def _entries_of_tips(self):
        """Where tips of all ranks' G stand in band, columns beyond and border."""
        inner, of_border, entries, beside = self.inner, np.arange(BORDER), [], []
        for rank, (columns, own, shown) in enumerate(self.of_rank):
            tip = np.arange(self.cut)[shown]
            beside.append([np.full(len(tip), rank), tip])
            tip, row = np.append(tip, self.cut + of_border), np.append(own, inner + of_border)
            of_g, tip = (part.ravel() for part in np.meshgrid(np.arange(len(columns)), tip, indexing="ij"))
            entries.append([np.full(len(tip), rank), of_g, tip, np.tile(row, len(columns)), columns[of_g]])
        self._beside_cuts, entries = np.concatenate(beside, axis=1), np.concatenate(entries, axis=1)

        def part(some):
            return tuple(entries[:3, some]), entries[3, some], entries[4, some]

        of_cuts, of_inner = entries[3] < inner, entries[4] < inner
        tips, row, column = part(of_cuts & of_inner)
        self._in_band = tips, (self.below + self.above + row - column, column)
        tips, row, column = part(of_cuts & ~of_inner)
        self._in_beyond = tips, (row, column - inner)
        tips, row, column = part(~of_cuts)
        self._in_border = tips, (row - inner, column)

    def _matrix(self, tips):
        """The band with room for its factors, what the border adds to its rows, and the border's rows."""
        parts = self._band.copy(order="F"), self._beyond.copy(order="F"), self._border.copy()
        for part, (given, there) in zip(
            parts, (self._in_band, self._in_beyond, self._in_border), strict=True
        ):
            part[there] += tips[given]
        return parts


def never_zero(diagonal):
    """A preconditioner may be off where the operator is singular, but must not be infinite."""
    diagonal[diagonal == 0.0] = np.abs(diagonal).max(initial=0.0) or 1.0
