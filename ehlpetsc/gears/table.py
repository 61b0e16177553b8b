"""Points of a path of contact in a table, the path as CSV for ``[operation]``, crowned teeth as a case."""

from __future__ import annotations

import io
import math
import tomllib
from typing import TYPE_CHECKING, Any

import numpy as np

from ehlpetsc.base.errors import CaseError
from ehlpetsc.base.toml_file import plain, toml_text
from ehlpetsc.base.units import converted
from ehlpetsc.gears.load_sharing import edge_contact
from ehlpetsc.gears.path import Path, describe, gear_loss_factor, hertz, path_of_contact
from ehlpetsc.gears.standards import STANDARDS, Rating, loss_factor, values_of
from ehlpetsc.physics.contact.hertz import hertz_ellipse, hertz_line

if TYPE_CHECKING:
    from ehlpetsc.base.case import Case

EDGE_RADIUS = 0.05  # of the module: radius of a tip edge that is left out
EDGES = {"A": "before A, on the tip edge of the wheel", "E": "after E, on the tip edge of the pinion"}


def rows(path: Path, modulus: float, rating: Rating | None) -> list[str]:
    """Lines of text: data of the pair, a table of A to E, mean values of the standards."""
    pair = path.pair
    where = [path.index(name) for name in pair.points_on_path]
    arcs = pair.flank_arcs(path.rho)
    quantities = [
        ("time, µs", 1e6 * path.time),
        ("rho 1, mm", 1e3 * path.rho),
        ("R, mm", 1e3 * path.radius),
        ("load, kN/m", 1e-3 * path.load),
        ("u1, m/s", path.speed_1),
        ("u2, m/s", path.speed_2),
        ("u, m/s", path.entrainment),
        ("u1 - u2, m/s", path.speed_1 - path.speed_2),
        ("slide/roll", path.slide_roll_ratio),
        ("arc 1, mm", 1e3 * arcs[0]),
        ("arc 2, mm", 1e3 * arcs[1]),
    ]
    a, p0 = hertz(path, modulus)
    quantities += [("a, mm", 1e3 * a), ("p0, GPa", 1e-9 * p0)]
    lines = [*describe(path), *edges(path, modulus)]
    own, standard = gear_loss_factor(path), loss_factor(pair)
    lines.append(f"loss factor H_V {own:.4f} of this load sharing, {standard:.4f} of Niemann and Winter")
    names, values = {}, values_of(rating) if rating is not None else {}
    for name, value in values.items():
        entry = STANDARDS[name]
        if np.ndim(value):
            label = f"{name.split(' ', 1)[1]}{', ' if entry.unit else ''}{entry.unit}"
            quantities.append((label, value))
            names[label] = entry.source
        elif name != "loss factor H_V":
            lines.append(f"{name} {value:.4g} {entry.unit}{' ' if entry.unit else ''}by {entry.source}")
    width = max(len(name) for name, _ in quantities)
    lines += ["", " " * width + "".join(f"{name:>11}" for name in pair.points_on_path)]
    for name, values in quantities:
        source = f"  {names[name]}" if name in names else ""
        lines.append(f"{name:{width}}" + "".join(f"{_shown(values[i]):>11}" for i in where) + source)
    return lines


def edges(path: Path, modulus: float) -> list[str]:
    """Contact of the tip edges before A and after E, and bound of its pressure: of an elastic round edge."""
    pair, lines = path.pair, []
    edge = pair.tip_radius or EDGE_RADIUS * pair.module
    flanks = {"A": pair.points["A"], "E": pair.line_of_action - pair.points["E"]}
    for name, (way, carried) in edge_contact(pair).items():
        if way > 0.0:
            load, where = carried * pair.normal_load, EDGES[name]
            pressure = hertz_line(load, 1.0 / (1.0 / edge + 1.0 / flanks[name]), modulus)[1]
            lines += [
                f"contact {1e3 * way:.2f} mm {where}, with up to {1e-3 * load:.1f} kN/m: Hertz pressure of "
                f"an edge of radius {1e3 * edge:.3g} mm {1e-9 * pressure:.2f} GPa"
            ]
    return lines


