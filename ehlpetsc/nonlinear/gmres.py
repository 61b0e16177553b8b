r"""Flexible GMRES as PETSc's Python Krylov method: as PETSc's own, with half its messages and calls.

Arnoldi's process by classical Gram and Schmidt (Saad 1993),

.. math:: z_k=M^{-1}v_k,\qquad
   w=Az_k,\qquad h_i=v_i\cdot w,\qquad
   h_{k+1}^2=w\cdot w-\sum_ih_i^2,

so that one sum over the ranks gives the products with all vectors and the norm of the next one, where PETSc
takes two. Vectors are those of the whole system; entries that an active set leaves out are zero. Tolerances,
convergence test and monitors are PETSc's. There is no restart: at most `MOST` iterations.

Use: ``-ksp_type python -ksp_python_type ehlpetsc.nonlinear.gmres.FlexibleGMRES`` (the default), on matrices
and with the preconditioner of this program.
"""

import numpy as np
from petsc4py import PETSc

from ehlpetsc.compiled import compiled
from ehlpetsc.nonlinear.collectives import exchange

MOST = 100  # iterations of a solve


class FlexibleGMRES:
    """Context of PETSc's Python Krylov method."""

    def __init__(self):
        self._v = self._z = np.empty((0, 0))
        self._hessenberg, self._rotations = np.zeros((MOST, MOST + 1)), np.zeros((MOST, 2))
        self._right = np.zeros(MOST + 1)

    def solve(self, ksp, b, x):
        """Solve from zero."""
        operator, max_it = ksp.getOperators()[0].getPythonContext(), ksp.getTolerances()[-1]
        ranks, size = operator.factors.lu.ranks, operator.size
        if self._v.shape[1] != size:
            self._v, self._z = np.empty((MOST + 1, size)), np.empty((MOST, size))
            self._sums = np.zeros((ranks.size, MOST + 2))
        v, z, mine = self._v, self._z, self._sums[ranks.rank]
        v[0] = 0.0
        v[0, operator.active] = b.array_r
        for k in range(-1, min(max_it, MOST)):
            if k >= 0:
                operator.precondition(v[k], z[k])
                operator.times(z[k], v[k + 1])
            np.dot(v[: k + 2], v[k + 1], out=mine[: k + 2])
            exchange(ranks, self._sums)
            norm = extend(v, k + 1, self._sums, self._hessenberg, self._rotations, self._right)
            reason = ksp.callConvergenceTest(k + 1, norm)
            ksp.setIterationNumber(k + 1)
            ksp.setResidualNorm(norm)
            ksp.logConvergenceHistory(norm)
            ksp.monitor(k + 1, norm)
            if reason:
                break
        ksp.setConvergedReason(reason or PETSc.KSP.ConvergedReason.DIVERGED_MAX_IT)
        if k >= 0:
            x.array[:] = combined(z, k + 1, self._hessenberg, self._right)[operator.active]


@compiled
def extend(v, new, sums, hessenberg, rotations, right):
    """Make the vector `new` orthonormal to those before, and return the norm of the residual.

    Parameters
    ----------
    v : ndarray, shape (MOST + 1, size)
    new : int
        0: v holds the right-hand side.
    sums : ndarray, shape (ranks, MOST + 2)
        Products of the vectors, local parts of each rank.
    hessenberg : ndarray, shape (MOST, MOST + 1)
        Columns of the triangular matrix.
    rotations : ndarray, shape (MOST, 2)
        Cosines and sines.
    right : ndarray, shape (MOST + 1,)
        Rotated right-hand side; the last number is the residual.
    """
    w, column = v[new], hessenberg[max(new - 1, 0)]
    square = sums[:, new].sum()
    for i in range(new):
        column[i] = sums[:, i].sum()
        square -= column[i] * column[i]
    norm = np.sqrt(max(square, 0.0)) if square == square else square
    w -= np.dot(column[:new], v[:new])
    if norm > 0.0:
        w *= 1.0 / norm
    if new == 0:
        right[0] = norm
        return norm
    k = new - 1
    for i in range(k):
        above, below = column[i], column[i + 1]
        column[i] = rotations[i, 0] * above + rotations[i, 1] * below
        column[i + 1] = rotations[i, 0] * below - rotations[i, 1] * above
    length = np.hypot(column[k], norm)
    rotations[k, 0], rotations[k, 1] = (column[k] / length, norm / length) if length > 0.0 else (1.0, 0.0)
    column[k] = length if length > 0.0 else 1.0
    right[new] = -rotations[k, 1] * right[k]
    right[k] *= rotations[k, 0]
    return abs(right[new])


@compiled
def combined(z, number, hessenberg, right):
    """Sum of the first vectors z that leaves the least residual."""
    factors = right[:number].copy()
    for k in range(number - 1, -1, -1):
        factors[k] /= hessenberg[k, k]
        for i in range(k):
            factors[i] -= hessenberg[k, i] * factors[k]
    return np.dot(factors, z[:number])
