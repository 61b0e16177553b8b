"""The preconditioner of many ranks: overlapping blocks of a band, its border eliminated as a whole."""
import numpy as np
import petsc4py

petsc4py.init([])

from petsc4py import PETSc  # noqa: E402

SIZE, HALF = 240, 5


def bordered(comm):
    """A matrix of random entries in a band, a full last row and column, and a strong diagonal."""
    rng = np.random.default_rng(4)
    dense = rng.standard_normal((SIZE, SIZE))
    distance = np.abs(np.subtract.outer(np.arange(SIZE), np.arange(SIZE)))
    dense[(distance > HALF) & (np.arange(SIZE) < SIZE - 1)[:, None] & (np.arange(SIZE) < SIZE - 1)] = 0.0
    dense[np.arange(SIZE), np.arange(SIZE)] = 8.0
    matrix = PETSc.Mat().createAIJ((SIZE, SIZE), comm=comm)
    matrix.setUp()
    matrix.setOption(PETSc.Mat.Option.NEW_NONZERO_ALLOCATION_ERR, False)
    for i in range(*matrix.getOwnershipRange()):
        columns = np.flatnonzero(dense[i]).astype(np.int32)
        matrix.setValues([i], columns, dense[i, columns])
    matrix.assemble()
    return matrix, dense


def test_it_is_nearly_the_inverse_of_a_bordered_band():
    matrix, dense = bordered(PETSc.COMM_WORLD)
    b, x = matrix.createVecRight(), matrix.createVecRight()
    right = np.sin(np.arange(SIZE))
    b.array = right[slice(*b.getOwnershipRange())]
    ksp = PETSc.KSP().create(PETSc.COMM_WORLD)
    ksp.setOperators(matrix)
    ksp.setType("gmres")
    ksp.setTolerances(rtol=1e-10)
    ksp.pc.setType("python")
    ksp.pc.setPythonType("ehlpetsc.banded.OverlappingBand")
    for _ in range(2):  # the second time with the numbering kept
        ksp.pc.setOperators(matrix)
        ksp.setUp()
        ksp.solve(b, x)
        matrix.assemble()
    exact = np.linalg.solve(dense, right)[slice(*x.getOwnershipRange())]
    np.testing.assert_allclose(x.array, exact, rtol=0, atol=1e-9)
    assert ksp.getIterationNumber() <= (1 if PETSc.COMM_WORLD.size == 1 else 8)
