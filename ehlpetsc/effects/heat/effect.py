r"""Heat: temperatures of the film and of both surfaces, and the viscosity at them.

Equations and the temperature of a node: :mod:`ehlpetsc.effects.heat.film_law`; conduction into the bodies:
:mod:`ehlpetsc.effects.heat.half_spaces`. In the solve of a step the temperature of a node follows
from its pressure and film, with the response of both surfaces to the flux of the step; heat of the pressure
flow and of rubbing solids, and the heat that the film carries along, are those of the last level there. Of
the accepted solution all temperatures and fluxes are then computed with its own flow, so that the energy
balance holds in every step. The stored film temperature is that of the solve: with pressure, film and void
fraction it is one state.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from ehlpetsc.base.declarations import Field, Key, KeyTable, Required, StepScalar, Values
from ehlpetsc.base.quantities import AtEnd, Error
from ehlpetsc.effects.effect import Effect, Step
from ehlpetsc.effects.heat.record import MIN_TEMPERATURE_RISE, HeatRecord, interpolated, mixed_record

if TYPE_CHECKING:
    from ehlpetsc.discretisation.ehl_problem import Solution, StepInputs
    from ehlpetsc.effects.heat.step import HeatStep
    from ehlpetsc.physics.scales import Scales

TEMPERATURE = ("K", 150, 2000)


class HeatValues(Values):
    """`[heat]`; without it the case is isothermal."""

    @property
    def oil_inlet_temperature(self) -> float:
        """Temperature of the oil that enters [K]."""
        return self.inlet_temperature or 0.5 * sum(self.bulk_temperature)


def _of_bodies(text: str, unit: str, ge: float, le: float, default: float) -> Key:
    return Key(f"{text} of the bodies", unit, ge, le, many="both", default=(default, default))


HEAT_KEYS = {
    "bulk_temperature": Required(
        'of the bodies far from the contact; "losses": of gears, by their losses',
        *TEMPERATURE,
        many="both",
        words=("losses",),
    ),
    "inlet_temperature": Key("of the oil that enters; left out: mean of both bodies", *TEMPERATURE),
    "conductivity": _of_bodies("conductivity", "W/(m K)", 1e-3, 1e4, 46.0),
    "density": _of_bodies("density", "kg/m^3", 10, 1e5, 7850.0),
    "heat_capacity": _of_bodies("heat capacity", "J/(kg K)", 10, 1e5, 470.0),
    "oil_conductivity": Key("at ambient pressure", "W/(m K)", 1e-3, 10, default=0.14),
    "oil_conductivity_pressure": Key(
        "`b` of `k_f = oil_conductivity (1 + b p/(1 + c p))`, of paraffinic mineral oil",
        *("1/Pa", 0, 1e-7),
        default=1.72e-9,
    ),
    "oil_conductivity_saturation": Key("c of it", "1/Pa", 0, 1e-7, default=0.54e-9),
    "oil_density": Key("at ambient pressure", "kg/m^3", 100, 5000, default=860.0),
    "oil_heat_capacity": Key("at ambient pressure", "J/(kg K)", 100, 1e5, default=2000.0),
    "reference_temperature": Key(
        "`T0` at which viscosity holds; left out: fluid.temperature or inlet_temperature", *TEMPERATURE
    ),
    "viscosity_temperature": Key(
        "`beta` of `ln eta = ln eta(p) - beta (T - T0)`; left out: by grade, or roelands_s0 where law is "
        "Roelands', 0.04 otherwise",
        *("1/K", 0, 1),
    ),
    "roelands_s0": Key(
        "`S0` of Roelands' law [1.1]",
        *("", 0, 10),
        needs=("heat.viscosity_temperature left out",),
        equation="`ln(eta/eta0) = c ((1 + p/p_r)^z ((T - 138)/(T0 - 138))^(-S0) - 1)`, `c = alpha p_r/z`",
    ),
    "thermal_expansion": Key(
        "`beta_v` of the oil, heat of compression `beta_v T h (dp/dt + u dp/dx)`", "1/K", 0, 0.01, default=0.0
    ),
}
HEAT = KeyTable(
    "heat",
    "left out: isothermal; defaults: steel, mineral oil",
    HEAT_KEYS,
    needs=("[motion]",),
    values=HeatValues,
)

STEADY = 2e-5  # of the maximum temperature rise: change between two solutions that ends the steady start


def _temperature(name: str, over_run: str) -> StepScalar:
    return StepScalar("K", name, over_run=over_run, summary=".5g" if over_run == "max" else "", compared=True)


class Heat(Effect[HeatRecord]):
    """Film and surface temperatures."""

    name = "heat"
    table = HEAT
    record = HeatRecord
    fields = {
        "film_temperature": Field("K", "mean temperature across the film"),
        "temperature_1": Field("K", "temperature of surface 1"),
        "temperature_2": Field("K", "temperature of surface 2"),
        "heat_flux_1": Field("W/m^2", "heat flux into body 1"),
        "heat_flux_2": Field("W/m^2", "heat flux into body 2"),
    }
    scalars = {
        "film_temperature_max": _temperature("highest film temperature", "max"),
        "film_temperature_mean": _temperature("film temperature, mean over the Hertz contact", "last"),
        "temperature_1_max": _temperature("highest temperature of surface 1", "max"),
        "temperature_1_mean": _temperature("temperature of surface 1, mean over the Hertz contact", "last"),
        "temperature_2_max": _temperature("highest temperature of surface 2", "max"),
        "temperature_2_mean": _temperature("temperature of surface 2, mean over the Hertz contact", "last"),
        "heat": AtEnd("W", "heat dissipated", integrated=True, compared=True),
        "heat_error": Error(
            "imbalance of the heat dissipated with that taken by bodies and oil, over the first"
        ),
    }

    @cached_property
    def _steps(self) -> HeatStep:
        from ehlpetsc.effects.heat.step import HeatStep

        return HeatStep(self.scene)

    def start(self, before: HeatRecord | None = None) -> HeatRecord:
        """Bodies at bulk temperature, also after a pass before, and oil at that of the inlet."""
        n, steps = self.scene.scales.grid.n, self._steps
        cold: dict[str, Any] = dict.fromkeys(HeatRecord._fields, np.zeros(n))
        cold |= dict.fromkeys(("film", "base", "solved"), np.full(n, steps.inlet))
        for side, bulk, body in zip("12", steps.bulk, steps.bodies, strict=True):
            cold |= {f"wall_{side}": np.full(n, bulk), f"body_{side}": body.cold()}
        return HeatRecord(**cold | {"flow": np.zeros(n + steps.rows), "heat": 0.0, "error": 0.0, "levels": 0})

    def interpolated(self, record: HeatRecord, scales: Scales) -> HeatRecord | None:
        """Temperatures on the nodes of this scene."""
        return interpolated(record, scales.grid, self.scene.scales.grid)

    def inputs(self, record: HeatRecord, inputs: StepInputs, step: Step) -> StepInputs:
        """Oil at the film's temperature; the first steady solution is isothermal."""
        if not record.levels or inputs.oil is None:
            return inputs
        return replace(inputs, oil=self._steps.film_heat(record, inputs, step))

    def accept(self, record: HeatRecord, solution: Solution, step: Step) -> HeatRecord:
        """Temperatures and fluxes of a solution."""
        steps = self._steps
        temperatures, film, source, spread, solved = steps.solve(record, solution, step)
        heat, error = steps.balance(temperatures, film, source)
        return HeatRecord(
            film=temperatures.film,
            wall_1=temperatures.walls[0],
            wall_2=temperatures.walls[1],
            flux_1=temperatures.fluxes[0],
            flux_2=temperatures.fluxes[1],
            base=temperatures.state[0],
            profile=temperatures.state[1],
            solved=temperatures.film if solution.inputs.fluid is None else solved,
            shear=temperatures.stress,
            source=source,
            rubbing=np.zeros_like(film.rubbing) if steps.thinnest else film.rubbing,
            spread=spread,
            flow=film.couette,
            response_1=temperatures.responses[0],
            response_2=temperatures.responses[1],
            pressure=film.pressure,
            **steps.rates(temperatures, film, solution, step),
            body_1=temperatures.bodies[0],
            body_2=temperatures.bodies[1],
            heat=heat,
            error=error,
            levels=record.levels + 1,
        )

    def mixed(self, pairs: Sequence[tuple[HeatRecord, HeatRecord]]) -> HeatRecord:
        """Record for the next steady solve, by Anderson's acceleration."""
        return mixed_record(pairs, self._steps.inlet)

    def is_settled(self, before: HeatRecord | None, after: HeatRecord) -> bool:
        """Whether a steady solution and its temperatures agree."""
        rise = max(np.abs(after.film - self._steps.inlet).max(), MIN_TEMPERATURE_RISE)
        return self.scene.case.fluid is None or np.abs(after.film - before.film).max() < STEADY * rise

    def film_shear(
        self, record: HeatRecord, solution: Solution, shear: np.ndarray | None
    ) -> np.ndarray | None:
        """Mean shear stress of the film [Pa], resolved across it; None without oil."""
        return shear if solution.inputs.fluid is None else record.shear

    def observe(self, record: HeatRecord, solution: Solution, step: Step) -> tuple[dict, dict]:
        """Temperatures and heat fluxes; their maximum and mean values."""
        values = record.solved, record.wall_1, record.wall_2, record.flux_1, record.flux_2
        fields = dict(zip(self.fields, values, strict=True))
        scalars, scales = {"heat": record.heat, "heat_error": record.error}, self.scene.scales
        contact = scales.grid.inside(scales.size(step.conditions))  # of the instant
        for name in ("film_temperature", "temperature_1", "temperature_2"):
            scalars |= {f"{name}_max": fields[name].max(), f"{name}_mean": fields[name][contact].mean()}
        return fields, scalars
