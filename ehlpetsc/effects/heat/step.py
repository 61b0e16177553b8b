"""Temperatures of one step: the data of a solve, and temperatures and heat of its solution."""

from typing import NamedTuple

import numpy as np

from ehlpetsc.discretisation.contact import smallest_film
from ehlpetsc.discretisation.reynolds import Reynolds
from ehlpetsc.discretisation.step_inputs import StepInputs
from ehlpetsc.effects.effect import Step
from ehlpetsc.effects.heat.film import FilmHeat, faces
from ehlpetsc.effects.heat.film_law import R1, R2, SPREAD, W1, W2, G, film_law
from ehlpetsc.effects.heat.half_spaces import Body
from ehlpetsc.effects.heat.record import HeatRecord
from ehlpetsc.effects.heat.transport import Film, explicit_transport, heat_taken, transport
from ehlpetsc.physics.flash_temperature import Solid

MOLECULES = 1e-9  # m: films of one or two molecules of oil
NO_EXCHANGE = 1.0  # m: gap of dry surfaces apart, which exchange no heat
HEATED = 1.5  # half-widths: where a uniform flux gives the responses of the surfaces in a steady solve
MAX_FLOW_RATIO = 2.0  # pressure flow next to direct contact, over that of the mean speed
MIN_RESPONSE = 0.01  # of the largest one
DEPTH = 6
ITERATIONS = 200
ACCURACY = 1e-11  # of the largest value


class Temperatures(NamedTuple):
    """Temperatures [K], heat fluxes, heat of shear and `extrapolated` of :class:`.transport.Film` at its end
    [W/m^2] at the nodes, and records of both bodies."""

    film: np.ndarray
    walls: list
    fluxes: list
    shear: np.ndarray
    extrapolated: np.ndarray
    bodies: list
    responses: list


