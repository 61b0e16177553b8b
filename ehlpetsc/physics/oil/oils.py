"""Measured oils by name: values of the keys of `[fluid]` and `[heat]`, for ``fluid.oil``.

Pressure and temperature of the film change the viscosity by the modulus law. The limiting shear stress is
Hoeglund's (1999), as Arana et al. (2019) print it, the Eyring stress Bair and Winer's, see
:meth:`MeasuredOil.at`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

from ehlpetsc.physics.oil.law import STANDARD_TEMPERATURE
from ehlpetsc.physics.oil.laws import LAWS
from ehlpetsc.physics.oil.viscosity_laws import KELVIN

MINERAL, NAPHTHENIC, PAO = 0.047, 0.053, 0.035  # limiting shear stress over pressure
CONDUCTIVITY = {  # W/(m K), 1/Pa, 1/Pa: at ambient pressure, rise with pressure and saturation
    PAO: (0.16, 1.40e-9, 0.34e-9),
    NAPHTHENIC: (0.118, 1.54e-9, 0.33e-9),
    MINERAL: (0.134, 1.72e-9, 0.54e-9),
}  # Larsson & Andersson, Proc. IMechE J 214 (2000) 337; ambient value of the mineral oil: Wingertszahn 2023
OIL_SHEAR = "eyring"  # shear law of all oils, whose stress grows with pressure


@dataclass(frozen=True)
class MeasuredOil:
    """A measured oil; `viscosity` of `fluid` holds at 40 degrees C."""

    source: str
    fluid: dict[str, Any]
    heat: dict[str, float]

    def at(self, temperature: float) -> dict[str, Any]:
        r"""Keys of `[fluid]` where the viscosity is needed at a temperature [K].

        Eyring stress of Bair and Winer, :math:`2\Lambda/\alpha(p,T)`, :math:`\alpha=1/m` the secant of the
        modulus law: :math:`2\Lambda[a_1+a_2T+(b_1+b_2T)p]` at this temperature, not falling with pressure.
        """
        law, fluid = LAWS[self.fluid["law"]], SimpleNamespace(temperature=None, **self.fluid)
        ln_eta, slope, _ = law(0.0, temperature, law.constants(fluid, None))
        ambient = fluid.modulus_a1 + fluid.modulus_a2 * temperature
        rise = fluid.modulus_b1 + fluid.modulus_b2 * temperature
        return self.fluid | {
            "viscosity": self.fluid["viscosity"] * math.exp(ln_eta),
            "pressure_viscosity": float(slope),
            "eyring_stress": 2.0 * fluid.limiting_shear * ambient,
            "eyring_stress_pressure": max(rise / ambient, 0.0),
        }


def _of_modulus(
    source: str, limit: float, density: float, law: tuple[float, ...], zero: float = 0.0, **others: float
) -> MeasuredOil:
    """Oil of the modulus law by K [Pa s], C, D, a1, a2, b1, b2 of temperatures above `zero` [K]."""
    k, c, d, a1, a2, b1, b2 = law
    ambient, rise, saturation = CONDUCTIVITY[limit]
    return MeasuredOil(
        source,
        {
            "viscosity": k * math.exp(c / (d + STANDARD_TEMPERATURE - zero)),
            "law": "modulus",
            "modulus_c": c,
            "modulus_d": d - zero,
            "modulus_a1": a1 - zero * a2,
            "modulus_a2": a2,
            "modulus_b1": b1 - zero * b2,
            "modulus_b2": b2,
            "density": "dowson-higginson",
            "limiting_shear": limit,
            **others,
        },
        {
            "oil_density": density,
            "oil_heat_capacity": 2000.0,
            "oil_conductivity": ambient,
            "oil_conductivity_pressure": rise,
            "oil_conductivity_saturation": saturation,
        },
    )


_ARANA = "Arana, Larranaga & Ulacia, Proc. IMechE J 233 (2019) 303, falling-body viscometer"

OILS = {
    "fva3": _of_modulus(
        "mineral reference oil FVA 3, ISO VG 100: Wingertszahn et al., Lubricants 11 (2023) 369, table A1",
        MINERAL,
        872.6,  # 887.6 at 15 degrees C, less 0.6 per K, at 40
        (0.062e-3, 1021.7, 101.5517, 327.7918e5, 2.9862e5, 4.419e-3, 3.0115e-4),
        KELVIN,
    ),
    "m100": _of_modulus(
        f"mineral reference oil FVA 3, ISO VG 100: {_ARANA}",
        MINERAL,
        882.0,
        (86.86e-6, 890.0, -182.0, -2.28e7, 2.26e5, -0.06820, 27.68e-5),
    ),
    "n100": _of_modulus(
        f"naphthenic, ISO VG 100: {_ARANA}",
        NAPHTHENIC,
        900.0,
        (161.6e-6, 650.0, -206.0, -7.23e7, 3.48e5, 5.00e-3, -1.83e-5),
    ),
    "pao100": _of_modulus(
        f"polyalphaolefin, ISO VG 100: {_ARANA}",
        PAO,
        840.0,
        (12.26e-6, 1740.0, -116.0, -5.73e7, 3.90e5, -0.0395, 23.54e-5),
    ),
    "shc320": _of_modulus(
        "polyalphaolefin SHC 320, ISO VG 320: fitted to viscosities to 400 MPa measured by flucon for IMKT "
        "Hannover 2014, from github.com/ngocminhdao88/dao_masterarbeit, to 2 % rms, 6 % at most",
        PAO,
        846.9,
        (0.2261e-3, 973.58, -176.432, -1.35312e8, 6.89389e5, -0.295586, 1.0884975e-3),
        gamma=2.52e-9,
        **{"lambda": 1.82e-9},
    ),
}
