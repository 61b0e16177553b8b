"""Point contact of crowned teeth at a point of their path of contact, as a case."""

from __future__ import annotations

import math
import tomllib
from typing import TYPE_CHECKING, Any

from ehlpetsc.base.errors import CaseError
from ehlpetsc.base.toml_file import plain, toml_text
from ehlpetsc.base.units import converted
from ehlpetsc.gears.path import path_of_contact
from ehlpetsc.physics.hertz import hertz_ellipse

if TYPE_CHECKING:
    from ehlpetsc.base.case import Case

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
