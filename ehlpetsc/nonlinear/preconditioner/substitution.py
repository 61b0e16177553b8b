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


@compiled(fastmath={"contract"})
def solve_scattered(factors, pivots, places, kept, b, y):
    """Solve for one right-hand side that stands at some places and is zero elsewhere.

    Parameters
    ----------
    factors, pivots
        As of :func:`substitute`.
    places, kept : ndarray of int
        ``b[i]`` stands at ``places[kept[i]]``.
    b : ndarray
    y : ndarray, shape (1, order)
        Filled in.
    """
    y[:] = 0.0
    for i in range(len(kept)):
        y[0, places[kept[i]]] = b[i]
    substitute(factors, pivots, y, 0)


@compiled
def tips(y, shown, places, dense, out):
    """Fill in what the small system needs of local solutions.

    Parameters
    ----------
    y : ndarray, shape (solutions, order)
    shown : ndarray of int
        Places of the unknowns that other ranks take.
    places : ndarray of int
        Of the local unknowns, two a node.
    dense : ndarray, shape (3, nodes)
        Dense rows under the first unknowns.
    out : ndarray, shape (solutions, shown + 3)
    """
    for r in range(len(y)):
        for j in range(len(shown)):
            out[r, j] = y[r, shown[j]]
        for k in range(len(dense)):
            total = 0.0
            for node in range(dense.shape[1]):
                total += dense[k, node] * y[r, places[2 * node]]
            out[r, len(shown) + k] = total


@compiled
def without(y, places, w, spread, out):
    """Fill in the local unknowns of y at their places, less what the unknowns w add through `spread`."""
    for i in range(len(places)):
        value = y[places[i]]
        for k in range(len(w)):
            value -= w[k] * spread[k, i]
        out[i] = value


@compiled
def is_close(derivatives, held, share):
    """Whether no entry is off by more than a share of the largest one of its row."""
    for i in range(len(held)):
        largest = 0.0
        for k in range(held.shape[1]):
            largest = max(largest, abs(held[i, k]))
        for k in range(held.shape[1]):
            if not abs(derivatives[i, k] - held[i, k]) <= share * largest:
                return False
    return True
