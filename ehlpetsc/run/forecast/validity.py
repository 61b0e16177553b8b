"""Validity of the model: warnings about a case before it runs, limits of its result.

The `limits` follow from the totals over all steps, are printed at the end of a run and stored in its file.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.base.quantities import MIN_CONTINUUM_FILM, STEP_SCALARS, unit_in
from ehlpetsc.case.checking import attribute
from ehlpetsc.physics.film_formulas import expected_film
from ehlpetsc.physics.oil.laws import LAW_TABLES, names_in_use, reference_temperature, viscosity
from ehlpetsc.physics.oil.oils import OIL_SHEAR, OILS
from ehlpetsc.physics.oil.rheology import shear_law
from ehlpetsc.run.forecast.domain import domain_warnings, rolling_warnings, strip_warnings

if TYPE_CHECKING:
    from ehlpetsc.case.tables import Case
    from ehlpetsc.case.tables.contact import Contact
    from ehlpetsc.physics.scales import Scales
    from ehlpetsc.surfaces.motion.roughness import Roughness

MIN_HERTZ, MAX_HERTZ = 0.1e9, 10e9  # Pa: Hertz pressures of EHL contacts, with a margin
MAX_EHL_FILM = 0.1  # half-widths: films of EHL contacts are at most a hundredth of a half-width
MAX_TILT_VARIANCE = 0.5  # of the height variance: a profile with more in a straight line counts as tilted
MIN_YIELD_PRESSURE = 0.25  # of p0: softer solids yield as a whole
ASPERITY_YIELD_PRESSURE = 5e9  # Pa: asperities of hardened steel flow at 5 to 8 GPa
MAX_MEASURED_VISCOSITY = 1e7  # Pa s: about the highest measured viscosity of oils
MAX_MASS_ERROR = 0.05  # of the oil in the contact
SAME_COEFFICIENT = 1e-3  # relative, of pressure-viscosity coefficients
MAX_OIL_FRICTION = 0.15  # shear stress of oils over their pressure: up to about 0.1
# temperatures [K] above which: round numbers without a source; a flash does less than a furnace
MAX_STEEL = 800.0, "hardened steel softens"
MAX_OIL = 700.0, "oils crack"
MIN_SHARE_OF_SOLIDS = 0.01  # of the load: with more their coefficient of friction matters
FLATTENED = 0.01  # film over the rms height of the layer: below it the mesh does not resolve the film
MAX_DECADES = 300  # log10 of the maximum viscosity that is printed with digits


def warnings(case: Case, scales: Scales, rough: Roughness | None = None) -> list[str]:
    """Warnings before a run, one message each; `rough`: surfaces of the case, None: read here."""
    notes = [*_scene_warnings(case, scales), *_oil_warnings(case), *domain_warnings(case, scales)]
    if case.surface.body_1 or case.surface.body_2:
        from ehlpetsc.surfaces.motion.profile_checks import entry_warnings, mesh_warnings
        from ehlpetsc.surfaces.motion.roughness import Roughness

        profiles = rough or Roughness.of(case, scales)
        notes += [*_tilt_warnings(case, profiles), *entry_warnings(case, scales, profiles)]
        notes += [*mesh_warnings(profiles, scales), *strip_warnings(case, scales)]
    return notes + rolling_warnings(case, scales) + heat_warnings(case, scales)


def _scene_warnings(case: Case, scales: Scales) -> Iterator[str]:
    """Solids that yield, roughness at rest; magnitudes outside EHL contacts, most likely wrong units."""
    if case.contact.yield_pressure and min(case.contact.yield_pressure) < MIN_YIELD_PRESSURE * scales.p0:
        yield (
            f"contact.yield_pressure = {1e-9 * min(case.contact.yield_pressure):g} GPa is below a quarter of "
            f"Hertz' {1e-9 * scales.p0:.3g} GPa: the solids yield as a whole, beyond half-space theory"
        )
    if case.gears:
        yield from case.gears.notes
    rough = [f"surface.{name}" for name in ("1", "2") if case.surface.side(name)]
    if rough and case.time is None and case.motion is not None:
        yield (
            f"{' and '.join(rough)} with [motion] but without [time]: "
            "the roughness is held still under the film; add [time] to let it move"
        )
    if not MIN_HERTZ <= scales.p0 <= MAX_HERTZ:
        yield (
            f"Hertz' pressure p0 = {1e-9 * scales.p0:.3g} GPa: EHL contacts have "
            f"{1e-9 * MIN_HERTZ:g} to {1e-9 * MAX_HERTZ:g} GPa; "
            f"radius = {scales.R:g} m, load = {scales.load:g} {load_unit(case)}?"
        )
    film = expected_film(case, scales) * scales.h if case.fluid else 0.0
    if film > MAX_EHL_FILM * scales.a:
        yield (
            f"the expected film, {1e6 * film:.3g} um, is more than a tenth of the contact's half-width, "
            f"{1e6 * scales.a:.3g} um: "
            f"viscosity = {scales.eta0:g} Pa s, entrainment_speed = {scales.u:g} m/s?"
        )


def load_unit(case: Case) -> str:
    """Unit of the load of a case."""
    return unit_in(STEP_SCALARS["load"], case.kind)


def heat_warnings(case: Case, scales: Scales) -> list[str]:
    """Warning of an isothermal case with a high estimated flash temperature."""
    friction = case.contact.boundary_friction if case.motion else None
    if case.motion and case.fluid:
        from ehlpetsc.physics.flash_temperature import expected_friction

        film = expected_film(case, scales) * scales.h
        sliding = scales.u1 - scales.u2
        friction = expected_friction(case.fluid, scales.load_per_length, scales.a, sliding, film)
    return list(isothermal(case, scales, friction))


def _oil_warnings(case: Case) -> Iterator[str]:
    """Oil constants that none of the case's laws uses, and a shear law in place of that of a measured oil."""
    if (fluid := case.fluid) is None:
        return
    if fluid.oil and (law := shear_law(fluid)) != OIL_SHEAR:
        rise = OILS[fluid.oil].at(reference_temperature(fluid, case.heat))["eyring_stress_pressure"]
        if rise > 0.0:
            yield (
                f"the stress of the {law} law takes the place of the Eyring stress of "
                f'fluid.oil = "{fluid.oil}": '
                f"it is constant, and that grows by {1e9 * rise:.3g} of itself per GPa"
            )
    of_laws = {name: key for laws in LAW_TABLES for law in laws.values() for name, key in law.keys.items()}
    given = {name for name, key in of_laws.items() if getattr(fluid, attribute(name)) != key.default}
    in_use = [laws[name] for laws, name in zip(LAW_TABLES, names_in_use(fluid), strict=True)]
    unused = sorted(f"fluid.{name}" for name in given.difference(*(law.keys for law in in_use)))
    coefficient = case._tables["fluid"].get("pressure_viscosity")
    if coefficient is not None and abs(fluid.pressure_viscosity / coefficient - 1.0) > SAME_COEFFICIENT:
        yield (
            f'fluid.pressure_viscosity = {coefficient:g}: not used by law = "{fluid.law}", whose constants '
            f"give {fluid.pressure_viscosity:.3g} 1/Pa"
        )
    if unused:
        yield f'{", ".join(unused)}: not used by law = "{fluid.law}", density = "{fluid.density}"'


