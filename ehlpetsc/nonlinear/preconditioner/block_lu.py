r"""LU of a block tridiagonal matrix, with dense inverses of what is left of its diagonal blocks.

.. math:: S_i=D_i-L_i\,W_{i-1},\quad W_i=S_i^{-1}U_i,\qquad
   y_i=S_i^{-1}(b_i-L_iy_{i-1}),\quad x_i=y_i-W_ix_{i+1}.

Rows are exchanged within a block alone. L contains some of the unknowns of the group before, U some of the
group behind. A solve is three products of small matrices with vectors in each group, a sixth of the time of
LAPACK's substitution in a band; the factors take half as long as LAPACK's.

All matrices are stored by columns, each with room for `LINE` numbers, three vectors of the processor. Numba
makes vectors of a loop only where it can tell that nothing written is read again; :func:`axpy_four` reads
before it writes, so that it need not ask. Loops count in unsigned numbers or to constants: numba takes twice
as long over indices that may be negative, and over short loops whose length it does not know. It keeps what
it compiled as long as this file is as it was, so the constants stand here.
"""

import numpy as np

from ehlpetsc.compiled import compiled, unsigned

SIZE = 11  # unknowns of a group
LINE = 12  # room for them
LEFT, FROM_LEFT = 9, 2  # unknowns of the group before that the rows contain, and the first of them
RIGHT, FROM_RIGHT = 9, 0  # those of the group behind: one more than it has, for the mirrored order
WIDTH, CUT = LEFT + SIZE + RIGHT, LEFT + RIGHT
AT_LEFT, AT_RIGHT = slice(FROM_RIGHT, FROM_RIGHT + RIGHT), slice(FROM_LEFT, SIZE)  # what cuts there take
FAST = {"contract", "nsz", "reassoc"}
ONE, TWO, THREE, FOUR, EIGHT = (unsigned(k) for k in (1, 2, 3, 4, 8))


class BlockLU:
    """Factors of one matrix, and room for them.

    Parameters
    ----------
    groups : int

    Attributes
    ----------
    inverses : ndarray, shape (groups, SIZE, LINE)
        Columns of the inverse of S.
    upper : ndarray, shape (groups, RIGHT, LINE)
        Columns of W, of the last group too.
    factors : tuple of ndarray
        For :func:`forward` and :func:`backward`: the matrix, both of these and room, in one dimension.
    """

    def __init__(self, groups):
        self.inverses, self.upper = np.zeros((groups, SIZE, LINE)), np.zeros((groups, RIGHT, LINE))
        self._work, self._column = np.empty((SIZE + RIGHT) * LINE), np.empty(LINE)
        self._free, self._pivots = np.empty(SIZE), np.empty(SIZE, dtype=unsigned)

    def factor(self, columns):
        """Factor.

        Parameters
        ----------
        columns : ndarray, shape (groups, WIDTH, LINE)
            What the rows of each group have of the group before, of their own and of the group behind, by
            columns; to be left as it is while solves follow. What the first group has of one before is not
            looked at, and what the last one has of one behind enters W alone.
        """
        room = self._work, self._column, self._free, self._pivots
        self.factors = columns.ravel(), self.inverses.ravel(), self.upper.ravel(), self._column
        factor(*self.factors[:3], *room)

    def solve(self, b, first=0):
        """Solve in place for `b` (groups * LINE,), whose groups before `first` are zero."""
        forward(self.factors, b, first)
        backward(self.factors, b)

    def backward_transposed(self, b):
        """Replace the coefficients `b` of x (rows, groups * LINE) by the equivalent ones of y, in place."""
        backward_transposed(self.upper.ravel(), b)


@compiled(fastmath=FAST)
def axpy_four(a, i, factor, b, k):
    """Take four numbers of b from the k-th on, times a factor, off those of a from the i-th on."""
    first, second = a[i] - factor * b[k], a[i + ONE] - factor * b[k + ONE]
    third, fourth = a[i + TWO] - factor * b[k + TWO], a[i + THREE] - factor * b[k + THREE]
    a[i], a[i + ONE], a[i + TWO], a[i + THREE] = first, second, third, fourth


