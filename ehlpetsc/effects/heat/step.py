"""Temperatures of one step: the data of a solve, and temperatures and heat of its solution."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ehlpetsc.discretisation.contact import face_gap, smallest_film
from ehlpetsc.discretisation.ehl_problem import Solution
from ehlpetsc.discretisation.film_history import FilmHistory
from ehlpetsc.discretisation.step_inputs import (
    IsothermalOil,
    StepInputs,
    mirrored,
    shear_constants,
)
from ehlpetsc.discretisation.transport import carried, carried_with
from ehlpetsc.effects.heat.film import FilmHeat, cross_flow_heat, faces_in_rows, last_profile
from ehlpetsc.effects.heat.film_law import R1, R2, SPREAD, T_MEAN, W1, W2, G
from ehlpetsc.effects.heat.film_oil import film_law
from ehlpetsc.effects.heat.half_spaces import Body
from ehlpetsc.effects.heat.record import MIN_TEMPERATURE_RISE, HeatRecord, mixing
from ehlpetsc.effects.heat.transport import (
    Film,
    explicit_transport,
    heat_taken_in_rows,
    limited,
    transport_in_rows,
)
from ehlpetsc.effects.scene import Scene
from ehlpetsc.effects.step import Step
from ehlpetsc.physics.flash_temperature import Solid

MOLECULES = 1e-9  # m: films of one or two molecules of oil
NO_EXCHANGE = 1.0  # m: gap of dry surfaces apart, which exchange no heat
HEATED = 1.5  # half-widths: where a uniform flux gives the responses of the surfaces in a steady solve
MAX_FLOW_RATIO = 2.0  # pressure flow next to direct contact, over that of the mean speed
MIN_RESPONSE = 0.01  # of the maximum
NO_RESPONSE = 1e-30  # m^2 K/W: bodies without response share equally
OF_CHANGE = 1e-3  # of the change between two solutions


class Temperatures(NamedTuple):
    """State of the film, temperatures of the walls [K], heat fluxes, heat of shear and `extrapolated` of
    :class:`.transport.Film` at its end [W/m^2] and shear stress [Pa] at the nodes, records of both bodies."""

    state: np.ndarray
    walls: list
    fluxes: list
    shear: np.ndarray
    extrapolated: np.ndarray
    stress: np.ndarray
    bodies: list
    responses: list

    @property
    def film(self) -> np.ndarray:
        """Mean temperature of the film [K]."""
        return self.state[T_MEAN]


class HeatStep:
    """Steps of one scene."""

    def __init__(self, scene: Scene) -> None:
        case, self.scales = scene.case, scene.scales
        self.heat, self.fluid = case.heat, case.fluid
        s, self.bulk, self.inlet = self.scales, case.heat.bulk_temperature, case.heat.oil_inlet_temperature
        solids = map(Solid, self.heat.conductivity, self.heat.density, self.heat.heat_capacity)
        dt = s.dt or 0.5 * s.spacing / s.u_max
        self.bodies = [Body(solid, u, s.grid, dt) for solid, u in zip(solids, (s.u1, s.u2), strict=True)]
        self.capacity = self.heat.oil_density * self.heat.oil_heat_capacity
        # of films that close the shear would heat without limit, and not at all once they are closed
        self.thinnest = 0.0 if smallest_film(case.contact, s) else MOLECULES
        self.gap, self.rows = face_gap(case.contact), s.grid.n // s.nx
        self.coldest = min(self.inlet, *self.bulk)

    def film_heat(self, record: HeatRecord, inputs: StepInputs, step: Step) -> FilmHeat:
        """Data of the film's temperature in a solve, from the record at the beginning of the step."""
        n = self.scales.grid.n
        stored, bodies, old, flow = np.zeros(n), None, record.film, record.flow
        if step.dt is None:
            responses = [record.response_1, record.response_2]
            pairs = (record.wall_1, record.flux_1), (record.wall_2, record.flux_2)
            walls = [w - r * q for (w, q), r in zip(pairs, responses, strict=True)]
        else:
            records, speeds = (record.body_1, record.body_2), (step.conditions.u1, step.conditions.u2)
            fluxes = record.flux_1, record.flux_2
            movements = zip(self.bodies, records, step.travelled, speeds, fluxes, strict=True)
            bodies = tuple(
                body.advance(body_heat, travelled, step.dt, speed, flux)
                for body, body_heat, travelled, speed, flux in movements
            )
            walls = [bulk + body.history for bulk, body in zip(self.bulk, bodies, strict=True)]
            responses = [np.full(n, body.response) for body in bodies]
            if inputs.history is not None:
                stored = self.capacity * self.scales.h * inputs.history.extrapolated / step.dt
                old = self._carried(record.film, inputs.history)
                flow = np.zeros_like(flow) if inputs.history.follows_path else flow
        balance = explicit_transport(self.rows, stored, flow, old, self.inlet)
        rows = *balance, record.source, record.spread
        law = film_law(inputs.fluid, self.heat, step.conditions.sliding, self.thinnest)
        rubbed, _ = _rubbed(walls, responses, record.rubbing)
        between, middle = np.ones(n), record.base.copy()
        if inputs.fluid is not None:
            walls_apart = np.abs(record.wall_1 - record.wall_2)
            last_profile(record.profile, record.pressure, walls_apart, tuple(law), between, middle)
        of_nodes = np.array((*rows, *rubbed, *responses, between, middle, record.base))
        guess = np.array((record.base, record.profile, record.film))
        oil = None if inputs.oil is None else IsothermalOil(inputs.fluid, self.scales)
        return FilmHeat(oil, law, of_nodes, guess, np.array(walls), stored, bodies)

    def solve(
        self, record: HeatRecord, solution: Solution, step: Step
    ) -> tuple[Temperatures, Film, np.ndarray, np.ndarray, np.ndarray]:
        """Temperatures and heat of an accepted solution.

        Returns both, and `source`, `spread`, `solved` of :class:`.record.HeatRecord`, shape (n,).
        """
        s, loads = self.scales, solution.loads
        heat = solution.inputs.oil  # of the first steady solution, and without oil, isothermal
        if not isinstance(heat, FilmHeat):
            heat = self.film_heat(record, solution.inputs, step)
        friction = solution.inputs.boundary_friction * abs(step.conditions.sliding)
        rubbing = friction * loads.friction_pressure * s.p0
        pressure, blank = loads.oil_pressure * s.p0, np.zeros(s.grid.n)
        if self.fluid is None:
            thickness = np.where(loads.friction_pressure > 0.0, 0.0, NO_EXCHANGE)
            no_oil = blank, blank, blank, np.zeros(s.grid.n + self.rows)
            film = Film(blank, thickness, np.ones(s.grid.n), record.film, *no_oil, rubbing)
            source = spread = blank
        else:
            q = solution.nodes.reynolds_unknown
            solved, couette, pressure_heat, spread, gradient = self._flow(solution, heat)
            heat = heat._replace(guess=solved)
            unit = self.capacity * s.u * s.h / s.spacing
            thickness = np.where(loads.sheared_oil, loads.film * s.h, 0.0)
            left, history = 1.0 + np.minimum(q, 0.0), solution.inputs.history
            old, last_step = record.film, (blank, blank)
            if history is not None:
                in_rows, moved = s.grid.rows, history.nodes_carried
                old = self._carried(old, history)
                rate, beyond = (
                    carried(in_rows(v), moved, 0.0).ravel() for v in (record.rate, record.extrapolated)
                )
                last_step = rate * step.dt, beyond / step.dt
            film = Film(pressure, thickness, left, old, heat.stored, *last_step, unit * couette, rubbing)
            source = np.where(loads.sheared_oil, pressure_heat, 0.0)
            source = source + self._compression(record, film, gradient, step)
        heat = heat.with_rows((G, SPREAD), (source, spread))
        heat = heat._replace(law=heat.law._replace(thinnest=0.0))
        temperatures = (
            self._steady(record, heat, film, step) if heat.bodies is None else self._moving(heat, film)
        )
        return temperatures, film, source, spread, heat.guess[T_MEAN]

    def _flow(
        self, solution: Solution, heat: FilmHeat
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Temperatures of the film in the solve; results of `film.faces`."""
        nodes, backward = solution.nodes, solution.inputs.conditions.entrainment < 0.0
        given = solution.inputs, nodes.reynolds_unknown, nodes.film, solution.loads.oil_mask, heat.guess
        inputs, q, h, oil, guess = map(mirrored, given) if backward else given
        filled, at = inputs.oil.begin(), np.empty((inputs.oil.rows, len(q) + self.rows))
        filled.fill(q, h, slice(0, len(q)), at)
        solved = filled.guess if isinstance(filled, FilmHeat) else guess
        s, table, max_flow = self.scales.grid, inputs.flow_table, self._max_flow(h, oil, inputs)
        along, *across = (self._face_law(inputs, spacing) for spacing in reversed(s.increments))
        of_faces = faces_in_rows(self.rows, at, along, table, oil, max_flow)
        couette, pressure_heat, spread, gradient = of_faces
        for law in across:
            laws = law, inputs.flow, inputs.cross_flow_table
            pressure_heat += cross_flow_heat(at, s.shape, s.periodic, laws, oil, max_flow)
        if backward:
            solved, couette, pressure_heat, spread, gradient = map(
                mirrored, (solved, -couette, pressure_heat, spread, -gradient)
            )
        return solved, couette, pressure_heat, spread, gradient

    def _carried(self, temperatures: np.ndarray, history: FilmHistory) -> np.ndarray:
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

    def _compression(
        self, record: HeatRecord, film: Film, gradient: np.ndarray, step: Step
    ) -> np.ndarray | float:
        r"""Heat of compression :math:`\beta_vTh(\partial_t+u\partial_x)p` [W/m^2]."""
        if not self.heat.thermal_expansion:
            return 0.0
        rate = step.conditions.entrainment * gradient
        if step.dt:
            rate = rate + (film.pressure - record.pressure) / step.dt
        return self.heat.thermal_expansion * film.old * film.thickness * film.left * rate

    def _nodes(
        self,
        heat: FilmHeat,
        film: Film,
        walls: Sequence[np.ndarray],
        responses: Sequence[np.ndarray],
        state: np.ndarray,
    ) -> tuple[np.ndarray, list[np.ndarray], np.ndarray, np.ndarray, np.ndarray]:
        """State of the film, both fluxes, the heat of shear, e and the shear stress."""
        rubbed, fractions = _rubbed(walls, responses, film.rubbing)
        heat = heat.with_rows((W1, W2, R1, R2), (*rubbed, *responses))
        given = state, np.array(film[:-2]), film.couette, (self.inlet, self.coldest)
        state, out = transport_in_rows(self.rows, *given, tuple(heat.law), heat.of_nodes)
        *fluxes, shear, extrapolated, stress = out
        fluxes = [q + part * film.rubbing for q, part in zip(fluxes, fractions, strict=True)]
        return state, fluxes, shear, extrapolated, stress

    def _moving(self, heat: FilmHeat, film: Film) -> Temperatures:
        responses = heat.of_nodes[[R1, R2]]
        state, fluxes, shear, extrapolated, stress = self._nodes(
            heat, film, heat.walls, responses, heat.guess
        )
        walls = [w + r * q for w, r, q in zip(heat.walls, responses, fluxes, strict=True)]
        bodies = [
            body.accept(body_step, q)
            for body, body_step, q in zip(self.bodies, heat.bodies, fluxes, strict=True)
        ]
        return Temperatures(state, walls, fluxes, shear, extrapolated, stress, bodies, responses)

    def _steady(self, record: HeatRecord, heat: FilmHeat, film: Film, step: Step) -> Temperatures:
        """Temperatures of a steady solution: those of film and surfaces made to agree."""
        speeds = step.conditions.u1, step.conditions.u2
        heated = (np.abs(self.scales.grid.coordinates[-1]) < HEATED) * 1.0
        responses = [body.steady(heated, u)[0] for body, u in zip(self.bodies, speeds, strict=True)]
        responses = [np.maximum(response, response.max() * MIN_RESPONSE) for response in responses]
        temperatures = None

        def fluxes(values: np.ndarray) -> np.ndarray:
            nonlocal temperatures
            q = np.split(values, 2)
            risen = [body.steady(flux, u) for body, flux, u in zip(self.bodies, q, speeds, strict=True)]
            walls = [bulk + rise for bulk, (rise, _) in zip(self.bulk, risen, strict=True)]
            walls_without_flux = [
                w - response * flux for w, response, flux in zip(walls, responses, q, strict=True)
            ]
            state = np.array((record.base, record.profile, record.film))
            if temperatures is not None:
                state = temperatures.state
            state, new_fluxes, shear, extrapolated, stress = self._nodes(
                heat, film, walls_without_flux, responses, state
            )
            bodies = [
                body.record(flux, terms) for body, flux, (_, terms) in zip(self.bodies, q, risen, strict=True)
            ]
            temperatures = Temperatures(
                state, walls, new_fluxes, shear, extrapolated, stress, bodies, responses
            )
            return np.concatenate(new_fluxes)

        # a dry contact is solved once, an oil film and its temperatures in turn until they agree
        of_change = OF_CHANGE if heat.isothermal else 0.0
        mixing(fluxes, np.concatenate([record.flux_1, record.flux_2]), of_change)
        return temperatures

    def rates(self, temperatures: Temperatures, film: Film, solution: Solution, step: Step) -> dict:
        """`rate` and `extrapolated` of the record: as fast as the temperatures change along the film's path.

        In a steady film they change along x alone.
        """
        if step.dt is not None or solution.mass is None:
            dt = step.dt or np.inf
            change = temperatures.film - film.old
            return {"rate": change / dt, "extrapolated": temperatures.extrapolated * (step.dt or 0.0)}
        s, speed = self.scales, step.conditions.entrainment
        t = s.grid.rows(temperatures.film)
        if speed < 0.0:
            t = t[:, ::-1]
        rise = np.diff(t, prepend=self.inlet)
        following = np.diff(t, append=t[:, -1:])
        turned = slice(None, None, -1 if speed < 0.0 else 1)
        beyond = limited(rise, following)[:, turned].ravel() * solution.mass * self.capacity * s.h
        rise = rise[:, turned].ravel()
        return {"rate": rise * (abs(speed) / s.spacing), "extrapolated": beyond}

    def balance(self, temperatures: Temperatures, film: Film, source: np.ndarray) -> tuple[float, float]:
        """Heat dissipated [W/m], in a point contact [W], and the imbalance with what takes it, over it.

        Bodies and oil take it. Next to no heat, as at rest, is not the measure of the imbalance, but the heat
        that warms by `MIN_TEMPERATURE_RISE` the oil that is stored and carried, or in each row a film of
        a^2/R at the maximum speed.
        """
        total = (temperatures.shear + source + film.rubbing).sum()
        taken = heat_taken_in_rows(self.rows, film, self.inlet, temperatures.film, temperatures.extrapolated)
        missing = total - temperatures.fluxes[0].sum() - temperatures.fluxes[1].sum() - taken
        s = self.scales
        flow = np.abs(film.couette.reshape(self.rows, -1)).max(axis=1)
        moved = np.maximum(flow, self.capacity * s.u_max * s.h / s.spacing).sum()
        least = MIN_TEMPERATURE_RISE * (moved + film.stored.sum())
        return s.grid.node_size * total, abs(missing) / max(abs(total), least)


def _rubbed(
    walls: Sequence[np.ndarray], responses: Sequence[np.ndarray], rubbing: np.ndarray
) -> tuple[list[np.ndarray], tuple[np.ndarray, np.ndarray]]:
    """Walls [K] with the heat of the solids, which warms both by the same, and the parts in either."""
    first = (responses[1] + NO_RESPONSE) / (responses[0] + responses[1] + 2.0 * NO_RESPONSE)
    rise = responses[0] * first * rubbing
    return [wall + rise for wall in walls], (first, 1.0 - first)
