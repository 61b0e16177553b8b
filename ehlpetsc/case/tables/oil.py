"""Keys of `[fluid]` and `[heat]`: the oil, temperatures, thermal properties of oil and bodies."""

from __future__ import annotations

from ehlpetsc.keys import Key, KeyTable, Required, Values
from ehlpetsc.materials import OILS
from ehlpetsc.physics.laws import DENSITY_LAWS, LAWS, completed

_equations = [{name: law.equation for name, law in laws.items()} for laws in (LAWS, DENSITY_LAWS)]
VISCOSITY, DENSITY = ("; ".join(f"{name}: {text}" for name, text in laws.items()) for laws in _equations)
TEMPERATURE = ("K", 150, 2000)

GRADE = KeyTable(
    "fluid.grade",
    f"oil of data sheets at fluid.temperature or that of [heat]; or a name: {', '.join(OILS)}",
    {
        "v40": Required(
            "kinematic viscosity at 40 C",
            *("m^2/s", None, 0.1, 2e-6),
            equation="lg lg(nu + 0.7) = A - B lg T, nu in mm^2/s (ASTM D341); viscosity = nu density; "
            "alpha = 9.904 nu^0.139 /GPa (Gold et al. 2001)",
        ),
        "v100": Required("kinematic viscosity at 100 C", "m^2/s", None, 0.1, 2e-6, below="v40"),
        "density": Required(
            "at the temperature of the oil; data sheets quote 15 C, less 0.07 % per K",
            "kg/m^3",
            500,
            3000,
        ),
    },
)
KEYS = {
    "viscosity": Required("at ambient pressure", "Pa s", 1e-6, 1e4, replaced_by=("grade",)),
    "grade": GRADE.key,
    "temperature": Key(
        "at which grade or a law of temperature gives the viscosity; left out: that of [heat]", "K", 200, 700
    ),
    "law": Required("viscosity law", choices=tuple(LAWS), equation=VISCOSITY),
    "pressure_viscosity": Key("alpha; left out: of grade, or of a law that has it", "1/Pa", 1e-12, 1e-6),
    "density": Required("density law", choices=tuple(DENSITY_LAWS), equation=DENSITY),
    **{name: key for laws in (LAWS, DENSITY_LAWS) for law in laws.values() for name, key in law.keys.items()},
    "eyring_stress": Key("tau0, du/dz = (tau0/eta) sinh(tau/tau0); left out: Newtonian", "Pa", 1e3, 1e12),
    "limiting_shear": Key(
        "limiting shear stress over pressure",
        *("", 1e-4, 1),
        equation="mean shear stress (tau^-4 + (limiting_shear p)^-4)^(-1/4), tau without it",
    ),
    "inlet_film": Key("h (1 - theta) at the first node; left out: fully flooded", "m", 1e-10, 1e-2),
}
FLUID = KeyTable("fluid", "left out: dry contact", KEYS, complete=lambda fluid: completed(vars(fluid)))


class Heat(Values):
    """`[heat]`; without it the case is isothermal."""

    @property
    def oil_inlet_temperature(self) -> float:
        """Temperature of the oil that enters [K]."""
        return self.inlet_temperature or 0.5 * sum(self.bulk_temperature)


def _of_bodies(text: str, unit: str, ge: float, le: float, default: float) -> Key:
    return Key(f"{text} of the bodies", unit, ge, le, many="both", default=(default, default))


HEAT_KEYS = {
    "bulk_temperature": Required("temperature of the bodies far from the contact", *TEMPERATURE, many="both"),
    "inlet_temperature": Key("of the oil that enters; left out: mean of both bodies", *TEMPERATURE),
    "conductivity": _of_bodies("conductivity", "W/(m K)", 1e-3, 1e4, 46.0),
    "density": _of_bodies("density", "kg/m^3", 10, 1e5, 7850.0),
    "heat_capacity": _of_bodies("heat capacity", "J/(kg K)", 10, 1e5, 470.0),
    "oil_conductivity": Key("at ambient pressure", "W/(m K)", 1e-3, 10, default=0.14),
    "oil_conductivity_pressure": Key(
        "b of k_f = oil_conductivity (1 + b p); mineral oils about 1e-9", "1/Pa", 0, 1e-7, default=0.0
    ),
    "oil_density": Key("at ambient pressure", "kg/m^3", 100, 5000, default=860.0),
    "oil_heat_capacity": Key("at ambient pressure", "J/(kg K)", 100, 1e5, default=2000.0),
    "reference_temperature": Key(
        "T0 at which viscosity holds; left out: fluid.temperature or inlet_temperature", *TEMPERATURE
    ),
    "viscosity_temperature": Key("beta [0.04] of ln(eta) = ln(eta(p)) - beta (T - T0)", "1/K", 0, 1),
    "roelands_s0": Key(
        "S0 of Roelands' law",
        *("", 0, 10),
        needs=("heat.viscosity_temperature left out",),
        equation="ln(eta/eta0) = c ((1 + p/pr)^z ((T - 138)/(T0 - 138))^-S0 - 1), c = alpha pr/z",
    ),
    "thermal_expansion": Key(
        "beta_v of the oil, heat of compression beta_v T h (dp/dt + u dp/dx)", "1/K", 0, 0.01, default=0.0
    ),
}
HEAT = KeyTable(
    "heat", "left out: isothermal; defaults: steel, mineral oil", HEAT_KEYS, needs=("[motion]",), values=Heat
)
