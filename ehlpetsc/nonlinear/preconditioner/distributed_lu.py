r"""LU of the band of :mod:`.banded_jacobian` on one or several ranks, and of what borders the band.

The first rank eliminates its groups from the left end of the mesh towards the cut, the last one from the
right end (twisted factorisation, :mod:`.block_lu`): what is left at the cut couples the outer groups alone,

.. math:: x_i=y_i-W_ix_{i+1}.

Ranks between have two cuts; they solve for the columns :math:`G=A^{-1}C` of what their outer groups take of
others (Polizzi & Sameh 2006: SPIKE), :math:`x=y-Gw`. The unknowns w at the cuts obey :mod:`.reduced_system`.

Three dense rows border the band: the whole deflection of both end nodes, and the load. They enter by two
columns :math:`z=A^{-1}e`, e the rows of the end nodes, and a system of three unknowns: what the band lacks of
both rows, and h00.
"""

import numpy as np
from scipy.linalg.lapack import dgetrf, dgetrs

from ehlpetsc.compiled import compiled
from ehlpetsc.nonlinear.halo_exchange import all_ranks
from ehlpetsc.nonlinear.preconditioner.block_lu import FROM_LEFT, FROM_RIGHT, LEFT, LINE, RIGHT, SIZE, BlockLU
from ehlpetsc.nonlinear.preconditioner.reduced_system import ReducedSystem, regularise_pivots

CLOSE = 0.1  # of a Reynolds row's largest entry: smaller changes cost a fraction of a Krylov iteration
BORDER = 3


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
        self._is_inner = 0 < ranks.rank < ranks.size - 1
        self._y = np.zeros((1, band.size))
        self._ends = np.zeros((2, band.size))
        self._factored = None
        if ranks.size > 1:
            first, last = band.end_groups
            self._interface = last[FROM_LEFT:SIZE]
            if self._is_inner:
                self._interface = np.concatenate([first[FROM_RIGHT : FROM_RIGHT + RIGHT], self._interface])
            self._reduced = ReducedSystem(LEFT, RIGHT, ranks.rank, ranks.size)

    def factor(self, entries, inactive_nodes, anew=True):
        """Factor for one state; unless `anew`, not where the last factors are nearly its own; collective.

        Other arguments as of :meth:`.banded_jacobian.BandedJacobian.fill`.
        """
        if not anew and all_ranks(self.ranks, self._is_still_good(entries, inactive_nodes)):
            return
        self._factored = inactive_nodes, entries.reynolds_derivatives
        columns = self.band.fill(entries, inactive_nodes)
        self._lu.factor(columns)
        if self.ranks.size > 1:
            self._factor_interface(columns[0, :LEFT], columns[-1, LEFT + SIZE :])
        self._factor_border()

    def _factor_interface(self, left, right):
        """G of an inner rank, or W of the group at the cut of an outer one; and the reduced system."""
        if self._is_inner:
            g = np.zeros((LEFT + RIGHT, self.band.groups, LINE))
            g[:LEFT, 0], g[LEFT:, -1] = left, right
            for k, column in enumerate(g):
                self._lu.solve(column, 0 if k < LEFT else self.band.groups - 1)
            self._g = g.reshape(len(g), -1)
            at_cuts = self._g[:, self._interface]
        else:
            self._g = self._lu.upper[-1]
            at_cuts = self._in_mesh_order(self._g[:, FROM_LEFT:SIZE])
        values = np.zeros((LEFT + RIGHT, LEFT + RIGHT))
        values[: len(at_cuts), : len(at_cuts)] = at_cuts
        self._reduced_inverse = self._reduced.rows_of_inverse(self._gather(values))

    def _in_mesh_order(self, values):
        """Values at a cut of this rank, from left to right or back; the last rank counts from the right."""
        return np.flip(values) if self.band.is_mirrored else values

    def _gather(self, mine):
        gathered = np.empty((self.ranks.size, *mine.shape))
        self.ranks.Allgather(np.ascontiguousarray(mine), gathered)
        return gathered

    def _solve_band(self, y, *firsts):
        """Solve in place for right-hand sides (k, size), each zero before its first group; collective."""
        sides = y.reshape(len(y), self.band.groups, LINE)
        for side, first in zip(sides, firsts, strict=True):
            self._lu.forward(side, first)
            if self._is_inner:
                self._lu.backward(side)
        if self.ranks.size > 1:
            values = np.zeros((len(y), LEFT + RIGHT))
            for row, side in zip(values, y, strict=True):
                row[: len(self._interface)] = self._in_mesh_order(side[self._interface])
            w = self._reduced_inverse @ self._gather(values).transpose(0, 2, 1).reshape(-1, len(y))
            for side, of_side in zip(y, w.T, strict=True):
                if self._is_inner:
                    side -= of_side @ self._g
                else:
                    side[-LINE:] -= self._in_mesh_order(of_side) @ self._g
        if not self._is_inner:
            for side in sides:
                self._lu.backward(side)

    def _factor_border(self):
        band, z, c = self.band, self._ends, self._approach_coefficient
        z[:] = 0.0
        firsts = [band.groups, band.groups]
        for column, is_here, dof in (
            (0, self.ranks.rank == 0, band.dofs[0]),
            (1, self.ranks.rank == self.ranks.size - 1, band.dofs[-2]),
        ):
            if is_here:
                z[column, dof], firsts[column] = 1.0, dof // LINE
        self._solve_band(z, *firsts)
        matrix = np.array([[1.0, 0.0, -c], [0.0, 1.0, -c], [0.0, 0.0, 0.0]])
        matrix[:, :2] += self._border_sums(z).T
        lu, pivots, singular = dgetrf(matrix)
        if singular:
            regularise_pivots(np.einsum("ii->i", lu))
        self._border_inverse = dgetrs(lu, pivots, np.eye(BORDER))[0]

    def _border_sums(self, y, load=0.0):
        """Products of the dense rows with solutions (k, size) less the load, over all ranks, shape (k, 3)."""
        sums = np.empty((len(y), BORDER))
        border_sums(y, self.band.dofs, self.band.dense, load, sums)
        return sums if self.ranks.size == 1 else self._gather(sums).sum(axis=0)

    def _is_still_good(self, entries, inactive_nodes):
        """Whether the factors of this rank are nearly those of the given state."""
        before, rows = self._factored
        return (
            np.array_equal(inactive_nodes, before)
            and entries.same_deflection(self.band.entries)
            and is_close(entries.reynolds_derivatives, rows, CLOSE)
        )

    def solve(self, b, active_dofs, load):
        """Solution of the local (q, h, q, h, ...), shape (2 nodes,), and h00; collective.

        Parameters
        ----------
        b : ndarray
            Right-hand side of the rows `active_dofs` (of 2 nodes); that of all others is zero.
        active_dofs : ndarray of int
        load : float
            Right-hand side of the load's row on the rank that has it, else 0.
        """
        y, dofs = self._y, self.band.dofs
        scatter(dofs, active_dofs, b, y)
        self._solve_band(y, 0)
        first, last, approach = self._border_inverse @ self._border_sums(y, load)[0]
        solution = np.empty(len(dofs))
        combine(y, self._ends, first, last, dofs, solution)
        return solution, approach


