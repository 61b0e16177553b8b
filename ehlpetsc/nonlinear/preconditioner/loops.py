"""Compiled loops of the preconditioner over a rank's unknowns."""

from ehlpetsc.compiled import compiled


@compiled
def scatter(places, kept, b, y):
    """Fill in y (1, order): zero but for what stands at some places, ``b[i]`` at ``places[kept[i]]``."""
    y[:] = 0.0
    for i in range(len(kept)):
        y[0, places[kept[i]]] = b[i]


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
        first = second = load = 0.0
        for node in range(dense.shape[1]):
            pressure = y[r, places[2 * node]]
            first += dense[0, node] * pressure
            second += dense[1, node] * pressure
            load += dense[2, node] * pressure
        out[r, len(shown)], out[r, len(shown) + 1], out[r, len(shown) + 2] = first, second, load


@compiled(fastmath={"contract"})
def without(y, places, w, g, out):
    """Fill in the local unknowns of y at their places, less what the unknowns w add by g; changes y.

    Parameters
    ----------
    y : ndarray, shape (order,)
    places : ndarray of int
    w : ndarray, shape (columns,)
    g : ndarray, shape (columns, order)
    out : ndarray
    """
    for k in range(len(w)):
        for j in range(len(y)):
            y[j] -= w[k] * g[k, j]
    for i in range(len(places)):
        out[i] = y[places[i]]


@compiled
def put(entries, places, dropped, diagonal, values):
    """Put rows of entries at their places among values; of a row dropped, a one on its diagonal alone.

    Parameters
    ----------
    entries : ndarray, shape (rows, width)
    places : ndarray of int, shape (rows, width)
    dropped : ndarray of int
    diagonal : int
        Column of the entry on the diagonal.
    values : ndarray
    """
    for i in range(entries.shape[0]):
        for k in range(entries.shape[1]):
            values[places[i, k]] = entries[i, k]
    for i in dropped:
        for k in range(entries.shape[1]):
            values[places[i, k]] = 1.0 if k == diagonal else 0.0


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
