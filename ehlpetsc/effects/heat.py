r"""Heat: temperatures of the film and of both surfaces, and the viscosity at them.

Equations and the temperature of a node: :mod:`ehlpetsc.physics.heat_film`; conduction into the bodies:
:mod:`ehlpetsc.physics.half_space_conduction`. In the solve of a step the temperature of a node follows from
its pressure and film, with the response of both surfaces to the flux of the step; heat of the pressure flow,
of rubbing solids and what the film carries along are those of the last level there. Of the accepted solution
all temperatures and fluxes are then computed with its own flow, so that the energy balance holds in every
step.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ehlpetsc.discretisation.film_heat import faces, transport
from ehlpetsc.discretisation.reynolds import Reynolds
from ehlpetsc.effects.effect import Effect
from ehlpetsc.effects.heat_bodies import Body, BodyHeat
from ehlpetsc.effects.heat_steady import mixing
from ehlpetsc.physics.half_space_conduction import Solid
from ehlpetsc.physics.heat_film import FilmHeat
from ehlpetsc.physics.heat_laws import film_law
from ehlpetsc.quantity import Field, Figure

AWAY = 1.0  # m: gap of surfaces that exchange no heat
STEADY = 2e-5  # of the largest temperature rise: change between two solutions that ends the steady start


class HeatRecord(NamedTuple):
    """Temperatures and heat at a time level; arrays of shape (nx,) but for `flow`, (nx + 1,).

    Attributes
    ----------
    film, wall_1, wall_2
        Temperatures [K].
    flux_1, flux_2
        Heat fluxes into both bodies [W/m^2].
    source
        Heat that does not depend on the film's temperature in a step [W/m^2].
    spread
        Of :func:`ehlpetsc.physics.heat_film.shear_stress`.
    flow
        Heat capacity that the surfaces' mean speed moves through the faces, per cell [W/(m^2 K)].
    response_1, response_2
        Of the surfaces to their flux, in a steady solve [m^2 K/W].
    pressure
        Of the oil [Pa].
    body_1, body_2 : heat_bodies.BodyHeat
    heat : float
        Dissipated [W/m].
    error : float
        Imbalance over the heat.
    solved : int
        Number of solutions that it has come from; 0: none yet.
    """

    film: np.ndarray
    wall_1: np.ndarray
    wall_2: np.ndarray
    flux_1: np.ndarray
    flux_2: np.ndarray
    source: np.ndarray
    spread: np.ndarray
    flow: np.ndarray
    response_1: np.ndarray
    response_2: np.ndarray
    pressure: np.ndarray
    body_1: BodyHeat
    body_2: BodyHeat
    heat: float
    error: float
    solved: int


class Heat(Effect):
    """Film and surface temperatures."""

    name = "heat"
    record = HeatRecord
    fields = {
        "film_temperature": Field("K", "mean temperature across the film"),
        "temperature_1": Field("K", "temperature of surface 1"),
        "temperature_2": Field("K", "temperature of surface 2"),
        "heat_flux_1": Field("W/m^2", "heat flux into body 1"),
        "heat_flux_2": Field("W/m^2", "heat flux into body 2"),
    }
    scalars = {
        "film_temperature_max": Figure(
            "K", "highest film temperature", over_run="max", summary=".5g", compared=True
        ),
        "film_temperature_mean": Figure("K", "film temperature, mean over the Hertz contact", over_run="last"),
        "temperature_1_max": Figure("K", "highest temperature of surface 1", over_run="max", summary=".5g"),
        "temperature_1_mean": Figure(
            "K", "temperature of surface 1, mean over the Hertz contact", over_run="last"
        ),
        "temperature_2_max": Figure("K", "highest temperature of surface 2", over_run="max", summary=".5g"),
        "temperature_2_mean": Figure(
            "K", "temperature of surface 2, mean over the Hertz contact", over_run="last"
        ),
        "heat": Figure("W/m", "heat dissipated", over_run="last", summary=".4g", compared=True),
        "heat_error": Figure(
            "1",
            "heat dissipated less that taken by the bodies, stored and carried away by the oil, over the first",
            over_run="max",
            summary=".2e",
        ),
    }

    def __init__(self, scene):
        super().__init__(scene)
        case, s = scene.case, scene.scales
        self.heat, self.fluid = case.heat, case.fluid
        self.bulk = self.heat.bulk_temperature
        self.inlet = self.heat.oil_inlet_temperature
        solids = zip(self.heat.conductivity, self.heat.density, self.heat.heat_capacity, strict=True)
        u = (s.u1, s.u2)
        dt = s.dt or 0.5 * s.dx / s.u_max
        self.bodies = [Body(Solid(*solid), speed, s, dt) for solid, speed in zip(solids, u, strict=True)]
        self.capacity = self.heat.oil_density * self.heat.oil_heat_capacity
        self.reynolds = None if self.fluid is None else Reynolds(s, 1.0, 0, s.nx)
        self._now = None

    @classmethod
    def is_in(cls, case):
        """Whether the case has a table [heat]."""
        return case.heat is not None

    def start(self, before=None):
        """Bodies at bulk temperature, oil at that of the inlet; both bodies have cooled since a pass before."""
        n = self.scene.scales.nx
        zero, one = np.zeros(n), np.ones(n)
        bodies = [body.cold() for body in self.bodies]
        walls = [bulk * one for bulk in self.bulk]
        state = (self.inlet * one, *walls, zero, zero, zero, zero, np.zeros(n + 1), zero, zero, zero)
        return HeatRecord(*state, *bodies, 0.0, 0.0, 0)

    def inputs(self, record, inputs, step):
        """Add the data of the film's temperature; the first steady solution is isothermal."""
        steps = None
        if step.dt is None:
            walls = (record.wall_1, record.wall_2), (record.response_1, record.response_2)
            known = [w - r * q for w, r, q in zip(*walls, (record.flux_1, record.flux_2), strict=True)]
            responses, stored = walls[1], np.zeros(len(record.film))
        else:
            steps = [
                body.advance(was, way, step.dt)
                for body, was, way in zip(
                    self.bodies, (record.body_1, record.body_2), step.travelled, strict=True
                )
            ]
            known = [bulk + one.history for bulk, one in zip(self.bulk, steps, strict=True)]
            responses = [np.full(len(record.film), one.response) for one in steps]
            stored = np.zeros(len(record.film))
            if inputs.history is not None:
                stored = self.capacity * self.scene.scales.h * inputs.history.carried / step.dt
        heat = None
        if self.fluid is not None:
            flow, t = record.flow, record.film
            left, right = np.maximum(flow[:-1], 0.0), np.maximum(-flow[1:], 0.0)
            a = stored + left + right
            b = stored * t + left * np.append(self.inlet, t[:-1]) + right * np.append(t[1:], self.inlet)
            law = film_law(self.fluid, self.heat, step.conditions.sliding)
            heat = FilmHeat(law, a, b, record.source, record.spread, *known, *responses, t)
        if record.solved:
            inputs = replace(inputs, heat=heat)
        self._now = inputs, heat, stored, steps
        return inputs

    def accept(self, record, solution, step):
        """Temperatures and fluxes of a solution."""
        inputs, heat, stored, steps = self._now
        s, loads, sliding = self.scene.scales, solution.loads, abs(step.conditions.sliding)
        source = self.scene.case.contact.boundary_friction * loads.friction_pressure * s.p0 * sliding
        n = s.nx
        flow, total_flow = np.zeros(n + 1), np.zeros(n + 1)
        spread, pressure = np.zeros(n), loads.oil_pressure * s.p0
        if self.fluid is None:
            left, film = np.ones(n), np.where(loads.friction_pressure > 0.0, 0.0, AWAY)
            law = film_law(None, self.heat, step.conditions.sliding)
            blank = np.zeros(n)
            heat = FilmHeat(law, blank, blank, blank, blank, blank, blank, blank, blank, record.film)
            if steps:
                known = [bulk + one.history for bulk, one in zip(self.bulk, steps, strict=True)]
                responses = [np.full(n, one.response) for one in steps]
                heat = heat._replace(w1=known[0], w2=known[1], r1=responses[0], r2=responses[1])
        else:
            q = solution.nodes.reynolds_unknown
            left = 1.0 + np.minimum(q, 0.0)
            film = np.where(loads.sheared_oil, loads.film * s.h, 0.0)
            at = self.reynolds.properties(q, solution.nodes.film, inputs)
            pressure_heat, gradient = np.empty(n), np.empty(n)
            faces(at, self.reynolds.face_law(inputs), total_flow, flow, pressure_heat, spread, gradient)
            flow *= self.capacity * s.u * s.h / s.dx
            total_flow *= self.capacity * s.u * s.h / s.dx
            source = source + np.where(loads.sheared_oil, pressure_heat, 0.0)
            if self.heat.thermal_expansion:
                rate = step.conditions.entrainment * gradient
                if step.dt:
                    rate += (pressure - record.pressure) / step.dt
                source = source + self.heat.thermal_expansion * record.film * film * left * rate
        heat = heat._replace(g=source, spread=spread)
        state = pressure, film, left, record.film, stored, flow
        if steps is None:
            found, bodies, responses = self._steady(record, heat, state, step.conditions)
        else:
            found = self._temperatures(heat, state, record.film)
            fluxes = found[1:3]
            bodies = [
                body.accept(one, q) for body, one, q in zip(self.bodies, steps, fluxes, strict=True)
            ]
            walls = [w + r * q for w, r, q in zip(heat[5:7], heat[7:9], fluxes, strict=True)]
            found, responses = (found, walls), heat[7:9]
        (t, q1, q2, shear), walls = found
        total, error = self._balance(t, q1, q2, shear + source, stored, flow, total_flow, record.film)
        return HeatRecord(
            t,
            *walls,
            q1,
            q2,
            source,
            spread,
            flow,
            *responses,
            pressure,
            *bodies,
            total,
            error,
            record.solved + 1,
        )

    def _temperatures(self, heat, state, guess):
        """Film temperatures, both fluxes and the heat of shear."""
        out = [np.empty(len(guess)) for _ in range(4)]
        pressure, film, left, old, stored, flow = state
        transport(guess, pressure, film, left, old, stored, flow, self.inlet, heat, *out)
        return out

    def _steady(self, record, heat, state, conditions):
        """Temperatures of a steady solution: both surfaces' and the film's made to agree."""
        speeds, bulk = (conditions.u1, conditions.u2), self.bulk
        heated = (np.abs(self.scene.scales.x) < 1.5) * 1.0
        responses = [b.steady(heated, u)[0] for b, u in zip(self.bodies, speeds, strict=True)]
        responses = [np.maximum(r, r.max() * 1e-2) for r in responses]
        n = len(heated)
        last = None

        def fluxes(q):
            nonlocal last
            rises = [b.steady(f, u) for b, f, u in zip(self.bodies, (q[:n], q[n:]), speeds, strict=True)]
            walls = [t0 + rise for t0, (rise, _) in zip(bulk, rises, strict=True)]
            known = [w - r * f for w, r, f in zip(walls, responses, (q[:n], q[n:]), strict=True)]
            guess = record.film if last is None else last[0][0]
            now = heat._replace(w1=known[0], w2=known[1], r1=responses[0], r2=responses[1])
            found = self._temperatures(now, state, guess)
            last = found, walls, [terms for _, terms in rises]
            return np.concatenate(found[1:3])

        q = mixing(fluxes, np.concatenate([record.flux_1, record.flux_2]))
        found, walls, terms = last
        halves = q[:n], q[n:]
        bodies = [b.record(f, a) for b, f, a in zip(self.bodies, halves, terms, strict=True)]
        return (found, walls), bodies, responses

    def _balance(self, t, q1, q2, sources, stored, flow, total_flow, old):
        """Heat dissipated [W/m], and what is missing of it in what takes it, over it."""
        dx, rise, was = self.scene.scales.dx, t - self.inlet, old - self.inlet
        # what the pressure moves is counted where it turns
        turned = np.diff(total_flow - flow)
        kept = stored - np.diff(total_flow)
        storage = (kept * rise - stored * was).sum() if stored.any() else (np.diff(total_flow) * -rise).sum()
        out = max(flow[-1], 0.0) * rise[-1] + max(-flow[0], 0.0) * rise[0] + (turned * rise).sum()
        total = sources.sum()
        missing = total - (q1 + q2).sum() - storage - out
        return dx * total, abs(missing) / total if total else 0.0

    def is_settled(self, before, after):
        """Whether a steady solution and its temperatures agree."""
        rise = max(np.abs(after.film - self.inlet).max(), 1e-3)
        return np.abs(after.film - before.film).max() < STEADY * rise

    def log_viscosity(self, record, pressure):
        """ln(eta/eta0) at the temperatures of a record."""
        from ehlpetsc.physics.thermal_viscosity import log_viscosity

        law = film_law(self.fluid, self.heat, 0.0)
        pairs = zip(pressure, record.film, strict=True)
        return np.array([log_viscosity(p, t, law.pressure_law, law.thermal_law)[0] for p, t in pairs])

    def observe(self, record, solution, step):
        """Temperatures and heat fluxes; their largest and mean values."""
        fields = dict(zip(self.fields, (record.film, *record[1:5]), strict=True))
        contact = np.abs(self.scene.scales.x) <= 1.0
        scalars = {"heat": record.heat, "heat_error": record.error}
        for name in ("film_temperature", "temperature_1", "temperature_2"):
            scalars |= {f"{name}_max": fields[name].max(), f"{name}_mean": fields[name][contact].mean()}
        return fields, scalars
