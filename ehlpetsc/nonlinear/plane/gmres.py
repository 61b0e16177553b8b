r"""Flexible GMRES of a contact in the plane as PETSc's Python Krylov method, its basis in single precision.

Arnoldi's process by classical Gram and Schmidt, taken again where less than half of a vector's square is left
(PETSc's `refine_ifneeded`), as in :mod:`ehlpetsc.nonlinear.line.gmres`. PETSc's own method stores two vectors
of double precision an iteration, and takes memory for ten at a time: 480 bytes a node from the fourth
iteration on, here 16 in each: stored vectors are rounded to single precision, where the preconditioner is of
single precision. The orthonormal ones are then orthogonal to 1e-7, and the solution, a sum of the others, is
right to that, both far below the tolerance. Vectors that are multiplied or made orthogonal, sums and the
triangular matrix are of double precision.

Use: ``-ksp_type python -ksp_python_type ehlpetsc.nonlinear.plane.gmres.FlexibleGMRES`` (the default).
"""

from __future__ import annotations

import numpy as np
from petsc4py import PETSc

from ehlpetsc.nonlinear.minimum_residual import coefficients, least_residual, numbers_of
from ehlpetsc.nonlinear.options import PRODUCT
from ehlpetsc.nonlinear.plane.jacobian import PlaneJacobian
from ehlpetsc.nonlinear.ranks import global_sum

MAX_IT = 100  # of a solve
BLOCK = 16384  # entries of all vectors that are in the cache at a time


class FlexibleGMRES:
    """Context of PETSc's Python Krylov method."""

    def solve(self, ksp: PETSc.KSP, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Solve from zero."""
        operator: PlaneJacobian = ksp.getOperators()[0].getPythonContext()
        max_it = min(ksp.getTolerances()[-1], MAX_IT)
        w = np.zeros(operator.size)
        w[operator.active] = b.array_r
        basis, numbers = Basis(operator, max_it), numbers_of(max_it)
        for k in range(max_it + 1):
            norm = least_residual(numbers, k, basis.add(w, numbers[0][max(k - 1, 0)]))
            reason = PETSc.KSP.ConvergedReason.DIVERGED_NANORINF  # PETSc refuses nan
            if np.isfinite(norm):
                reason = ksp.callConvergenceTest(k, norm)
            ksp.logConvergenceHistory(norm if np.isfinite(norm) else np.inf)
            ksp.monitor(k, norm if np.isfinite(norm) else np.inf)
            if reason or k == max_it:
                break
            w = None  # freed, and made anew, as the preconditioner takes most memory
            w = self._product(operator, basis.preconditioned(operator))
        ksp.setIterationNumber(k)
        ksp.setResidualNorm(norm if np.isfinite(norm) else np.inf)
        ksp.setConvergedReason(reason or PETSc.KSP.ConvergedReason.DIVERGED_MAX_IT)
        w = None
        x.array[:] = basis.solution(operator, coefficients(numbers, k))[operator.active]

    def _product(self, operator: PlaneJacobian, change: np.ndarray) -> np.ndarray:
        """Product of the Jacobian with a preconditioned vector."""
        out = np.empty(operator.size)
        with PRODUCT:
            operator.product(change, out)
        return out


class Basis:
    """Orthonormal vectors of the local rows, and quantities of each of them preconditioned.

    Memory of a vector is taken when it is written to: that of large arrays is not there before.

    `operator`: of the system. `max_it`: largest number of iterations.
    """

    def __init__(self, operator: PlaneJacobian, max_it: int):
        self.ranks, self.count = operator.ranks, 0
        precision = operator.elimination.precision(operator)
        self.vectors = np.empty((max_it + 1, operator.size), dtype=precision)
        self.changes = np.empty((max_it, operator.size), dtype=precision)

    def add(self, w: np.ndarray, column: np.ndarray) -> float:
        """Make a vector orthonormal to those before and store it; return its norm before it is made one.

        `w`: the vector, overwritten. `column`: filled in: its products with those before.
        """
        column[: self.count] = 0.0
        for _ in range(2):
            *products, square = global_sum(self.ranks, self._products(w))
            left = square
            for k, product in enumerate(products):
                column[k] += product
                left -= product * product
            self._subtract(w, np.array(products))
            if left >= 0.5 * square:
                break
        norm = float(np.sqrt(max(left, 0.0)))
        self.vectors[self.count] = w * (1.0 / norm if norm > 0.0 else 1.0)
        self.count += 1
        return norm

    def _blocks(self) -> list[slice]:
        return [slice(k, k + BLOCK) for k in range(0, self.vectors.shape[1], BLOCK)]

    def _products(self, w: np.ndarray) -> np.ndarray:
        """Local parts of the products of all vectors with another one, and of its square."""
        sums = np.zeros(self.count + 1)
        for block in self._blocks():
            part = w[block]
            sums[:-1] += self.vectors[: self.count, block].astype(np.float64, copy=False) @ part
            sums[-1] += part @ part
        return sums

    def _subtract(self, w: np.ndarray, products: np.ndarray) -> None:
        """Subtract so many times each vector from another one."""
        for block in self._blocks():
            w[block] -= products @ self.vectors[: self.count, block].astype(np.float64, copy=False)

    def preconditioned(self, operator: PlaneJacobian) -> np.ndarray:
        """Last vector with the preconditioner applied, before its quantities are rounded to be stored."""
        last = self.vectors[self.count - 1].astype(np.float64, copy=False)
        change = operator.elimination.solve(operator, last)
        self.changes[self.count - 1] = operator.elimination.take_quantities()
        return change

    def solution(self, operator: PlaneJacobian, factors: np.ndarray) -> np.ndarray:
        """Sum of so many times each of the first preconditioned vectors."""
        out = np.empty(self.changes.shape[1])
        for block in self._blocks():
            out[block] = factors @ self.changes[: len(factors), block].astype(np.float64, copy=False)
        return operator.elimination.unknowns(operator, out)