class HeatStep:
    """Steps of one scene.

    Parameters
    ----------
    scene : effects.effect.Scene
    """

    def __init__(self, scene):
        case, self.scales = scene.case, scene.scales
        self.heat, self.fluid = case.heat, case.fluid
        s, self.bulk, self.inlet = self.scales, case.heat.bulk_temperature, case.heat.oil_inlet_temperature
        solids = map(Solid, self.heat.conductivity, self.heat.density, self.heat.heat_capacity)
        dt = s.dt or 0.5 * s.dx / s.u_max
        self.bodies = [Body(solid, u, s, dt) for solid, u in zip(solids, (s.u1, s.u2), strict=True)]
        self.capacity = self.heat.oil_density * self.heat.oil_heat_capacity
        # of films that close the shear would heat without limit, and not at all once they are closed
        self.thinnest = 0.0 if smallest_film(case.contact, s) else MOLECULES
        self.reynolds = None if self.fluid is None else Reynolds(s, 1.0, 0, s.nx)
        self.coldest = min(self.inlet, *self.bulk)

    def film_heat(self, record: HeatRecord, inputs: StepInputs, step: Step) -> FilmHeat:
        """Data of the film's temperature in a solve, from the record at the beginning of the step."""
        n = self.scales.nx
        stored, bodies = np.zeros(n), None
        if step.dt is None:
            responses = [record.response_1, record.response_2]
            pairs = (record.wall_1, record.flux_1), (record.wall_2, record.flux_2)
            walls = [w - r * q for (w, q), r in zip(pairs, responses, strict=True)]
        else:
            records, speeds = (record.body_1, record.body_2), (step.conditions.u1, step.conditions.u2)
            movements = zip(self.bodies, records, step.travelled, speeds, strict=True)
            bodies = tuple(
                body.advance(body_heat, travelled, step.dt, speed)
                for body, body_heat, travelled, speed in movements
            )
            walls = [bulk + body.history for bulk, body in zip(self.bulk, bodies, strict=True)]
            responses = [np.full(n, body.response) for body in bodies]
            if inputs.history is not None:
                stored = self.capacity * self.scales.h * inputs.history.extrapolated / step.dt
        t = record.film
        rows = *explicit_transport(stored, record.flow, t, self.inlet), record.source, record.spread
        law = film_law(inputs.fluid, self.heat, step.conditions.sliding, self.thinnest)
        return FilmHeat(law, np.array((*rows, *walls, *responses)), t, stored, bodies)

    def solve(self, record, solution, step):
        """Temperatures and heat of an accepted solution.

        Returns
        -------
        Temperatures
        Film
        source, spread : ndarray, shape (nx,)
            See :class:`ehlpetsc.effects.heat.HeatRecord`.
        """
        s, loads = self.scales, solution.loads
        heat = solution.inputs.heat or self.film_heat(record, solution.inputs, step)
        friction = solution.inputs.boundary_friction * abs(step.conditions.sliding)
        source = rubbing = friction * loads.friction_pressure * s.p0
        pressure, blank = loads.oil_pressure * s.p0, np.zeros(s.nx)
        if self.fluid is None:
            thickness = np.where(loads.friction_pressure > 0.0, 0.0, NO_EXCHANGE)
            film = Film(blank, thickness, np.ones(s.nx), record.film, *[blank] * 3, np.zeros(s.nx + 1), blank)
            spread = blank
        else:
            q = solution.nodes.reynolds_unknown
            solved, couette, pressure_heat, spread, gradient = self._flow(solution, heat)
            heat = heat._replace(guess=solved)
            unit = self.capacity * s.u * s.h / s.dx
            thickness = np.where(loads.sheared_oil, loads.film * s.h, 0.0)
            left = 1.0 + np.minimum(q, 0.0)
            film_rubbing = rubbing if self.thinnest else blank
            last_step = (record.rate * step.dt, record.extrapolated / step.dt) if step.dt else (blank, blank)
            old, flow = record.film, unit * couette
            film = Film(pressure, thickness, left, old, heat.stored, *last_step, flow, film_rubbing)
            source = source + np.where(loads.sheared_oil, pressure_heat, 0.0)
            source = source + self._compression(record, film, gradient, step)
        heat = heat.with_rows((G, SPREAD), (source, spread))
        heat = heat._replace(law=heat.law._replace(thinnest=0.0))
        temperatures = (
            self._steady(record, heat, film, step) if heat.bodies is None else self._moving(heat, film)
        )
        return temperatures, film, source, spread

    def _flow(self, solution, heat):
        """Temperatures of the film in the solve; results of `film.faces`."""
        n, inputs = self.scales.nx, solution.inputs
        q, h, oil = solution.nodes.reynolds_unknown, solution.nodes.film, solution.loads.oil_mask
        backward = inputs.conditions.entrainment < 0.0
        if backward:  # the first node is the inlet
            inputs, q, h, oil = inputs.mirrored(), q[::-1], h[::-1], np.ascontiguousarray(oil[::-1])
        solved, couette = heat.guess[::-1].copy() if backward else heat.guess.copy(), np.zeros(n + 1)
        pressure_heat, spread, gradient = np.empty(n), np.empty(n), np.empty(n)
        at = self.reynolds.properties(np.ascontiguousarray(q), np.ascontiguousarray(h), inputs, solved)
        faces(
            at,
            self.reynolds.face_law(inputs),
            oil,
            self._max_flow(h, oil, inputs),
            couette,
            pressure_heat,
            spread,
            gradient,
        )
        if backward:
            return solved[::-1].copy(), -couette[::-1], pressure_heat[::-1], spread[::-1], -gradient[::-1]
        return solved, couette, pressure_heat, spread, gradient

    def _max_flow(self, h, oil, inputs):
        """Bounds of the pressure flow, see `film.faces`: direct contact makes oil, which flows off."""
        if oil.all():
            return np.inf, np.inf
        speed, contact = MAX_FLOW_RATIO * abs(inputs.conditions.entrainment), np.abs(self.scales.x) <= 1.0
        return speed, speed * h[contact].mean() * self.scales.h

    def _compression(self, record, film, gradient, step):
        r"""Heat of compression :math:`\beta_vTh(\partial_t+u\partial_x)p` [W/m^2]."""
        if not self.heat.thermal_expansion:
            return 0.0
        rate = step.conditions.entrainment * gradient
        if step.dt:
            rate = rate + (film.pressure - record.pressure) / step.dt
        return self.heat.thermal_expansion * film.old * film.thickness * film.left * rate

    def _nodes(self, heat, film, guess):
        """Film temperatures, both fluxes, the heat of shear and e."""
        out = [np.empty(len(guess)) for _ in range(5)]
        transport(guess, *film[:-1], self.inlet, self.coldest, tuple(heat.law), heat.of_nodes, *out)
        return out

    def _moving(self, heat, film):
        t, *fluxes, shear, extrapolated = self._nodes(heat, film, heat.guess)
        walls_before, responses = heat.of_nodes[[W1, W2]], heat.of_nodes[[R1, R2]]
        walls = [w + r * q for w, r, q in zip(walls_before, responses, fluxes, strict=True)]
        bodies = [
            body.accept(body_step, q)
            for body, body_step, q in zip(self.bodies, heat.bodies, fluxes, strict=True)
        ]
        return Temperatures(t, walls, fluxes, shear, extrapolated, bodies, responses)

    def _steady(self, record, heat, film, step):
        """Temperatures of a steady solution: those of film and surfaces made to agree."""
        speeds = step.conditions.u1, step.conditions.u2
        heated = (np.abs(self.scales.x) < HEATED) * 1.0
        responses = [body.steady(heated, u)[0] for body, u in zip(self.bodies, speeds, strict=True)]
        responses = [np.maximum(response, response.max() * MIN_RESPONSE) for response in responses]
        temperatures = None

        def fluxes(values):
            nonlocal temperatures
            q = np.split(values, 2)
            risen = [body.steady(flux, u) for body, flux, u in zip(self.bodies, q, speeds, strict=True)]
            walls = [bulk + rise for bulk, (rise, _) in zip(self.bulk, risen, strict=True)]
            walls_without_flux = [
                w - response * flux for w, response, flux in zip(walls, responses, q, strict=True)
            ]
            now = heat.with_rows((W1, W2, R1, R2), walls_without_flux + responses)
            guess = record.film if temperatures is None else temperatures.film
            t, *new_fluxes, shear, extrapolated = self._nodes(now, film, guess)
            bodies = [
                body.record(flux, terms) for body, flux, (_, terms) in zip(self.bodies, q, risen, strict=True)
            ]
            temperatures = Temperatures(t, walls, new_fluxes, shear, extrapolated, bodies, responses)
            return np.concatenate(new_fluxes)

        mixing(fluxes, np.concatenate([record.flux_1, record.flux_2]))
        return temperatures

    def balance(self, temperatures, film, source):
        """Heat dissipated [W/m], and its imbalance with the heat that bodies and oil take, over it."""
        total = (temperatures.shear + source).sum()
        of_film = film.old, film.stored, film.extrapolated, film.couette
        taken = heat_taken(*of_film, self.inlet, temperatures.film, temperatures.extrapolated)
        missing = total - temperatures.fluxes[0].sum() - temperatures.fluxes[1].sum() - taken
        return self.scales.dx * total, abs(missing) / max(abs(total), 1e-300) if total else 0.0


def mixing(function, start):
    r"""Fixed point :math:`x=g(x)` by Anderson's acceleration (Walker & Ni 2011).

    Parameters
    ----------
    function : callable
    start : ndarray

    Returns
    -------
    ndarray
        The last argument of the function.
    """
    x, steps, residuals = start, [], []
    for _ in range(ITERATIONS):
        new = function(x)
        f = new - x
        if np.abs(f).max() <= ACCURACY * max(np.abs(new).max(), 1e-300):
            return x
        steps, residuals = [*steps, x][-DEPTH:], [*residuals, f][-DEPTH:]
        if len(steps) == 1:
            x = new
            continue
        differences = np.diff(np.array(residuals), axis=0).T
        gamma = np.linalg.lstsq(differences, f, rcond=1e-12)[0]
        moved = np.diff(np.array(steps), axis=0).T
        x = new - (moved + differences) @ gamma
    return x