@compiled
def scatter(dofs, active_dofs, b, y):
    """Fill in y (1, size): zero, but ``b[i]`` at ``dofs[active_dofs[i]]``."""
    y[:] = 0.0
    for i in range(len(active_dofs)):
        y[0, dofs[active_dofs[i]]] = b[i]


@compiled
def combine(y, ends, first, last, dofs, solution):
    """Fill in the solution with ``y - first * ends[0] - last * ends[1]`` at `dofs`."""
    for i in range(len(dofs)):
        k = dofs[i]
        solution[i] = y[0, k] - first * ends[0, k] - last * ends[1, k]


@compiled
def border_sums(y, dofs, dense, right, sums):
    """Products of the dense rows with solutions; of the last one less `right`.

    Parameters
    ----------
    y : ndarray, shape (k, size)
    dofs : ndarray of int, shape (2 nodes,)
    dense : ndarray, shape (3, nodes)
        Coefficients of the first unknowns.
    sums : ndarray, shape (k, 3)
    """
    for r in range(len(y)):
        first = second = load = 0.0
        for node in range(dense.shape[1]):
            pressure = y[r, dofs[2 * node]]
            first += dense[0, node] * pressure
            second += dense[1, node] * pressure
            load += dense[2, node] * pressure
        sums[r, 0], sums[r, 1], sums[r, 2] = first, second, load - right


@compiled
def is_close(derivatives, before, tolerance):
    """Whether no entry is off by more than a fraction of the largest one of its row."""
    for i in range(len(before)):
        largest = 0.0
        for k in range(before.shape[1]):
            largest = max(largest, abs(before[i, k]))
        for k in range(before.shape[1]):
            if not abs(derivatives[i, k] - before[i, k]) <= tolerance * largest:
                return False
    return True
