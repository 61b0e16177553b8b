"""Matrix-free Jacobian of a contact in the plane: stencils and one convolution a product."""

from __future__ import annotations

from typing import Protocol

import numpy as np
from mpi4py import MPI

from ehlpetsc.discretisation.ehl_problem import EHLProblem
from ehlpetsc.discretisation.plane.deflection import PressureSums
from ehlpetsc.discretisation.unknowns import n_dofs
from ehlpetsc.nonlinear.plane.exchange import PlaneExchange
from ehlpetsc.nonlinear.ranks import all_ranks
from ehlpetsc.nonlinear.two_fields import Jacobian

SAME_PRESSURE = 1e-6  # relative: the elimination leaves out what asperities carry in a cavity


class Elimination(Protocol):
    """Elimination of the film for the preconditioner, kept between solves."""

    def prepare(self, operator: PlaneJacobian) -> None:
        """Prepare for the state of an operator."""

    def solve(self, operator: PlaneJacobian, full: np.ndarray) -> np.ndarray:
        """Unknowns for a local right-hand side."""


class PlaneJacobian(Jacobian):
    """Jacobian in the plane.

    `elimination`: of the preconditioner, kept between solves.

    `deflected`: last change of the unknowns whose deflection is known, that deflection and load: the
        preconditioner, which computes them for the vector that GMRES multiplies next, saves every second
        convolution.
    """

    exchange: PlaneExchange
    deflected: tuple[np.ndarray, np.ndarray, float] | None = None

    def __init__(
        self, problem: EHLProblem, exchange: PlaneExchange, ranks: MPI.Comm, elimination: Elimination
    ):
        super().__init__(problem, exchange, ranks)
        self.elimination = elimination

    def pressure_of(self, v: np.ndarray) -> np.ndarray:
        """Change of the local pressures by a change of the local unknowns."""
        by, owned = self.derivatives, self.problem.owned
        pairs = v[: n_dofs(self.problem.local)].reshape(-1, 2)
        return by[0, 0, owned] * pairs[:, 0] + by[0, 1, owned] * pairs[:, 1]

    def remember(self, v: np.ndarray, pressure: np.ndarray, sums: PressureSums) -> None:
        """Store the deflection for the next product, if it is that by the change v of the unknowns."""
        missed = np.linalg.norm(self.pressure_of(v) - pressure)
        fits = missed <= SAME_PRESSURE * np.linalg.norm(pressure)
        self.deflected = (v, sums.deflection, float(sums.load[0])) if all_ranks(self.ranks, fits) else None

    def product(self, v: np.ndarray, out: np.ndarray) -> None:
        """See :class:`ehlpetsc.nonlinear.two_fields.Jacobian`."""
        p, by = self.problem, self.derivatives
        local, owned = n_dofs(p.local), p.owned
        pairs = v[:local].reshape(-1, 2)
        if self.deflected is not None and all_ranks(self.ranks, np.array_equal(self.deflected[0], v)):
            _, deflection, load = self.deflected
        else:
            deflection, loads = self.exchange.sums(self.pressure_of(v))
            load = loads[0]
        window = self.exchange.window(pairs)
        unknown, film = (by[k, 0] * window[:, 0] + by[k, 1] * window[:, 1] for k in (1, 2))
        separation = by[3, 0, owned] * pairs[:, 0] + by[3, 1, owned] * pairs[:, 1]
        scale = p.deflection.row_scale
        h00 = self.exchange.h00(v)
        out[0:local:2] = scale * (separation - h00 - deflection)
        out[1:local:2] = p.reynolds.product(self.reynolds_derivatives, unknown, film, owned.start)
        if len(out) > local:
            out[local] = p.balance.product(h00, load)
        out[2 * self.inactive_nodes + 1] = 0.0
