r"""Laws of the oil in tables: viscosity of pressure and temperature, density and conductivity of pressure.

A law is added by an entry in one of the tables, :class:`ehlpetsc.physics.oil.law.Law`. Shear laws are in
:mod:`ehlpetsc.physics.oil.rheology`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np

from ehlpetsc.base.compiled import address_of, call_at, inlined
from ehlpetsc.base.declarations import Key, Refused, Values
from ehlpetsc.physics.oil.law import (
    STANDARD_TEMPERATURE,
    Derivatives,
    FluidValues,
    Law,
    Numbers,
    OilLaw,
    padded,
    switched,
)
from ehlpetsc.physics.oil.rheology import SHEAR_LAWS, shear_law
from ehlpetsc.physics.oil.viscosity_laws import (
    DOOLITTLE,
    EXPONENTIAL,
    ISOTHERMAL,
    MIN_ABOVE_POLE,
    MIN_MODULUS,
    MODULUS,
    ROELANDS,
    ROELANDS_WALTHER,
    WALTHER,
    YASUTOMI,
    doolittle,
    modulus,
    power_law,
    walther_constants,
    yasutomi,
)

BETA = 0.04  # 1/K, where a case gives no thermal viscosity: mineral oils have 0.03 to 0.05
ROELANDS_S0 = 1.1  # where a case with his law of pressure gives none: mineral oils have 1 to 1.5
ROELANDS_PRESSURE = 1.96e8  # Pa
ROELANDS_VISCOSITY = 6.315e-5  # Pa s: ln eta0 + 9.67 = ln(eta0/6.315e-5)


def reference_temperature(fluid: FluidValues, heat: Values | None = None) -> float:
    """Temperature at which `fluid.viscosity` holds [K]."""
    given = getattr(fluid, "temperature", None)
    if heat is None:
        return given or STANDARD_TEMPERATURE
    return heat.reference_temperature or given or heat.oil_inlet_temperature


# ---- viscosity ----


def temperature_constants(
    fluid: FluidValues, heat: Values | None, factor: float | None = None
) -> tuple[float, float, float, float]:
    """Last four constants of :func:`power_law`; `factor` c of Roelands' law, None: not his."""
    reference = reference_temperature(fluid, heat)
    if heat is None:
        return ISOTHERMAL, 0.0, 0.0, reference
    if heat.roelands_s0 is not None:
        return ROELANDS, heat.roelands_s0, 0.0, reference
    if heat.viscosity_temperature is None and getattr(fluid, "grade", None) is not None:
        kind = ROELANDS_WALTHER if factor else WALTHER
        return kind, *walther_constants(fluid.grade.v40, fluid.grade.v100), reference
    if heat.viscosity_temperature is None and factor:
        return ROELANDS, ROELANDS_S0, 0.0, reference
    beta = BETA if heat.viscosity_temperature is None else heat.viscosity_temperature
    return EXPONENTIAL, beta, 0.0, reference


def _barus(fluid: FluidValues, heat: Values | None) -> tuple[float, ...]:
    return fluid.pressure_viscosity, 1.0, 1.0, *temperature_constants(fluid, heat)


def _roelands(fluid: FluidValues, heat: Values | None) -> tuple[float, ...]:
    pressure, z = fluid.roelands_pressure, fluid.roelands_z
    factor = fluid.pressure_viscosity * pressure / z
    return factor, pressure, z, *temperature_constants(fluid, heat, factor)


def _with_coefficient(fluid: FluidValues) -> dict[str, float]:
    if fluid.pressure_viscosity is None:
        raise Refused("", "pressure_viscosity")
    return {}


