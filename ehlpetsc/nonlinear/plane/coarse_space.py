r"""Coarse correction of the pressures of a contact in the plane, for the long waves.

An incomplete factorisation reduces waves of a few nodes; those of pressure ahead of the contact, where the
flow obeys nearly Poisson's equation, and in it, where film and deflection are in balance, take it ever
longer on finer meshes. On bilinear functions P over some nodes the Reynolds rows, with flow :math:`A` and
transport :math:`\Gamma` by the separation, have the matrix

.. math:: P^TAP+(P^T\Gamma P)\,K_c,

K_c the deflection by a function at the coarse nodes: dense, but of some hundred unknowns.
"""

from __future__ import annotations

import warnings

import numpy as np
from mpi4py import MPI
from scipy.linalg import LinAlgWarning, lu_factor, lu_solve
from scipy.sparse import csr_matrix

from ehlpetsc.base.compiled import compiled
from ehlpetsc.discretisation.plane.deflection import Convolution, Transposition
from ehlpetsc.discretisation.unknowns import Share
from ehlpetsc.elasticity.kernel import Kernel
from ehlpetsc.nonlinear.ranks import global_sum

# Between coarse nodes along the longer side of a mesh of up to OF_NODES; on finer ones they grow as the root
# of the nodes: more waves are too long for the incomplete factorisation, and each iteration costs more.
INTERVALS, OF_NODES = 24, 129
BLOCK = 8192  # nodes whose rows are restricted at a time


