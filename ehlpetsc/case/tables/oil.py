"""Keys of `[fluid]` and `[heat]`: the oil, temperatures, thermal properties of oil and bodies."""

from __future__ import annotations

from typing import Any

from ehlpetsc.keys import Key, KeyTable, Values
from ehlpetsc.materials import OILS
from ehlpetsc.physics.laws import DENSITY_LAWS, LAWS, completed

GRADE = KeyTable(
    "fluid.grade",
    f"oil of data sheets at fluid.temperature or that of [heat]; or a name: {', '.join(OILS)}",
    {
        "v40": Key(
            "kinematic viscosity at 40 C",
            unit="m^2/s",
            gt=2e-6,
            le=0.1,
            required=True,
            equation="lg lg(nu + 0.7) = A - B lg T, nu in mm^2/s (ASTM D341); viscosity = nu density; "
            "alpha = 9.904 nu^0.139 /GPa (Gold et al. 2001)",
        ),
        "v100": Key(
            "kinematic viscosity at 100 C", unit="m^2/s", gt=2e-6, le=0.1, required=True, below="v40"
        ),
        "density": Key(
            "density at ambient pressure and the temperature of the oil; data sheets quote it at 15 C: "
            "subtract 0.07 % per K",
            unit="kg/m^3",
            ge=500,
            le=3000,
            required=True,
        ),
    },
)

FLUID = KeyTable(
    "fluid",
    "left out: dry contact",
    {
        "viscosity": Key(
            "viscosity at ambient pressure",
            unit="Pa s",
            ge=1e-6,
            le=1e4,
            required=True,
            replaced_by=("grade",),
        ),
        "grade": GRADE.key,
        "temperature": Key(
            "at which grade or a law of temperature gives the viscosity; left out: that of [heat]",
            unit="K",
            ge=200,
            le=700,
        ),
        "law": Key(
            "viscosity law",
            str,
            choices=tuple(LAWS),
            required=True,
            equation="; ".join(f"{name}: {law.equation}" for name, law in LAWS.items()),
        ),
        "pressure_viscosity": Key(
            "pressure-viscosity coefficient alpha; left out: of grade, or of a law that has it",
            unit="1/Pa",
            ge=1e-12,
            le=1e-6,
        ),
        "density": Key(
            "density law",
            str,
            choices=tuple(DENSITY_LAWS),
            required=True,
            equation="; ".join(f"{name}: {law.equation}" for name, law in DENSITY_LAWS.items()),
        ),
        **{
            name: key
            for laws in (LAWS, DENSITY_LAWS)
            for law in laws.values()
            for name, key in law.keys.items()
        },
        "eyring_stress": Key(
            "Eyring stress; left out: Newtonian",
            unit="Pa",
            ge=1e3,
            le=1e12,
            equation="du/dz = (tau0/eta) sinh(tau/tau0), tau0 = eyring_stress",
        ),
        "limiting_shear": Key(
            "limiting shear stress over pressure",
            ge=1e-4,
            le=1,
            equation="mean shear stress (tau^-4 + (limiting_shear p)^-4)^(-1/4), tau without it",
        ),
        "inlet_film": Key(
            "oil film at the inlet; left out: fully flooded",
            unit="m",
            ge=1e-10,
            le=1e-2,
            equation="h (1 - theta) = inlet_film at the first node",
        ),
    },
    complete=lambda fluid: completed(vars(fluid)),
)


class Heat(Values):
    """`[heat]`; without it the case is isothermal."""

    @property
    def oil_inlet_temperature(self) -> float:
        """Temperature of the oil that enters [K]."""
        return self.inlet_temperature or 0.5 * sum(self.bulk_temperature)


def _temperature(text: str, **more: Any) -> Key:
    return Key(text, unit="K", ge=150, le=2000, **more)


def _of_bodies(text: str, unit: str, ge: float, le: float, default: float) -> Key:
    return Key(f"{text} of the bodies", unit=unit, ge=ge, le=le, many="both", default=(default, default))


HEAT = KeyTable(
    "heat",
    "left out: isothermal; defaults are steel and mineral oil",
    {
        "bulk_temperature": _temperature(
            "temperature of the bodies far from the contact", many="both", required=True
        ),
        "inlet_temperature": _temperature("of the oil that enters; left out: mean of both bodies"),
        "conductivity": _of_bodies("conductivity", "W/(m K)", 1e-3, 1e4, 46.0),
        "density": _of_bodies("density", "kg/m^3", 10, 1e5, 7850.0),
        "heat_capacity": _of_bodies("heat capacity", "J/(kg K)", 10, 1e5, 470.0),
        "oil_conductivity": Key(
            "conductivity of the oil at ambient pressure", unit="W/(m K)", ge=1e-3, le=10, default=0.14
        ),
        "oil_conductivity_pressure": Key(
            "relative increase with pressure; mineral oils about 1e-9",
            unit="1/Pa",
            ge=0,
            le=1e-7,
            default=0.0,
            equation="k_f = oil_conductivity (1 + oil_conductivity_pressure p)",
        ),
        "oil_density": Key(
            "density of the oil at ambient pressure", unit="kg/m^3", ge=100, le=5000, default=860.0
        ),
        "oil_heat_capacity": Key("heat capacity of the oil", unit="J/(kg K)", ge=100, le=1e5, default=2000.0),
        "reference_temperature": _temperature(
            "at which fluid.viscosity holds; left out: fluid.temperature, or inlet_temperature"
        ),
        "viscosity_temperature": Key(
            "beta of the exponential law [0.04]",
            unit="1/K",
            ge=0,
            le=1,
            equation="ln(eta/eta0) = ln(eta(p)/eta0) - beta (T - T0)",
        ),
        "roelands_s0": Key(
            "S0 of Roelands' law",
            ge=0,
            le=10,
            needs=("heat.viscosity_temperature left out",),
            equation="ln(eta/eta0) = c ((1 + p/pr)^z ((T - 138)/(T0 - 138))^-S0 - 1), c = alpha pr/z",
        ),
        "thermal_expansion": Key(
            "beta_v of the oil, for the heat of compression; the density is that of the pressure",
            unit="1/K",
            ge=0,
            le=0.01,
            default=0.0,
            equation="heat beta_v T h (dp/dt + u dp/dx)",
        ),
    },
    needs=("[motion]",),
    values=Heat,
)