def _tilt_warnings(case: Case, profiles: Roughness) -> Iterator[str]:
    """Profiles and maps whose heights are mostly a straight line or plane, a tilt of the measurement."""
    for side in ("1", "2"):
        profile, spec = profiles.side(side), case.surface.side(side)
        if not profile or not profile.given.measured or spec.level:
            continue
        z = profile.given.z
        axes = [(profile.X, z.mean(axis=0))]
        if len(z) > 1:
            axes.append((profile.given.Y, z.mean(axis=1)))
        slopes = [np.polyfit(X - X.mean(), heights, 1)[0] for X, heights in axes]
        variance = sum(slope**2 * X.var() for slope, (X, _) in zip(slopes, axes, strict=True))
        total = float(z.var())  # 0 also of heights whose squares are below the smallest number
        fraction = variance / total if total else 0.0
        if fraction > MAX_TILT_VARIANCE:
            rises = [(abs(slope) * np.ptp(X), np.ptp(X)) for slope, (X, _) in zip(slopes, axes, strict=True)]
            text = " and ".join(f"{1e6 * rise:.3g} um over {1e3 * length:.3g} mm" for rise, length in rises)
            yield (
                f"surface.{side}: {100 * fraction:.0f} % of the height variance is a "
                f"{'plane' if len(z) > 1 else 'straight line'} ({text}); level = true takes it off"
            )


def limits(
    case: Case,
    scales: Scales,
    rough: Roughness | None,
    totals: dict[str, float],
    boundary_friction: float | None = None,
) -> list[str]:
    """Messages on results outside the validity of the model.

    `totals`: scalars over the run, see `ehlpetsc.results.means.Totals`.
    `boundary_friction`: maximum over the run, of effects too; None: that of the case.
    """
    if "p_max" not in totals:  # no step was taken
        return []
    friction = case.contact.boundary_friction if boundary_friction is None else boundary_friction
    of_oil = _of_oil(case, totals, friction) if case.fluid else []
    heat = (f"heat: {note}" for note in isothermal(case, scales, totals.get("friction_coefficient")))
    mesh = []
    if rough:
        from ehlpetsc.surfaces.motion.profile_checks import mesh_warnings

        mesh = [f"mesh: {note}" for note in mesh_warnings(rough, scales)]
    return [
        *_of_solids(case.contact, totals),
        *_of_default_friction(case, scales, totals),
        *mesh,
        *heat,
        *_of_temperatures(totals),
        *of_oil,
    ]


