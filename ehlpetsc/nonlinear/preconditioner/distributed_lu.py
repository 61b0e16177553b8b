r"""LU of the band of :mod:`.banded_jacobian` on one or several ranks, and of what borders the band.

The first rank eliminates its groups from the left end of the mesh towards the cut, the last one from the
right end (twisted factorisation, :mod:`.block_lu`): what is left at the cut couples the outer groups alone,

.. math:: x_i=y_i-W_ix_{i+1}.

Ranks between have two cuts; they solve for the columns :math:`G=A^{-1}C` of what their outer groups take of
others (Polizzi & Sameh 2006: SPIKE), :math:`x=y-Gw`. The unknowns w at the cuts obey :mod:`.reduced_system`.

Three dense rows d border the band: the whole deflection of both end nodes, and the load. They enter by two
columns :math:`z=A^{-1}e`, e the rows of the end nodes, and a system of three unknowns: what the band lacks of
both rows, and h00. The products :math:`d\cdot x=U^{-T}d\cdot y` need no substitution before, so that ranks
exchange them with the values at the cuts: once a solve.
"""

import numpy as np
from scipy.linalg.lapack import dgetrf, dgetrs

from ehlpetsc.compiled import compiled, unsigned
from ehlpetsc.discretisation.finite_volumes import STENCIL
from ehlpetsc.nonlinear.collectives import all_ranks, exchange
from ehlpetsc.nonlinear.preconditioner.block_lu import AT_LEFT, AT_RIGHT, CUT, FAST, LEFT, LINE, SIZE, BlockLU
from ehlpetsc.nonlinear.preconditioner.reduced_system import BORDER, ReducedSystem, regularise_pivots

CLOSE = 0.1  # of a Reynolds row's largest entry: smaller changes cost a fraction of a Krylov iteration
IDENTITY = np.eye(BORDER)
ENTRIES = 2 * STENCIL  # of a Reynolds row


