"""Input of one solve: oil, history of the film, conditions."""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Protocol

import numpy as np

from ehlpetsc.base.case import Fluid
from ehlpetsc.base.compiled import compiled
from ehlpetsc.discretisation.contact.model import ContactModel
from ehlpetsc.discretisation.film_history import FilmHistory
from ehlpetsc.discretisation.finite_volumes import FLUIDITY, LN_ETA_P, PROPERTIES, fill_mass
from ehlpetsc.discretisation.unknowns import Unknowns
from ehlpetsc.physics.oil.laws import density_law, ln_viscosity, viscosity_law
from ehlpetsc.physics.oil.rheology import NEWTON, FlowLaw, flow_law, stress_pressure
from ehlpetsc.physics.oil.tabulated_flow import cross_flow_table, flow_table
from ehlpetsc.physics.operation import Conditions
from ehlpetsc.physics.scales import Scales


class Oil(Protocol):
    """Interface of an oil.

    `fluid`: table `[fluid]` of the case.
    `scales`: of pressure, film and speed.
    `rows`: number of nodal properties.
    """

    @property
    def fluid(self) -> Fluid: ...
    @property
    def scales(self) -> Scales: ...
    @property
    def rows(self) -> int: ...

    def begin(self) -> Oil:
        """Oil of one solve, which may keep a state from one evaluation to start the next one from."""
        ...

    def fill(self, q: np.ndarray, h: np.ndarray, nodes: slice | np.ndarray, at: np.ndarray) -> None:
        """Fill in the properties of `nodes` of the mesh at their q and h.

        `at`: shape (rows, columns): one for each node, and one for each row of nodes along x that `nodes`
            holds up to the outlet: a node beyond the outlet, with the film of the last one and no pressure.
        """
        ...


@dataclass(frozen=True)
class IsothermalOil:
    """Oil whose viscosity and density are laws of the pressure; interface of :class:`Oil`."""

    fluid: Fluid
    scales: Scales
    rows = PROPERTIES

    @cached_property
    def viscosity(self) -> tuple:
        """Law of the viscosity, as compiled loops take it."""
        return tuple(viscosity_law(self.fluid))

    @cached_property
    def density(self) -> tuple:
        """Law of the density, as compiled loops take it."""
        return tuple(density_law(self.fluid))

    @cached_property
    def units(self) -> tuple[float, float, float]:
        """Scales of pressure p0 [Pa] and film [m]; 1/(u film) [s/m^2]."""
        s = self.scales
        return s.p0, s.h, 1.0 / (s.u * s.h)

    def begin(self) -> IsothermalOil:
        """The oil itself, which has no state."""
        return self

    def fill(self, q: np.ndarray, h: np.ndarray, nodes: slice | np.ndarray, at: np.ndarray) -> None:
        """Fill the arrays as :meth:`Oil.fill` does."""
        nodal(q, h, self.viscosity, self.density, (*self.units, 1.0 / self.fluid.viscosity), at)


@compiled
def nodal(
    q: np.ndarray, h: np.ndarray, viscosity: tuple, density: tuple, units: tuple, at: np.ndarray
) -> None:
    """Fill in the nodal properties, see :mod:`.finite_volumes`.

    Parameters
    ----------
    q, h : shape (nodes,)
    viscosity, density
        :class:`ehlpetsc.physics.oil.laws.OilLaw` of both, as tuples, which numba looks up faster.
    units
        Scales of pressure p0 [Pa] and film [m]; 1/(u film) [s/m^2]; 1/eta0 [1/(Pa s)].
    at : shape (10, columns)
        As of :meth:`Oil.fill`.
    """
    nodes, (p0, film, unit, fluidity) = len(q), units
    for i in range(at.shape[1]):
        here, gap = (q[i], h[i]) if i < nodes else (0.0, h[last_before(i, nodes, at)])
        p = fill_mass(i, here, gap, density, p0, film, unit, at)
        ln_eta, ln_eta_p, _ = ln_viscosity(viscosity, p, viscosity[2])
        at[FLUIDITY, i], at[LN_ETA_P, i] = np.exp(-ln_eta) * fluidity, p0 * ln_eta_p