def _shown(value: float) -> str:
    if not math.isfinite(value):
        return "-"
    digits = 3 - (math.floor(math.log10(abs(value))) if abs(value) > 1e-9 else 0)
    return f"{0.0 if abs(value) <= 1e-9 else value:.{min(max(digits, 0), 4)}f}"


HEADING = "time, load, radius, speed 1, speed 2"  # of the table for [operation]


def csv(path: Path) -> str:
    """Loaded part of the path as CSV text for ``[operation]``."""
    loaded = path.load > 0.0
    values = np.column_stack([path.time, path.load, path.radius, path.speed_1, path.speed_2])[loaded]
    values[:, 0] -= values[0, 0]
    text = io.StringIO()
    np.savetxt(text, values, "%.12g", ", ", header=HEADING, comments="")
    return text.getvalue()


POINTS_ACROSS = 32  # per half-width b of a long ellipse
OF_PATHS = {
    "": ("gears", "time"),
    "mesh": ("width", "near_field"),
}  # keys that the point contact does not have


def crowned(case: Case, modulus: float, point: str, depth: str) -> str:
    r"""Text of a steady case of the point contact at A, B, C, D or E.

    A crown or end relief of a depth :math:`C_c` at both ends of the face width b, of both flanks in sum, is a
    parabola across: :math:`R_y=b^2/(8C_c)`. The load is that of the whole tooth pair.

    `modulus`: reduced modulus E' [Pa].

    Raises
    ------
    CaseError
        No such point or depth; helical teeth, an unloaded point; an ellipse wider than the face.
    """
    pair, place = case.gears.pair, f"--crowned {point} {depth}"
    try:
        deep = float(str(converted(depth, "m")))
    except ValueError:
        deep = math.nan
    path, face = path_of_contact(pair), pair.face_width
    allowed = ", ".join(name for name in pair.points_on_path if path.load[path.index(name)] > 0.0)
    if pair.helix_angle:
        raise CaseError([f"{place}: of helical teeth; allowed: spur gears, whose contact is along the face"])
    if point not in allowed.split(", ") or not 0.0 < deep < face:
        raise CaseError([f'{place}: allowed: a loaded point, {allowed}, and a depth, as "10 um" [m]'])
    k = path.index(point)
    load, radii = float(path.load[k]) * face, (float(path.radius[k]), face**2 / (8.0 * deep))
    wide = 2.0 * hertz_ellipse(load, *radii, modulus).b
    if wide > face:
        raise CaseError(
            [
                f"{place}: the ellipse is {1e3 * wide:.3g} mm wide, the face {1e3 * face:.3g} mm; allowed: a "
                "deeper crown; without one [gears] is a line contact"
            ]
        )
    mean, sliding = (float(of[k]) for of in (path.entrainment, path.slide_roll_ratio))
    along = case.mesh.points_per_half_width
    changes: dict[str, dict[str, Any]] = {
        "contact": {"radius": [_rounded(radius) for radius in radii], "load": _rounded(load)},
        "motion": {"entrainment_speed": _rounded(mean), "slide_roll_ratio": _rounded(sliding)},
        "mesh": {"points_per_half_width": [along, min(along, POINTS_ACROSS)]},
        "heat": {"bulk_temperature": plain(case.heat.bulk_temperature)} if case.heat else {},
    }
    tables = tomllib.loads(case.text)
    for name, keys in OF_PATHS.items():
        for key in keys:
            (tables[name] if name else tables).pop(key, None)
    for name, values in changes.items():
        if values:
            tables[name] = tables.get(name, {}) | values
    return toml_text(tables | {"title": f"{case.title}: crowned, at {point}"})


def _rounded(value: float) -> float:
    return round(float(f"{value:.6g}"), 9)
