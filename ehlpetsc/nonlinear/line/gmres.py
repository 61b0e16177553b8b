r"""Flexible GMRES as PETSc's Python Krylov method: as PETSc's own, with half its messages and calls.

Arnoldi's process by classical Gram and Schmidt (Saad 1993),

.. math:: z_k=M^{-1}v_k,\qquad
   w=Az_k,\qquad h_i=v_i\cdot w,\qquad
   h_{k+1}^2=w\cdot w-\sum_ih_i^2,

so that one sum over the ranks gives the products with all vectors and the norm of the next one, where PETSc
takes two; it is taken again where the norm cancels. Vectors are those of the whole system; entries that an
active set leaves out are zero. Tolerances, convergence test and monitors are PETSc's. There is no restart: at
most `MAX_IT`. All iterations of a solve are one compiled call.

Use: ``-ksp_type python -ksp_python_type ehlpetsc.nonlinear.line.gmres.FlexibleGMRES`` (the default), on
matrices and with the preconditioner of this program.
"""

from __future__ import annotations

import numpy as np
from petsc4py import PETSc

from ehlpetsc.base.compiled import ZERO, compiled
from ehlpetsc.nonlinear.line.distributed_lu import solve
from ehlpetsc.nonlinear.line.exchange import exchange
from ehlpetsc.nonlinear.line.jacobian import jacobian_product
from ehlpetsc.nonlinear.minimum_residual import coefficients, least_residual, numbers_of

MAX_IT = 100  # of a solve
CANCELLED = 1e-8  # of the square of a norm: what is left of it by differences is right to as many digits


class FlexibleGMRES:
    """Context of PETSc's Python Krylov method."""

    def solve(self, ksp: PETSc.KSP, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Solve from zero."""
        operator, (*tolerances, max_it) = ksp.getOperators()[0].getPythonContext(), ksp.getTolerances()
        lu, limits = operator.factors.lu, (min(max_it, MAX_IT), *tolerances)
        solution = np.zeros(operator.size)
        solution[operator.active] = b.array_r
        norms = iterations(solution, *operator.linearisation, *operator.halo[1:], *lu.factors, limits)
        for k, norm in enumerate(norms.tolist()):
            if not np.isfinite(norm):
                norm, reason = np.inf, PETSc.KSP.ConvergedReason.DIVERGED_NANORINF  # PETSc refuses nan
            else:
                reason = ksp.callConvergenceTest(k, norm)
            ksp.logConvergenceHistory(norm)
            ksp.monitor(k, norm)
        ksp.setIterationNumber(len(norms) - 1)
        ksp.setResidualNorm(norm)
        ksp.setConvergedReason(reason or PETSc.KSP.ConvergedReason.DIVERGED_MAX_IT)
        x.array[:] = solution[operator.active]


@compiled
def iterations(
    b: np.ndarray,
    state: tuple,
    work: tuple,
    buffers: tuple,
    matrices: tuple,
    pressures: tuple,
    place: tuple,
    lu: tuple,
    cuts: tuple,
    border: tuple,
    room: tuple,
    limits: tuple,
) -> np.ndarray:
    """Replace the right-hand side b by the solution to PETSc's tolerances; collective.

    `state`, `work`: as of :func:`.jacobian.jacobian_product`.
    `buffers`, `matrices`, `pressures`: of a `Halo`.
    `place`, `lu`, `cuts`, `border`, `room`: `factors` of a `DistributedLU`; one by one, see
        :func:`.exchange.collective`.
    `limits`: iterations, relative and absolute tolerance, divergence tolerance.

    Returns the norms of the residual, from that of the right-hand side on.
    """
    (collective, rank, _), (max_it, rtol, atol, divtol) = place, limits
    halo, factors = ((collective, rank), buffers, matrices, pressures), (place, lu, cuts, border, room)
    v, z, norms = np.empty((max_it + 1, len(b))), np.empty((max_it, len(b))), np.zeros(max_it + 1)
    sums = np.zeros((len(buffers[1]), MAX_IT + 2))  # products of the vectors, local parts of each rank
    numbers = numbers_of(max_it)
    v[0] = b
    new = ZERO
    while True:
        if new > 0:
            solve(factors, v[new - 1], z[new - 1])
            jacobian_product(state, work, halo, z[new - 1], v[new])
        norm = orthonormalise(v, new, numbers[0][max(new - 1, 0)], sums, rank, collective)
        norms[new] = least_residual(numbers, new, norm)
        if norms[new] <= max(rtol * norms[0], atol) or not norms[new] < divtol * norms[0] or new == max_it:
            np.dot(coefficients(numbers, new), z[:new], out=b)
            return norms[: new + 1]
        new += 1


@compiled
def orthonormalise(
    v: np.ndarray, new: int, column: np.ndarray, sums: np.ndarray, rank: int, collective: tuple
) -> float:
    """Make the vector `new` orthonormal to those before, fill in their products with it, return its norm.

    The norm is a difference. Of a vector of which little is left it would be rounding, and so would be the
    direction: such a vector is taken once more.
    """
    w, mine = v[new], sums[rank]
    column[:new] = 0.0
    for _ in range(2):
        np.dot(v[: new + 1], w, out=mine[: new + 1])
        exchange(collective, sums)
        square_before = square = sums[:, new].sum()
        for i in range(new):
            mine[i] = sums[:, i].sum()
            column[i] += mine[i]
            square -= mine[i] * mine[i]
        w -= np.dot(mine[:new], v[:new])
        if square > CANCELLED * square_before:
            break
    norm = np.sqrt(max(square, 0.0)) if square == square else square
    if norm > 0.0:
        w *= 1.0 / norm
    return norm
