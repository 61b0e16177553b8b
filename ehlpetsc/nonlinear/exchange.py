"""What the ranks tell each other of a vector of unknowns: one collective, of the same few numbers from each.

Every rank gives the unknowns of its outer nodes, which its neighbours' stencils reach, the moments of its
pressures, by which they reach all others, and their sums (:mod:`ehlpetsc.discretisation.far_pressures`).
"""

import numpy as np
from mpi4py import MPI

from ehlpetsc.discretisation.deflection import HALO
from ehlpetsc.discretisation.far_pressures import FarPressures
from ehlpetsc.discretisation.interleaving import count, pairs


def largest(ranks, number):
    """Of the numbers of all ranks."""
    if ranks.size == 1:
        return number
    there = np.array([number], dtype=float)
    ranks.Allreduce(MPI.IN_PLACE, there, MPI.MAX)
    return there[0]


def everywhere(ranks, here):
    """Whether something holds on every rank."""
    return largest(ranks, not here) == 0.0


class Exchange:
    """Of one scene on one communicator; on one rank nothing is told, and arrays are handed on as they are.

    Parameters
    ----------
    problem : ehl_problem.EHLProblem
        Of this rank's nodes.
    cuts : sequence of int
        First nodes of all ranks, and the number of nodes.
    ranks : mpi4py communicator
    """

    def __init__(self, problem, cuts, ranks):
        self.problem, self.ranks = problem, ranks
        self.local, self.edge = problem.local, count(HALO)
        if ranks.size > 1:
            self.far = FarPressures(problem.deflection, cuts, ranks.rank)
            size = 2 * self.edge + 1 + self.far.told
            self._mine, self._all = np.zeros(size), np.empty((ranks.size, size))

    def __call__(self, vector, pressure):
        """Unknowns at the nodes of the window, and what the rest of the pressures does to the local rows.

        Parameters
        ----------
        vector : ndarray
            Local unknowns, interleaved; h00 last on the last rank.
        pressure : callable
            Local pressures of the unknowns of the local nodes, given as shape (local, 2).

        Returns
        -------
        nodes : ndarray, shape (window, 2)
        h00 : float
        outside : deflection.Outside or None
            None on one rank.
        """
        nodes = pairs(vector, self.local)
        if self.ranks.size == 1:
            return nodes, vector[-1], None
        mine, edge, rank = self._mine, self.edge, self.ranks.rank
        mine[:edge], mine[edge : 2 * edge] = nodes[:HALO].ravel(), nodes[-HALO:].ravel()
        mine[2 * edge] = vector[-1]  # h00 on the last rank
        self.far.tell(pressure(nodes), mine[2 * edge + 1 :])
        self.ranks.Allgather(mine, self._all)
        parts = [nodes]
        if rank > 0:
            parts.insert(0, pairs(self._all[rank - 1, edge:], HALO))
        if rank < self.ranks.size - 1:
            parts.append(pairs(self._all[rank + 1], HALO))
        outside = self.far.outside(self._all[:, 2 * edge + 1 :])
        return np.concatenate(parts), self._all[-1, 2 * edge], outside

    def whole(self, record):
        """A named tuple of arrays at the nodes of the window, of others in it too, with the whole arrays."""
        if self.ranks.size == 1:
            return record
        own = self.problem.own
        return record._make(self._whole_of(part, own) for part in record)

    def _whole_of(self, part, own):
        if isinstance(part, np.ndarray):
            return np.concatenate(self.ranks.allgather(part[own]))
        return self.whole(part) if isinstance(part, tuple) else part
