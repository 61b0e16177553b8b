"""Matrix-free Jacobian of a contact in the plane: stencils and one convolution a product."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np
from mpi4py import MPI

from ehlpetsc.discretisation.contact.node_state import directional_derivative
from ehlpetsc.discretisation.ehl_problem import EHLProblem, Evaluation
from ehlpetsc.discretisation.unknowns import border_of, n_dofs
from ehlpetsc.nonlinear.plane.exchange import PlaneExchange
from ehlpetsc.nonlinear.two_fields import Jacobian

# of the relative tolerance of GMRES, change of the pressures that a known deflection may leave out: the
# elimination neglects soft asperities in a cavity, a few millionths; a tolerance of its own would refuse them
SAME_PRESSURE = 0.03


class KnownDeflection(NamedTuple):
    """Deflection of the local nodes, and forces by the local pressures, of a change of the local unknowns."""

    change: np.ndarray
    deflection: np.ndarray
    forces: np.ndarray


class FilmElimination(Protocol):
    """Elimination of the film for the preconditioner, kept between solves."""

    def prepare(self, operator: PlaneJacobian) -> None:
        """Prepare for the state of an operator."""

    def solve(self, operator: PlaneJacobian, full: np.ndarray) -> np.ndarray:
        """Unknowns for a local right-hand side."""


class PlaneJacobian(Jacobian):
    """Jacobian in the plane.

    `elimination`: of the preconditioner, kept between solves.

    `linear_rtol`: relative tolerance of GMRES.

    `known`: what the preconditioner has computed for the vector that GMRES multiplies next; it saves every
        second convolution.
    """

    exchange: PlaneExchange
    known: KnownDeflection | None = None

    def __init__(
        self,
        problem: EHLProblem,
        exchange: PlaneExchange,
        ranks: MPI.Comm,
        elimination: FilmElimination,
        linear_rtol: float,
    ):
        super().__init__(problem, exchange, ranks)
        self.elimination, self.linear_rtol = elimination, linear_rtol

    def linearise(self, evaluation: Evaluation) -> None:
        """See :class:`ehlpetsc.nonlinear.two_fields.Jacobian`; what is left of the state are derivatives."""
        super().linearise(evaluation)
        self.state = None

    def release(self) -> None:
        """See :class:`ehlpetsc.nonlinear.two_fields.Jacobian`."""
        super().release()
        self.known = None

    def pressure_of(self, v: np.ndarray) -> np.ndarray:
        """Change of the local pressures by a change of the local unknowns."""
        pressure = np.empty(self.problem.local)
        pairs = v[: n_dofs(self.problem.local)].reshape(-1, 2)
        directional_derivative(self.derivatives[0], pairs, self.problem.owned.start, pressure)
        return pressure

    def remember(self, v: np.ndarray, pressure: np.ndarray, deflection: np.ndarray) -> None:
        """Store the deflection by local pressures, if these are those of the change v of unknowns."""
        missed, allowed = self.pressure_of(v) - pressure, SAME_PRESSURE * self.linear_rtol
        fits = np.linalg.norm(missed) <= allowed * np.linalg.norm(pressure)
        forces = self.exchange.local_forces(pressure)
        self.known = KnownDeflection(v, deflection, forces) if fits else None

    def product(self, v: np.ndarray, out: np.ndarray) -> None:
        """See :class:`ehlpetsc.nonlinear.two_fields.Jacobian`."""
        p, by = self.problem, self.derivatives
        local, first = n_dofs(p.local), p.owned.start
        pairs = v[:local].reshape(-1, 2)
        is_known = self.known is not None and np.array_equal(self.known.change, v)
        forces = self.known.forces if is_known else np.zeros(p.balance.unknowns)
        (unknown, *forces), border = self.exchange.with_border(np.array([not is_known, *forces]), v)
        if unknown == 0.0:  # on any rank
            deflection, forces = self.known.deflection, np.array(forces)
        else:
            deflection, forces = self.exchange.sums(self.pressure_of(v))
        self.known = None  # of one product
        window, separation = self.exchange.window(pairs), np.empty(p.local)
        changes = np.empty_like(window)
        for k in range(2):
            directional_derivative(by[1 + k], window, 0, changes[:, k])
        directional_derivative(by[3], pairs, first, separation)
        of_border = p.balance.gap(border, p.share.local)
        out[0:local:2] = p.deflection.row_scale * (separation - of_border - deflection)
        out[1:local:2] = p.reynolds.product(self.reynolds_derivatives, changes, first)
        if p.owns_border:
            border_of(out, p.local)[:] = p.balance.product(border, forces)
        out[2 * self.inactive_nodes + 1] = 0.0
