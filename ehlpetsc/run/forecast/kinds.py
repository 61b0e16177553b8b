"""Notes and faults before a run by kind of contact: its shape, its ends, and oil outside its mesh."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple, cast

from ehlpetsc.base.counts import whole_up
from ehlpetsc.case.tables import Case
from ehlpetsc.physics.film_formulas import (
    MAX_FILM_SLOPE,
    expected_film,
    film_left_by_inlet,
    film_on_mesh,
    point_rolling_friction,
    rolling_left_by_inlet,
    rolling_outside,
    smooth_films,
)
from ehlpetsc.physics.scales import NODE_TOLERANCE, Scales

if TYPE_CHECKING:
    from ehlpetsc.physics.contact.grid import Grid
    from ehlpetsc.physics.contact.roller import RollerGrid
    from ehlpetsc.physics.contact.window import WindowGrid

MIN_FILM_RATIO = 0.95  # film over that of a flooded contact, below which the inlet is reported as too near
PROPOSED_FILM_RATIO = 0.99  # film over that of a flooded contact, with the proposed inlet
MIN_ROLLING_FRICTION, PROPOSED_ROLLING_FRICTION = 0.95, 0.97  # over that of a flooded contact
MAX_INLET = 100.0  # half-widths: maximum distance of the proposed inlet
MAX_OUTSIDE, PROPOSED_OUTSIDE = 0.05, 0.02  # of the load of a point contact, outside the mesh
MESH_MARGIN = 1.1  # a mesh with a few percent too few points causes no warning
MIN_END_LOAD = 0.05  # of the largest load per length: the oil beside a contact carries less
MAX_END_OPENING = 3.0  # films: arcs of 20 mm on rows of 120 um, 4.2, have false contact at the ends
OUTLET_ROOM, PROPOSED_OUTLET = 1.2, 1.5  # over the widest half-width of a roller


class Forecast(NamedTuple):
    """Texts of a kind of contact.

    `shape`: radii and dry contact of scales, for two lines, and further lines.
    `formulas`: of the films that are expected.
    `near`, `rolling`: warnings of load, film and rolling friction outside the mesh, in oil.
    `ends`: warnings of the ends of the contact across.
    `faults`: of the mesh, with what is allowed.
    `found`: lines at the end of a run, from the scalars of its last step.
    """

    shape: Callable[[Scales], tuple[str, str, list[str]]]
    formulas: str
    near: Callable[[Case, Scales], list[str]]
    rolling: Callable[[Case, Scales], list[str]]
    ends: Callable[[Case, Scales], list[str]]
    faults: Callable[[Case, Scales], list[str]]
    found: Callable[[dict[str, Any]], list[str]]


def _line_shape(s: Scales) -> tuple[str, str, list[str]]:
    return f"radius {s.R:g} m", f"half-width a = {s.a * 1e3:.6f} mm", []


def _strip_shape(s: Scales) -> tuple[str, str, list[str]]:
    strip = f"Strip: {1e3 * s.grid.breadth * s.a:.4g} mm of its length, periodic across"
    return *_line_shape(s)[:2], [strip]


def _point_shape(s: Scales) -> tuple[str, str, list[str]]:
    widths = f"half-widths a = {s.a * 1e3:.6f} mm along, b = {s.b * 1e3:.6f} mm across"
    return f"a point, radii {s.R:g} m along, {s.R * s.extent:g} m across", widths, []


def _roller_shape(s: Scales) -> tuple[str, str, list[str]]:
    shape = f"a roller, radius {s.R:g} m, length {1e3 * s.extent:g} mm"
    widths = f"of the mean load, half-width a = {s.a * 1e3:.6f} mm"
    grid = cast("RollerGrid", s.grid)
    first, last = (1e3 * s.a * y for y in grid.loaded)
    slices = (
        f"Slices: contact from y = {first:.4g} to {last:.4g} mm, highest load per length "
        f"{grid.widening**2:.3g} of the mean, half-width there {grid.widening:.3g} a"
    )
    return shape, widths, [slices]


def _window_shape(s: Scales) -> tuple[str, str, list[str]]:
    shape, widths, slices = _roller_shape(replace(s, grid=cast("WindowGrid", s.grid).whole))
    first, last = (1e3 * s.a * (y + side * s.grid.increments[0]) for y, side in _sides(s.grid))
    whole = " x ".join(map(str, cast("WindowGrid", s.grid).whole.shape[::-1]))
    held = f"Window: y = {first:.4g} to {last:.4g} mm; the smooth roller beside it on {whole} nodes"
    return shape, widths, [*slices, held]


def _sides(grid: Grid) -> tuple[tuple[float, float], tuple[float, float]]:
    """Outer rows, and the direction of the side beyond each in halves of a row."""
    return (grid.axes[0][0], -0.5), (grid.axes[0][-1], 0.5)


def _no_ends(case: Case, scales: Scales) -> list[str]:
    return []


def _roller_ends(case: Case, scales: Scales) -> list[str]:
    """Warnings of a contact that reaches a sharp end, or of rows too far apart for the film beside it."""
    notes, grid = [], cast("RollerGrid", scales.grid)
    if grid.is_sharp and grid.reached:
        place = " and ".join(f"y = {1e3 * scales.a * y:.4g} mm" for y in grid.reached)
        notes.append(
            f"the contact reaches the end of the roller, {place}: pressure and film of its last rows follow "
            "the mesh across; a profile that unloads the ends, or contact.end_radius, has values of its own"
        )
    if case.fluid is None:
        return notes
    film = smooth_films(scales, case.fluid, scales.conditions)[0] / scales.h
    opening = max(grid.openings, default=0.0) / film
    if opening > MESH_MARGIN * MAX_FILM_SLOPE:
        inside = round(scales.b / scales.grid.spacings[0])
        rows = whole_up(inside * (opening / MAX_FILM_SLOPE) ** (2.0 / 3.0))
        consequence = (
            "which leaves no film there" if opening > MAX_END_OPENING else "the film there is too thin"
        )
        notes.append(
            f"the rows are too far apart for the ends of the contact: beside it the gap opens by "
            f"{opening:.2g} films from one row to the next, {consequence}; try "
            f"mesh.points_per_half_width = [{case.mesh.points_per_half_width}, {rows}], "
            f"{1e6 * scales.b / rows:.3g} um"
        )
    return notes


def _no_faults(case: Case, scales: Scales) -> list[str]:
    return []


def _roller_faults(case: Case, scales: Scales) -> list[str]:
    """Rows beside a sharp end or that leave the roller out, and a mesh narrower than the dry contact."""
    mesh, grid, faults = case.mesh, cast("RollerGrid", scales.grid), []
    rounds = 2.0 + 2.0 * (case.contact.end_radius or 0.0) / scales.b
    if mesh.width is not None and not 2.0 <= mesh.width <= rounds * (1.0 + NODE_TOLERANCE):
        allowed = (
            f"from 2 to {rounds:.4g}" if not grid.is_sharp else "2, as sharp ends have no rows beside them"
        )
        faults.append(
            f"mesh.width = {mesh.width:g}: of a roller, in halves of its length; allowed: {allowed}"
        )
    widest = grid.widening
    for key, reach in (("inlet", -mesh.inlet), ("outlet", mesh.outlet)):
        if reach <= widest:
            faults.append(
                f"mesh.{key} = {getattr(mesh, key):g}: the dry contact is {widest:.3g} a wide at the highest "
                "load per length; allowed: further out"
            )
    return faults


def _window_ends(case: Case, scales: Scales) -> list[str]:
    """Notes as of :func:`_roller_ends` on the rows of a window, and of the smooth roller without a film."""
    notes = _roller_ends(case, scales)
    if case.fluid is None:
        return notes
    whole = cast("WindowGrid", scales.grid).whole
    opening = max(whole.openings, default=0.0) * scales.h
    film = smooth_films(scales, case.fluid, scales.conditions)[0]
    if opening > MAX_END_OPENING * film:
        notes.append(
            f"rows of the smooth roller beside the window are {1e6 * scales.a * whole.increments[0]:.3g} um "
            f"apart, and at its ends the gap opens by {opening / film:.2g} films from one to the next, which "
            "leaves no film there; try a smaller mesh.window.coarsening across"
        )
    return notes


def _window_faults(case: Case, scales: Scales) -> list[str]:
    """A window beyond its roller, or of too few rows."""
    window, half = case.mesh.window, 0.5 * case.contact.length
    if not -half * (1.0 + NODE_TOLERANCE) <= window.from_ < window.to <= half * (1.0 + NODE_TOLERANCE):
        place = f"from {window.from_:g} to {window.to:g} m"
        return [f"mesh.window = {place}; allowed: on the roller, from {-half:g} to {half:g} m"]
    return _roller_faults(case, scales)


def _nothing(scalars: dict[str, Any]) -> list[str]:
    return []


def _along_roller(scalars: dict[str, Any]) -> list[str]:
    """Load, pressure, moment, film and life along a roller."""
    w = {name: 1e-3 * scalars[f"load_per_length_{name}"] for name in ("middle", "end_1", "end_2", "max")}
    reaches = max(w["end_1"], w["end_2"]) > MIN_END_LOAD * w["max"]
    lines = [
        f"load per length {w['middle']:.4g} N/mm in the middle, {w['end_1']:.3g} and {w['end_2']:.3g} N/mm "
        f"at the ends, largest {w['max']:.4g} N/mm at y = {1e3 * scalars['load_per_length_max_at']:.3g} mm",
        f"maximum pressure {scalars['edge_factor']:.4g} p0, {scalars['edge_factor_local']:.4g} of Hertz' "
        "under the load of its row",
    ]
    if reaches:
        inside = scalars["edge_factor_inside"]
        lines.append(f"it reaches an end, where pressure follows the mesh; a inside, at most {inside:.4g} p0")
    if tilt := scalars.get("tilt"):
        moment, of_lamina = scalars["moment"], scalars["moment_lamina"]
        lines.append(
            f"moment {moment:.4g} N m, by the lamina model {of_lamina:.4g} N m; tilt {1e3 * tilt:.4g} mrad, "
            f"stiffness {abs(moment / tilt):.4g} N m/rad"
        )
    if "film_of_ends" in scalars:
        lines.append(f"minimum film of the ends {scalars['film_of_ends']:.3g} of that in the middle")
    lines.append(
        f"life {scalars['life_factor']:.3g} of that under an even load, by the lamina model "
        f"{scalars['life_factor_lamina']:.3g}"
    )
    return [f"roller: {line}" for line in lines]


def _roller_near(case: Case, scales: Scales) -> list[str]:
    """Warnings of an inlet or outlet that is near the widest part of a roller."""
    widest = scales.grid.widening
    notes = _near_inlet(case, scales)
    if case.mesh.outlet < OUTLET_ROOM * widest:
        notes.append(
            f"mesh.outlet = {case.mesh.outlet:g} is near the highest load, where slices have a half-width of "
            f"{widest:.3g} a; mesh.outlet = {math.ceil(10.0 * PROPOSED_OUTLET * widest) / 10.0:g} is enough"
        )
    return notes


def _near_edges(case: Case, scales: Scales) -> list[str]:
    """Warning of a point contact with much of its load outside the mesh; otherwise of a near inlet."""
    inlet, half_width = -case.mesh.inlet, scales.grid.axes[0][-1]
    share, left = film_on_mesh(case, scales, scales.a * inlet, scales.a * half_width)
    if share < MAX_OUTSIDE and left >= MIN_FILM_RATIO:
        return _near_inlet(case, scales)
    factor, found = 1.0, share
    while found > PROPOSED_OUTSIDE and factor * inlet < MAX_INLET:
        factor = min(1.1 * factor, MAX_INLET / inlet)
        found, _ = film_on_mesh(case, scales, *(factor * scales.a * size for size in (inlet, half_width)))
    width = 2.0 * half_width * scales.a / scales.b
    return [
        f"mesh.inlet = {case.mesh.inlet:g} and mesh.width = {width:.3g} are too near for this light contact, "
        f"M = {scales.moes_m:.2g}: flooded, it carries about {100 * share:.0f} % of its load outside them; "
        f"they leave {100 * left:.0f} % of its film, under a higher pressure; "
        f"mesh.inlet = {-math.ceil(factor * inlet):g} and mesh.width = {math.ceil(factor * width):g} leave "
        f"{100 * found:.0f} % of the load outside"
    ]


def _near_inlet(case: Case, scales: Scales) -> list[str]:
    """Warning of an inlet near the widest part of the contact."""
    film, inlet = _at_widest(case, scales)
    ratio = film_left_by_inlet(film, inlet)
    if ratio >= MIN_FILM_RATIO:
        return []
    proposed = inlet
    while proposed < MAX_INLET and film_left_by_inlet(film, proposed) < PROPOSED_FILM_RATIO:
        proposed += 0.1
    proposed *= scales.grid.widening
    return [
        f"mesh.inlet = {case.mesh.inlet:g} is too near: by Grubin's integral it leaves {100 * ratio:.0f} % "
        f"of the film of a flooded contact; mesh.inlet = {-math.ceil(10.0 * proposed) / 10.0:g} leaves "
        f"{100 * PROPOSED_FILM_RATIO:g} %"
    ]


def _at_widest(case: Case, scales: Scales) -> tuple[float, float]:
    """Film and distance of the inlet in units of the widest part of the contact, a^2/R and half-widths."""
    widest = scales.grid.widening
    return expected_film(case, scales) / widest**2, -case.mesh.inlet / widest


def _line_rolling(case: Case, scales: Scales) -> list[str]:
    film, inlet = _at_widest(case, scales)
    left = rolling_left_by_inlet(film, inlet)
    if left >= MIN_ROLLING_FRICTION:
        return []
    while inlet < MAX_INLET and rolling_left_by_inlet(film, inlet) < PROPOSED_ROLLING_FRICTION:
        inlet *= 1.05
    return [
        f"mesh.inlet = {case.mesh.inlet:g}: up to {100.0 * (1.0 - left):.0f} % of the rolling friction arise "
        f"before it and are not computed; mesh.inlet = {-math.ceil(inlet * scales.grid.widening)} computes "
        f"all but {100.0 * (1.0 - PROPOSED_ROLLING_FRICTION):.0f} %"
    ]


def _point_rolling(case: Case, scales: Scales) -> list[str]:
    inlet, half_width = -scales.a * case.mesh.inlet, scales.a * scales.grid.axes[0][-1]
    outside, total = rolling_outside(scales, inlet, half_width), point_rolling_friction(scales)
    if outside < (1.0 - MIN_ROLLING_FRICTION) * total:
        return []
    return [
        f"mesh.inlet = {case.mesh.inlet:g} and mesh.width: the oil outside them, as far as a third of the "
        f"radius, would add {outside:.2g} N to the rolling friction of each surface, of about {total:.2g} N"
    ]


LINE = Forecast(_line_shape, "Moes", _near_inlet, _line_rolling, _no_ends, _no_faults, _nothing)
STRIP = LINE._replace(shape=_strip_shape)
POINT = Forecast(
    _point_shape,
    "fit of computed points to 10 %, of another oil to 13 %",
    _near_edges,
    _point_rolling,
    _no_ends,
    _no_faults,
    _nothing,
)
ROLLER = LINE._replace(
    shape=_roller_shape, near=_roller_near, ends=_roller_ends, faults=_roller_faults, found=_along_roller
)
WINDOW = ROLLER._replace(shape=_window_shape, ends=_window_ends, faults=_window_faults, found=_nothing)
