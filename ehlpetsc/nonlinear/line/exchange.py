"""Exchange of unknowns and pressure sums between the ranks of a line contact: one collective.

Every rank sends as many numbers: the unknowns of its outer nodes, which the stencils of its neighbours reach,
and of its pressures what :mod:`ehlpetsc.discretisation.line.curvature_product` sends and the sums over its
nodes.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from mpi4py import MPI

from ehlpetsc.base.compiled import call_allgather, compiled
from ehlpetsc.base.errors import UsageError
from ehlpetsc.discretisation.ehl_problem import EHLProblem
from ehlpetsc.discretisation.line.curvature_product import BLOCK, TOLERANCE, Blocks, pack, unpack
from ehlpetsc.discretisation.line.deflection import HALO, PressureSums
from ehlpetsc.discretisation.unknowns import Unknowns, n_dofs

LINEAR_TOLERANCE = 1e-6  # of the far kernel in the product with the Jacobian, which GMRES solves to 1e-4
EDGE = n_dofs(HALO)
LOAD = 2 * EDGE + 1  # place in a message of three sums and a flag, behind the unknowns
BEHIND_LOAD = LOAD + 4
ALLGATHER = ctypes.cast(ctypes.CDLL(MPI.__file__).MPI_Allgather, ctypes.c_void_p).value
HANDLES = {4: ctypes.c_int, 8: ctypes.c_size_t}  # numbers of MPICH, addresses of Open MPI


class Halo(NamedTuple):
    """Buffers of the exchange of a rank with others.

    `place`: :func:`collective` and the rank.
    `buffers`: `load_weights` of `deflection.Deflection`; messages, shape (ranks, size); unknowns of the
        window, (window, 2).
    `matrices`, `room`: of a `curvature_product.Blocks`.
    """

    place: tuple
    buffers: tuple
    matrices: tuple
    room: tuple

    @classmethod
    def of(
        cls, problem: EHLProblem, cuts: Sequence[int], ranks: MPI.Comm, tolerance: float = TOLERANCE
    ) -> Halo:
        """Halo of one scene on one communicator.

        `problem`: of the nodes of this rank.
        `cuts`: first nodes of all ranks, and the number of nodes.
        `ranks`: to outlive it.
        `tolerance`: of the far kernel in the pressure sums.
        """
        blocks = Blocks.of(problem.deflection.curvature, cuts, ranks.rank, tolerance)
        messages = np.zeros((ranks.size, BEHIND_LOAD + blocks.message_size))
        window = np.empty((problem.window.stop - problem.window.start, 2))
        return cls(
            (collective(ranks), ranks.rank), (problem.deflection.load_weights, messages, window), *blocks[1:]
        )


class LineExchange:
    """Exchange of a line contact; `linear` is the halo of products with the Jacobian."""

    def __init__(self, problem: EHLProblem, cuts: Sequence[int], ranks: MPI.Comm):
        self.halo = Halo.of(problem, cuts, ranks)
        self.linear = Halo.of(problem, cuts, ranks, LINEAR_TOLERANCE)

    def unknowns(
        self, vector: np.ndarray, pressure: np.ndarray, flag: bool
    ) -> tuple[Unknowns, PressureSums, bool]:
        """See :class:`ehlpetsc.nonlinear.ranks.Exchange`."""
        nodes, border, curvature, load = exchange_unknowns(*self.halo, (vector, pressure, flag))
        q, w = np.ascontiguousarray(nodes.T)
        return Unknowns(q, w, border), PressureSums(curvature, load[:3]), load[3] > 0.0


def first_nodes(n: int, ranks: int) -> list[int]:
    """First nodes of all ranks, multiples of `BLOCK`, and n."""
    max_ranks = max(n // BLOCK, 1)
    if ranks > max_ranks:
        raise UsageError(f"{ranks} ranks for {n} nodes; allowed: at most {max_ranks}")
    return [n * k // ranks // BLOCK * BLOCK for k in range(ranks)] + [n]


@compiled
def exchange_unknowns(place: tuple, buffers: tuple, matrices: tuple, room: tuple, local: tuple) -> tuple:
    """Unknowns at the nodes of the window, and sums over all pressures.

    `place`, `buffers`, `matrices`, `room`: of a `Halo`.
    `local`: local unknowns, interleaved, on the last rank the border's behind; pressures of the local nodes;
        flag.

    Returns the unknowns, shape (window, 2), valid until the next exchange, the border's, shape (1,), and
    curvature and load of `deflection.PressureSums`: on the last rank some more of the first; of the second
    the number of ranks with the flag, too, shape (4,).
    """
    (collective, rank), (load_weights, messages, window), (vector, pressure, flag) = place, buffers, local
    mine, last, local_unknowns = messages[rank], len(messages) - 1, vector[: 2 * len(pressure)]
    np.dot(load_weights, pressure, out=mine[LOAD : LOAD + 3])
    mine[LOAD + 3] = flag
    mine[LOAD - 1] = vector[-1]  # of the border on the last rank
    pack(rank, matrices, room, pressure, mine[BEHIND_LOAD:])
    nodes = local_unknowns.reshape(-1, 2)
    if last > 0:
        mine[:EDGE], mine[EDGE : 2 * EDGE] = local_unknowns[:EDGE], local_unknowns[-EDGE:]
        exchange(collective, messages)
        nodes, unknowns, first = window, window.ravel(), EDGE if rank > 0 else 0
        unknowns[first : first + len(local_unknowns)] = local_unknowns
        if rank > 0:
            unknowns[:EDGE] = messages[rank - 1, EDGE : 2 * EDGE]
        if rank < last:
            unknowns[-EDGE:] = messages[rank + 1, :EDGE]
    load = messages[0, LOAD:BEHIND_LOAD].copy()
    for other in range(last):
        load += messages[other + 1, LOAD:BEHIND_LOAD]
    return (
        nodes,
        messages[last, LOAD - 1 : LOAD].copy(),
        unpack(rank, matrices, room, messages[:, BEHIND_LOAD:]),
        load,
    )


def collective(ranks: MPI.Comm) -> tuple:
    """Addresses and arguments of MPI for :func:`exchange`, of a communicator that must outlive it.

    As all that compiled functions are called with, arrays and plain tuples of four arrays at most: numba asks
    Python for the types of longer ones and for the class of named ones at every call, 50 microseconds.
    """
    return ALLGATHER, int(MPI.IN_PLACE), _handle(MPI.DOUBLE), _handle(ranks)


def _handle(of_mpi: object) -> int:
    return HANDLES[MPI._sizeof(of_mpi)].from_address(MPI._addressof(of_mpi)).value


@compiled
def exchange(collective: tuple, everyone: np.ndarray) -> None:
    """Fill in what all other ranks have in their rows, the first axis; collective."""
    if len(everyone) > 1:
        function, in_place, number, communicator = collective
        at, count = everyone.ctypes.data, everyone.size // len(everyone)
        if call_allgather(function, in_place, number, at, count, communicator):
            raise RuntimeError("MPI_Allgather failed")
