"""Units and distances of points in the words above the numbers of a text file."""

from __future__ import annotations

import re

from ehlpetsc.base.errors import ProfileError
from ehlpetsc.surfaces.files.text import UNIT_OF_NAME, UNITS

AGREEMENT = 0.02  # relative, of spacings
NAME = "|".join(sorted(map(re.escape, UNIT_OF_NAME), key=len, reverse=True))


def _unit_of(names: str, may_be_alone: bool) -> re.Pattern[str]:
    """Unit in one group of four: ``Z unit: um``, ``Unit Z: um``, ``z [um]``, ``heights in um``.

    `names`: of the quantity, parted by a bar. `may_be_alone`: ``unit: um`` is of it.
    """
    quantity = rf"(?:(?:{names})(?:[ _-]*(?:axis|axes))?[ _-]*)"
    behind = rf"\s*[:=\s]\s*\"?({NAME})\b"
    return re.compile(
        rf"^\W*{quantity}{'?' if may_be_alone else ''}units?{behind}"
        rf"|^\W*units?[ _-]*(?:of[ _-]*)?{quantity}{behind}"
        rf"|(?<![a-z])(?:{names})\s*[\[(/]\s*({NAME})\s*(?:[\])]|$)"
        rf"|(?<![a-z])(?:{names})\s+(?:(?:is|are)\s+)?in\s+({NAME})\b(?!\s*[:=])",
        re.IGNORECASE | re.MULTILINE,
    )


UNIT_OF_HEIGHTS = _unit_of("z|heights?|values?|data", True)
UNIT_OF_X = _unit_of("x|y|lateral|axis|axes|positions?", False)
LENGTH = rf"(\d+(?:[.,]\d+|\.)?(?:e[+-]?\d+)?)\s*\"?\s*(?:[\[(]?({NAME})\b)?"
ENTRY = re.compile(
    rf"(?:^|,)[^\w\n]*([a-z][a-z _.-]*?)\s*(?:[\[(/]\s*({NAME})\s*[\])]?)?\s*[:=,;\t ]\s*\"?"
    rf"{LENGTH}(?:\s*[x*\u00d7]\s*{LENGTH})?",
    re.IGNORECASE | re.MULTILINE,
)  # name [unit] = number unit, or number unit x number unit
STEP_NAMES = set(
    """step stepsize stepwidth spacing pointspacing pixelsize pixelwidth pixelspacing cellsize
lateralresolution samplinginterval""".split()
)
OTHER_STEPS = {"increment", "pitch", "resolution", "sampling", "interval"}  # where nothing else is stated
STEPS_OF_AXES = STEP_NAMES | OTHER_STEPS | {"d", "delta"}  # beside the name of an axis
SIZES = {"size", "scansize", "area", "scanarea"}  # along x times along y
EXTENTS = {"": {"width": "x", "scanwidth": "x", "scansize": "x", "scanheight": "y"}}
EXTENTS |= {axis: dict.fromkeys(("length", "range", "extent", "size", "width"), axis) for axis in "xy"}
HEIGHT = "height"  # of a map, beside its width, or of a surface
MAX_RATIO = 5.0  # of the distance of the rows to that of the columns


def spacings_in(header: str, shape: tuple[int, ...], x_unit: str | None) -> dict[str, float]:
    """Distances [m] of columns, "x", and rows, "y", of a matrix by the words of a header that have a unit.

    ProfileError if steps and sizes contradict each other.

    `shape`: lines and columns; a width or height is that of as many cells.
    `x_unit`: of steps without a unit; None: they are not read.
    """
    steps: dict[str, float] = {}
    others: dict[str, float] = {}  # of names that may be those of something else
    sizes: dict[str, float] = {}
    for name, unit_before, number, unit_behind, number_y, unit_y in ENTRY.findall(header):
        words = re.findall("[a-z]+", re.sub("d([xy])", r"d \1", name.lower()))
        axes = [word for word in words if word in ("x", "y")]
        rest = "".join(word for word in words if word not in ("x", "y", "of", "in"))
        is_step = rest in (STEPS_OF_AXES if axes else STEP_NAMES | OTHER_STEPS)
        name_of_unit = (unit_before or unit_behind or unit_y).lower()
        unit = UNIT_OF_NAME.get(name_of_unit, x_unit if is_step else None)
        if unit is None or len(axes) > 1 and not number_y:
            continue
        value = UNITS[unit] * float(number.replace(",", "."))
        if number_y:
            both = value, UNITS[UNIT_OF_NAME.get(unit_y.lower(), unit)] * float(number_y.replace(",", "."))
            if is_step:
                _add(steps, dict(zip("xy", both, strict=True)))
            elif rest in SIZES:
                _add(sizes, {axis: size / n for axis, size, n in zip("xy", both, shape[::-1], strict=True)})
        elif is_step:
            _add(steps if axes or rest in STEP_NAMES else others, dict.fromkeys(axes or ("x", "y"), value))
        elif axis := EXTENTS["".join(axes)].get(rest):
            _add(sizes, {axis: value / shape[axis == "x"]})
        elif rest == HEIGHT and not axes:
            others.setdefault(HEIGHT, value / shape[0])
    height = others.pop(HEIGHT, None)
    if height and "x" in sizes and 1.0 / MAX_RATIO <= height / sizes["x"] <= MAX_RATIO:
        sizes.setdefault("y", height)
    for axis in steps.keys() & sizes.keys():
        if abs(sizes[axis] / steps[axis] - 1.0) > AGREEMENT + 1.0 / shape[axis == "x"]:
            raise ProfileError(_contradiction(steps[axis], sizes[axis]))
    found = sizes | steps
    return found if "x" in found else others if "x" in others else {}


def _add(found: dict[str, float], more: dict[str, float]) -> None:
    """Add distances by axis; ProfileError if others are there."""
    for axis, distance in more.items():
        if abs(found.setdefault(axis, distance) / distance - 1.0) > AGREEMENT:
            raise ProfileError(_contradiction(found[axis], distance))


def _contradiction(one: float, other: float) -> str:
    return (
        f"its header gives {1e6 * one:.4g} and {1e6 * other:.4g} um as the distance of its points; allowed: "
        "one of them; delete the other from the file"
    )


def units_by(pattern: re.Pattern[str], header: str) -> list[str]:
    """Units that a header names by a pattern of :func:`_unit_of`."""
    return [UNIT_OF_NAME["".join(groups).lower()] for groups in pattern.findall(header)]


def units_named(header: str) -> list[str]:
    """Units of length that a header names for positions and for heights."""
    return [*units_by(UNIT_OF_X, header), *units_by(UNIT_OF_HEIGHTS, header)]