def linear_functions(n: int, spacing: int, periodic: bool) -> tuple[np.ndarray, np.ndarray, int]:
    """Hat functions over some of n nodes.

    Those of each node, -1: none, and their values there, shape (n, 2); the number of functions.
    """
    i, count = np.arange(n), -(-n // spacing)
    left, t = i // spacing, (i % spacing) / spacing
    right = (left + 1) % count if periodic else left + 1
    inside = right < count
    return np.stack([left, np.where(inside, right, -1)], 1), np.stack([1.0 - t * inside, t], 1), count


class CoarseSpace:
    """Coarse functions and the deflections by them.

    `kernel`: of the deflection at distances 0 .. n - 1 nodes, (n_y, n_x).
    """

    def __init__(self, kernel: np.ndarray, periodic: bool):
        self.shape, self.periodic = kernel.shape, periodic
        longer = max(self.shape)
        intervals = round(INTERVALS * np.sqrt(max(longer / OF_NODES, 1.0)))
        self.spacing = max(-(-longer // intervals), 2)
        n_y, n_x = self.shape
        *self.across, rows = linear_functions(n_y, self.spacing, periodic)
        *self.along, columns = linear_functions(n_x, self.spacing, False)
        self.counts = rows, columns
        deflections = self._deflections(kernel)
        self.deflections = deflections.astype(np.float32)
        self.convolution = Convolution(Kernel(deflections), False, Transposition())

    def reaches(self, mask: np.ndarray) -> bool:
        """Whether a coarse node is in a mask of nodes."""
        return bool(mask.reshape(self.shape)[:: self.spacing, :: self.spacing].any())

    def restricted(self, stencils: np.ndarray, functions: csr_matrix, first: int) -> csr_matrix:
        """Matrix between the coarse functions of rows of coefficients, a block of nodes at a time.

        `stencils`: coefficients of the nodes i-2 .. i+1, below and above, (rows, 6). `first`: node of the
        first row.
        """
        (n_y, n_x), total = self.shape, csr_matrix((functions.shape[1],) * 2, dtype=stencils.dtype)
        for begin in range(0, len(stencils), BLOCK):
            part = stencils[begin : begin + BLOCK]
            i = np.arange(len(part)) + first + begin
            near = np.stack([i - 2, i - 1, i, i + 1, i - n_x, i + n_x], axis=1) % (n_y * n_x)
            of_nodes = part.ravel(), near.ravel(), 6 * np.arange(len(i) + 1)
            matrix = csr_matrix(of_nodes, (len(i), n_y * n_x))
            total += functions[i[0] : i[-1] + 1].T @ (matrix @ functions)
        return total

    def _deflections(self, kernel: np.ndarray) -> np.ndarray:
        """Deflection by a function at distances of coarse nodes, shape of the coarse nodes."""
        (n_y, n_x), d = self.shape, self.spacing
        offset = np.arange(1 - d, d)
        hat = 1.0 - np.abs(offset) / d
        y, x = (np.abs(d * np.arange(count)[:, None] - offset) for count in self.counts)
        y, x = y % n_y if self.periodic else np.minimum(y, n_y - 1), np.minimum(x, n_x - 1)
        by_y = np.einsum("kyx,y->kx", kernel[y.ravel()].reshape(*y.shape, n_x), hat)
        return np.einsum("kmx,x->km", by_y[:, x.ravel()].reshape(len(by_y), *x.shape), hat)

    def deflection(self, kept: np.ndarray, pressures: np.ndarray) -> np.ndarray:
        """Deflections at some coarse nodes by their pressures."""
        of_all = np.zeros(self.counts[0] * self.counts[1], dtype=pressures.dtype)
        of_all[kept] = pressures
        return self.convolution(of_all)[kept]

    def chosen(self, mask: np.ndarray) -> tuple[csr_matrix, np.ndarray]:
        """Functions cut off outside of a mask of nodes, and their coarse nodes.

        Those whose own coarse node is in the mask: cut off more, several may be the same but for a factor.
        """
        of_coarse = mask.reshape(self.shape)[:: self.spacing, :: self.spacing].ravel()
        kept, most = np.flatnonzero(of_coarse), 4 * np.count_nonzero(mask)
        column = np.where(of_coarse, np.cumsum(of_coarse) - 1, -1).astype(np.int32).reshape(self.counts)
        data, columns = np.empty(most, dtype=np.float32), np.empty(most, dtype=np.int32)
        pointers = np.zeros(len(mask) + 1, dtype=np.int32)
        count = cut_off(*self.across, *self.along, mask, column, (data, columns, pointers))
        cut = csr_matrix((data[:count], columns[:count], pointers), (len(mask), len(kept)))
        return cut, kept


@compiled
def cut_off(
    rows: np.ndarray,
    of_rows: np.ndarray,
    columns: np.ndarray,
    of_columns: np.ndarray,
    mask: np.ndarray,
    number: np.ndarray,
    parts: tuple,
) -> int:
    """Values at the nodes of a mask, flat, of products of hat functions, in compressed rows; their number.

    `rows`, `of_rows`; `columns`, `of_columns`: of :func:`linear_functions` across; along.
    `number`: of each product among those wanted, -1: not wanted, shape of the coarse nodes.
    `parts`: filled in: values, numbers, pointers (zeros).
    """
    values, numbers, pointers = parts
    count = 0
    for node in range(len(mask)):
        y, x = node // len(columns), node % len(columns)
        for k in range(4 if mask[node] else 0):
            j, i = rows[y, k // 2], columns[x, k % 2]
            if j >= 0 and i >= 0 and number[j, i] >= 0:
                values[count], numbers[count] = of_rows[y, k // 2] * of_columns[x, k % 2], number[j, i]
                count += 1
        pointers[node + 1] = count
    return count


@compiled
def between(nodes: np.ndarray, n_x: int, deflections: np.ndarray) -> np.ndarray:
    """Deflections of coarse nodes by one another; `n_x`: coarse nodes in a row."""
    y, x, out = nodes // n_x, nodes % n_x, np.empty((len(nodes), len(nodes)), dtype=deflections.dtype)
    for j in range(len(nodes)):
        for i in range(len(nodes)):
            out[j, i] = deflections[abs(y[j] - y[i]), abs(x[j] - x[i])]
    return out


class CoarseCorrection:
    """Correction of Reynolds rows at the nodes of a mask; each rank restricts its own rows. Collective.

    In single precision: on fine meshes the dense matrix takes longer than the sparse form. Its rows differ by
    as many orders of magnitude as viscosity does, the condition may be 1e13, so that pivots are sought among
    them; among columns, as by the factors of the transpose, the correction of extreme loads is of no use.

    `derivatives`: of the local rows by pressure and separation of the nodes i-2 .. i+1, below and above,
        shape (local nodes, 12).
    `share`: of the rank.
    """

    def __init__(
        self, space: CoarseSpace, derivatives: np.ndarray, mask: np.ndarray, share: Share, ranks: MPI.Comm
    ):
        functions, self.kept = space.chosen(mask)
        self.ranks, self.space, self.restriction, self.functions = ranks, space, functions.T, functions
        if share.window_size != len(mask) or ranks.size > 1:
            self.restriction, self.functions = functions[share.local].T, functions[share.window]
        # by pressure and separation: as fast as one of both
        stencils = derivatives.astype(np.float32, copy=False).view(np.complex64)
        both = space.restricted(stencils, functions, share.first)
        matrix = both.imag @ between(self.kept, space.counts[1], space.deflections)
        entries = both.tocoo()
        matrix[entries.row, entries.col] += entries.data.real
        matrix = global_sum(ranks, matrix)
        with warnings.catch_warnings():  # a singular one ends the solve, and the step is halved
            warnings.simplefilter("ignore", LinAlgWarning)
            self.lu = lu_factor(matrix, overwrite_a=True, check_finite=False)

    def __call__(self, rows: np.ndarray) -> np.ndarray:
        """Pressures that reduce local Reynolds rows, and the separations by them, shape (window, 2)."""
        restricted = global_sum(self.ranks, self.restriction @ rows)
        coarse = lu_solve(self.lu, restricted, check_finite=False)
        return self.functions @ np.stack([coarse, self.space.deflection(self.kept, coarse)], axis=1)
