"""Exchange of unknowns and pressure sums between ranks: one collective, with the same few numbers from each.

Every rank sends the unknowns of its outer nodes, which the stencils of its neighbours reach, and of its
pressures what :mod:`ehlpetsc.discretisation.curvature_product` sends and the sums over its nodes.
"""

import numpy as np

from ehlpetsc.discretisation.curvature_product import TOLERANCE, CurvatureProduct
from ehlpetsc.discretisation.deflection import HALO, PressureSums
from ehlpetsc.discretisation.interleaving import n_dofs, pairs
from ehlpetsc.nonlinear.collectives import exchange

LINEAR_TOLERANCE = 1e-6  # of the far kernel in the product with the Jacobian, which GMRES solves to 1e-4


class HaloExchange:
    """Exchange of one scene on one communicator; on one rank nothing is sent.

    Parameters
    ----------
    problem : ehl_problem.EHLProblem
        Of the nodes of this rank.
    cuts : sequence of int
        First nodes of all ranks, and the number of nodes.
    ranks : mpi4py communicator
    tolerance : float
        Of the far kernel in the pressure sums.

    Attributes
    ----------
    flagged : bool
        Whether a rank has set the flag of the last exchange.
    """

    def __init__(self, problem, cuts, ranks, tolerance=TOLERANCE):
        self.problem, self.ranks = problem, ranks
        self._product = CurvatureProduct(problem.deflection.curvature, cuts, ranks.rank, tolerance)
        self._edge = n_dofs(HALO)
        self._load = 2 * self._edge + 1  # behind the outer unknowns and h00: three sums and the flag
        size = self._load + 4 + self._product.message_size
        self.flagged, self._window = False, np.empty((problem.window.stop - problem.window.start, 2))
        self._all = np.zeros((ranks.size, size))
        self._mine = self._all[ranks.rank]

    def __call__(self, vector, pressure, flag=False):
        """Unknowns at the nodes of the window, and sums over all pressures.

        Parameters
        ----------
        vector : ndarray
            Local unknowns, interleaved; h00 last on the last rank.
        pressure : ndarray
            Of the local nodes.
        flag : bool
            Whatever `flagged` is to be for all ranks, where it is true on any.

        Returns
        -------
        nodes : ndarray, shape (window, 2)
            Until the next exchange.
        h00 : float
        sums : deflection.PressureSums
        """
        problem, rank, edge, mine = self.problem, self.ranks.rank, self._edge, self._mine
        nodes, behind_load = pairs(vector, problem.local), self._load + 4
        self._product.pack(pressure, mine[behind_load:])
        load = problem.deflection.load_weights @ pressure
        self.flagged = flag
        if self.ranks.size == 1:
            return nodes, vector[-1], PressureSums(self._product.sums(self._all[:, behind_load:]), load)
        mine[:edge], mine[edge : 2 * edge] = nodes[:HALO].ravel(), nodes[-HALO:].ravel()
        mine[2 * edge] = vector[-1]  # h00 on the last rank
        mine[self._load : behind_load - 1], mine[behind_load - 1] = load, flag
        exchange(self.ranks, self._all)
        window, owned = self._window, problem.owned
        window[owned] = nodes
        if rank > 0:
            window[: owned.start] = pairs(self._all[rank - 1, edge:], HALO)
        if rank < self.ranks.size - 1:
            window[owned.stop :] = pairs(self._all[rank + 1], HALO)
        loads = self._all[:, self._load : behind_load].sum(axis=0)
        self.flagged = loads[3] > 0.0
        sums = PressureSums(self._product.sums(self._all[:, behind_load:]), loads)
        return window, self._all[-1, 2 * edge], sums
