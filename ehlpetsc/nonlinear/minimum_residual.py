"""Least squares of GMRES: Givens rotations of the triangular matrix, norm of the residual, coefficients."""

import numpy as np

from ehlpetsc.base.compiled import compiled


@compiled
def numbers_of(max_it: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Zeros for so many iterations.

    Columns of the triangular matrix; cosines and sines; rotated right-hand side, whose last number is the
    residual.
    """
    return np.zeros((max_it, max_it + 1)), np.zeros((max_it, 2)), np.zeros(max_it + 1)


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
def coefficients(numbers: tuple, count: int) -> np.ndarray:
    """Coefficients of so many vectors whose sum leaves the minimum residual."""
    hessenberg, _, right = numbers
    factors = right[:count].copy()
    for k in range(count - 1, -1, -1):
        factors[k] /= hessenberg[k, k]
        for i in range(k):
            factors[i] -= hessenberg[k, i] * factors[k]
    return factors