@compiled(fastmath=FAST)
def axpy(a, i, factor, b, k):
    """Take a column of b times a factor off one of a; they begin at the k-th and the i-th number."""
    axpy_four(a, i, factor, b, k)
    axpy_four(a, i + FOUR, factor, b, k + FOUR)
    axpy_four(a, i + EIGHT, factor, b, k + EIGHT)


@compiled(fastmath=FAST)
def factor(columns, inverses, upper, work, column, free, pivots):
    """Fill in the inverses of S and W; see :class:`BlockLU`."""
    line, size, right = unsigned(LINE), unsigned(SIZE), unsigned(RIGHT)
    for i in range(unsigned(len(inverses) // (SIZE * LINE))):
        left = i * unsigned(WIDTH * LINE)
        own, inverse, part = left + unsigned(LEFT * LINE), i * size * line, i * right * line
        for j in range(unsigned((SIZE + RIGHT) * LINE)):
            work[j] = columns[own + j]
        if i > 0:
            before = part - right * line
            for c in range(right):
                for k in range(unsigned(LEFT)):
                    entry = upper[before + c * line + unsigned(FROM_LEFT) + k]
                    axpy(work, (unsigned(FROM_RIGHT) + c) * line, entry, columns, left + k * line)
        eliminate(work, column, free, pivots)
        for c in range(size):
            for k in range(size):
                inverses[inverse + pivots[c] * line + k] = work[c * line + pivots[k]]
        for c in range(right):
            for k in range(size):
                upper[part + c * line + k] = work[(size + c) * line + pivots[k]]


@compiled(fastmath=FAST)
def eliminate(a, column, free, pivots):
    """Gauss and Jordan on SIZE columns and RIGHT more, rows left where they are.

    The unknown k is eliminated by the row ``pivots[k]``. Then column c has, in that row, what the unknown k
    takes of the right-hand side of row ``pivots[c]``, or of that of a column more.
    A pivot that is zero is taken for one: a preconditioner may be off where the operator is singular, but
    must not be infinite.
    """
    line, size = unsigned(LINE), unsigned(SIZE)
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
            axpy(a, c * line, entry, column, unsigned(0))
            a[c * line + pivot] = entry
        for r in range(line):
            a[here + r] = -inverse * column[r]
        a[here + pivot] = inverse


@compiled(fastmath=FAST)
def forward(factors, b, first):
    """Replace `b` (groups * LINE,), whose groups before `first` are zero, by y, in place."""
    columns, inverses, _, known = factors
    line = unsigned(LINE)
    groups, first = unsigned(len(b) // LINE), unsigned(first)
    for i in range(first, groups):
        here = i * line
        if i > first:
            for c in range(unsigned(LEFT)):
                entry = b[here - line + unsigned(FROM_LEFT) + c]
                axpy(b, here, entry, columns, (i * unsigned(WIDTH) + c) * line)
        for k in range(line):
            known[k], b[here + k] = b[here + k], 0.0
        for c in range(unsigned(SIZE)):
            axpy(b, here, -known[c], inverses, (i * unsigned(SIZE) + c) * line)


@compiled(fastmath=FAST)
def backward(factors, b):
    """Replace y by x, in place: the last group is left as it is."""
    upper, line = factors[2], unsigned(LINE)
    groups = unsigned(len(b) // LINE)
    for done in range(ONE, groups):
        i = groups - ONE - done
        for c in range(unsigned(RIGHT)):
            entry = b[(i + ONE) * line + unsigned(FROM_RIGHT) + c]
            axpy(b, i * line, entry, upper, (i * unsigned(RIGHT) + c) * line)


@compiled(fastmath=FAST)
def backward_transposed(upper, b):
    """Substitute in place; see :class:`BlockLU`."""
    line = unsigned(LINE)
    for i in range(unsigned(b.shape[1] // LINE) - ONE):
        for c in range(unsigned(RIGHT)):
            column, behind = (i * unsigned(RIGHT) + c) * line, (i + ONE) * line + unsigned(FROM_RIGHT) + c
            for row in range(unsigned(len(b))):
                total = 0.0
                for k in range(line):
                    total += upper[column + k] * b[row, i * line + k]
                b[row, behind] -= total
