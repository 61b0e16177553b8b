"""Reduced system of the unknowns w at the cuts, which couples the ranks' parts of a band.

In the order of the cuts it is banded; its cost grows as the number of ranks. Every rank factors it and keeps
the rows of the inverse for the unknowns w that it takes, and for sums over the solution.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg.lapack import dgbtrf, dgbtrs

BORDER = 3  # sums over the solutions of all ranks
CONSTANTS, ZERO, ONE = np.array([0.0, 1.0]), -2, -1  # appended to other numbers, and their places


class ReducedSystem:
    """Indices of w, and the rows of the inverse that a rank needs.

    `left`, `right`: unknowns at a cut that the other side takes: of the last group before it, of the first
        one behind.
    """

    def __init__(self, left: int, right: int, rank: int, ranks: int):
        cut = left + right
        places = [_indices(other, ranks, left, right) for other in range(ranks)]
        taken, size = places[rank][0], cut * (ranks - 1)
        self._below, self._above = cut + left - 1, cut + right - 1
        self._diagonal = self._below + self._above
        # places among the values, in LAPACK's band and in the right-hand sides; among the solutions
        number = np.arange(ranks * (cut + 2) * (cut + BORDER)).reshape(ranks, cut + 2, cut + BORDER)
        self._band = np.full((size, self._diagonal + self._below + 1), ZERO)
        self._wanted = np.full((len(taken) + BORDER, size), ZERO)
        self._rows = np.full((len(taken) + BORDER, ranks, cut + BORDER), ZERO)
        for other, (takes, own) in enumerate(places):
            of_rank, takes_too = number[other, : len(takes)], takes[:, None]
            self._band[takes_too, self._diagonal + own - takes_too] = of_rank[:, : len(own)]
            self._wanted[-BORDER:, takes] = of_rank[:, cut:].T
            self._rows[:, other, : len(own)] = size * np.arange(len(self._rows))[:, None] + own
        self._band[:, self._diagonal] = self._wanted[np.arange(len(taken)), taken] = ONE
        for k in range(-BORDER, 0):
            self._rows[k, :, k] = ONE

    def rows_of_inverse(self, values: np.ndarray) -> np.ndarray:
        """Coefficients of the unknowns that this rank takes, and of the sums over all ranks.

        `values`: of every rank, by each unknown taken of others: the rank's own unknowns at its cuts, and its
            sums; the last two rows are not used, shape (ranks, left + right + 2, left + right + BORDER).

        They apply to the values at the cuts and the sums that every rank has without the others; shape
        (taken + BORDER, ranks (left + right + BORDER)).
        """
        numbers = np.concatenate((values.ravel(), CONSTANTS))
        band, solution = numbers[self._band], numbers[self._wanted]
        if len(band):
            solution[-BORDER:] *= -1.0
            lu, pivots, singular = dgbtrf(band.T, self._below, self._above, overwrite_ab=True)
            if singular:
                regularise_pivots(lu[self._diagonal])
            solution = dgbtrs(lu, self._below, self._above, solution.T, pivots, trans=1, overwrite_b=True)[
                0
            ].T
        return np.concatenate((solution.ravel(), CONSTANTS))[self._rows].reshape(len(self._rows), -1)


def _indices(rank: int, ranks: int, left: int, right: int) -> tuple[np.ndarray, np.ndarray]:
    """Indices of the unknowns that a rank takes of others, and of its own at its cuts."""
    cut = (left + right) * rank  # the one behind the rank
    before, behind = np.arange(cut - left - right, cut), np.arange(cut, cut + left + right)
    before, behind = before[: len(before) * (rank > 0)], behind[: len(behind) * (rank < ranks - 1)]
    return np.append(before[:left], behind[left:]), np.append(before[left:], behind[:left])


def regularise_pivots(diagonal: np.ndarray) -> None:
    """Replace zero pivots: a preconditioner may be off where the operator is singular, but not infinite."""
    diagonal[diagonal == 0.0] = np.abs(diagonal).max(initial=0.0) or 1.0
