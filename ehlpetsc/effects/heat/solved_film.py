"""Film of a solution: flow at the temperatures of its solve, the heat that it carries and dissipates."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ehlpetsc.discretisation.contact import face_gap
from ehlpetsc.discretisation.ehl_problem import Solution
from ehlpetsc.discretisation.film_history import FilmHistory
from ehlpetsc.discretisation.step_inputs import (
    StepInputs,
    face_speeds,
    mirrored,
    row_speeds,
    shear_constants,
)
from ehlpetsc.discretisation.transport import carried, carried_with
from ehlpetsc.effects.effect import Step
from ehlpetsc.effects.heat.film import FilmHeat, cross_flow_heat, faces_in_rows
from ehlpetsc.effects.heat.record import HeatRecord
from ehlpetsc.effects.heat.transport import Film
from ehlpetsc.effects.scene import Scene

NO_EXCHANGE = 1.0  # m: gap of dry surfaces apart, which exchange no heat
MAX_FLOW_RATIO = 2.0  # pressure flow next to direct contact, over that of the mean speed


class Flow(NamedTuple):
    """Flow through the film of a solution.

    `state`: temperatures of the film in the solve, as of :class:`.step.Temperatures`.
    `couette`: mean speed times film through the faces of each row, over u a^2/R, shape (rows (nx + 1),).
    `pressure_heat`, `spread`, `gradient`: heat of the pressure flow [W/m^2], spread of the stress and
        pressure gradient [Pa/m] at the nodes, see :func:`.film.faces_in_rows`.
    """

    state: np.ndarray
    couette: np.ndarray
    pressure_heat: np.ndarray
    spread: np.ndarray
    gradient: np.ndarray


class SolvedFilm:
    """Films of the solutions of one scene.

    `capacity`: heat capacity of the oil [J/(m^3 K)]. `rows`: of nodes along x.
    """

    def __init__(self, scene: Scene) -> None:
        self.scales, self.heat = scene.scales, scene.case.heat
        self.inlet, self.gap = self.heat.oil_inlet_temperature, face_gap(scene.case.contact)
        self.capacity = self.heat.oil_density * self.heat.oil_heat_capacity
        self.rows = self.scales.grid.n // self.scales.nx

    def flow(self, solution: Solution, heat: FilmHeat) -> Flow:
        """Flow through the film; where the entrainment is backward, that of the mirrored film."""
        nodes, backward = solution.nodes, solution.inputs.conditions.entrainment < 0.0
        given = solution.inputs, nodes.reynolds_unknown, nodes.film, solution.loads.oil_mask, heat.guess
        inputs, q, h, oil, guess = map(mirrored, given) if backward else given
        filled, at = inputs.oil.begin(), np.empty((inputs.oil.rows, len(q) + self.rows))
        filled.fill(q, h, slice(0, len(q)), at)
        state = filled.guess if isinstance(filled, FilmHeat) else guess
        s, table, max_flow = self.scales.grid, inputs.flow_table, self._max_flow(h, oil, inputs)
        along, *across = (self._face_law(inputs, spacing) for spacing in reversed(s.increments))
        speeds = row_speeds(inputs, self.scales)
        flow = Flow(state, *faces_in_rows(speeds, at, along, table, oil, max_flow))
        for law in across:
            laws = law, face_speeds(speeds), inputs.flow, inputs.cross_flow_table
            heat_across = cross_flow_heat(at, s.shape, s.periodic, laws, oil, max_flow)
            flow = flow._replace(pressure_heat=flow.pressure_heat + heat_across)
        if backward:
            flow = flow._replace(couette=-flow.couette, gradient=-flow.gradient)
            flow = Flow(*map(mirrored, flow))
        return flow

    def film(
        self, record: HeatRecord, solution: Solution, step: Step, flow: Flow, stored: np.ndarray
    ) -> Film:
        """Film of a solution, with what its oil has carried from the step before; `stored`: as of `Film`."""
        s, loads, history = self.scales, solution.loads, solution.inputs.history
        old, blank = record.film, np.zeros(s.grid.n)
        change = extrapolated = blank
        if history is not None:
            old = self.carried(old, history)
            rate, beyond = (
                carried(s.grid.rows(values), history.nodes_carried, 0.0).ravel()
                for values in (record.rate, record.extrapolated)
            )
            change, extrapolated = rate * step.dt, beyond / step.dt
        return Film(
            pressure=loads.oil_pressure * s.p0,
            thickness=np.where(loads.sheared_oil, loads.film * s.h, 0.0),
            left=1.0 + np.minimum(solution.nodes.reynolds_unknown, 0.0),
            old=old,
            stored=stored,
            change=change,
            extrapolated=extrapolated,
            couette=self.capacity * s.u * s.h / s.spacing * flow.couette,
            rubbing=self._rubbing(solution, step),
        )

    def dry_gap(self, record: HeatRecord, solution: Solution, step: Step, flow: Flow) -> Film:
        """Gap without oil: surfaces that touch exchange heat, those apart none."""
        touches, blank = solution.loads.friction_pressure > 0.0, np.zeros(self.scales.grid.n)
        return Film(
            pressure=blank,
            thickness=np.where(touches, 0.0, NO_EXCHANGE),
            left=np.ones(blank.size),
            old=record.film,
            stored=blank,
            change=blank,
            extrapolated=blank,
            couette=flow.couette,
            rubbing=self._rubbing(solution, step),
        )

    def _rubbing(self, solution: Solution, step: Step) -> np.ndarray:
        """Heat of the friction of the solids [W/m^2]."""
        friction = solution.inputs.boundary_friction * self.scales.across.slip(step.conditions).speed
        return friction * solution.loads.friction_pressure * self.scales.p0

    def source(
        self, record: HeatRecord, solution: Solution, step: Step, flow: Flow, film: Film
    ) -> np.ndarray:
        r"""Heat of pressure flow and compression, :math:`\beta_vTh(\partial_t+u\partial_x)p` [W/m^2]."""
        source = np.where(solution.loads.sheared_oil, flow.pressure_heat, 0.0)
        if not self.heat.thermal_expansion:
            return source
        speeds = np.repeat(self.scales.across.entrainment(step.conditions), self.scales.nx)
        rate = speeds * flow.gradient
        if step.dt:
            rate = rate + (film.pressure - record.pressure) / step.dt
        return source + self.heat.thermal_expansion * film.old * film.thickness * film.left * rate

    def carried(self, temperatures: np.ndarray, history: FilmHistory) -> np.ndarray:
        """Temperatures of the film one step ago where the oil was that is now at each node [K]."""
        rows = self.scales.grid.rows
        given = rows(history.before), rows(temperatures), history.nodes_carried, self.inlet
        return carried_with(*given).ravel()

    def _face_law(self, inputs: StepInputs, spacing: float) -> tuple:
        """Constants of :func:`.finite_volumes.flux_through` between nodes `spacing` half-widths apart."""
        s = self.scales
        return s.p0 / (s.a * spacing), s.h, *shear_constants(inputs, s), *self.gap

    def _max_flow(self, h: np.ndarray, oil: np.ndarray, inputs: StepInputs) -> tuple[float, float]:
        """Bounds of the pressure flow, see `film.faces`: direct contact makes oil, which flows off."""
        if oil.all():
            return np.inf, np.inf
        speed, contact = MAX_FLOW_RATIO * abs(inputs.conditions.entrainment), self.scales.grid.inside(1.0)
        return speed, speed * h[contact].mean() * self.scales.h
