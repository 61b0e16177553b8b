"""Flexible GMRES of a contact in the plane as PETSc's Python Krylov method, with as many vectors as it takes.

Arnoldi's process by classical Gram and Schmidt, taken again where the vectors before take most of a new one
(PETSc's `refine_ifneeded`), so that iterations are those of PETSc's `fgmres`. That takes memory for ten
iterations at a time and keeps it between linear solves: 480 bytes a node from the fourth iteration on. Here
it is 32 bytes a node in each iteration, and none after the solve. There is no restart: at most `MAX_IT`.

Use: ``-ksp_type python -ksp_python_type ehlpetsc.nonlinear.plane.gmres.FlexibleGMRES`` (the default).
"""

from __future__ import annotations

import numpy as np
from petsc4py import PETSc

from ehlpetsc.nonlinear.minimum_residual import coefficients, least_residual, numbers_of

MAX_IT = 100  # of a solve


class FlexibleGMRES:
    """Context of PETSc's Python Krylov method."""

    def solve(self, ksp: PETSc.KSP, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Solve from zero."""
        basis: list[PETSc.Vec] = [b.copy()]
        changes: list[PETSc.Vec] = []
        try:
            iterate(ksp, basis, changes, x)
        finally:  # petsc4py may put off what it destroys by itself
            for vector in (*basis, *changes):
                vector.destroy()


def iterate(ksp: PETSc.KSP, basis: list[PETSc.Vec], changes: list[PETSc.Vec], x: PETSc.Vec) -> None:
    """Solve from zero.

    `basis`: the right-hand side, replaced by orthonormal vectors of the rows.
    `changes`: empty, filled in: each of them preconditioned.
    """
    (operator, _), pc, max_it = ksp.getOperators(), ksp.getPC(), min(ksp.getTolerances()[-1], MAX_IT)
    numbers = numbers_of(max_it)
    for k in range(max_it + 1):
        norm = least_residual(numbers, k, orthonormalise(basis, numbers[0][max(k - 1, 0)]))
        reason = PETSc.KSP.ConvergedReason.DIVERGED_NANORINF
        if np.isfinite(norm):
            reason = ksp.callConvergenceTest(k, norm)
        else:
            norm = np.inf  # PETSc refuses nan
        ksp.logConvergenceHistory(norm)
        ksp.monitor(k, norm)
        if reason or k == max_it:
            break
        changes.append(x.duplicate())
        pc.apply(basis[-1], changes[-1])
        basis.append(x.duplicate())
        operator.mult(changes[-1], basis[-1])
    ksp.setIterationNumber(k)
    ksp.setResidualNorm(norm)
    ksp.setConvergedReason(reason or PETSc.KSP.ConvergedReason.DIVERGED_MAX_IT)
    x.zeroEntries()
    x.maxpy(coefficients(numbers, k), changes)


def orthonormalise(basis: list[PETSc.Vec], column: np.ndarray) -> float:
    """Make the last vector of a basis orthonormal to those before; return its norm before it is made one.

    `column`: filled in: its products with those before.
    """
    *before, w = basis
    column[: len(before)] = 0.0
    norm, products = w.norm(), np.zeros(0)
    for _ in range(2 if before else 0):
        for vector in before:
            w.dotBegin(vector)
        products = np.array([w.dotEnd(vector) for vector in before])  # by one message
        w.maxpy(-products, before)
        column[: len(before)] += products
        norm = w.norm()
        if norm >= np.linalg.norm(products):
            break
    if norm > 0.0:
        w.scale(1.0 / norm)
    return norm