class DistributedLU:
    """Factors and solves.

    Parameters
    ----------
    band : banded_jacobian.BandedJacobian
        Of the nodes of this rank.
    approach_coefficient : float
        Of h00 in the deflection rows of the end nodes.
    ranks : mpi4py communicator
    """

    def __init__(self, band, approach_coefficient, ranks):
        self.band, self.ranks = band, ranks
        self._approach_coefficient = approach_coefficient
        self._lu = BlockLU(band.groups)
        is_inner = 0 < ranks.rank < ranks.size - 1
        self._is_outer = ranks.size > 1 and not is_inner
        self._y, self._ends = np.zeros(band.size), np.zeros((2, band.size))
        first, last = band.end_groups
        self._interface = np.concatenate([first[AT_LEFT], last[AT_RIGHT]]) if is_inner else last[AT_RIGHT]
        self._in_mesh_order = slice(None, None, -1 if band.is_mirrored else 1)  # the last rank counts back
        self._interface = self._interface[self._in_mesh_order]
        self._reduced = ReducedSystem(LEFT, CUT - LEFT, ranks.rank, ranks.size)
        self._everyone, self._g = np.zeros((ranks.size, CUT + BORDER)), np.zeros((0, LINE))
        self._rows = self._reduced.rows_of_inverse([])  # of one rank
        self._factored = None

    def factor(self, entries, inactive_nodes, anew=True):
        """Factor for one state; unless `anew`, not where the last factors are nearly its own; collective.

        Other arguments as of :meth:`.banded_jacobian.BandedJacobian.fill`.
        """
        if not anew and all_ranks(self.ranks, self._is_still_good(entries, inactive_nodes)):
            return
        self._factored = inactive_nodes, entries.reynolds_derivatives
        columns = self.band.fill(entries, inactive_nodes)
        self._lu.factor(columns)
        self._dense = self.band.dense
        if self._is_outer:
            self._dense = self._dense.copy()
            for row in self._dense:
                self._lu.backward_transposed(row)
        if self.ranks.size > 1:
            self._factor_interface(columns[0, :LEFT], columns[-1, LEFT + SIZE :])
        self._factor_border()

    def _factor_interface(self, left, right):
        """G of an inner rank, or W of the group at the cut of an outer one; and the reduced system."""
        if self._is_outer:
            self._g = self._lu.upper[-1][self._in_mesh_order]
        else:
            g = np.zeros((CUT, self.band.groups, LINE))
            g[:LEFT, 0], g[LEFT:, -1] = left, right
            self._g = g.reshape(CUT, -1)
            for k, column in enumerate(self._g):
                self._lu.solve(column, 0 if k < LEFT else self.band.groups - 1)
        taken, width = self._g.shape
        values = np.zeros((self.ranks.size, CUT + BORDER, CUT))
        mine = values[self.ranks.rank]
        mine[:taken, :taken] = self._g[:, self._interface - self.band.size + width]
        mine[CUT:, :taken] = self._dense[:, -width:] @ self._g.T
        exchange(self.ranks, values)
        self._rows = self._reduced.rows_of_inverse(values)

    def _factor_border(self):
        band, c = self.band, self._approach_coefficient
        matrix = np.array([[1.0, 0.0, -c], [0.0, 1.0, -c], [0.0, 0.0, 0.0]])
        self._ends[:] = 0.0
        for k, (rank, dof) in enumerate(((0, band.dofs[0]), (self.ranks.size - 1, band.dofs[-2]))):
            first = band.groups
            if self.ranks.rank == rank:
                self._ends[k, dof], first = 1.0, dof // LINE
            matrix[:, k] += self._solve_band(self._ends[k], first)
        lu, pivots, singular = dgetrf(matrix)
        if singular:
            regularise_pivots(np.einsum("ii->i", lu))
        self._border_inverse = np.ascontiguousarray(dgetrs(lu, pivots, IDENTITY)[0])

    def _solve_band(self, y, first=0, load=0.0):
        """Solve in place for y, zero before group `first`; collective.

        Returns
        -------
        ndarray, shape (BORDER,)
            Products of the dense rows with the solution, of the last one less `load`.
        """
        self._lu.forward(y, first)
        if not self._is_outer:
            self._lu.backward(y)
        mine, (taken, width) = self._everyone[self.ranks.rank], self._g.shape
        np.dot(self._dense, y, out=mine[CUT:])
        mine[-1] -= load
        if taken:
            mine[: len(self._interface)] = y[self._interface]
            exchange(self.ranks, self._everyone)
        w = self._rows @ self._everyone.ravel()
        if taken:
            y[-width:] -= w[:taken] @ self._g
        if self._is_outer:
            self._lu.backward(y)
        return w[taken:]

    def _is_still_good(self, entries, inactive_nodes):
        """Whether the factors of this rank are nearly those of the given state."""
        before, rows = self._factored
        return (
            np.array_equal(inactive_nodes, before)
            and entries.same_deflection(self.band.entries)
            and is_close(entries.reynolds_derivatives, rows, CLOSE)
        )

    def solve(self, b, unknowns, solution):
        """Fill in the solution of the local (q, h, q, h, ...), and h00 on the last rank; collective.

        Parameters
        ----------
        b : ndarray
            Right-hand side, zero in the rows that are not in the system.
        unknowns : ndarray, shape (nodes, 2, 2)
            By both unknowns of the band at each node, those of the solution.
        solution : ndarray
        """
        y, dofs = self._y, self.band.dofs
        scatter(dofs, b, y)
        sums = self._solve_band(y, 0, b[-1] if len(b) > len(dofs) else 0.0)
        combine(y, self._ends, self._border_inverse, sums, dofs, unknowns, solution)


@compiled
def scatter(dofs, b, y):
    """Fill in y: zero, but `b` at `dofs`."""
    y[:] = 0.0
    for i in range(len(dofs)):
        y[dofs[i]] = b[i]


@compiled(fastmath=FAST)
def combine(y, ends, border_inverse, sums, dofs, unknowns, solution):
    """Fill in the solution from those of the band and of the border."""
    first = last = approach = 0.0
    for k in range(BORDER):
        first += border_inverse[0, k] * sums[k]
        last += border_inverse[1, k] * sums[k]
        approach += border_inverse[2, k] * sums[k]
    for i in range(len(unknowns)):
        k, m = dofs[2 * i], dofs[2 * i + 1]
        one = y[k] - first * ends[0, k] - last * ends[1, k]
        two = y[m] - first * ends[0, m] - last * ends[1, m]
        solution[2 * i] = unknowns[i, 0, 0] * one + unknowns[i, 0, 1] * two
        solution[2 * i + 1] = unknowns[i, 1, 0] * one + unknowns[i, 1, 1] * two
    if len(solution) > len(dofs):
        solution[-1] = approach


@compiled
def is_close(derivatives, before, tolerance):
    """Whether no entry is off by more than a fraction of the largest one of its row."""
    for i in range(unsigned(len(before))):
        largest = change = 0.0
        for k in range(unsigned(ENTRIES)):
            largest = max(largest, abs(before[i, k]))
            change = max(change, abs(derivatives[i, k] - before[i, k]))
        if not change <= tolerance * largest:
            return False
    return True
