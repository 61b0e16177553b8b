"""What the ranks of a communicator exchange, agree on or gather; nothing is sent on one rank."""

import numpy as np
from mpi4py import MPI


def global_max(ranks, number):
    """Largest of the numbers of all ranks."""
    if ranks.size == 1:
        return number
    received = np.array([number], dtype=float)
    ranks.Allreduce(MPI.IN_PLACE, received, MPI.MAX)
    return received[0]


def all_ranks(ranks, condition):
    """Whether a condition holds on every rank."""
    return global_max(ranks, not condition) == 0.0


def exchange(ranks, everyone):
    """Fill in what all other ranks have in their rows, the first axis; collective."""
    if ranks.size > 1:
        ranks.Allgather(MPI.IN_PLACE, everyone)


def gathered(ranks, record, owned):
    """Named tuple of the arrays of all nodes, from one of arrays of which `owned` are those of the rank."""
    if ranks.size == 1:
        return record
    return record._make(_gathered(ranks, part, owned) for part in record)


def _gathered(ranks, part, owned):
    if isinstance(part, np.ndarray):
        return np.concatenate(ranks.allgather(part[owned]))
    return gathered(ranks, part, owned) if isinstance(part, tuple) else part
