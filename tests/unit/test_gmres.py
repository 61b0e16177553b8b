"""Orthonormal vectors of the Krylov method where nearly nothing of a vector is left."""

import numpy as np
import petsc4py
import pytest

petsc4py.init([])

from petsc4py import PETSc

from ehlpetsc.nonlinear.gmres import MAX_IT, orthonormalise
from ehlpetsc.nonlinear.ranks import collective

SIZE, VECTORS = 300, 4


@pytest.mark.parametrize("left", [1.0, 1e-3, 1e-6, 1e-10, 1e-13])
def test_krylov_remainder_is_orthonormal_with_exact_norm(left):
    """A preconditioner that is nearly exact leaves little; by differences alone 1e-8 would be rounding."""
    rng = np.random.default_rng(1)
    basis = np.linalg.qr(rng.standard_normal((SIZE, VECTORS + 1)))[0].T
    v, products = np.zeros((MAX_IT + 1, SIZE)), rng.standard_normal(VECTORS)
    v[:VECTORS], v[VECTORS] = basis[:-1], products @ basis[:-1] + left * basis[-1]
    column, sums = np.zeros(MAX_IT + 1), np.zeros((1, MAX_IT + 2))
    norm = orthonormalise(v, VECTORS, column, sums, 0, collective(PETSc.COMM_SELF.tompi4py()))
    assert norm == pytest.approx(left, rel=1e-7 + 1e-15 / left)
    np.testing.assert_allclose(column[:VECTORS], products, rtol=0, atol=1e-14)
    products = v[: VECTORS + 1] @ v[: VECTORS + 1].T
    np.testing.assert_allclose(np.diag(products), 1.0, rtol=1e-7)
    np.testing.assert_allclose(np.tril(products, -1), 0.0, atol=1e-11)


@pytest.mark.parametrize("value", [0.0, np.nan])
def test_zero_and_nan_remainders(value):
    v, sums = np.zeros((MAX_IT + 1, SIZE)), np.zeros((1, MAX_IT + 2))
    v[0, 0], v[1] = 1.0, value
    norm = orthonormalise(v, 1, np.zeros(MAX_IT + 1), sums, 0, collective(PETSc.COMM_SELF.tompi4py()))
    np.testing.assert_equal(norm, value)