def _complete_roelands(fluid: FluidValues) -> dict[str, float]:
    """Exponent from the viscosity that the oil tends to under tension, by default Roelands' 6.315e-5 Pa s."""
    _with_coefficient(fluid)
    pressure = fluid.roelands_pressure or ROELANDS_PRESSURE
    if fluid.roelands_z is not None:
        return {"roelands_pressure": pressure}
    reference = fluid.reference_viscosity or ROELANDS_VISCOSITY
    if fluid.reference_viscosity is not None and reference >= fluid.viscosity:
        raise Refused("", "reference_viscosity")
    decades = math.log(fluid.viscosity / reference)
    z = fluid.pressure_viscosity * pressure / decades if decades > 0.0 else math.inf
    if fluid.reference_viscosity is None and not 1e-3 <= z <= 2.0:
        raise Refused(
            f"roelands_z is missing, and by viscosity and pressure_viscosity it is {z:.3g}; allowed: "
            "0.001 to 2 (viscosity in Pa s, pressure_viscosity in 1/Pa?)"
        )
    return {"roelands_z": z, "roelands_pressure": pressure}


def _doolittle(fluid: FluidValues, heat: Values | None) -> tuple[float, ...]:
    constants = *(getattr(fluid, name) for name in DOOLITTLE), 0.0
    ambient = doolittle(0.0, reference_temperature(fluid, heat), *constants)[0]
    return *constants[:-1], ambient / fluid.doolittle_b


def _yasutomi(fluid: FluidValues, heat: Values | None) -> tuple[float, ...]:
    c1, c2, glass, *others = (getattr(fluid, name) for name in YASUTOMI)
    above = reference_temperature(fluid, heat) - glass
    return c1, c2, glass, *others, above / (c2 + above)


def _modulus(fluid: FluidValues, heat: Values | None) -> tuple[float, ...]:
    c, d, *others = (getattr(fluid, name) for name in MODULUS)
    return 1.0, c, d, *others, c / (d + reference_temperature(fluid, heat))


def _complete_modulus(fluid: FluidValues) -> dict[str, float]:
    """Values as of :func:`_complete_with_slope`; refuse constants that are not those of T in K."""
    values = _complete_with_slope(fluid)
    T = reference_temperature(fluid)
    if fluid.modulus_d + T < MIN_ABOVE_POLE:
        raise Refused(f"at {T:g} K is D + T = {fluid.modulus_d + T:.3g} K; allowed: D of T in K", "modulus_d")
    if (m := fluid.modulus_a1 + fluid.modulus_a2 * T) < MIN_MODULUS:
        raise Refused(f"a1 + a2 T = {m:.3g} Pa at {T:g} K; allowed: {MIN_MODULUS:g} Pa", "modulus_a1")
    return values


def _complete_with_slope(fluid: FluidValues) -> dict[str, float]:
    """Pressure-viscosity coefficient of a law that needs all its keys, its slope at ambient pressure.

    It takes the place of one that is given, which films of formulas would have and the run would not.
    """
    law = LAWS[fluid.law]
    for name in law.keys:
        if getattr(fluid, name) is None:
            raise Refused("", name)
    slope = law(0.0, reference_temperature(fluid), law.constants(fluid, None))[1]
    return {"pressure_viscosity": float(slope)}


LAWS = {
    "barus": Law(power_law, _barus, "`ln(eta/eta0) = alpha p`", complete=_with_coefficient),
    "roelands": Law(
        power_law,
        _roelands,
        "`ln(eta/eta0) = (alpha p_r/z) ((1 + p/p_r)^z - 1)`, `z = alpha p_r/ln(eta0/reference_viscosity)`",
        {
            "roelands_pressure": Key("`p_r`; left out: 1.96e8", unit="Pa", ge=1e6, le=1e10, default=None),
            "roelands_z": Key(
                "exponent `z`; left out: `alpha p_r/ln(eta0/reference_viscosity)`", ge=1e-3, le=2
            ),
            "reference_viscosity": Key(
                "below viscosity, sets the exponent; left out: 6.315e-5, Roelands' constant",
                unit="Pa s",
                ge=1e-9,
                le=1,
            ),
        },
        _complete_roelands,
    ),
    "doolittle": Law(
        doolittle,
        _doolittle,
        "`ln(eta/eta0) = B (v_inf/(v - v_inf) - v_inf0/(v0 - v_inf0))`, `v` of Tait",
        DOOLITTLE,
        _complete_with_slope,
        of_temperature=True,
    ),
    "yasutomi": Law(
        yasutomi,
        _yasutomi,
        "`lg(eta/eta0) = C1 (x0/(C2 + x0) - x/(C2 + x))`, `x = (T - T_g) (1 + b1 p)^b2`",
        YASUTOMI,
        _complete_with_slope,
        of_temperature=True,
    ),
    "modulus": Law(
        modulus,
        _modulus,
        "`ln(eta/eta0) = C/(D + T) - C/(D + T0) + p/(a1 + a2 T + (b1 + b2 T) p)`",
        MODULUS,
        _complete_modulus,
        of_temperature=True,
    ),
}
BUILT_IN = tuple(LAWS.values())
N_BUILT_IN = len(BUILT_IN)  # positions; larger numbers are addresses
_ln_viscosity, _ln_viscosities = switched(LAWS, 2), switched(LAWS, 2, pair=True)


