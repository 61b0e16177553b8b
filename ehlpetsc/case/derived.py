"""Values of a case that follow from named steels, oil grades and the short waves of its profiles."""

from __future__ import annotations

import math
from collections.abc import Set
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.base.declarations import Values
from ehlpetsc.base.errors import CaseError, ProfileError
from ehlpetsc.base.materials import GRADES, fatigue_constants, flow_pressure, named_steels
from ehlpetsc.base.toml_file import Tables
from ehlpetsc.case.checking import Fault, check, unsound_tables, values_of
from ehlpetsc.case.tables.contact import CONTACT, FLUID, GRADE, LAYER_NODES
from ehlpetsc.case.tables.surface import PROFILE
from ehlpetsc.case.values import allowed, is_allowed, is_number, show
from ehlpetsc.elasticity.bodies import reduced_modulus
from ehlpetsc.physics.contact.hertz import hertz_load
from ehlpetsc.physics.oil.law import STANDARD_TEMPERATURE
from ehlpetsc.physics.oil.laws import ROELANDS_PRESSURE, ROELANDS_VISCOSITY, reference_temperature, viscosity
from ehlpetsc.physics.oil.oils import OIL_SHEAR, OILS
from ehlpetsc.physics.oil.rheology import SHEAR_LAWS
from ehlpetsc.physics.oil.viscosity_laws import (
    gold_pressure_viscosity,
    roelands_slope_of_secant,
    walther,
    walther_constants,
)
from ehlpetsc.physics.scales import Scales

if TYPE_CHECKING:
    from ehlpetsc.case.tables import Case
    from ehlpetsc.gears.path import Path as ContactPath
    from ehlpetsc.gears.standards import Rating

MEASURED_KEY = "asperity_height"
DIGITS = 6  # of a measured asperity height


class NotDerived(Exception):
    """A value does not follow from a given key; `fault` states the reason."""

    def __init__(self, place: str, value: object, reason: str) -> None:
        super().__init__(reason)
        self.fault = Fault(place, f"{place} = {show(value)}: {reason}")


def with_derived(tables: Tables, unsound: Set[str]) -> tuple[Tables, list[Fault]]:
    """Tables of a case with the constants of its steels and of its oil, except those of unsound tables.

    With the faults of given keys from which they do not follow.
    """
    faults = []
    for derived, sources in DERIVATIONS:
        if not unsound & sources:
            try:
                tables = derived(tables)
            except NotDerived as error:
                faults.append(error.fault)
    return tables, faults


def _with_material(tables: Tables) -> Tables:
    """Elastic constants of the steels, and their flow pressure for ``yield_pressure = "material"``."""
    contact = tables.get("contact", {})
    if "material" not in contact:
        return tables
    steels = named_steels(contact["material"])
    elastic = ("youngs_modulus", "poisson_ratio")
    filled = {key: [getattr(steel, key) for steel in steels] for key in elastic} | contact
    if contact.get("yield_pressure") == "material":
        constants = [fatigue_constants(steel, tables.get("post", {})) for steel in steels]
        pressures = [flow_pressure(one["cyclic_strength"], one["cyclic_hardening"]) for one in constants]
        filled["yield_pressure"] = list(map(float, pressures))
    return tables | {"contact": filled}


def _with_approach(tables: Tables) -> Tables:
    """Load of the dry smooth point contact of a given approach, from which the scales come."""
    contact = tables.get("contact", {})
    elastic = [contact.get(key) for key in ("youngs_modulus", "poisson_ratio")]
    if not {"approach", "radius"} <= contact.keys() or None in elastic:
        return tables
    modulus = reduced_modulus(*([value] * 2 if is_number(value) else value for value in elastic))
    approach, (along, across), key = contact["approach"], contact["radius"], CONTACT.keys["load"]
    load = float(hertz_load(approach, along, across, modulus))
    if not is_allowed(key, load):
        limits = ((key.ge, "or more"), (key.le, "or less"))
        cures = [f"{approach * (limit / load) ** (2 / 3):.3g} m {side}" for limit, side in limits if limit]
        reason = f"the load of the dry contact, {load:.3g} N, is not allowed; allowed: "
        raise NotDerived("contact.approach", approach, reason + " and ".join(cures))
    return tables | {"contact": {"load": load} | contact}


