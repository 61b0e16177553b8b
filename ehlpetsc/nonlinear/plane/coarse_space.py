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
from scipy.sparse import csr_matrix, kron

from ehlpetsc.base.compiled import compiled
from ehlpetsc.discretisation.unknowns import Share
from ehlpetsc.nonlinear.ranks import global_sum

# Between coarse nodes along the longer side of a mesh of up to OF_NODES; on finer ones they grow as the root
# of the nodes: more waves are too long for the incomplete factorisation, and each iteration costs more.
INTERVALS, OF_NODES = 24, 129


def linear_functions(n: int, spacing: int, periodic: bool) -> csr_matrix:
    """Values at n nodes of hat functions over some nodes, shape (n, coarse nodes)."""
    i, count = np.arange(n), -(-n // spacing)
    left, t = i // spacing, (i % spacing) / spacing
    right = (left + 1) % count if periodic else left + 1
    inside = right < count
    rows, columns = np.concatenate([i, i[inside]]), np.concatenate([left, right[inside]])
    return csr_matrix((np.concatenate([1.0 - t * inside, t[inside]]), (rows, columns)), (n, count))


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
        across, along = (
            linear_functions(n_y, self.spacing, periodic),
            linear_functions(n_x, self.spacing, False),
        )
        self.functions = kron(across, along).tocsr().astype(np.float32)
        self.counts = across.shape[1], along.shape[1]
        self.deflections = self._deflections(kernel).astype(np.float32)

    def reaches(self, mask: np.ndarray) -> bool:
        """Whether a coarse node is in a mask of nodes."""
        return bool(mask.reshape(self.shape)[:: self.spacing, :: self.spacing].any())

    def matrix(self, stencils: np.ndarray, local: slice) -> csr_matrix:
        """Matrix of rows of coefficients of the nodes i-2 .. i+1, below and above, (local nodes, 6)."""
        (n_y, n_x), i = self.shape, np.arange(local.start, local.stop)
        near = np.stack([i - 2, i - 1, i, i + 1, i - n_x, i + n_x], axis=1) % (n_y * n_x)
        return csr_matrix((stencils.ravel(), near.ravel(), 6 * np.arange(len(i) + 1)), (len(i), n_y * n_x))

    def _deflections(self, kernel: np.ndarray) -> np.ndarray:
        """Deflection by a function at distances of coarse nodes, shape of the coarse nodes."""
        (n_y, n_x), d = self.shape, self.spacing
        offset = np.arange(1 - d, d)
        hat = 1.0 - np.abs(offset) / d
        y, x = (np.abs(d * np.arange(count)[:, None] - offset) for count in self.counts)
        y, x = y % n_y if self.periodic else np.minimum(y, n_y - 1), np.minimum(x, n_x - 1)
        by_y = np.einsum("kyx,y->kx", kernel[y.ravel()].reshape(*y.shape, n_x), hat)
        return np.einsum("kmx,x->km", by_y[:, x.ravel()].reshape(len(by_y), *x.shape), hat)

    def chosen(self, mask: np.ndarray) -> tuple[csr_matrix, np.ndarray]:
        """Functions cut off outside of a mask of nodes, and their deflections K_c.

        Those whose own coarse node is in the mask: cut off more, several may be the same but for a factor.
        """
        of_coarse = mask.reshape(self.shape)[:: self.spacing, :: self.spacing].ravel()
        kept, f = np.flatnonzero(of_coarse), self.functions
        column = np.where(of_coarse, np.cumsum(of_coarse) - 1, -1).astype(np.int32)
        parts = np.empty_like(f.data), np.empty_like(f.indices), np.zeros_like(f.indptr)
        count = cut_off(f.data, f.indices, f.indptr, mask, column, parts)
        data, columns, pointers = parts
        cut = csr_matrix((data[:count], columns[:count], pointers), (len(mask), len(kept)))
        return cut, between(kept, self.counts[1], self.deflections)


@compiled
def cut_off(
    values: np.ndarray,
    indices: np.ndarray,
    pointers: np.ndarray,
    mask: np.ndarray,
    column: np.ndarray,
    parts: tuple,
) -> int:
    """Entries of the rows in a mask whose new `column` is not negative, in compressed rows; their number.

    `parts`: filled in: entries, columns, pointers (zeros).
    """
    new_values, new_columns, new_pointers = parts
    count = 0
    for row in range(len(mask)):
        if mask[row]:
            for k in range(pointers[row], pointers[row + 1]):
                if column[indices[k]] >= 0:
                    new_values[count], new_columns[count] = values[k], column[indices[k]]
                    count += 1
        new_pointers[row + 1] = count
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

    In single precision: on fine meshes the dense matrices take longer than the sparse form.

    `derivatives`: of the local rows by pressure and separation of the nodes i-2 .. i+1, below and above,
        shape (local nodes, 12).
    `share`: of the rank.
    """

    def __init__(
        self, space: CoarseSpace, derivatives: np.ndarray, mask: np.ndarray, share: Share, ranks: MPI.Comm
    ):
        functions, deflections = space.chosen(mask)
        self.ranks, self.restriction = ranks, functions[share.local].T.tocsr()
        self.functions = functions[share.window]
        self.deflections = deflections
        # by pressure and separation: as fast as one of both
        stencils = derivatives.astype(np.float32, copy=False).view(np.complex64)
        both = (self.restriction @ space.matrix(stencils, share.local) @ functions).tocsr()
        matrix = global_sum(ranks, both.real.toarray() + both.imag @ deflections)
        with warnings.catch_warnings():  # a singular one ends the solve, and the step is halved
            warnings.simplefilter("ignore", LinAlgWarning)
            self.lu = lu_factor(matrix, overwrite_a=True, check_finite=False)

    def __call__(self, rows: np.ndarray) -> np.ndarray:
        """Pressures that reduce local Reynolds rows, and the separations by them, shape (window, 2)."""
        restricted = global_sum(self.ranks, self.restriction @ rows)
        coarse = lu_solve(self.lu, restricted, check_finite=False)
        return self.functions @ np.stack([coarse, self.deflections @ coarse], axis=1)
