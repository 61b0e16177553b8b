"""Warnings about a case before it runs: solids, motion, domain, mesh, profiles; faults of the domain."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from ehlpetsc.discretisation.contact import smallest_film
from ehlpetsc.physics.film_formulas import (
    expected_film,
    film_left_by_inlet,
    inlet_opening,
    points_for_opening,
)
from ehlpetsc.physics.flash_temperature import expected_friction
from ehlpetsc.physics.laws import LAWS
from ehlpetsc.run.outputs.limits import isothermal
from ehlpetsc.surfaces.roughness import Roughness

if TYPE_CHECKING:
    from ehlpetsc.case.tables import Case
    from ehlpetsc.physics.scales import Scales

MIN_FILM_RATIO = 0.95  # film over that of a flooded contact, below which the inlet is reported as too near
PROPOSED_FILM_RATIO = 0.99  # film over that of a flooded contact, with the proposed inlet
MAX_FILM_SLOPE = 0.25  # films by which the gap opens from node to node: the film is 5 % too thin
MESH_MARGIN = 1.1  # a mesh with a few percent too few points causes no warning
MAX_OPENING = 5.0  # films by which the gap opens from node to node: there is no smooth film
MAX_INLET = 100.0  # half-widths: maximum distance of the proposed inlet
LOW_PRESSURE, HIGH_PRESSURE = 0.1e9, 10e9  # Pa: Hertz pressures of EHL contacts, with a margin
MAX_EHL_FILM = 0.1  # half-widths: films of EHL contacts are at most a hundredth of a half-width
MAX_TILT_VARIANCE = 0.5  # of the height variance: a profile with more in a straight line counts as tilted
MIN_YIELD_PRESSURE = 0.25  # of p0: softer solids yield as a whole


def domain_warnings(case: Case, scales: Scales) -> list[str]:
    """Warnings of an inlet that is too near, or a mesh that is too coarse for the inlet, with the cure."""
    if case.fluid is None:
        return []
    notes = [] if case.fluid.inlet_film is not None else _near_inlet(case, scales)
    film = _smallest_expected_film(case, scales)
    opening = inlet_opening(film, case.mesh.points_per_half_width)
    if MESH_MARGIN * MAX_FILM_SLOPE < opening:
        notes.append(_coarse(case, film, opening, ": the film comes out too thin"))
    return notes


def domain_faults(case: Case, scales: Scales) -> list[str]:
    """Faults of the domain that make the result meaningless, one message each; checked before a run."""
    if case.fluid is None or case.contact.has_contact_pressure:  # the boundary film remains
        return []
    film, points = _smallest_expected_film(case, scales), case.mesh.points_per_half_width
    opening = inlet_opening(film, points)
    if opening <= MAX_OPENING:
        return []
    where = f"{case.path}: mesh.points_per_half_width = {points}"
    return [f"{where}: {_coarse(case, film, opening, ', which leaves no film')}"]


def _smallest_expected_film(case: Case, scales: Scales) -> float:
    """Expected film or, if larger, the smallest film of the contact model [a^2/R]."""
    return max(expected_film(case, scales), smallest_film(case.contact, scales))


def _coarse(case: Case, film: float, opening: float, consequence: str) -> str:
    other = "" if case.contact.has_contact_pressure else '; or contact.model = "mixed"'
    return (
        f"the mesh is too coarse for the inlet: beside the contact the gap opens by {opening:.2g} films from "
        f"one node to the next{consequence}; try mesh.points_per_half_width = "
        f"{math.ceil(points_for_opening(film, MAX_FILM_SLOPE))}{other}"
    )


def _near_inlet(case: Case, scales: Scales) -> list[str]:
    film, inlet = expected_film(case, scales), -case.mesh.inlet
    ratio = film_left_by_inlet(film, inlet)
    if ratio >= MIN_FILM_RATIO:
        return []
    proposed = inlet
    while proposed < MAX_INLET and film_left_by_inlet(film, proposed) < PROPOSED_FILM_RATIO:
        proposed += 0.1
    return [
        f"mesh.inlet = {case.mesh.inlet:g} is too near: by Grubin's integral it leaves {100 * ratio:.0f} % "
        f"of the film of a flooded contact; mesh.inlet = {-math.ceil(10.0 * proposed) / 10.0:g} leaves "
        f"{100 * PROPOSED_FILM_RATIO:g} %"
    ]


def warnings(case: Case, scales: Scales) -> list[str]:
    """Warnings before a run, one message each."""
    profiles = Roughness.of(case, scales)
    notes = [*_scene_warnings(case, scales), *_oil_warnings(case.fluid), *domain_warnings(case, scales)]
    if profiles:
        from ehlpetsc.surfaces.profile_checks import entry_warnings, mesh_warnings

        notes += [*_tilt_warnings(case, profiles), *entry_warnings(case, scales, profiles)]
        notes += mesh_warnings(profiles, scales)
    return notes + heat_warnings(case, scales)


def _scene_warnings(case: Case, scales: Scales) -> Iterator[str]:
    """Solids that yield, roughness at rest; magnitudes outside EHL contacts, most likely wrong units."""
    if case.contact.yield_pressure and min(case.contact.yield_pressure) < MIN_YIELD_PRESSURE * scales.p0:
        yield (
            f"contact.yield_pressure = {1e-9 * min(case.contact.yield_pressure):g} GPa is below a quarter of "
            f"Hertz' {1e-9 * scales.p0:.3g} GPa: the solids yield as a whole, beyond half-space theory"
        )
    rough = [f"surface.{name}" for name in ("1", "2") if case.surface.side(name)]
    if rough and case.time is None and case.motion is not None:
        yield (
            f"{' and '.join(rough)} with [motion] but without [time]: "
            "the roughness is held still under the film; add [time] to let it move"
        )
    if not LOW_PRESSURE <= scales.p0 <= HIGH_PRESSURE:
        yield (
            f"Hertz' pressure p0 = {1e-9 * scales.p0:.3g} GPa: EHL contacts have "
            f"{1e-9 * LOW_PRESSURE:g} to {1e-9 * HIGH_PRESSURE:g} GPa; "
            f"radius = {scales.R:g} m, load = {scales.load:g} N/m?"
        )
    film = expected_film(case, scales) * scales.h if case.fluid else 0.0
    if film > MAX_EHL_FILM * scales.a:
        yield (
            f"the expected film, {1e6 * film:.3g} um, is more than a tenth of the contact's half-width, "
            f"{1e6 * scales.a:.3g} um: "
            f"viscosity = {scales.eta0:g} Pa s, entrainment_speed = {scales.u:g} m/s?"
        )


def heat_warnings(case: Case, scales: Scales) -> list[str]:
    """Warning of an isothermal case with a high estimated flash temperature."""
    film, friction = expected_film(case, scales) * scales.h, case.contact.boundary_friction
    friction = expected_friction(case.fluid, friction, scales, film) if case.motion else None
    return list(isothermal(case, scales, friction))


def _oil_warnings(fluid: Any) -> Iterator[str]:
    """Oil constants that the viscosity law does not use."""
    others = {name for law in LAWS.values() for name in law.keys}
    others -= set(LAWS[fluid.law].keys) if fluid else others
    keys = sorted(f"fluid.{name}" for name in others if getattr(fluid, name) is not None)
    if keys:
        yield f'{", ".join(keys)}: not used by law = "{fluid.law}"'


def _tilt_warnings(case: Case, profiles: Roughness) -> Iterator[str]:
    """Profiles whose heights are mostly a straight line, a tilt of the measurement."""
    for side in ("1", "2"):
        profile, spec = profiles.side(side), case.surface.side(side)
        if not profile or not profile.given.measured or spec.level:
            continue
        X, z = profile.X, profile.heights
        slope = np.polyfit(X - X.mean(), z, 1)[0]
        fraction = slope**2 * X.var() / z.var() if z.any() else 0.0
        if fraction > MAX_TILT_VARIANCE:
            yield (
                f"surface.{side}: {100 * fraction:.0f} % of the height variance is a straight line "
                f"({1e6 * abs(slope) * (X[-1] - X[0]):.3g} um over {1e3 * (X[-1] - X[0]):.3g} mm); "
                "level = true takes it off"
            )
