r"""The discrete contact problem: one interleaved system for q, w and the border.

Unknowns (q_0, w_0, q_1, w_1, ...), see :mod:`ehlpetsc.discretisation.contact`; rows in the same order,
because SNESVI pairs row with unknown:

* row of q: deflection, :mod:`.line.deflection`, :mod:`.plane.deflection`;
* row of w: Reynolds equation, :class:`.reynolds.Reynolds`, in direct contact complementary to the bound of
  the film; without oil :class:`.reynolds.NoOil`;
* last rows: the border, :mod:`.balance`, of the load :math:`\sum p\,\Delta x=\pi/2`.

The problem is stateless: `StepInputs` and `Evaluation` are frozen records. A rank evaluates its own rows from
the unknowns of its window, see :mod:`.deflection`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Generic, Protocol, TypeVar

import numpy as np

from ehlpetsc.base.case import Case, Fluid
from ehlpetsc.discretisation.balance import balance_of
from ehlpetsc.discretisation.contact import contact_model, face_gap, film_scale_of
from ehlpetsc.discretisation.contact.model import ContactModel
from ehlpetsc.discretisation.contact.node_state import NodeState, SurfaceLoads
from ehlpetsc.discretisation.film_history import FilmHistory
from ehlpetsc.discretisation.reynolds import NoOil, Reynolds
from ehlpetsc.discretisation.step_inputs import IsothermalOil, StepInputs
from ehlpetsc.discretisation.unknowns import Share, Unknowns, border_of, n_dofs, q_of, w_of
from ehlpetsc.physics.operation import Conditions
from ehlpetsc.physics.scales import Scales


@dataclass(frozen=True)
class Evaluation:
    """Residual and derivatives at one state.

    `residual`: local rows, interleaved; shape of the local part of the vector.
    `reynolds_derivatives`: derivatives of the local Reynolds rows by q and h of the nodes i-2 .. i+1, shape
        (local nodes, 8); in a plane also of the nodes below and above, (local nodes, 12).
    """

    model: ContactModel
    state: NodeState
    residual: np.ndarray
    reynolds_derivatives: np.ndarray


@dataclass(frozen=True)
class Solution:
    """An accepted solution on the whole mesh, dimensionless; arrays of shape (nodes,).

    `unknowns`: as solved, with the plastic deformation of the step.
    `nodes`: pressure, film and plastic deformation of the step, without derivatives.
    `loads`: pressures, film and friction on the surfaces.
    `residual`: rows F of the Reynolds equation.
    `mass`: mass per area of the film, :math:`\rho h(1-\theta)`; None without oil.
    `inputs`: of the solve.
    """

    unknowns: Unknowns
    nodes: NodeState
    loads: SurfaceLoads
    residual: np.ndarray
    mass: np.ndarray | None
    inputs: StepInputs


class Sums(Protocol):
    """Sums over the pressures of the whole mesh, from the exchange of a kind of contact for its own rows."""

    @property
    def forces(self) -> np.ndarray:
        """Sums in the rows of the border, see :mod:`.balance`."""


S = TypeVar("S", bound=Sums, contravariant=True)


class Deflection(Protocol[S]):
    """Deflection rows of a kind of contact: :mod:`.line.deflection`, :mod:`.plane.deflection`."""

    @property
    def largest_eigenvalue(self) -> float:
        """Bound of the eigenvalues of `integral`."""

    @property
    def is_homogeneous(self) -> bool:
        """Whether both bodies are homogeneous."""

    def residual(self, separation: np.ndarray, of_border: float | np.ndarray, sums: S) -> np.ndarray:
        """Local rows, from the separation at the nodes of the window and the gap of the border."""

    def integral(self, pressure: np.ndarray) -> np.ndarray:
        """Elastic deflection at every node of the mesh, in a^2/R, by the pressures there."""


D = TypeVar("D", bound=Deflection)


class EHLProblem(Generic[D]):
    """Residual and derivatives of the nodes of a rank.

    `scales`: with the nodes of the mesh.
    `share`: nodes of this rank; the rank that owns the last node owns the border.
    `film_scale`: scale of the Reynolds rows, about the expected film, in a^2/R.

    `balance`: border of the system.
    `n`, `x`, `dx`: number of nodes; coordinates of all nodes and spacing along x.
    """

    def __init__(
        self,
        case: Case,
        scales: Scales,
        share: Share,
        model: ContactModel,
        deflection: D,
        reynolds: NoOil,
        film_scale: float,
    ):
        self.scales, self.grid, self.share = scales, scales.grid, share
        self.n, self.x, self.dx = self.grid.n, self.grid.coordinates[-1], self.grid.dx
        self.first, self.last, self.local = share.first, share.last, share.last - share.first
        self.window, self.owned = share.window, share.owned
        self.fluid, self.boundary_friction = case.fluid, case.contact.boundary_friction
        self.film_scale, self.model = film_scale, model
        self.deflection, self.reynolds = deflection, reynolds
        self.balance = balance_of(case, scales)
        self.inlet_film = self.oil = None
        if self.fluid is not None:
            self.oil = IsothermalOil(self.fluid, scales)
            if self.fluid.inlet_film is not None:
                self.inlet_film = self.fluid.inlet_film / scales.h

    @property
    def owns_border(self) -> bool:
        """Whether this rank has the border behind the unknowns of its nodes."""
        return self.last == self.n

    @property
    def size(self) -> int:
        """Number of unknowns of this rank."""
        return n_dofs(self.local) + self.owns_border * self.balance.unknowns

    def inputs(
        self,
        phi: np.ndarray | None = None,
        history: FilmHistory | None = None,
        conditions: Conditions | None = None,
        dt: float | None = None,
    ) -> StepInputs:
        """Inputs of a step of this case; by default smooth, steady, under the reference conditions."""
        phi = np.zeros(self.n) if phi is None else phi
        conditions = conditions or self.scales.conditions
        friction = self.boundary_friction
        return StepInputs(
            phi, history, self.oil, self.inlet_film, conditions, dt=dt, boundary_friction=friction
        )

    def film(self, pressure: np.ndarray, border: np.ndarray, phi: np.ndarray) -> np.ndarray:
        """Separation by the integral form, in a^2/R."""
        return self.balance.gap(border) + self.grid.undeformed() + phi + self.deflection.integral(pressure)

    def mass_per_area(self, q: np.ndarray, w: np.ndarray) -> np.ndarray | None:
        r"""Mass per area of the film, :math:`\rho h(1-\theta)`, at every node; None without oil."""
        return self._mass(self.model.state(q, w), self.fluid)

    def _mass(self, nodes: NodeState, fluid: Fluid) -> np.ndarray | None:
        return self.reynolds.mass_per_area(nodes.reynolds_unknown, nodes.film, fluid)

    def solution(self, unknowns: Unknowns, residual: np.ndarray, inputs: StepInputs) -> Solution:
        """Solution at unknowns of the whole mesh with their rows of the Reynolds equation."""
        q, w, _ = unknowns
        nodes = self.model.state(q, w)
        loads = self.model.surface_loads(q, w, nodes.film, residual)
        mass = self._mass(nodes, inputs.fluid)
        return Solution(unknowns, nodes.without_derivatives(), loads, residual, mass, inputs)

    def evaluate(self, unknowns: Unknowns, inputs: StepInputs, sums: Sums) -> Evaluation:
        """Local rows and their derivatives at the unknowns of the window's nodes.

        `sums`: of the pressures at these unknowns, from the exchange of the kind of contact.
        """
        (q, w, border), model = unknowns, inputs.contact or self.model
        state = model.state(q, w)
        residual = np.empty(self.size)
        # the parabola's second difference is dx^2 exactly
        undeformed = self.grid.undeformed(self.scales.R / inputs.conditions.radius, self.window)
        separation = state.separation - undeformed - inputs.phi[self.window]
        approach = self.balance.gap(border, self.share.local)
        q_of(residual, self.local)[:] = self.deflection.residual(separation, approach, sums)
        reynolds, derivatives = self.reynolds.evaluate(state.reynolds_unknown, state.film, inputs)
        w_of(residual, self.local)[:] = reynolds
        if self.owns_border:
            border_of(residual, self.local)[:] = self.balance.residual(border, sums.forces, inputs)
        return Evaluation(model, state, residual, derivatives)


def problem_of(
    case: Case,
    scales: Scales,
    film_scale: float,
    share: Share,
    deflection: D,
    has_sides: tuple[bool, bool] | None = None,
    bound_tolerance: float = 0.0,
) -> EHLProblem[D]:
    """Problem of the nodes of a rank.

    `film_scale`: expected film in a^2/R.
    `has_sides`: whether the domain ends below and above the local rows; of a line left out.
    `bound_tolerance`: of the active set in a^2/R: films this close to their bound count as on it.
    """
    film_scale = film_scale_of(case, scales, film_scale)
    model = contact_model(case, scales, film_scale, bound_tolerance)
    if case.fluid is None:
        reynolds = NoOil(scales.grid, share)
    else:
        reynolds = Reynolds(scales, film_scale, share, has_sides, face_gap(case.contact))
    return EHLProblem(case, scales, share, model, deflection, reynolds, film_scale)