@inlined
def ln_viscosity(law: tuple, p: float, T: float) -> Derivatives:
    """ln(eta/eta0) at one state with its derivatives by p [1/Pa] and T [1/K]; law as of `viscosity_law`."""
    if law[0] >= N_BUILT_IN:
        return call_at(law[0], p, T, law[1])
    return _ln_viscosity(law[0], (p, T), law[1])


@inlined
def ln_viscosities(law: tuple, p: float, T: float, other: float) -> tuple[Derivatives, Derivatives]:
    """:func:`ln_viscosity` at two temperatures, in little more time."""
    if law[0] >= N_BUILT_IN:
        return call_at(law[0], p, T, law[1]), call_at(law[0], p, other, law[1])
    return _ln_viscosities(law[0], (p, T, other), law[1])


def viscosity_law(fluid: FluidValues, heat: Values | None = None) -> OilLaw:
    """Viscosity law of a case; `fluid.exponent_factor` below 1 is that of a continuation."""
    law = LAWS[fluid.law]
    first, *others = law.constants(fluid, heat)
    first *= getattr(fluid, "exponent_factor", 1.0)
    kind = BUILT_IN.index(law) if law in BUILT_IN else address_of(law.function, 1 + len(others), 2)
    return OilLaw(kind, padded((first, *others)), float(reference_temperature(fluid, heat)))


