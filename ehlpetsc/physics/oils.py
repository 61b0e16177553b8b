"""Measured oils by name: values of the keys of `[fluid]` and `[heat]`, for ``fluid.oil``."""

from __future__ import annotations

import math
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

from ehlpetsc.physics.law import STANDARD_TEMPERATURE
from ehlpetsc.physics.laws import LAWS, ROELANDS_PRESSURE, ROELANDS_VISCOSITY
from ehlpetsc.physics.viscosity_laws import ROELANDS_ZERO


@dataclass(frozen=True)
class Oil:
    """A measured oil; `viscosity` and `pressure_viscosity` of `fluid` hold at 40 degrees C."""

    source: str
    fluid: dict[str, Any]
    heat: dict[str, float]

    def at(self, temperature: float) -> dict[str, Any]:
        """Keys of `[fluid]` where the viscosity is needed at a temperature [K]."""
        if self.fluid["law"] == "roelands":
            rise = (temperature - ROELANDS_ZERO) / (STANDARD_TEMPERATURE - ROELANDS_ZERO)
            theta = rise ** -self.heat["roelands_s0"]
            decades = math.log(self.fluid["viscosity"] / ROELANDS_VISCOSITY)
            changed = {
                "viscosity": ROELANDS_VISCOSITY * math.exp(theta * decades),
                "pressure_viscosity": theta * self.fluid["pressure_viscosity"],
                "roelands_z": self.fluid["pressure_viscosity"] * ROELANDS_PRESSURE / decades,
                "roelands_pressure": ROELANDS_PRESSURE,
            }
            return self.fluid | changed
        law, fluid = LAWS[self.fluid["law"]], SimpleNamespace(temperature=None, **self.fluid)
        ln_eta = law(0.0, temperature, law.constants(fluid, None))[0]
        return self.fluid | {"viscosity": self.fluid["viscosity"] * math.exp(ln_eta)}


_PAO = "data of github.com/DausdasKreuz/Thermoelastohydrodynamics_time_transient, which names no article"


def _pao(eta: float, alpha: float, s0: float, density: float, capacity: float, conductivity: float) -> Oil:
    """A polyalphaolefin; conductivity by Larsson & Andersson, Proc. IMechE J 214 (2000) 337."""
    return Oil(
        _PAO,
        {
            "viscosity": eta,
            "law": "roelands",
            "pressure_viscosity": alpha,
            "density": "dowson-higginson",
            "limiting_shear": 0.0395,
        },
        {
            "roelands_s0": s0,
            "oil_density": density,
            "oil_heat_capacity": capacity,
            "oil_conductivity": conductivity,
            "oil_conductivity_pressure": 1.40e-9,
            "oil_conductivity_saturation": 0.34e-9,
        },
    )


OILS = {
    "pao4": _pao(13.62e-3, 14.8e-9, 0.978, 815.8, 2049.0, 0.1407),
    "pao10": _pao(52.52e-3, 17.1e-9, 0.781, 835.0, 2046.0, 0.160),
    "pao40": _pao(345.8e-3, 23.89e-9, 0.610, 843.4, 2045.0, 0.1641),
    "t9": Oil(
        "naphthenic mineral oil: Bjoerling, Habchi, Bair, Larsson & Marklund, Tribol. Int. 66 (2013) 19; "
        "from memory",
        {
            "viscosity": 0.007946,
            "law": "yasutomi",
            "yasutomi_c1": 16.09,
            "yasutomi_c2": 17.38,
            "yasutomi_glass": 273.15 - 83.2,
            "yasutomi_a1": 188.95,
            "yasutomi_a2": 0.719e-9,
            "yasutomi_b1": 8.2e-9,
            "yasutomi_b2": -0.5278,
            "density": "dowson-higginson",
            "carreau_stress": 7e6,
            "carreau_exponent": 0.35,
            "carreau_width": 5.0,
            "limiting_shear": 0.083,
        },
        {
            "oil_density": 872.0,
            "oil_heat_capacity": 1950.0,
            "oil_conductivity": 0.118,
            "oil_conductivity_pressure": 1.54e-9,
            "oil_conductivity_saturation": 0.33e-9,
        },
    ),
}
