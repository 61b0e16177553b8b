"""Forward and back substitution with LAPACK's banded factors.

LAPACK's own ``dgbtrs`` calls a routine for every column of the factors; one compiled loop takes six tenths of
its time for one right-hand side or more, and need not begin before the first entry that is not zero.
"""

from ehlpetsc.compiled import compiled


@compiled(fastmath={"contract"})
def substitute(factors, pivots, b, first):
    """Solve in place.

    Parameters
    ----------
    factors : ndarray, shape (order, 3 half + 1)
        Transpose of what ``dgbtrf`` gives for a matrix with as many subdiagonals as superdiagonals.
    pivots : ndarray of int, shape (order,)
    b : ndarray, shape (right-hand sides, order)
    first : int
        Entries of b before this one are zero.
    """
    order, half = factors.shape[0], factors.shape[1] // 3
    for k in range(max(first - half, 0), order):
        pivot, below = pivots[k], min(half, order - 1 - k)
        lower = factors[k, 2 * half + 1 : 2 * half + 1 + below]
        for r in range(len(b)):
            x = b[r]
            value = x[pivot]
            if pivot != k:
                x[pivot], x[k] = x[k], value
            rest = x[k + 1 : k + 1 + below]
            for j in range(below):
                rest[j] -= lower[j] * value
    for k in range(order - 1, -1, -1):
        above = min(2 * half, k)
        upper, inverse = factors[k, 2 * half - above : 2 * half], 1.0 / factors[k, 2 * half]
        for r in range(len(b)):
            x = b[r]
            value = x[k] * inverse
            x[k] = value
            rest = x[k - above : k]
            for j in range(above):
                rest[j] -= upper[j] * value
