r"""Flexible GMRES as PETSc's Python Krylov method: as PETSc's own, with half its messages and calls.

Arnoldi's process by classical Gram and Schmidt (Saad 1993),

.. math:: z_k=M^{-1}v_k,\qquad
   w=Az_k,\qquad h_i=v_i\cdot w,\qquad
   h_{k+1}^2=w\cdot w-\sum_ih_i^2,

so that one sum over the ranks gives the products with all vectors and the norm of the next one, where PETSc
takes two; it is taken again where the norm cancels. Vectors are those of the whole system; entries that an
active set leaves out are zero. Tolerances, convergence test and monitors are PETSc's. There is no restart: at
most `MAX_IT`. All iterations of a solve are one compiled call.

Use: ``-ksp_type python -ksp_python_type ehlpetsc.nonlinear.gmres.FlexibleGMRES`` (the default), on matrices
and with the preconditioner of this program.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from petsc4py import PETSc

from ehlpetsc.base.compiled import compiled
from ehlpetsc.nonlinear.jacobian import jacobian_product
from ehlpetsc.nonlinear.preconditioner.distributed_lu import solve
from ehlpetsc.nonlinear.ranks import exchange

MAX_IT = 100  # of a solve
CANCELLED = 1e-8  # of the square of a norm: what is left of it by differences is right to as many digits


class Basis(NamedTuple):
    """Vectors and numbers of a solve.

    Attributes
    ----------
    vectors
        v, shape (MAX_IT + 1, size); z, (MAX_IT, size); products of the vectors, local parts of each rank,
        (ranks, MAX_IT + 2); norms of the residuals, (MAX_IT + 1,).
    numbers
        Columns of the triangular matrix, shape (MAX_IT, MAX_IT + 1); cosines and sines, (MAX_IT, 2); rotated
        right-hand side, (MAX_IT + 1,), whose last number is the residual.
    """

    vectors: tuple
    numbers: tuple

    @classmethod
    def of(cls, size: int, ranks: int) -> Basis:
        """Room for vectors of a local size on so many ranks."""
        sums, norms = np.zeros((ranks, MAX_IT + 2)), np.zeros(MAX_IT + 1)
        vectors = np.empty((MAX_IT + 1, size)), np.empty((MAX_IT, size)), sums, norms
        numbers = np.zeros((MAX_IT, MAX_IT + 1)), np.zeros((MAX_IT, 2)), np.zeros(MAX_IT + 1)
        return cls(vectors, numbers)


class FlexibleGMRES:
    """Context of PETSc's Python Krylov method."""

    def __init__(self) -> None:
        self._size: int = None
        self._basis: Basis = None

    def solve(self, ksp: PETSc.KSP, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Solve from zero."""
        operator, (*tolerances, max_it) = ksp.getOperators()[0].getPythonContext(), ksp.getTolerances()
        factors, halo = operator.factors, operator.halo
        if self._size != operator.size:
            self._size, self._basis = operator.size, Basis.of(operator.size, len(halo.messages))
        basis = self._basis
        v, _, _, norms = basis.vectors
        v[0] = 0.0
        v[0, operator.active] = b.array_r
        system = *operator.linearisation, *halo, *factors.lu.factors, factors.units
        number = iterations(*basis, *system, min(max_it, MAX_IT), *tolerances)
        for k, norm in enumerate(norms[: number + 1].tolist()):
            if not np.isfinite(norm):
                norm, reason = np.inf, PETSc.KSP.ConvergedReason.DIVERGED_NANORINF  # PETSc refuses nan
            else:
                reason = ksp.callConvergenceTest(k, norm)
            ksp.logConvergenceHistory(norm)
            ksp.monitor(k, norm)
        ksp.setIterationNumber(number)
        ksp.setResidualNorm(norm)
        ksp.setConvergedReason(reason or PETSc.KSP.ConvergedReason.DIVERGED_MAX_IT)
        x.array[:] = v[0, operator.active]


@compiled
def iterations(
    vectors: tuple,
    numbers: tuple,
    state: tuple,
    changes: tuple,
    collective: tuple,
    load_weights: np.ndarray,
    messages: np.ndarray,
    window: np.ndarray,
    rank: int,
    matrices: tuple,
    pressures: tuple,
    place: tuple,
    lu: tuple,
    cuts: tuple,
    border: tuple,
    room: tuple,
    units: np.ndarray,
    max_it: int,
    rtol: float,
    atol: float,
    divtol: float,
) -> int:
    """Replace the right-hand side, the first v, by the solution to PETSc's tolerances; collective.

    Parameters
    ----------
    vectors, numbers
        Of a `Basis`.
    state, changes
        Of a `Linearisation`.
    collective, load_weights, messages, window, rank, matrices, pressures
        Of a `Halo`.
    place, lu, cuts, border, room
        Of `RankFactors`.
    units
        As of :func:`.distributed_lu.solve`.

    Returns
    -------
    int
        Number of iterations.
    """
    v, z, sums, norms = vectors
    halo = collective, load_weights, messages, window, rank, matrices, pressures
    new = 0
    while True:
        if new > 0:
            solve(place, lu, cuts, border, room, v[new - 1], units, z[new - 1])
            jacobian_product(state, changes, halo, z[new - 1], v[new])
        norm = orthonormalise(v, new, numbers[0][max(new - 1, 0)], sums, rank, collective)
        norms[new] = least_residual(numbers, new, norm)
        if norms[new] <= max(rtol * norms[0], atol) or not norms[new] < divtol * norms[0] or new == max_it:
            combine(vectors, numbers, new)
            return new
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


@compiled
def least_residual(numbers: tuple, new: int, norm: float) -> float:
    """Norm of the residual with a vector more, of this norm before it was made one."""
    hessenberg, rotations, right = numbers
    column = hessenberg[max(new - 1, 0)]
    if new == 0:
        right[0] = norm
        return norm
    k = new - 1
    for i in range(k):
        above, below = column[i], column[i + 1]
        column[i] = rotations[i, 0] * above + rotations[i, 1] * below
        column[i + 1] = rotations[i, 0] * below - rotations[i, 1] * above
    length = np.hypot(column[k], norm)
    rotations[k, 0], rotations[k, 1] = (column[k] / length, norm / length) if length != 0.0 else (1.0, 0.0)
    column[k] = length if length != 0.0 else 1.0
    right[new] = -rotations[k, 1] * right[k]
    right[k] *= rotations[k, 0]
    return abs(right[new])


@compiled
def combine(vectors: tuple, numbers: tuple, number: int) -> None:
    """Replace the first v by the sum of so many vectors z that leaves the least residual."""
    (v, z, _, _), (hessenberg, _, right) = vectors, numbers
    factors = right[:number].copy()
    for k in range(number - 1, -1, -1):
        factors[k] /= hessenberg[k, k]
        for i in range(k):
            factors[i] -= hessenberg[k, i] * factors[k]
    np.dot(factors, z[:number], out=v[0])
