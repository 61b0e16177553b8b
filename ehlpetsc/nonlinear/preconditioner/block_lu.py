r"""LU of a block tridiagonal matrix, with dense inverses of what is left of its diagonal blocks.

.. math:: S_i=D_i-L_i\,W_{i-1},\quad W_i=S_i^{-1}U_i,\qquad
   y_i=S_i^{-1}(b_i-L_iy_{i-1}),\quad x_i=y_i-W_ix_{i+1}.

Rows are exchanged within a block alone. L contains some of the unknowns of the group before, U some of the
group behind. A solve is three products of small matrices with vectors in each group, a third of the time of
LAPACK's substitution in a band; the factors take as long as LAPACK's.

Loops count in unsigned numbers or to constants: numba takes twice as long over indices that may be negative,
and over short loops whose length it does not know. It keeps what it compiled as long as this file is as it
was, so the constants stand here.
"""

import numpy as np

from ehlpetsc.compiled import compiled, unsigned

SIZE = 11  # unknowns of a group
LEFT, FROM_LEFT = 9, 2  # unknowns of the group before that the rows contain, and the first of them
RIGHT, FROM_RIGHT = 8, 1  # those of the group behind
WIDTH = LEFT + SIZE + RIGHT
FAST = {"contract", "nsz", "reassoc"}
ONE = unsigned(1)


class BlockLU:
    """Factors of one matrix, and room for them.

    Parameters
    ----------
    groups : int

    Attributes
    ----------
    inverses : ndarray, shape (groups, SIZE, SIZE)
        Of S, transposed.
    spread : ndarray, shape (groups, SIZE, RIGHT)
        W.
    """

    def __init__(self, groups):
        self.inverses, self.spread = np.empty((groups, SIZE, SIZE)), np.empty((groups, SIZE, RIGHT))
        self._work, self._pivot_row = np.empty(SIZE * (SIZE + RIGHT)), np.empty(SIZE + RIGHT)
        self._exchanged = np.empty(SIZE, dtype=unsigned)

    def factor(self, rows):
        """Factor.

        Parameters
        ----------
        rows : ndarray, shape (groups, SIZE, WIDTH)
            What the rows of each group have of the group before, of their own and of the group behind; to be
            left as it is while solves follow. What the first group has of one before and the last of
            one behind is not looked at.
        """
        self._rows = rows
        room = self._work, self._pivot_row, self._exchanged
        factor(rows.ravel(), self.inverses, self.spread, self.spread.ravel(), *room)

    def solve(self, b, first=0):
        """Solve in place for `b` (groups, SIZE), whose groups before `first` are zero."""
        substitute(self._rows, self.inverses, self.spread, b, first)


@compiled(fastmath=FAST)
def take_off(a, i, factor, b, k, count):
    """Take `count` entries of b from the k-th on, times a factor, off those of a from the i-th on."""
    i, k = unsigned(i), unsigned(k)
    for j in range(unsigned(count)):
        a[i + j] -= factor * b[k + j]


@compiled(fastmath=FAST)
def factor(rows, inverses, spread, flat_spread, work, pivot_row, exchanged):
    """Fill in the inverses of S, transposed, and W; see :class:`BlockLU`."""
    size, left, right, columns = unsigned(SIZE), unsigned(LEFT), unsigned(RIGHT), unsigned(SIZE + RIGHT)
    given = unsigned(0)
    for i in range(unsigned(len(inverses))):
        before = ((i - ONE) * size + unsigned(FROM_LEFT)) * right
        for r in range(size):
            here = r * columns
            for c in range(columns):
                work[here + c] = rows[given + left + c]
            if i > 0:
                for k in range(left):
                    entry = rows[given + k]
                    if entry != 0.0:
                        take_off(
                            work, here + unsigned(FROM_RIGHT), entry, flat_spread, before + k * right, right
                        )
            given += left + columns
        eliminate(work, pivot_row, exchanged)
        inverse, part = inverses[i], spread[i]
        for r in range(size):
            for c in range(size):
                inverse[c, r] = work[r * columns + c]
            for c in range(right):
                part[r, c] = work[r * columns + size + c]


@compiled(fastmath=FAST)
def eliminate(a, pivot_row, exchanged):
    """Gauss and Jordan: a square matrix becomes its inverse, the columns beside it what that makes of them.

    A pivot that is zero is taken for one: a preconditioner may be off where the operator is singular, but
    must not be infinite.
    """
    size, width = unsigned(SIZE), unsigned(SIZE + RIGHT)
    for k in range(size):
        pivot, largest = k, abs(a[k * width + k])
        for r in range(k + ONE, size):
            if abs(a[r * width + k]) > largest:
                pivot, largest = r, abs(a[r * width + k])
        exchanged[k] = pivot
        here, there = k * width, pivot * width
        if pivot != k:
            for c in range(width):
                a[here + c], a[there + c] = a[there + c], a[here + c]
        inverse = 1.0 / a[here + k] if largest != 0.0 else 1.0
        a[here + k] = 1.0
        for c in range(width):
            a[here + c] *= inverse
            pivot_row[c] = a[here + c]
        for r in range(size):
            entry = a[r * width + k]
            if r != k and entry != 0.0:
                a[r * width + k] = 0.0
                take_off(a, r * width, entry, pivot_row, 0, width)
    for done in range(size):
        k = size - ONE - done
        other = exchanged[k]
        if other != k:
            for r in range(size):
                o = r * width
                a[o + k], a[o + other] = a[o + other], a[o + k]


@compiled(fastmath=FAST)
def substitute(rows, inverses, spread, b, first):
    """Solve in place; see :class:`BlockLU`."""
    known = np.empty(SIZE)
    for i in range(first, len(b)):
        for k in range(SIZE):
            known[k] = b[i, k]
            if i > first:
                taken = 0.0
                for c in range(LEFT):
                    taken += rows[i, k, c] * b[i - 1, FROM_LEFT + c]
                known[k] -= taken
        for k in range(SIZE):
            b[i, k] = 0.0
        for c in range(SIZE):
            for k in range(SIZE):
                b[i, k] += inverses[i, c, k] * known[c]
    for i in range(len(b) - 2, -1, -1):
        for k in range(SIZE):
            taken = 0.0
            for c in range(RIGHT):
                taken += spread[i, k, c] * b[i + 1, FROM_RIGHT + c]
            b[i, k] -= taken
