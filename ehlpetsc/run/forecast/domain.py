"""Domain of a contact: a near inlet, a mesh too coarse for it, a strip too narrow; a case without a start."""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import TYPE_CHECKING

from ehlpetsc.base.case import KINDS
from ehlpetsc.base.declarations import Values
from ehlpetsc.case.tables import Case
from ehlpetsc.discretisation.contact import film_scale_of
from ehlpetsc.physics.contact.geometry import POINT_WIDTH
from ehlpetsc.physics.film_formulas import (
    MAX_FILM_SLOPE,
    expected_film,
    inlet_opening,
    points_for_opening,
)
from ehlpetsc.physics.operation import Conditions
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.forecast.kinds import MESH_MARGIN

if TYPE_CHECKING:
    from ehlpetsc.physics.variable_operation import ConditionsTable

MAX_ROLLING = 1e-3  # slide/roll ratio below which friction is that of rolling
MAX_OPENING = 5.0  # films by which the gap opens from node to node: there is no smooth film
CORRELATION_LENGTHS = 4.0  # across a strip of random roughness; of its variance .45 is then uniform across
EARLY = 0.1  # of a stroke: oil that arrives later leaves a film by the border of the mesh
MIN_BORDER = 1.5  # half-widths: nearest border beside an outlet
AT_REST = 1e-6  # of the longest stroke: shorter ones are rest
RIGID_FILM = 1000.0  # a^2/R: below a thicker film solids hardly deform
SOFT_LAYER = 0.1  # beta E* over p0: a node of a softer layer has no asperity pressure or all of it


def domain_warnings(case: Case, scales: Scales) -> list[str]:
    """Warnings of an inlet that is too near, or a mesh too coarse for inlet or ends, with the cure."""
    of_kind = KINDS[case.kind].part("forecast")
    notes = of_kind.ends(case, scales)
    if case.fluid is None:
        return notes
    notes += [] if case.fluid.inlet_film is not None else of_kind.near(case, scales)
    if not resolves_inlet(case, scales):
        notes.append(_coarse(case, *_inlet(case, scales), ": the film comes out too thin"))
    return notes


def resolves_inlet(case: Case, scales: Scales) -> bool:
    """Whether the mesh resolves the gap beside a contact with oil, where the film is formed."""
    return _inlet(case, scales)[1] <= MESH_MARGIN * MAX_FILM_SLOPE


def _inlet(case: Case, scales: Scales) -> tuple[float, float]:
    """Expected film in a^2/R, and the films by which the gap beside the contact opens from node to node."""
    film = film_scale_of(case, scales, expected_film(case, scales))
    return film, inlet_opening(film, case.mesh.points_per_half_width)


def domain_faults(case: Case, scales: Scales) -> list[str]:
    """Faults of the domain that make the result meaningless, one message each; checked before a run."""
    if case.time is not None and case.time.ramp == "coarse" and not ramps_coarsely(case):
        allowed = (
            'of a point contact or a strip with time.start = "rough", without heat, wear and yield_pressure'
        )
        return [f'{case.path}: time.ramp = "coarse": allowed: in steps {allowed}']
    if fault := _beside_mesh(case, scales):
        return [f"{case.path}: {fault}"]
    varies = case.conditions is not None and case.conditions.varies
    if case.time is not None and case.time.tolerance and not varies:
        return [f"{case.path}: time.tolerance: allowed: with [operation] or [gears], conditions that vary"]
    if found := KINDS[case.kind].part("forecast").faults(case, scales):
        return [f"{case.path}: {fault}" for fault in found]
    if case.fluid is None or case.contact.has_contact_pressure:  # the boundary film remains
        return []
    film, opening = _inlet(case, scales)
    if opening <= MAX_OPENING:
        return []
    where = f"{case.path}: mesh.points_per_half_width = {case.mesh.points_per_half_width}"
    return [f"{where}: {_coarse(case, film, opening, ', which leaves no film')}"]


def _beside_mesh(case: Case, scales: Scales) -> str:
    """Fault of a tilt that moves the dry contact across, beyond a side of the mesh; "": it does not."""
    grid = scales.grid
    half, b, moved = grid.axes[0][-1], grid.half_widths[0], abs(grid.middle)
    if not moved or moved + b <= half:
        return ""
    needed = math.ceil(2.0 * moved / b + POINT_WIDTH)  # with the same room beside it
    return (
        f"contact.tilt = {case.contact.tilt:g}: moves the contact {moved / b:.3g} b across, beyond the mesh; "
        f"allowed: a smaller one, or mesh.width = {needed} or more"
    )


def refusals(case: Case, scales: Scales) -> list[str]:
    """Reasons why a run refuses a checked case, one message each."""
    if case.series:
        allowed = "one of them at a time; a member: --set KEY=VALUE -o NAME.h5"
        return [f"{case.path}: [series] and time.passes: {allowed}"] * has_passes(case)
    return domain_faults(case, scales)


def ramps_coarsely(case: Case) -> bool:
    """Whether roughness, ramped up in the plane, is all that a state on a coarser mesh has to hand on."""
    only_rough = case.heat is None and case.wear is None and case.contact.yield_pressure is None
    kind = KINDS[case.kind]
    return (
        kind.is_areal
        and not kind.surroundings
        and case.time.start == "rough"
        and case.fluid is not None
        and only_rough
    )


def has_passes(case: Case) -> bool:
    """Whether a case has more than one pass."""
    return case.time is not None and case.time.passes > 1