def viscosity(
    p: np.ndarray, fluid: FluidValues, heat: Values | None = None, T: Numbers | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """ln(eta/eta0), by default at the reference temperature, and its derivative by p [1/Pa]."""
    law = viscosity_law(fluid, heat)
    return LAWS[fluid.law](p, law.temperature if T is None else T, law.constants)[:2]


@cache
def is_linear_in_temperature(law: OilLaw, name: str) -> bool:
    """Whether the logarithm of the viscosity is linear in temperature, by the law of this name."""
    function, rise = LAWS[name], 0.1 * law.temperature
    (cold, _, slope), (hot, _, _) = (function(1e9, law.temperature + T, law.constants) for T in (0.0, rise))
    return abs(hot - cold - rise * slope) <= 1e-9 * abs(hot - cold)


# ---- conductivity ----


@inlined
def conductivity(p: float, ambient: float, c1: float, c2: float) -> tuple[float, float]:
    r"""Conductivity of an oil [W/(m K)], :math:`k_0[1+c_1p/(1+c_2p)]`, and its derivative by p.

    Larsson & Andersson, Proc. IMechE J 214 (2000) 337, doi:10.1243/1350650001543223, measured to 1.1 GPa.
    """
    over = 1.0 / (1.0 + c2 * p)
    return ambient * (1.0 + c1 * p * over), ambient * c1 * over * over


# ---- density ----


def compression(p: Numbers, gamma: float, lambda_: float) -> Derivatives:
    r"""Density over its ambient value, :math:`(1+\gamma p)/(1+\lambda p)`, and its derivative."""
    below = 1.0 + lambda_ * p
    return (1.0 + gamma * p) / below, (gamma - lambda_) / (below * below)


def incompressible(p: Numbers) -> Derivatives:
    """Density 1 and derivative 0."""
    return 1.0 + 0.0 * p, 0.0 * p


# the density law is (1 + gamma p)/(1 + lambda p): gamma is the sum of both constants as textbooks print them
TEXTBOOKS = "the density `1 + 0.6e-9 p/(1 + 1.7e-9 p)` of textbooks is gamma = 2.3e-9 and lambda = 1.7e-9"
DENSITY_CONSTANTS = {"gamma": 2.3e-9, "lambda_": 1.7e-9}  # 1/Pa


def _complete_density(fluid: FluidValues) -> dict[str, float]:
    values = {name: getattr(fluid, name) for name in DENSITY_CONSTANTS}
    missing = [name for name, value in values.items() if value is None]
    if len(missing) == 1:  # the default of one is no companion of another value
        raise Refused("", missing[0].rstrip("_"))
    values = DENSITY_CONSTANTS if missing else values
    if values["lambda_"] > values["gamma"]:  # the density would fall with pressure
        raise Refused("", "lambda")
    return values


DENSITY_LAWS = {
    "dowson-higginson": Law(
        compression,
        lambda fluid, heat: (fluid.gamma, fluid.lambda_),
        "`rho/rho0 = (1 + gamma p)/(1 + lambda p)`",
        {
            "gamma": Key(f"{TEXTBOOKS}, the default", unit="1/Pa", ge=0, le=1e-6),
            "lambda": Key(f"at most gamma; {TEXTBOOKS}, the defaults", unit="1/Pa", ge=0, le=1e-6),
        },
        _complete_density,
    ),
    "incompressible": Law(incompressible, lambda fluid, heat: (), "`rho = rho0`"),
}
DENSITY_BUILT_IN = tuple(DENSITY_LAWS.values())
N_DENSITY_BUILT_IN = len(DENSITY_BUILT_IN)
_relative_density = switched(DENSITY_LAWS, 1)


@inlined
def relative_density(law: tuple, p: float) -> Derivatives:
    """Density over its ambient value at one pressure, and its derivative [1/Pa]; law as of `density_law`."""
    if law[0] >= N_DENSITY_BUILT_IN:
        value, slope, _ = call_at(law[0], p, 0.0, law[1])
        return value, slope
    return _relative_density(law[0], (p,), law[1])


def density_law(fluid: FluidValues) -> OilLaw:
    """Density law of a case."""
    law = DENSITY_LAWS[fluid.density]
    constants = law.constants(fluid, None)
    built_in = law in DENSITY_BUILT_IN
    kind = DENSITY_BUILT_IN.index(law) if built_in else address_of(law.function, len(constants), 1)
    return OilLaw(kind, padded(constants))


def density(p: np.ndarray, fluid: FluidValues) -> tuple[np.ndarray, np.ndarray]:
    """Density over its ambient value under pressures [Pa], and its derivative [1/Pa]."""
    return DENSITY_LAWS[fluid.density](p, density_law(fluid).constants)


# ---- all tables ----


LAW_TABLES: tuple[Mapping[str, Law], ...] = (LAWS, DENSITY_LAWS, SHEAR_LAWS)


def names_in_use(fluid: FluidValues) -> tuple[str, ...]:
    """Name of the law that a case has of each of `LAW_TABLES`."""
    return fluid.law, fluid.density, shear_law(fluid)


def completed(fluid: Mapping[str, Any]) -> dict[str, Any]:
    """Values of `[fluid]` with those that its laws complete."""
    values = dict(fluid)
    of_temperature = values.get("grade") or values.get("oil") or LAWS[values["law"]].of_temperature
    if values.get("temperature") and not of_temperature:
        raise Refused(
            "needs fluid.grade or oil; the temperature of a given viscosity is heat.reference_temperature",
            "temperature",
        )
    for laws, name in zip(LAW_TABLES, names_in_use(SimpleNamespace(**values)), strict=True):
        values |= laws[name].complete(SimpleNamespace(**values))
    return values
