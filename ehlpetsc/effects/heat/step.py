"""Temperatures of one step: the data of a solve, and temperatures and heat of its solution."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ehlpetsc.discretisation.contact import smallest_film
from ehlpetsc.discretisation.ehl_problem import Solution
from ehlpetsc.discretisation.step_inputs import (
    IsothermalOil,
    StepInputs,
)
from ehlpetsc.effects.effect import Step
from ehlpetsc.effects.heat.film import FilmHeat, last_profile
from ehlpetsc.effects.heat.film_law import R1, R2, SPREAD, T_MEAN, W1, W2, G
from ehlpetsc.effects.heat.film_oil import film_law
from ehlpetsc.effects.heat.half_spaces import Body
from ehlpetsc.effects.heat.record import MIN_TEMPERATURE_RISE, HeatRecord, mixing
from ehlpetsc.effects.heat.solved_film import Flow, SolvedFilm
from ehlpetsc.effects.heat.transport import (
    Film,
    explicit_transport,
    heat_taken_in_rows,
    limited,
    transport_in_rows,
)
from ehlpetsc.effects.scene import Scene
from ehlpetsc.physics.flash_temperature import Solid

MOLECULES = 1e-9  # m: films of one or two molecules of oil
HEATED = 1.5  # half-widths: where a uniform flux gives the responses of the surfaces in a steady solve
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


class Heating(NamedTuple):
    """Temperatures, film and heat of an accepted solution.

    `source`, `spread`, `solved`: as of :class:`.record.HeatRecord`, shape (n,).
    """

    temperatures: Temperatures
    film: Film
    source: np.ndarray
    spread: np.ndarray
    solved: np.ndarray


class HeatStep:
    """Steps of one scene."""

    def __init__(self, scene: Scene) -> None:
        case, self.scales = scene.case, scene.scales
        self.heat, self.fluid = case.heat, case.fluid
        s, self.bulk, self.inlet = self.scales, case.heat.bulk_temperature, case.heat.oil_inlet_temperature
        solids = map(Solid, self.heat.conductivity, self.heat.density, self.heat.heat_capacity)
        dt = s.dt or 0.5 * s.spacing / s.u_max
        self.bodies = [Body(solid, u, s.grid, dt) for solid, u in zip(solids, (s.u1, s.u2), strict=True)]
        self.films = SolvedFilm(scene)
        self.capacity, self.rows = self.films.capacity, self.films.rows
        # of films that close the shear would heat without limit, and not at all once they are closed
        self.thinnest = 0.0 if smallest_film(case.contact, s) else MOLECULES
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
                old = self.films.carried(record.film, inputs.history)
                flow = np.zeros_like(flow) if inputs.history.follows_path else flow
        balance = explicit_transport(self.rows, stored, flow, old, self.inlet)
        rows = *balance, record.source, record.spread
        law = film_law(inputs.fluid, self.heat, self.thinnest)
        rubbed, _ = _rubbed(walls, responses, record.rubbing)
        between, middle, sliding = np.ones(n), record.base.copy(), np.zeros(n)  # dry: no film is sheared
        if inputs.fluid is not None:
            sliding = self.scales.across.slip(step.conditions).speed
            walls_apart = np.abs(record.wall_1 - record.wall_2)
            last_profile(record.profile, record.pressure, walls_apart, tuple(law), between, middle)
        of_nodes = np.array((*rows, *rubbed, *responses, between, middle, record.base, sliding))
        guess = np.array((record.base, record.profile, record.film))
        oil = None if inputs.oil is None else IsothermalOil(inputs.fluid, self.scales)
        return FilmHeat(oil, law, of_nodes, guess, np.array(walls), stored, bodies)

    def solve(self, record: HeatRecord, solution: Solution, step: Step) -> Heating:
        """Temperatures and heat of an accepted solution.

        Its film flows at the temperatures of its solve. The flow carries heat along the film and dissipates
        some of it; from these sources follow the temperatures at which film and surfaces balance all heat.
        """
        heat = solution.inputs.oil  # of the first steady solution, and without oil, isothermal
        if not isinstance(heat, FilmHeat):
            heat = self.film_heat(record, solution.inputs, step)
        if self.fluid is None:
            blank = np.zeros(self.scales.grid.n)
            flow = Flow(heat.guess, np.zeros(blank.size + self.rows), blank, blank, blank)
            film, source = self.films.dry_gap(record, solution, step, flow), blank
        else:
            flow = self.films.flow(solution, heat)
            film = self.films.film(record, solution, step, flow, heat.stored)
            source = self.films.source(record, solution, step, flow, film)
        heat = heat._replace(guess=flow.state, law=heat.law._replace(thinnest=0.0))
        heat = heat.with_rows((G, SPREAD), (source, flow.spread))
        moves = heat.bodies is not None
        temperatures = self._moving(heat, film) if moves else self._steady(record, heat, film, step)
        return Heating(temperatures, film, source, flow.spread, flow.state[T_MEAN])

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
        speeds = np.abs(np.repeat(s.across.entrainment(step.conditions), s.nx))
        t = s.grid.rows(temperatures.film)
        if speed < 0.0:
            t = t[:, ::-1]
        rise = np.diff(t, prepend=self.inlet)
        following = np.diff(t, append=t[:, -1:])
        turned = slice(None, None, -1 if speed < 0.0 else 1)
        beyond = limited(rise, following)[:, turned].ravel() * solution.mass * self.capacity * s.h
        rise = rise[:, turned].ravel()
        return {"rate": rise * (speeds / s.spacing), "extrapolated": beyond}

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
