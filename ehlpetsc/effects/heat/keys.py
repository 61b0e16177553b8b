"""Keys of `[heat]`: temperatures, thermal properties of the bodies and of the oil."""

from __future__ import annotations

from ehlpetsc.base.declarations import Key, KeyTable, Required, Values

TEMPERATURE = ("K", 150, 2000)


class HeatValues(Values):
    """`[heat]`; without it the case is isothermal."""

    @property
    def oil_inlet_temperature(self) -> float:
        """Temperature of the oil that enters [K]."""
        return self.inlet_temperature or 0.5 * sum(self.bulk_temperature)


def _of_bodies(text: str, unit: str, ge: float, le: float, default: float) -> Key:
    return Key(f"{text} of the bodies", unit, ge, le, many="both", default=(default, default))


KEYS = {
    "bulk_temperature": Required(
        'of the bodies far from the contact; "losses": of gears, by their losses', *TEMPERATURE, many="both"
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
    "heat", "left out: isothermal; defaults: steel, mineral oil", KEYS, needs=("[motion]",), values=HeatValues
)
