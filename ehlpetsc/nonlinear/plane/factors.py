r"""Factors of the sparse form of a contact in the plane: incomplete LU, complete LU where that breaks down.

A row of the sparse form has blocks of two unknowns at the nodes i-2 .. i+1, below and above. The incomplete
LU keeps those that two of them bring, ILU(1), and no others: four to the left of the diagonal, four to the
right. As places and order are known, no index is looked up: in single precision it takes an eighth of the
time of PETSc's, and its solution half.
"""

from __future__ import annotations

import numpy as np
from petsc4py import PETSc

from ehlpetsc.base.compiled import compiled, unsigned
from ehlpetsc.discretisation.ehl_problem import EHLProblem
from ehlpetsc.discretisation.finite_volumes import STENCIL
from ehlpetsc.nonlinear.plane.screened_poisson import MIDDLE, UNKNOWNS, pattern
from ehlpetsc.nonlinear.two_fields import owned

# blocks of a row of the incomplete LU, of the nodes i-n_x, i-n_x+1, i-2, i-1, i, i+1, i+n_x-2, i+n_x-1, i+n_x
BELOW, BELOW_RIGHT, SECOND, LAST, DIAGONAL, NEXT, ABOVE_SECOND, ABOVE_LEFT, ABOVE = map(unsigned, range(9))
BLOCKS = 9
OF_STENCIL = (2, 3, 4, 5, 0, 8)  # blocks of the stencil's nodes
OVERLAP = 4  # rows of the neighbouring ranks that a rank factors beside its own
ONE, TWO, SINGLE = unsigned(1), unsigned(2), np.float32(1.0)


class IncompleteLU:
    """ILU(1) of a rank's rows of nodes and `OVERLAP` on either side.

    `n_x`, `nodes`: in a row; in all. `precision`: of the factors.

    `blocks`, `pointers`, `places`: to be filled in, see :func:`.screened_poisson.fill`.
    """

    def __init__(self, n_x: int, nodes: int, precision: type):
        self.n_x = n_x
        self.padded = np.zeros((n_x + nodes, BLOCKS, UNKNOWNS, UNKNOWNS), dtype=precision)
        self.blocks = self.padded[n_x:].reshape(-1, UNKNOWNS, UNKNOWNS)
        self.pointers = BLOCKS * np.arange(nodes + 1, dtype=np.int32)
        self.places = np.tile(np.array(OF_STENCIL, dtype=np.int8), (nodes, 1))
        i, n_y = np.arange(nodes), nodes // n_x
        for k in range(STENCIL):
            x, y = (
                i % n_x + (k - MIDDLE if k < MIDDLE + 2 else 0),
                i // n_x + (2 * k - 9 if k > MIDDLE + 1 else 0),
            )
            self.places[(x < 0) | (x >= n_x) | (y < 0) | (y >= n_y), k] = -1
        self.unknowns = np.zeros((nodes + 2 * n_x, UNKNOWNS), dtype=precision)
        self.b = self.unknowns[n_x:-n_x]

    def factor(self) -> None:
        """Factor the blocks in place."""
        factor_rows(self.padded, self.n_x)

    def solve(self) -> np.ndarray:
        """Unknowns of the nodes, (nodes, 2), for the right-hand side `b`, which they replace."""
        substitute(self.padded, self.n_x, self.unknowns)
        return self.b


@compiled
def block_at(blocks: np.ndarray, i: int, k: int) -> tuple:
    """Entries a, b, c, d of a block ((a, b), (c, d)), which is stored by columns."""
    block = blocks[i, k]
    return block[0, 0], block[1, 0], block[0, 1], block[1, 1]


@compiled
def set_block(blocks: np.ndarray, i: int, k: int, entries: tuple) -> None:
    """Store a block, see :func:`block_at`."""
    block = blocks[i, k]
    block[0, 0], block[1, 0], block[0, 1], block[1, 1] = entries


@compiled
def times(p: tuple, q: tuple) -> tuple:
    """Product of two blocks."""
    (a, b, c, d), (e, f, g, h) = p, q
    return a * e + b * g, a * f + b * h, c * e + d * g, c * f + d * h


@compiled
def less(o: tuple, p: tuple, q: tuple) -> tuple:
    """A block less the product of two others."""
    e, f, g, h = times(p, q)
    return o[0] - e, o[1] - f, o[2] - g, o[3] - h


