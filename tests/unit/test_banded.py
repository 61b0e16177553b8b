"""The bordered band preconditioner solves a bordered band matrix exactly."""
import numpy as np
import petsc4py
import pytest

petsc4py.init([])

from petsc4py import PETSc  # noqa: E402

from ehlpetsc.banded import BorderedBand  # noqa: E402


def bordered(n, below, above, seed):
    rng = np.random.default_rng(seed)
    a = np.triu(np.tril(rng.normal(size=(n, n)), above), -below)
    a[-1], a[:, -1] = rng.normal(size=n), rng.normal(size=n)
    return a


def solve(a, b):
    matrix = PETSc.Mat().createAIJ(a.shape, comm=PETSc.COMM_SELF)
    matrix.setUp()
    matrix.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, False)
    matrix.setValues(range(len(a)), range(len(a)), a)
    matrix.setOption(PETSc.Mat.Option.IGNORE_ZERO_ENTRIES, True)
    matrix.assemble()
    pc = PETSc.PC().create(PETSc.COMM_SELF)
    pc.setOperators(matrix)
    pc.setType("python")
    pc.setPythonContext(BorderedBand())
    pc.setUp()
    x, y = matrix.createVecs()
    x.array[:] = b
    pc.apply(x, y)
    return y.array.copy()


@pytest.mark.parametrize("n, below, above", [(40, 3, 5), (200, 17, 17), (12, 1, 0)])
def test_solves_exactly(n, below, above):
    a, b = bordered(n, below, above, n), np.arange(1.0, n + 1)
    x = solve(a, b)
    np.testing.assert_allclose(a @ x, b, atol=1e-9 * np.abs(a).max() * np.abs(x).max())


def test_stays_finite_where_the_band_is_singular():
    a = bordered(30, 2, 2, 1)
    a[10, :] = 0.0
    a[10, -1] = 1.0
    assert np.all(np.isfinite(solve(a, np.ones(30))))