def _of_solids(contact: Contact, totals: dict[str, float]) -> Iterator[str]:
    if contact.yield_pressure is None and totals["p_max"] > ASPERITY_YIELD_PRESSURE:
        yield (
            f"pressure: up to {1e-9 * totals['p_max']:.2f} GPa, but asperities of hardened steel flow at "
            f"{1e-9 * ASPERITY_YIELD_PRESSURE:g} to 8 GPa, and these solids are elastic; "
            "in mixed contact yield_pressure lets them flow"
        )
    height = contact.asperity_height
    if height is not None and totals["h_min"] - contact.adsorbed_film < FLATTENED * height:
        yield (
            f"layer: flattened from {1e9 * height:.3g} nm to a film of {1e9 * totals['h_min']:.2g} nm: "
            "friction and load on the solids depend on the mesh there; a longer short_cutoff with "
            'asperity_height = "measured" gives a thicker layer'
        )


def _of_default_friction(case: Case, scales: Scales, totals: dict[str, float]) -> Iterator[str]:
    """Note on solids that carry load with a coefficient of friction that the case does not give."""
    share, of = totals.get("contact_share", 1.0), "load"
    if case.fluid and not case.contact.has_contact_pressure:
        nodes = scales.grid.inside(1.0).sum() * (totals.get("step", 0) + 1)
        share, of = totals.get("contacts", 0) / nodes, "Hertz contact, in the mean"
    if case.default_friction is not None and share >= MIN_SHARE_OF_SOLIDS:
        yield (
            f"friction: the solids carry up to {100 * share:.3g} % of the {of}, with a coefficient of "
            f"friction of {case.default_friction:g}, the default; contact.boundary_friction sets theirs"
        )


def isothermal(case: Case, scales: Scales, friction: float | None) -> Iterator[str]:
    """Note on an isothermal case with a hot film by its coefficient of friction, if known."""
    if friction is None or case.heat is not None or case.motion is None:
        return
    from ehlpetsc.physics.flash_temperature import MAX_ISOTHERMAL_RISE, film_rise, flash_temperature

    flash = flash_temperature(abs(friction), scales)
    film = expected_film(case, scales) * scales.h if case.fluid else 0.0
    rise = film_rise(abs(friction), scales, film)
    if flash + rise > MAX_ISOTHERMAL_RISE:
        hotter = f" and the film {rise:.0f} K hotter" if rise >= 1.0 else ""
        yield (
            f"the case is isothermal, but its flash temperature by Blok's formula is about {flash:.0f} K "
            f"(steel, coefficient of friction {friction:.3f}){hotter}; [heat] computes with temperatures"
        )


def _of_temperatures(totals: dict[str, float]) -> Iterator[str]:
    """Temperatures at which neither the oil nor hard steel exists any longer."""
    walls = max(totals.get(f"temperature_{side}_max", 0.0) for side in ("1", "2"))
    for name, found, (limit, words) in (
        ("surfaces", walls, MAX_STEEL),
        ("film", totals.get("film_temperature_max", 0.0), MAX_OIL),
    ):
        if found > limit:
            yield f"temperature: up to {found:.4g} K in the {name}, but {words} above about {limit:g} K"


def _of_oil(case: Case, totals: dict[str, float], boundary_friction: float) -> Iterator[str]:
    coefficient = abs(totals.get("friction_coefficient", 0.0))
    if coefficient > max(MAX_OIL_FRICTION, boundary_friction):
        yield (
            f"friction: a coefficient of {coefficient:.3g}, but oils bear a shear stress of about 0.1 of "
            "their pressure; eyring_stress, carreau_stress or limiting_shear in [fluid] bounds it"
        )
    pressure, fluid = totals["oil_pressure"], case.fluid
    decades = (float(viscosity(np.array([pressure]), fluid)[0][0]) + np.log(fluid.viscosity)) / np.log(10.0)
    if decades > np.log10(MAX_MEASURED_VISCOSITY):
        value = f"{10.0**decades:.1e}" if decades < MAX_DECADES else f"1e{decades:.0f}"
        yield (
            f"viscosity: {value} Pa s by the law at the oil's maximum pressure, {1e-9 * pressure:.2f} GPa; "
            "oils are measured up to about 1e7 Pa s"
        )
    if totals["mass_error"] > MAX_MASS_ERROR:
        cure = "a finer mesh or smaller snes_atol reduces it"
        if not case.contact.has_contact_pressure:
            cure = 'nodes in direct contact do not conserve mass, contact.model = "mixed" does'
        yield (
            f"oil balance: the mass defect of one step is {100 * totals['mass_error']:.3g} % of the oil that "
            f"the contact carries; {cure}"
        )
    if totals["nodes_below_1nm"]:
        yield (
            f"film: {totals['nodes_below_1nm']} times a node out of contact had less than "
            f"{1e9 * MIN_CONTINUUM_FILM:g} nm of oil, a molecule or two, where oil is no continuum"
        )