@compiled
def factor_rows(blocks: np.ndarray, n_x: int) -> None:
    """Factor rows of blocks behind n_x rows of zeros, shape (n_x + nodes, 9, 2, 2), in place.

    Row i less its blocks of the rows to the left of the diagonal times these; on the diagonal the inverse.
    """
    stride = unsigned(n_x)
    for i in range(stride, unsigned(len(blocks))):
        below_right, second = block_at(blocks, i, BELOW_RIGHT), block_at(blocks, i, SECOND)
        last, diagonal = block_at(blocks, i, LAST), block_at(blocks, i, DIAGONAL)
        right, above_second = block_at(blocks, i, NEXT), block_at(blocks, i, ABOVE_SECOND)
        above_left = block_at(blocks, i, ABOVE_LEFT)

        k = i - stride
        factor = times(block_at(blocks, i, BELOW), block_at(blocks, k, DIAGONAL))
        set_block(blocks, i, BELOW, factor)
        below_right = less(below_right, factor, block_at(blocks, k, NEXT))
        second = less(second, factor, block_at(blocks, k, ABOVE_SECOND))
        last = less(last, factor, block_at(blocks, k, ABOVE_LEFT))
        diagonal = less(diagonal, factor, block_at(blocks, k, ABOVE))

        k = i - stride + ONE
        factor = times(below_right, block_at(blocks, k, DIAGONAL))
        set_block(blocks, i, BELOW_RIGHT, factor)
        last = less(last, factor, block_at(blocks, k, ABOVE_SECOND))
        diagonal = less(diagonal, factor, block_at(blocks, k, ABOVE_LEFT))
        right = less(right, factor, block_at(blocks, k, ABOVE))

        k = i - TWO
        factor = times(second, block_at(blocks, k, DIAGONAL))
        set_block(blocks, i, SECOND, factor)
        last = less(last, factor, block_at(blocks, k, NEXT))
        above_second = less(above_second, factor, block_at(blocks, k, ABOVE))

        k = i - ONE
        factor = times(last, block_at(blocks, k, DIAGONAL))
        set_block(blocks, i, LAST, factor)
        diagonal = less(diagonal, factor, block_at(blocks, k, NEXT))
        above_second = less(above_second, factor, block_at(blocks, k, ABOVE_LEFT))
        above_left = less(above_left, factor, block_at(blocks, k, ABOVE))

        a, b, c, d = diagonal
        by = SINGLE / (a * d - b * c)
        set_block(blocks, i, DIAGONAL, (d * by, -b * by, -c * by, a * by))
        set_block(blocks, i, NEXT, right)
        set_block(blocks, i, ABOVE_SECOND, above_second)
        set_block(blocks, i, ABOVE_LEFT, above_left)


@compiled
def subtract(blocks: np.ndarray, i: int, k: int, x: np.ndarray, j: int, left: tuple) -> tuple:
    """Two entries less a block times the unknowns of a node."""
    (a, b, c, d), u, v = block_at(blocks, i, k), x[j, 0], x[j, 1]
    return left[0] - a * u - b * v, left[1] - c * u - d * v


@compiled
def substitute(blocks: np.ndarray, n_x: int, x: np.ndarray) -> None:
    """Solve in place; `x`: of n_x nodes of zeros before and behind those of the rows."""
    stride, end = unsigned(n_x), unsigned(len(blocks))
    for i in range(stride, end):
        left = x[i, 0], x[i, 1]
        left = subtract(blocks, i, BELOW, x, i - stride, left)
        left = subtract(blocks, i, BELOW_RIGHT, x, i - stride + ONE, left)
        left = subtract(blocks, i, SECOND, x, i - TWO, left)
        x[i, 0], x[i, 1] = subtract(blocks, i, LAST, x, i - ONE, left)
    for back in range(unsigned(len(blocks) - n_x)):
        i = end - ONE - back
        left = x[i, 0], x[i, 1]
        left = subtract(blocks, i, ABOVE, x, i + stride, left)
        left = subtract(blocks, i, ABOVE_LEFT, x, i + stride - ONE, left)
        left = subtract(blocks, i, ABOVE_SECOND, x, i + stride - TWO, left)
        u, v = subtract(blocks, i, NEXT, x, i + ONE, left)
        a, b, c, d = block_at(blocks, i, DIAGONAL)
        x[i, 0], x[i, 1] = a * u + b * v, c * u + d * v


class CompleteLU:
    """LU of the assembled matrix by PETSc, on several ranks by MUMPS."""

    def __init__(self, problem: EHLProblem, comm: PETSc.Comm):
        local, block = problem.local, UNKNOWNS
        self.pointers = np.empty(local + 1, dtype=np.int32)
        self.places = np.empty((local, STENCIL), dtype=np.int8)
        columns = np.empty(local * STENCIL, dtype=np.int32)
        mesh = problem.grid.shape[-1], problem.n, problem.grid.periodic
        count = pattern(mesh, problem.first, problem.last, self.pointers, columns, self.places)
        self.columns = columns[:count]
        sizes = block * local, block * problem.n
        self.matrix = PETSc.Mat().createBAIJ(
            (sizes, sizes), block, csr=(self.pointers, self.columns), comm=comm
        )
        self.matrix.setOption(PETSc.Mat.Option.ROW_ORIENTED, False)
        self.pc = PETSc.PC().create(comm)
        self.pc.setOperators(self.matrix)
        self.pc.setType("lu")
        self.pc.setFactorSolverType("petsc" if comm.size == 1 else "mumps")
        self.right, self.left = self.matrix.createVecs()
        self._petsc_objects = owned(self, self.matrix, self.pc, self.right, self.left)
        self.b = self.right.array.reshape(local, block)
        self.blocks = np.empty((count, block, block))

    def factor(self) -> None:
        """Factor the blocks."""
        self.matrix.setValuesBlockedCSR(self.pointers, self.columns, self.blocks)
        self.matrix.assemble()
        self.pc.setUp()

    def solve(self) -> np.ndarray:
        """Unknowns of the local nodes, (nodes, 2), for the right-hand side `b`."""
        self.pc.apply(self.right, self.left)
        return self.left.array_r.reshape(-1, UNKNOWNS)
