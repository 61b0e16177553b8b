"""Validity of the model: warnings about a case before it runs."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.base.quantities import STEP_SCALARS, unit_in
from ehlpetsc.case.checking import attribute
from ehlpetsc.physics import operation_of
from ehlpetsc.physics.film_formulas import expected_film
from ehlpetsc.physics.oil.laws import LAW_TABLES, names_in_use, reference_temperature
from ehlpetsc.physics.oil.oils import OIL_SHEAR, OILS
from ehlpetsc.physics.oil.rheology import shear_law
from ehlpetsc.run.forecast.domain import (
    domain_warnings,
    reversal_warnings,
    rolling_warnings,
    strip_warnings,
)

if TYPE_CHECKING:
    from ehlpetsc.case.tables import Case
    from ehlpetsc.physics.scales import Scales
    from ehlpetsc.surfaces.motion.roughness import Roughness

MIN_HERTZ, MAX_HERTZ = 0.1e9, 10e9  # Pa: Hertz pressures of EHL contacts, with a margin
MAX_EHL_FILM = 0.1  # half-widths: films of EHL contacts are at most a hundredth of a half-width
MAX_TILT_VARIANCE = 0.5  # of the height variance: a profile with more in a straight line counts as tilted
MIN_YIELD_PRESSURE = 0.25  # of p0: softer solids yield as a whole
SAME_COEFFICIENT = 1e-3  # relative, of pressure-viscosity coefficients


def warnings(case: Case, scales: Scales, rough: Roughness | None = None) -> list[str]:
    """Warnings before a run, one message each; `rough`: surfaces of the case, None: read here."""
    notes = [*_scene_warnings(case, scales), *_oil_warnings(case), *domain_warnings(case, scales)]
    if case.surface.body_1 or case.surface.body_2:
        from ehlpetsc.surfaces.motion.profile_checks import (
            entry_warnings,
            mesh_warnings,
            smooth_warnings,
            step_warnings,
        )
        from ehlpetsc.surfaces.motion.roughness import Roughness

        profiles = rough or Roughness.of(case, scales)
        notes += [
            *smooth_warnings(profiles),
            *_tilt_warnings(case, profiles),
            *entry_warnings(case, scales, profiles),
        ]
        notes += [*mesh_warnings(profiles, scales), *strip_warnings(case, scales)]
        notes += step_warnings(case, profiles, scales, operation_of(case, scales).varies)
    notes += reversal_warnings(case, scales)
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