def _with_grade(tables: Tables) -> Tables:
    """Viscosity by Walther's equation (ASTM D341) times the density, and alpha by Gold et al. (2001)."""
    fluid, heat = tables.get("fluid", {}), tables.get("heat", {})
    given, temperature = fluid.get("grade"), _oil_temperature(fluid, heat)
    grade = given
    if isinstance(grade, str):
        named = GRADES[grade]
        density = named.density if temperature is None else named.density_at(temperature)
        grade = {"v40": named.v40, "v100": named.v100, "density": density}
        fluid = fluid | {"grade": grade}
        tables = tables | {"fluid": fluid}
    oil = check(GRADE, grade)[0] if isinstance(grade, dict) else None
    if oil is None:
        return tables
    nu = math.nan
    if temperature is not None:
        with np.errstate(all="ignore"):
            nu = float(walther(temperature, *walther_constants(oil.v40, oil.v100))[0])  # mm^2/s
    eta, key = nu / 1e6 * oil.density, FLUID.keys["viscosity"]
    if not is_allowed(key, eta):  # far from 40 and 100 degrees C
        if "viscosity" in fluid:
            return tables
        reason = f"the viscosity at {temperature} K, {eta:.3g} Pa s, is not allowed; allowed: {allowed(key)}"
        needs = "needs the temperature of the oil, fluid.temperature"
        raise NotDerived("fluid.grade", given, needs if temperature is None else reason)
    properties = {"viscosity": eta} | fluid
    alpha = _slope(gold_pressure_viscosity(nu), properties)
    tables = tables | {"fluid": {"pressure_viscosity": alpha} | properties}
    return tables | {"heat": {"oil_density": oil.density} | heat} if heat else tables


def _slope(secant: float, fluid: Tables) -> float:
    """Pressure-viscosity coefficient [1/Pa] of a law with the secant of Gold et al. over 2000 bar."""
    constants = {"reference_viscosity": ROELANDS_VISCOSITY, "roelands_pressure": ROELANDS_PRESSURE} | fluid
    eta, reference, z = constants["viscosity"], constants["reference_viscosity"], fluid.get("roelands_z")
    if fluid.get("law") != "roelands" or z is None and eta <= reference:
        return secant
    return roelands_slope_of_secant(secant, math.log(eta / reference), constants["roelands_pressure"], z)


def _with_oil(tables: Tables) -> Tables:
    """Constants of a measured oil; a case with another shear law than the oil's has none of its shear law."""
    fluid, heat = tables.get("fluid", {}), tables.get("heat", {})
    if "oil" not in fluid:
        return tables
    oil, temperature = OILS[fluid["oil"]], _oil_temperature(fluid, heat) or STANDARD_TEMPERATURE
    if not 200.0 < temperature < 700.0:
        return tables
    of_fluid = oil.at(temperature) | {"temperature": temperature}  # of the slope of its law
    of_shear = SHEAR_LAWS[OIL_SHEAR].keys
    stresses = {next(iter(law.keys)) for law in SHEAR_LAWS.values() if law.keys}  # the one given chooses
    if stresses & fluid.keys() - of_shear.keys():
        of_fluid = {key: value for key, value in of_fluid.items() if key not in of_shear}
    tables = tables | {"fluid": of_fluid | fluid}
    return tables | {"heat": oil.heat | heat} if heat else tables


DERIVATIONS = (  # function, tables that it reads
    (_with_material, {"contact", "post"}),
    (_with_approach, {"contact"}),
    (_with_grade, {"fluid", "heat"}),
    (_with_oil, {"fluid", "heat"}),
)


def _oil_temperature(fluid: Tables, heat: Tables) -> float | None:
    """Temperature at which `viscosity` holds [K], None if there is none."""
    bulk = heat.get("bulk_temperature")
    if isinstance(bulk, list):
        bulk = sum(bulk) / len(bulk)
    given = heat.get("reference_temperature"), fluid.get("temperature"), heat.get("inlet_temperature"), bulk
    return next((value for value in given if value is not None), None)


def with_measured_layer(folder: Path, data: Tables, known: Set[str]) -> tuple[Tables, list[Fault]]:
    r"""Tables of a case with a number in place of ``asperity_height = "measured"``, and the faults.

    .. math:: \sigma^2=\sum_{surfaces}\overline{(z-z_S)^2},

    z_S the profile or map after the S-filter (`short_cutoff`), both with the scale of the case.

    `known`: places of faults that have been found already.
    """
    contact, place = data.get("contact"), f"contact.{MEASURED_KEY}"
    if not isinstance(contact, dict) or contact.get(MEASURED_KEY) != "measured":
        return data, []
    unresolved = [Fault(place, f'{place} = "measured": the surfaces have faults', is_consequence=True)]
    if unsound_tables(data, known) & {"contact", "surface", "series"}:
        return data, unresolved
    series, surface = data.get("series", {}), data.get("surface", {})
    varied = [series["key"]] if "key" in series else series.get("keys", [])
    if any(name.startswith("surface.") for name in varied):
        return data, [Fault(place, f'{place} = "measured": not in a series over surfaces; allowed: a number')]
    tables = [table for table in surface.values() if "short_cutoff" in table]
    if not tables:
        return data, [Fault(place, f'{place} = "measured": needs short_cutoff in [surface.1] or [surface.2]')]
    from ehlpetsc.surfaces.motion.profile_checks import OTHER_HEIGHTS
    from ehlpetsc.surfaces.samples import measured_samples

    try:
        profiles = [values_of(PROFILE, table) for table in tables]
        before = [measured_samples(folder, profile.copy({"short_cutoff": None})).z for profile in profiles]
        after = [measured_samples(folder, profile).z for profile in profiles]
    except (ProfileError, CaseError):  # reported by the checks of the profiles
        return data, unresolved
    removed = [float((z - z_s).std()) for z, z_s in zip(before, after, strict=True)]
    height = float(f"{math.hypot(*removed):.{DIGITS}g}")
    key = CONTACT.keys[MEASURED_KEY]
    if not is_allowed(key, height):
        found = f"short_cutoff removes waves of an rms height of {1e6 * height:.3g} um"
        bounds = f"{1e6 * key.ge:g} to {1e6 * key.le:g} um"
        return data, [Fault(place, f'{place} = "measured": {found}; allowed: {bounds}; {OTHER_HEIGHTS}')]
    return data | {"contact": contact | {MEASURED_KEY: height}}, []