def _coarse(case: Case, film: float, opening: float, consequence: str) -> str:
    other = "" if case.contact.has_contact_pressure else '; or contact.model = "mixed"'
    return (
        f"the mesh is too coarse for the inlet: beside the contact the gap opens by {opening:.2g} films from "
        f"one node to the next{consequence}; try mesh.points_per_half_width = "
        f"{math.ceil(points_for_opening(film, MAX_FILM_SLOPE))}{other}"
    )


def rolling_warnings(case: Case, scales: Scales) -> list[str]:
    """Rolling friction that the oil before and beside the mesh would add, where no sliding hides it."""
    if case.fluid is None or abs(scales.xi) > MAX_ROLLING:
        return []
    return KINDS[case.kind].part("forecast").rolling(case, scales)


def reversal_warnings(case: Case, scales: Scales) -> list[str]:
    """Warning of entrainment that reverses: the new inlet begins with the oil of the old outlet.

    More oil enters at the border of the mesh, and arrives once the film has moved from there to the contact.
    """
    if case.fluid is None or case.conditions is None:
        return []
    strokes = _strokes_after_reversal(case.conditions)
    border = case.mesh.outlet  # the inlet is as far out
    shortest, way = min(strokes, default=math.inf) / scales.a, border - 1.0
    if way <= EARLY * shortest:
        return []
    arrives = f"arrives after {way:.3g} of the {shortest:.3g} half-widths of the shortest stroke"
    if way > shortest:
        arrives = f"does not arrive within the {shortest:.3g} half-widths of the shortest stroke"
    near = max(1.0 + EARLY * shortest, MIN_BORDER)
    cure = f"it arrives {'within the first tenth' if near > MIN_BORDER else 'as early as it can'}"
    return [
        f"the entrainment reverses: the film then begins with the oil of the old outlet, and oil of the "
        f"border, mesh.outlet = {border:g}, {arrives}; with mesh.inlet = {-near:.2g} and mesh.outlet = "
        f"{near:.2g} {cure}"
    ]


def _strokes_after_reversal(table: ConditionsTable) -> list[float]:
    """Distances of the film from each reversal of the entrainment to the next one or the end [m]."""
    import numpy as np

    from ehlpetsc.physics.variable_operation import cumulative

    fine = table.sampled()
    moved = cumulative(fine.entrainment, fine.time)
    turns = np.flatnonzero(np.diff(np.sign(fine.entrainment)) != 0.0)
    strokes = np.diff(moved[np.concatenate(([0], turns, [len(moved) - 1]))])
    strokes = strokes[np.abs(strokes) > AT_REST * np.abs(strokes).max(initial=0.0)]
    return [abs(float(after)) for before, after in pairwise(strokes) if before * after < 0.0]


def strip_warnings(case: Case, scales: Scales) -> Iterator[str]:
    """Warnings of random roughness that hardly varies across a strip, as its period is too short."""
    if not scales.grid.periodic:
        return
    width = scales.grid.breadth * scales.a
    for side in ("1", "2"):
        spec = case.surface.side(side)
        made = spec.synthetic if spec else None
        lengths = made and _lengths(made)
        if not lengths:
            continue
        turn = math.radians(spec.direction or 0.0)
        along, across, words = lengths
        needed = 1.0 / math.hypot(math.sin(turn) / along, math.cos(turn) / across)
        if width < needed * (1.0 - 1e-9):
            yield (
                f"surface.{side}: the strip is {1e3 * width:.3g} mm wide, less than {words} across, "
                f"{1e3 * needed:.3g} mm: its roughness is ridges, which hardly vary across; mesh.width = "
                f"{math.ceil(10.0 * needed / scales.a) / 10.0:g} or more holds its waves"
            )


def _lengths(made: Values) -> tuple[float, float, str] | None:
    """Widths that hold the waves of a random map along and across its rows [m], in words; None: no map."""
    if made.kind == "self-affine":
        return made.roll_off, made.roll_off / made.peklenik, "the roll-off wavelength"
    if made.kind != "ground" or made.correlation_across is None:
        return None
    of_both = (CORRELATION_LENGTHS * length for length in (made.correlation, made.correlation_across))
    return *of_both, f"{CORRELATION_LENGTHS:g} correlation lengths"


def cures(case: Case, scales: Scales, conditions: Conditions, film: float) -> str:
    """Advice for a case without a steady start under its first conditions; expected film in a^2/R."""
    if film > RIGID_FILM:
        return (
            f". The film, {film:.0f} a^2/R, is far thicker than solids deform, and the pressure wider than "
            "the domain. Try a higher load or a lower speed"
        )
    found = ["a finer mesh"]
    if case.fluid and case.heat and case.fluid.limiting_shear is None and conditions.sliding:
        found.append("fluid.limiting_shear, as sliding heats an oil without one beyond measure")
    if case.fluid and conditions.entrainment == 0.0:
        found.append("a slow entrainment instead of rest at the begin")
    if case.fluid and not case.contact.has_contact_pressure:
        found.append('contact.model = "mixed"')
    if case.contact.asperity_height and not case.contact.adsorbed_film:
        found.append("contact.adsorbed_film = 1e-9, without which the film in the layer may vanish")
    beta = case.contact.asperity_stiffness
    if beta and 0.5 * scales.E * beta < SOFT_LAYER * scales.p0:
        found.append(f"contact.asperity_stiffness above {beta:.2g}, as the Hertz pressure flattens the layer")
    return f". Try {' or '.join(found)}"
