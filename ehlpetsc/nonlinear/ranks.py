"""Reductions over the ranks of the solver; the exchange that each kind of contact has of its own."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from mpi4py import MPI

from ehlpetsc.discretisation.ehl_problem import Sums
from ehlpetsc.discretisation.unknowns import Unknowns


class Exchange(Protocol):
    """Exchange of unknowns and pressures of a kind of contact between ranks."""

    def unknowns(self, vector: np.ndarray, pressure: np.ndarray, flag: bool) -> tuple[Unknowns, Sums, bool]:
        """Unknowns at the nodes of the window, sums over all pressures, whether a flag is set on any rank.

        `vector`, `pressure`: local unknowns, interleaved, and pressures.
        """


class Columns:
    """Columns of nodes along x, of which each rank computes its own: work that all ranks would repeat.

    `n_x`: number of columns of the mesh.
    """

    def __init__(self, ranks: MPI.Comm, n_x: int):
        self.ranks, self.n_x = ranks, n_x
        self.counts = np.diff([n_x * k // ranks.size for k in range(ranks.size + 1)])

    def __call__(self, compute: Callable[[slice], np.ndarray]) -> np.ndarray:
        """Array over all columns, its last axis, on every rank; collective.

        `compute`: of a slice of columns.
        """
        end = int(self.counts[: self.ranks.rank + 1].sum())
        local = np.ascontiguousarray(compute(slice(end - int(self.counts[self.ranks.rank]), end)))
        if self.ranks.size == 1:
            return local
        shape = local.shape[:-1]
        sizes = self.counts * int(np.prod(shape))
        received = np.empty(sizes.sum())
        self.ranks.Allgatherv(local, [received, sizes])
        parts = np.split(received, np.cumsum(sizes)[:-1])
        return np.concatenate([part.reshape(*shape, -1) for part in parts], axis=-1)


def global_max(ranks: MPI.Comm, number: float) -> Any:
    """Largest of the numbers of all ranks."""
    return _reduced(ranks, number, MPI.MAX)


def global_sum(ranks: MPI.Comm, number: float | tuple) -> Any:
    """Sum of the numbers of all ranks, also of each of several numbers."""
    return _reduced(ranks, number, MPI.SUM)


def _reduced(ranks: MPI.Comm, number: float | tuple, operation: MPI.Op) -> Any:
    if ranks.size == 1:
        return number
    kind = getattr(number, "dtype", None)
    received = np.array([number], dtype=np.float32 if kind == np.float32 else float)
    ranks.Allreduce(MPI.IN_PLACE, received, operation)
    return received[0]


def all_ranks(ranks: MPI.Comm, condition: bool) -> bool:
    """Whether a condition holds on every rank."""
    return global_max(ranks, not condition) == 0.0


def gathered(ranks: MPI.Comm, record: Any, owned: slice) -> Any:
    """Named tuple of the arrays of all nodes, from one of arrays of which `owned` are those of the rank."""
    if ranks.size == 1:
        return record
    return record._make(_gathered(ranks, field, owned) for field in record)


def _gathered(ranks: MPI.Comm, field: object, owned: slice) -> object:
    if isinstance(field, np.ndarray):
        return np.concatenate(ranks.allgather(field[owned]))
    return gathered(ranks, field, owned) if isinstance(field, tuple) else field