def with_layer_stiffness(case: Case) -> Case:
    """Case whose layer has the stiffness of its longest wave, unless it is given."""
    contact = case.contact
    if contact is None or contact.law != "compliant" or contact.asperity_stiffness is not None:
        return case
    from ehlpetsc.physics.contact.asperities import asperity_stiffness

    surfaces = [case.surface.side(side) for side in ("1", "2")]
    tables = [table for surface in surfaces if surface for table in (surface, surface.synthetic)]
    cutoffs = [cutoff for table in tables if (cutoff := getattr(table, "short_cutoff", None))]
    longest = max(cutoffs, default=None) or LAYER_NODES * Scales.of(case).spacing
    stiffness = asperity_stiffness(contact.asperity_height, longest)
    return case.copy({"contact": contact.copy({"asperity_stiffness": stiffness})})


def modulus_of(case: Values) -> float:
    """Reduced modulus E' [Pa] of a case."""
    return reduced_modulus(case.contact.youngs_modulus, case.contact.poisson_ratio)


def rating_of(case: Values, folder: Path) -> Rating | None:
    """Gear pair with its contact, oil and temperatures, as standards need them; None without a pair or oil.

    Isothermal oils thin by their grade, or as `[heat]` takes by default; the pressure-viscosity coefficient
    depends on temperature as in ISO/TS 6336-22.
    """
    from ehlpetsc.gears.path import path_of_contact
    from ehlpetsc.gears.standards import Rating
    from ehlpetsc.physics.flash_temperature import STEEL, Solid
    from ehlpetsc.surfaces.samples import measured_samples

    if case.gears is None or case.fluid is None:
        return None
    fluid, heat = case.fluid, case.heat
    reference = reference_temperature(fluid, heat)
    solids = [STEEL, STEEL]
    if heat is not None:
        properties = zip(heat.conductivity, heat.density, heat.heat_capacity, strict=True)
        solids = [Solid(*of_body) for of_body in properties]
    bulk = 0.5 * sum(heat.bulk_temperature) if heat else reference
    missing = dict.fromkeys(("roelands_s0", "viscosity_temperature", "reference_temperature"))
    thermal = heat or Values(missing | {"oil_inlet_temperature": reference})
    profiles = [case.surface.side(side) for side in ("1", "2")]
    deviations = [measured_samples(folder, profile).z for profile in profiles if profile]
    roughness = sum(float(np.abs(z - z.mean()).mean()) for z in deviations) / 2.0

    def relative(temperature: np.ndarray) -> np.ndarray:
        return 1.0 + 516.0 * (1.0 / temperature - 1.0 / 311.0)

    path = path_of_contact(case.gears.pair)
    return Rating(
        path,
        modulus_of(case),
        roughness,
        lambda T: fluid.viscosity * np.exp(viscosity(0.0 * T, fluid, thermal, T)[0]),
        lambda T: fluid.pressure_viscosity * relative(T) / relative(reference),
        None if roughness else _film_friction(case, path),
        bulk,
        (heat.inlet_temperature if heat else None) or reference,
        (solids[0].effusivity, solids[1].effusivity),
        case.gears.oil_factor,
    )


def _film_friction(case: Values, path: ContactPath) -> np.ndarray:
    """Coefficient of friction of the smooth isothermal film along a path of contact, 0 without load."""
    from ehlpetsc.gears.path import hertz
    from ehlpetsc.physics.contact.geometry import LINE
    from ehlpetsc.physics.film_formulas import contact_films
    from ehlpetsc.physics.flash_temperature import expected_friction
    from ehlpetsc.physics.operation import Conditions

    modulus, found = modulus_of(case), np.zeros(len(path.rho))
    columns = zip(path.load, path.radius, path.speed_1, path.speed_2, strict=True)
    half_widths = hertz(path, modulus)[0]
    for k, conditions in enumerate(map(Conditions._make, columns)):
        if conditions.load > 0.0:
            film, _ = contact_films(LINE, modulus, 1.0, case.fluid, conditions)
            found[k] = expected_friction(
                case.fluid, conditions.load, half_widths[k], conditions.sliding, film
            )
    return found