@compiled
def last_before(beyond: int, nodes: int, at: np.ndarray) -> int:
    """Last node of the row along x that ends at the node `beyond` the outlet; all rows have one length."""
    return (beyond - nodes + 1) * (nodes // (at.shape[1] - nodes)) - 1


Watch = Callable[[], object] | None  # called in every iteration; an exception that it raises ends the solve


@dataclass(frozen=True)
class StepInputs:
    """Data of a solve, without its initial guess.

    `phi`: contribution of the roughness to the gap, in a^2/R, shape (nodes,).
    `history`: previous time levels; None: steady.
    `oil`: None: dry.
    `inlet_film`: oil film at the inlet in a^2/R; None: flooded.
    `conditions`: at the end of the step.
    `load_share`: applied fraction of the load of `conditions`.
    `dt`: length of the step [s]; None: steady.
    `contact`: contact model of the solve; None: that of the problem.
    `leaks`: whether faces leak although those of the contact do not, of a first solution to start from.
    `boundary_friction`: coefficient of friction between the solids.
    """

    phi: np.ndarray
    history: FilmHistory | None
    oil: Oil | None
    inlet_film: float | None
    conditions: Conditions
    load_share: float = 1.0
    dt: float | None = None
    contact: ContactModel | None = None
    leaks: bool = False
    boundary_friction: float | np.ndarray = 0.0

    @property
    def fluid(self) -> Fluid:
        """Table `[fluid]` of the case; None: dry."""
        return self.oil.fluid if self.oil else None

    @property
    def rests(self) -> bool:
        """Whether the oil is at rest, at ambient pressure: steady, without entrainment."""
        return self.oil is not None and self.history is None and self.conditions.entrainment == 0.0

    @property
    def film_is_carried(self) -> bool:
        """Whether the history follows the film's path and holds what the mean speed moves."""
        return self.history is not None and self.history.follows_path

    @cached_property
    def flow(self) -> FlowLaw:
        """Shear law of the oil."""
        return flow_law(self.fluid)

    @property
    def flow_table(self) -> np.ndarray:
        """Table of the pressure flow, empty where the shear law has a closed form."""
        kind, _, *constants = self.flow
        return flow_table(kind, *constants)

    @property
    def cross_flow_table(self) -> np.ndarray:
        """Table of the flow across the sliding, empty of Newton's law."""
        kind, _, *constants = self.flow
        return cross_flow_table(kind, *constants)

    def begin(self) -> StepInputs:
        """Inputs of one solve, see :meth:`.step_inputs.Oil.begin`."""
        return replace(self, oil=self.oil and self.oil.begin())


def shear_constants(inputs: StepInputs, scales: Scales) -> tuple[float, float, float, float]:
    """Constants of :func:`.finite_volumes.flux_through` from its third on: of shear law and speeds."""
    flow, now = inputs.flow, inputs.conditions
    stress = np.inf if flow.kind == NEWTON else flow.stress
    rise = scales.p0 * stress_pressure(inputs.fluid)
    moved = 0.0 if inputs.film_is_carried else now.entrainment / scales.u
    return stress, stress * rise if rise else 0.0, abs(now.sliding), moved


def row_speeds(inputs: StepInputs, scales: Scales) -> np.ndarray:
    """Speeds of :func:`shear_constants` of each row of nodes, shape (rows, 2): those that fluxes see.

    |u1 - u2| along x [m/s], entrainment speed over that of the scales.
    """
    across, now = scales.across, inputs.conditions
    moved = np.zeros(len(across.y)) if inputs.film_is_carried else across.entrainment(now) / scales.u
    return np.column_stack((np.abs(across.sliding(now)), moved))


def face_speeds(rows: np.ndarray) -> np.ndarray:
    """Speeds of the faces between rows, the mean of both; at a side those of the row, shape (rows + 1, 2)."""
    beyond = np.concatenate((rows[:1], rows, rows[-1:]))
    return 0.5 * (beyond[:-1] + beyond[1:])


def inlet(q: np.ndarray, h: np.ndarray, oil_film: float | None) -> tuple[np.ndarray, ...]:
    """Rows of inlet nodes and their derivatives by q and h.

    Ambient pressure where flooded, the given oil film where starved.
    """
    if oil_film is None:
        return q, np.ones_like(q), np.zeros_like(h)
    starved = oil_film < h
    return (
        np.where(starved, q + 1.0 - oil_film / h, q),
        np.ones_like(q),
        np.where(starved, oil_film / h**2, 0.0),
    )


def mirrored(value: Any) -> Any:
    """Arrays, last axis, and records of arrays with the nodes in reverse order; speeds change their sign.

    The discrete equations have their inlet at the first node: a step with a negative entrainment speed is
    solved mirrored. Tuples that are no records are not over nodes.
    """
    if isinstance(value, np.ndarray):
        return np.ascontiguousarray(value[..., ::-1])
    if isinstance(value, Unknowns):
        return value._replace(q=mirrored(value.q), w=mirrored(value.w))
    if isinstance(value, Conditions):
        return value._replace(u1=-value.u1, u2=-value.u2)
    if hasattr(value, "_make"):
        return value._make(map(mirrored, value))
    if isinstance(value, StepInputs | FilmHistory):
        turned = copy(value)
        vars(turned).update({name: mirrored(entry) for name, entry in vars(value).items()})
        return turned
    return value
