"""What the ranks of a communicator exchange, agree on or gather; nothing is sent on one rank.

Compiled loops call MPI themselves: to return to Python for it takes longer than the message.
"""

import ctypes

import numpy as np
from mpi4py import MPI

from ehlpetsc.compiled import call_allgather, compiled

ALLGATHER = ctypes.cast(ctypes.CDLL(MPI.__file__).MPI_Allgather, ctypes.c_void_p).value
HANDLES = {4: ctypes.c_int, 8: ctypes.c_size_t}  # numbers of MPICH, addresses of Open MPI


def global_max(ranks, number):
    """Largest of the numbers of all ranks."""
    return _reduced(ranks, number, MPI.MAX)


def global_sum(ranks, number):
    """Sum of the numbers of all ranks, also of each of several numbers."""
    return _reduced(ranks, number, MPI.SUM)


def _reduced(ranks, number, operation):
    if ranks.size == 1:
        return number
    received = np.array([number], dtype=float)
    ranks.Allreduce(MPI.IN_PLACE, received, operation)
    return received[0]


def all_ranks(ranks, condition):
    """Whether a condition holds on every rank."""
    return global_max(ranks, not condition) == 0.0


def collective(ranks):
    """What :func:`exchange` takes of a communicator, which must outlive it: addresses and arguments for MPI.

    As all that compiled functions are called with, arrays and plain tuples of four arrays at most: numba asks
    Python for the types of longer ones and for the class of named ones at every call, 50 microseconds.
    """
    return ALLGATHER, int(MPI.IN_PLACE), _handle(MPI.DOUBLE), _handle(ranks)


def _handle(of_mpi):
    return HANDLES[MPI._sizeof(of_mpi)].from_address(MPI._addressof(of_mpi)).value


@compiled
def exchange(collective, everyone):
    """Fill in what all other ranks have in their rows, the first axis; collective."""
    if len(everyone) > 1:
        function, in_place, number, communicator = collective
        at, count = everyone.ctypes.data, everyone.size // len(everyone)
        if call_allgather(function, in_place, number, at, count, communicator):
            raise RuntimeError("MPI_Allgather failed")


def gathered(ranks, record, owned):
    """Named tuple of the arrays of all nodes, from one of arrays of which `owned` are those of the rank."""
    if ranks.size == 1:
        return record
    return record._make(_gathered(ranks, field, owned) for field in record)


def _gathered(ranks, field, owned):
    if isinstance(field, np.ndarray):
        return np.concatenate(ranks.allgather(field[owned]))
    return gathered(ranks, field, owned) if isinstance(field, tuple) else field
