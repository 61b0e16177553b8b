r"""LU of the band of :mod:`.banded_jacobian`, split between ranks.

Each rank factors the part A of its own groups (:mod:`.block_lu`). What couples the parts, and what borders
the band, enters through few unknowns w (Polizzi & Sameh 2006: SPIKE),

.. math:: y = A^{-1}b - G\,w,

what the other side of a cut takes of the groups beside it, for both ends of the mesh what the band lacks of
their deflection, and h00. The columns of G are solved for with every matrix; w obeys a small system
(:mod:`.reduced_system`).
"""

import numpy as np

from ehlpetsc.compiled import compiled
from ehlpetsc.nonlinear.halo_exchange import all_ranks
from ehlpetsc.nonlinear.preconditioner.block_lu import FROM_LEFT, FROM_RIGHT, LEFT, LINE, RIGHT, SIZE, BlockLU
from ehlpetsc.nonlinear.preconditioner.reduced_system import BORDER, ReducedSystem

CLOSE = 0.1  # of a Reynolds row's largest entry: smaller changes cost a fraction of a Krylov iteration


class SpikeLU:
    """Factors and solves.

    Parameters
    ----------
    band : banded_jacobian.BandedJacobian
        Of this rank's nodes.
    end_scale : float
        What h00 counts in the end nodes' deflection rows, negative.
    ranks : mpi4py communicator
    """

    def __init__(self, band, end_scale, ranks):
        self.band, self.ranks = band, ranks
        self.lu = BlockLU(band.groups)
        self.reduced = ReducedSystem(LEFT, RIGHT, ranks.rank, ranks.size, end_scale)
        first, last = band.at_ends
        self.shown = np.concatenate([first[FROM_RIGHT : FROM_RIGHT + RIGHT], last[FROM_LEFT:SIZE]])
        self.tips_of_g = np.zeros((self.reduced.widest, len(self.shown) + BORDER))
        self.y, self.tips = np.zeros((1, band.order)), np.zeros((1, len(self.shown) + BORDER))

    def factor(self, entries, dropped, anew=True):
        """Factor for one state; unless `anew`, not where the last factors are nearly its own; collective.

        Other arguments as of :meth:`.banded_jacobian.BandedJacobian.fill`.
        """
        if not anew and all_ranks(self.ranks, self._still_good(entries, dropped)):
            return
        self.factored = dropped, entries.reynolds_derivatives
        e = self.band
        columns = e.fill(entries, dropped)
        self.lu.factor(columns)
        g = self._columns(columns[0, :LEFT], columns[-1, LEFT + SIZE :])
        tips(g, self.shown, e.place, e.dense, self.tips_of_g[: len(g)])
        self.coupling = self.reduced.rows_of_inverse(self._everyone(self.tips_of_g))
        self.g = g

    def _columns(self, left, right):
        """G of this rank, from what its outer groups take from their neighbours, or from the mesh's ends."""
        e = self.band
        first, last = e.at_ends
        if self.ranks.rank == 0:
            left = (first == e.place[0])[None]
        if self.ranks.rank == self.ranks.size - 1:
            right = (last == e.place[-2])[None]
        g = np.zeros((len(left) + len(right), e.groups, LINE))
        g[: len(left), 0], g[len(left) :, -1] = left, right
        for k, column in enumerate(g):
            self.lu.solve(column, 0 if k < len(left) else e.groups - 1)
        return g.reshape(len(g), -1)

    def _still_good(self, entries, dropped):
        """Whether this rank's factors are nearly those of the given state."""
        held, rows = self.factored
        return (
            np.array_equal(dropped, held)
            and entries.same_deflection(self.band.entries)
            and is_close(entries.reynolds_derivatives, rows, CLOSE)
        )

    def _everyone(self, mine):
        """The same array of every rank."""
        if self.ranks.size == 1:
            return mine[None]
        gathered = np.empty((self.ranks.size, *mine.shape))
        self.ranks.Allgather(mine, gathered)
        return gathered

    def solve(self, b, kept, load):
        """Solution of the local (q, h, q, h, ...), shape (2 nodes,), and h00; collective.

        Parameters
        ----------
        b : ndarray
            Right-hand side of the rows `kept` (of 2 nodes); that of all others is zero.
        kept : ndarray of int
        load : float
            Right-hand side of the load's row, where it is local.
        """
        e, y, mine = self.band, self.y, self.tips
        scatter(e.place, kept, b, y)
        self.lu.solve(y.reshape(e.groups, LINE))
        tips(y, self.shown, e.place, e.dense, mine)
        mine[0, -1] -= load
        w = self.coupling @ self._everyone(mine[0]).ravel()
        return (y[0] - w[:-1] @ self.g).take(e.place), w[-1]


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
