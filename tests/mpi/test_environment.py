"""The ranks that mpirun started are one communicator, on a PETSc of real double precision."""

import os

import numpy as np


def test_world_communicator_has_every_rank():
    from mpi4py import MPI

    size = next(os.environ[name] for name in ("OMPI_COMM_WORLD_SIZE", "PMI_SIZE") if name in os.environ)
    assert MPI.COMM_WORLD.size == int(size)
    assert MPI.COMM_WORLD.allreduce(MPI.COMM_WORLD.rank) == sum(range(MPI.COMM_WORLD.size))


def test_petsc_computes_in_real_double_precision():
    from petsc4py import PETSc

    assert np.dtype(PETSc.ScalarType) == np.float64
    vector = PETSc.Vec().createMPI(7)
    vector.set(1.0 + 2.0**-50)
    assert vector.sum() == 7.0 + 7 * 2.0**-50
