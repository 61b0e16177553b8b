"""Matrix-free Jacobian of a contact in the plane: stencils and one convolution a product."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from mpi4py import MPI

from ehlpetsc.discretisation.ehl_problem import EHLProblem
from ehlpetsc.discretisation.unknowns import n_dofs
from ehlpetsc.nonlinear.jacobian import Jacobian
from ehlpetsc.nonlinear.plane.exchange import PlaneExchange
from ehlpetsc.nonlinear.ranks import all_ranks

if TYPE_CHECKING:
    from ehlpetsc.nonlinear.plane.preconditioner import Elimination


class PlaneJacobian(Jacobian):
    """Jacobian in the plane.

    `elimination`: of the preconditioner, kept between solves.

    `deflected`: last change of the unknowns whose deflection is known, and that deflection: the preconditioner,
    which computes it for the vector that GMRES multiplies next, saves every second convolution.
    """

    exchange: PlaneExchange
    deflected: tuple[np.ndarray, np.ndarray, float] | None = None

    def __init__(
        self, problem: EHLProblem, exchange: PlaneExchange, ranks: MPI.Comm, elimination: Elimination
    ):
        super().__init__(problem, exchange, ranks)
        self.elimination = elimination

    def product(self, v: np.ndarray, out: np.ndarray) -> None:
        """See :class:`ehlpetsc.nonlinear.jacobian.Jacobian`."""
        p, by = self.problem, self.derivatives
        local, owned = n_dofs(p.local), p.owned
        pairs = v[:local].reshape(-1, 2)
        pressure = by[0, 0, owned] * pairs[:, 0] + by[0, 1, owned] * pairs[:, 1]
        if self.deflected is not None and all_ranks(self.ranks, np.array_equal(self.deflected[0], v)):
            _, deflection, load = self.deflected
        else:
            deflection, loads = self.exchange.sums(pressure)
            load = loads[0]
        window = self.exchange.window(pairs)
        unknown, film = (by[k, 0] * window[:, 0] + by[k, 1] * window[:, 1] for k in (1, 2))
        separation = by[3, 0, owned] * pairs[:, 0] + by[3, 1, owned] * pairs[:, 1]
        scale = p.deflection.row_scale
        out[0:local:2] = scale * (separation - self.exchange.h00(v) - deflection)
        out[1:local:2] = p.reynolds.product(self.reynolds_derivatives, unknown, film, owned.start)
        if len(out) > local:
            out[local] = load
        out[2 * self.inactive_nodes + 1] = 0.0
