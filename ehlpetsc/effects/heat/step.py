"""Temperatures of one step: before the solve what they depend on, after it what they are."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ehlpetsc.discretisation.contact import smallest_film
from ehlpetsc.effects.heat.bodies import Body
from ehlpetsc.effects.heat.film import faces
from ehlpetsc.effects.heat.mixing import mixing
from ehlpetsc.effects.heat.transport import Film, explicit_transport, heat_taken, transport
from ehlpetsc.discretisation.reynolds import Reynolds
from ehlpetsc.effects.heat.body_heat import Solid
from ehlpetsc.effects.heat.film_law import R1, R2, SPREAD, W1, W2, FilmHeat, G
from ehlpetsc.effects.heat.laws import film_law

MOLECULES = 1e-9  # m: films of one or two molecules of oil
NO_EXCHANGE = 1.0  # m: gap of dry surfaces apart, which exchange no heat
HEATED = 1.5  # half-widths: where a uniform flux gives the responses of the surfaces in a steady solve
MAX_FLOW_RATIO = 2.0  # pressure flow next to direct contact, over that of the mean speed
MIN_RESPONSE = 0.01  # of the largest one


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
        self.heat, self.fluid, self.contact = case.heat, case.fluid, case.contact
        s, self.bulk, self.inlet = self.scales, case.heat.bulk_temperature, case.heat.oil_inlet_temperature
        solids = map(Solid, self.heat.conductivity, self.heat.density, self.heat.heat_capacity)
        dt = s.dt or 0.5 * s.dx / s.u_max
        self.bodies = [Body(solid, u, s, dt) for solid, u in zip(solids, (s.u1, s.u2), strict=True)]
        self.capacity = self.heat.oil_density * self.heat.oil_heat_capacity
        # of films that close the shear would heat without limit, and not at all once they are closed
        self.thinnest = 0.0 if smallest_film(case.contact, s) else MOLECULES
        self.reynolds = None if self.fluid is None else Reynolds(s, 1.0, 0, s.nx)
        self.coldest = min(self.inlet, *self.bulk)
        self._film_law = None, None
        self._inputs = self._heat = self._stored = self._body_steps = None

    def prepare(self, record, inputs, step):
        """Inputs of the solve with the data of the film's temperature.

        Parameters and result of :meth:`ehlpetsc.effects.effect.Effect.inputs`. The first steady solution is
        isothermal.
        """
        n = self.scales.nx
        self._body_steps, self._stored = None, np.zeros(n)
        if step.dt is None:
            responses = [record.response_1, record.response_2]
            pairs = (record.wall_1, record.flux_1), (record.wall_2, record.flux_2)
            walls = [w - r * q for (w, q), r in zip(pairs, responses, strict=True)]
        else:
            records, speeds = (record.body_1, record.body_2), (step.conditions.u1, step.conditions.u2)
            movements = zip(self.bodies, records, step.travelled, speeds, strict=True)
            self._body_steps = [
                body.advance(body_heat, travelled, step.dt, speed)
                for body, body_heat, travelled, speed in movements
            ]
            walls = [
                bulk + body_step.history for bulk, body_step in zip(self.bulk, self._body_steps, strict=True)
            ]
            responses = [np.full(n, body_step.response) for body_step in self._body_steps]
            if inputs.history is not None:
                self._stored = self.capacity * self.scales.h * inputs.history.extrapolated / step.dt
        t = record.film
        rows = *explicit_transport(self._stored, record.flow, t, self.inlet), record.source, record.spread
        law = self._law(step.conditions.sliding)
        self._heat = FilmHeat.begun(law, (*rows, *walls, *responses), t.copy())
        if record.solved and self.fluid is not None:
            inputs = replace(inputs, heat=self._heat)
        self._inputs = inputs
        return inputs

    def _law(self, sliding):
        if self._film_law[0] != sliding:
            self._film_law = sliding, film_law(self.fluid, self.heat, sliding, self.thinnest)
        return self._film_law[1]

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
        friction = self.contact.boundary_friction * abs(step.conditions.sliding)
        source = rubbing = friction * loads.friction_pressure * s.p0
        pressure, blank = loads.oil_pressure * s.p0, np.zeros(s.nx)
        if self.fluid is None:
            thickness = np.where(loads.friction_pressure > 0.0, 0.0, NO_EXCHANGE)
            film = Film(blank, thickness, np.ones(s.nx), record.film, *[blank] * 3, np.zeros(s.nx + 1), blank)
            spread = blank
        else:
            q = solution.nodes.reynolds_unknown
            couette, pressure_heat, spread, gradient = self._flow(q, solution.nodes.film, loads.oil_mask)
            unit = self.capacity * s.u * s.h / s.dx
            thickness = np.where(loads.sheared_oil, loads.film * s.h, 0.0)
            left = 1.0 + np.minimum(q, 0.0)
            film_rubbing = rubbing if self.thinnest else blank
            last_step = (record.rate * step.dt, record.extrapolated / step.dt) if step.dt else (blank, blank)
            old, flow = record.film, unit * couette
            film = Film(pressure, thickness, left, old, self._stored, *last_step, flow, film_rubbing)
            source = source + np.where(loads.sheared_oil, pressure_heat, 0.0)
            source = source + self._compression(record, film, gradient, step)
        heat = self._heat.with_rows((G, SPREAD), (source, spread))
        heat = heat._replace(law=heat.law._replace(thinnest=0.0))
        temperatures = (
            self._steady(record, heat, film, step) if self._body_steps is None else self._moving(heat, film)
        )
        return temperatures, film, source, spread

    def _flow(self, q, h, oil):
        """Couette flow, heat of the pressure flow, `spread` and pressure gradient, see `film.faces`."""
        n, inputs = self.scales.nx, self._inputs
        backward = inputs.conditions.entrainment < 0.0
        if backward:  # the first node is the inlet
            inputs, q, h, oil = inputs.mirrored(), q[::-1], h[::-1], np.ascontiguousarray(oil[::-1])
        couette = np.zeros(n + 1)
        pressure_heat, spread, gradient = np.empty(n), np.empty(n), np.empty(n)
        at = self.reynolds.properties(np.ascontiguousarray(q), np.ascontiguousarray(h), inputs, again=True)
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
            if inputs.heat is not None:
                self._heat.guess[:] = inputs.heat.guess[::-1]
            return -couette[::-1], pressure_heat[::-1], spread[::-1], -gradient[::-1]
        return couette, pressure_heat, spread, gradient

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
            for body, body_step, q in zip(self.bodies, self._body_steps, fluxes, strict=True)
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
