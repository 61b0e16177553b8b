r"""LU of a block tridiagonal matrix, with dense inverses of what is left of its diagonal blocks.

.. math:: S_i=D_i-L_i\,W_{i-1},\quad W_i=S_i^{-1}U_i,\qquad
   y_i=S_i^{-1}(b_i-L_iy_{i-1}),\quad x_i=y_i-W_ix_{i+1}.

Rows are exchanged within a block alone. L contains some of the unknowns of the group before, U some of the
group behind. A solve is three products of small matrices with vectors in each group, a sixth of the time of
LAPACK's substitution in a band; the factors take half as long as LAPACK's.

All matrices are stored by columns, each with room for `STRIDE` numbers, three vectors of the processor. Numba
vectorises a loop only where it can exclude that a written number is read again: :func:`subtract_product` and
:func:`subtract_column` read four numbers before they write any. Loops count in unsigned numbers or to
constants: indices that may be negative, and short loops of unknown length, take twice as long. Numba caches
its code until this file changes and does not notice changes of imported constants, so they are defined here.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg.lapack import dgbtrf, dgbtrs

from ehlpetsc.base.compiled import compiled, unsigned

SIZE = 11  # unknowns of a group
STRIDE = 12  # room for them
LEFT, FROM_LEFT = 9, 2  # unknowns of the group before that the rows contain, and the first of them
RIGHT, FROM_RIGHT = 9, 0  # those of the group behind: one more than it has, for the mirrored order
ROW_WIDTH, CUT = LEFT + SIZE + RIGHT, LEFT + RIGHT
AT_LEFT, AT_RIGHT = slice(FROM_RIGHT, FROM_RIGHT + RIGHT), slice(FROM_LEFT, SIZE)  # what cuts there take
FAST = {"contract", "nsz", "reassoc"}
U1, U2, U3, U4 = (unsigned(k) for k in (1, 2, 3, 4))


class BlockLU:
    """Factors of one matrix, and room for them.

    `inverses`: columns of the inverse of S, shape (groups, SIZE, STRIDE).
    `upper`: columns of W, of the last group too, shape (groups, RIGHT, STRIDE).
    `factors`: for :func:`forward` and :func:`backward`: the matrix, both of these and room, in one dimension.
    """

    def __init__(self, groups: int):
        self.inverses, self.upper = np.zeros((groups, SIZE, STRIDE)), np.zeros((groups, RIGHT, STRIDE))
        self._work, self._column = np.empty((SIZE + RIGHT) * STRIDE), np.empty(STRIDE)
        self._free, self._pivots = np.empty(SIZE), np.empty(SIZE, dtype=unsigned)

    def factor(self, columns: np.ndarray) -> None:
        """Factor.

        `columns`: what the rows of each group have of the group before, of their own and of the group behind,
            by columns; to be left as it is while solves follow. What the first group has of one before is not
            looked at, and what the last one has of one behind enters W alone, shape (groups, WIDTH, STRIDE).
        """
        room = self._work, self._column, self._free, self._pivots
        self.factors = columns.ravel(), self.inverses.ravel(), self.upper.ravel(), self._column
        factor(*self.factors[:3], *room)

    def solve(self, b: np.ndarray, first: int = 0) -> None:
        """Solve in place for `b` (groups * STRIDE,), whose groups before `first` are zero."""
        forward(self.factors, b, first)
        backward(self.factors, b)


@compiled(fastmath=FAST)
def subtract_product(
    y: np.ndarray, i: int, matrix: np.ndarray, j: int, x: np.ndarray, k: int, count: int
) -> None:
    """Subtract the product of columns of a matrix with `x[k : k + count]` from `y[i : i + STRIDE]`.

    The columns start at `matrix[j]`. Four sums at a time stay in a register of the processor.
    """
    for chunk in range(U3):
        here, column = i + chunk * U4, j + chunk * U4
        a, b, c, d = y[here], y[here + U1], y[here + U2], y[here + U3]
        for n in range(unsigned(count)):
            value, at = x[k + n], column + n * unsigned(STRIDE)
            a, b = a - value * matrix[at], b - value * matrix[at + U1]
            c, d = c - value * matrix[at + U2], d - value * matrix[at + U3]
        y[here], y[here + U1], y[here + U2], y[here + U3] = a, b, c, d


@compiled(fastmath=FAST)
def subtract_column(y: np.ndarray, i: int, column: np.ndarray, factor: float) -> None:
    """Subtract a column times a factor from `y[i : i + STRIDE]`."""
    for chunk in range(U3):
        k = chunk * U4
        a, b = y[i + k] - factor * column[k], y[i + k + U1] - factor * column[k + U1]
        c, d = y[i + k + U2] - factor * column[k + U2], y[i + k + U3] - factor * column[k + U3]
        y[i + k], y[i + k + U1], y[i + k + U2], y[i + k + U3] = a, b, c, d


@compiled(fastmath=FAST)
def factor(
    columns: np.ndarray,
    inverses: np.ndarray,
    upper: np.ndarray,
    work: np.ndarray,
    column: int,
    free: np.ndarray,
    pivots: np.ndarray,
) -> None:
    """Fill in the inverses of S and W; see :class:`BlockLU`."""
    line, size, right = unsigned(STRIDE), unsigned(SIZE), unsigned(RIGHT)
    for i in range(unsigned(len(inverses) // (SIZE * STRIDE))):
        left = i * unsigned(ROW_WIDTH * STRIDE)
        diagonal_block, inverse, upper_block = (
            left + unsigned(LEFT * STRIDE),
            i * size * line,
            i * right * line,
        )
        for j in range(unsigned((SIZE + RIGHT) * STRIDE)):
            work[j] = columns[diagonal_block + j]
        if i > 0:
            before = upper_block - right * line
            for c in range(right):
                place, previous = (unsigned(FROM_RIGHT) + c) * line, before + c * line + unsigned(FROM_LEFT)
                subtract_product(work, place, columns, left, upper, previous, LEFT)
        eliminate(work, column, free, pivots)
        for c in range(size):
            for k in range(size):
                inverses[inverse + pivots[c] * line + k] = work[c * line + pivots[k]]
        for c in range(right):
            for k in range(size):
                upper[upper_block + c * line + k] = work[(size + c) * line + pivots[k]]


@compiled(fastmath=FAST)
def eliminate(a: np.ndarray, column: np.ndarray, free: np.ndarray, pivots: np.ndarray) -> None:
    """Gauss and Jordan on SIZE columns and RIGHT more, rows left where they are.

    The unknown k is eliminated by the row ``pivots[k]``. Then column c has, in that row, what the unknown k
    takes of the right-hand side of row ``pivots[c]``, or of that of a column more.
    A pivot that is zero is taken for one: a preconditioner may be off where the operator is singular, but
    must not be infinite.
    """
    line, size = unsigned(STRIDE), unsigned(SIZE)
    free[:] = 1.0
    for k in range(size):
        here, pivot, largest = k * line, unsigned(0), -1.0
        for r in range(size):
            if free[r] > 0.0 and abs(a[here + r]) > largest:
                pivot, largest = r, abs(a[here + r])
        pivots[k], free[pivot] = pivot, 0.0
        for r in range(line):
            column[r] = a[here + r]
        inverse = 1.0 / column[pivot] if largest > 0.0 else 1.0
        column[pivot] = 0.0
        for c in range(unsigned(SIZE + RIGHT)):
            entry = a[c * line + pivot] * inverse
            subtract_column(a, c * line, column, entry)
            a[c * line + pivot] = entry
        for r in range(line):
            a[here + r] = -inverse * column[r]
        a[here + pivot] = inverse


@compiled(fastmath=FAST)
def forward(factors: tuple, b: np.ndarray, first: int) -> None:
    """Replace `b` (groups * STRIDE,), whose groups before `first` are zero, by y, in place."""
    columns, inverses, _, minus_b = factors
    line = unsigned(STRIDE)
    groups = unsigned(len(b) // STRIDE)
    for i in range(unsigned(first), groups):
        here = i * line
        if i > first:
            before = here - line + unsigned(FROM_LEFT)
            subtract_product(b, here, columns, i * unsigned(ROW_WIDTH) * line, b, before, LEFT)
        for k in range(line):
            minus_b[k], b[here + k] = -b[here + k], 0.0
        subtract_product(b, here, inverses, i * unsigned(SIZE) * line, minus_b, unsigned(0), SIZE)


@compiled(fastmath=FAST)
def backward(factors: tuple, b: np.ndarray) -> None:
    """Replace y by x, in place: the last group is left as it is."""
    upper, line = factors[2], unsigned(STRIDE)
    groups = unsigned(len(b) // STRIDE)
    for done in range(U1, groups):
        i = groups - U1 - done
        behind = (i + U1) * line + unsigned(FROM_RIGHT)
        subtract_product(b, i * line, upper, i * unsigned(RIGHT) * line, b, behind, RIGHT)


@compiled(fastmath=FAST)
def backward_transposed(upper: np.ndarray, b: np.ndarray) -> None:
    """Replace the coefficients `b` of x (3, groups * STRIDE) by the equivalent ones of y, in place."""
    line, (first, second, third) = unsigned(STRIDE), (b[0], b[1], b[2])
    for i in range(unsigned(b.shape[1] // STRIDE) - U1):
        here, behind = i * line, (i + U1) * line + unsigned(FROM_RIGHT)
        for c in range(unsigned(RIGHT)):
            column, k = (i * unsigned(RIGHT) + c) * line, behind + c
            x, y, z = first[k], second[k], third[k]
            for r in range(line):
                value = upper[column + r]
                x, y = x - value * first[here + r], y - value * second[here + r]
                z -= value * third[here + r]
            first[k], second[k], third[k] = x, y, z


BORDER = 3  # sums over the solutions of all ranks
CONSTANTS, AT_ZERO, AT_ONE = np.array([0.0, 1.0]), -2, -1  # appended to other numbers, and their places


class ReducedSystem:
    """Reduced system of the unknowns w at the cuts, which couples the ranks' parts of a band.

    In the order of the cuts it is banded; its cost grows as the number of ranks. Every rank factors it and
    keeps the rows of the inverse for the unknowns w that it takes, and for sums over the solution.

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
        self._band = np.full((size, self._diagonal + self._below + 1), AT_ZERO)
        self._wanted = np.full((len(taken) + BORDER, size), AT_ZERO)
        self._rows = np.full((len(taken) + BORDER, ranks, cut + BORDER), AT_ZERO)
        for other, (takes, own) in enumerate(places):
            of_rank, takes_too = number[other, : len(takes)], takes[:, None]
            self._band[takes_too, self._diagonal + own - takes_too] = of_rank[:, : len(own)]
            self._wanted[-BORDER:, takes] = of_rank[:, cut:].T
            self._rows[:, other, : len(own)] = size * np.arange(len(self._rows))[:, None] + own
        self._band[:, self._diagonal] = self._wanted[np.arange(len(taken)), taken] = AT_ONE
        for k in range(-BORDER, 0):
            self._rows[k, :, k] = AT_ONE

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
            right, options = solution.T, {"trans": 1, "overwrite_b": True}
            solution = dgbtrs(lu, self._below, self._above, right, pivots, **options)[0].T
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
