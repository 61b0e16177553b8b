"""Maps in text files: matrices, with positions of their columns and rows or without, and lists of x y z.

Spacings are positions in the file, words of its header, or the keys of the case; where there are several of
them they must agree.
"""

from __future__ import annotations

import re
from typing import NamedTuple

import numpy as np

from ehlpetsc.base.errors import ProfileError
from ehlpetsc.surfaces.files.headers import (
    AGREEMENT,
    MAX_RATIO,
    UNIT_OF_HEIGHTS,
    UNIT_OF_X,
    spacings_in,
    units_by,
)
from ehlpetsc.surfaces.files.text import NUMBER, UNITS, Layout, units_in

MIN_POINTS = 4  # along either side
MAX_LISTED = 6  # columns of a list of x y z with others
MIN_MATRIX_COLUMNS = 8  # of heights alike, where no spacing is stated
LONG = 8  # points of a line that rises by chance in one of 20,000
MIN_PRESENT = 0.5  # of the heights of a map, of the points of a grid in a list
MAX_UNEVEN = 0.45  # steps, of positions, whose decimals are few, from equally spaced ones
MAX_UNEVEN_OF_FEW = 0.02  # of fewer than `LONG`
UNEVEN_RATIO, MIN_UNEVEN = 5.0, 0.05  # of heights beside positions: over the positions, and in steps
SAME_RISE = 0.2  # relative, of the lines of an inclined map
SMOOTH_JUMP = 0.3  # of a line to the next over the height, of a smooth map
JUMP_RATIO = 3.0  # of a line to the next over that of the others, where it is no line of heights
NEGLIGIBLE = 0.01  # range of positions in m over heights in um, and more
METRIC = "m", "mm", "um", "nm"
EQUAL_STEPS = 0.02  # relative, of x in a profile


class TextMap(NamedTuple):
    """Numbers of a map in the units of its file.

    `z`: heights, shape (ny, nx).
    `x`, `y`: positions of the columns and of the rows; None: not in the file.
    `is_list`: whether they are a list of x y z.
    `note`: on columns that are left out.
    """

    z: np.ndarray
    x: np.ndarray | None
    y: np.ndarray | None
    is_list: bool = False
    note: str = ""


def listed(columns: np.ndarray, header: str = "") -> TextMap | None:
    """Map of a list of x y z, in any order, nan where a point of the grid is missing; None: no such list.

    The columns are in the order of their names in the last line of the header. A few columns beside them,
    numbers of the points or intensities, are left out.
    """
    order = re.findall(r"(?<![a-z])[xyz](?![a-z])", header.rstrip().rpartition("\n")[2].lower())
    places = list(map(order.index, "xyz")) if sorted(order) == list("xyz") else [0, 1, 2]
    for first in range(len(columns) - 2 if len(columns) <= MAX_LISTED else 0):
        chosen = columns[first : first + 3]
        if found := _grid_of(chosen[places], are_all=len(columns) == 3):
            used = f"x y z: columns {first + 1} to {first + 3}, the others are left out"
            return found if len(columns) == 3 else found._replace(note=used)
    return None


def _grid_of(columns: np.ndarray, are_all: bool) -> TextMap | None:
    """Map of columns x, y and z; `are_all`: the list has no other ones, and a point twice is a fault."""
    if np.isnan(columns[:2]).any():
        return None
    axes, places = [], []
    for values in columns[:2]:
        digits = 7 - int(np.floor(np.log10(np.ptp(values)))) if np.ptp(values) > 0 else 0
        axis, place = np.unique(np.round(values, digits), return_inverse=True)
        axes.append(axis)
        places.append(place)
    (x, y), count = axes, columns.shape[1]
    if min(len(x), len(y)) < MIN_POINTS or count < MIN_PRESENT * len(x) * len(y):
        return None
    z = np.full((len(y), len(x)), np.nan)
    z[places[1], places[0]] = columns[2]
    if len(np.unique(places[1] * len(x) + places[0])) < count:
        if not are_all:
            return None
        raise ProfileError("x y z: a point is in it twice; allowed: every point of the grid once")
    return TextMap(z, x, y, True)


def is_matrix(columns: np.ndarray, header: str, layout: Layout) -> bool:
    """Whether columns of numbers are a map, not profiles: by a spacing, positions, or many columns alike."""
    if min(columns.shape) < MIN_POINTS:
        return False
    if layout.spacing is not None or spacings_in(header, columns.shape[::-1], layout.x_unit):
        return True
    return has_no_x(columns) or has_positions(columns, header)


def has_positions(columns: np.ndarray, header: str) -> bool:
    """Whether positions are above the columns; numbers alone may be those of profiles beside each other."""
    _, x, y, *_ = with_axes(columns.T, header)
    return x is not None and not (_are_numbers(x) and (y is None or not _are_numbers(y)))


def has_no_x(columns: np.ndarray, x: int = 0) -> bool:
    """Whether many columns are heights alike: column x, from 0, is not equally spaced."""
    step = np.abs(np.diff(columns[x]))
    usual = np.median(step)
    is_x = usual > 0.0 and (np.abs(step - usual) <= EQUAL_STEPS * usual).mean() > 0.5
    return len(columns) >= MIN_MATRIX_COLUMNS and not is_x


def with_axes(z: np.ndarray, header: str) -> TextMap:
    """Matrix without the line and the column that hold positions, or numbers, of its columns and rows.

    They are equally spaced beside heights that are not, or at the end of a header, behind a word.
    """
    x, y = _axis_in(header, z.shape[1]), None
    is_named = bool(np.isnan(z[:, 0]).all())  # rows with words in front
    if x is None and _is_axis(z[0, 1:], z[1:, 1:], "first line"):
        x, z = z[0], z[1:]
    if is_named or _is_axis(z[:, 0], z[:, 1:].T, "first column") or x is not None and len(x) < z.shape[1]:
        y, z = None if is_named else z[:, 0], z[:, 1:]
        x = x if x is None else x[-z.shape[1] :]
    for axis, place in ((x, "first line"), (y, "first column")):
        if axis is not None and not _unevenness(axis[np.newaxis])[0] <= MAX_UNEVEN:
            raise ProfileError(
                f"its {place} holds positions that are not equally spaced; allowed: equally spaced ones, or "
                "heights alone, with header_lines = lines above them"
            )
    return TextMap(z, x, y)


def _check_borders(z: np.ndarray) -> None:
    """Refuse a matrix with positions in a line or column that is not the first, or in a second one."""
    borders = {"first line": z, "last line": z[::-1], "first column": z.T, "last column": z.T[::-1]}
    for place, heights in borders.items():
        if _is_axis(heights[0], heights[1:], place):
            raise ProfileError(
                f"the {place} of its heights holds positions or numbers; allowed: one line of them above the "
                "heights and one column before them; delete the others"
            )


def _axis_in(header: str, width: int) -> np.ndarray | None:
    """Positions at the end of a header, one for each column, or for each but the first; None: none."""
    line = header.rstrip().rpartition("\n")[2].lstrip("#%; ")
    for separator in ("\t", ";", "|", ",", None):
        cells = [cell.strip(" \"'") for cell in line.split(separator)]
        if separator != ",":
            cells = [cell.replace(",", ".") for cell in cells]
        numbers: list[float] = []
        while cells and re.fullmatch(NUMBER, cells[-1], re.IGNORECASE):
            numbers.insert(0, float(cells.pop()))
        steps = np.diff(numbers)
        if MIN_POINTS <= len(numbers) and len(numbers) in (width, width - 1):
            return np.array(numbers) if (steps > 0).all() or (steps < 0).all() else None
    return None


def _is_axis(line: np.ndarray, others: np.ndarray, place: str) -> bool:
    """Whether a line beside lines of heights, shape (n, len(line)), holds positions.

    Equally spaced values, beside heights that are not, are heights where they are inclined as the others are,
    or differ from the next line of a smooth map as little as that from the one behind it, but for numbers of
    lines or columns and for values far smaller than the heights.
    """
    own, is_long = _unevenness(line[np.newaxis])[0] if len(line) >= MIN_POINTS else np.inf, len(line) >= LONG
    others = others[~np.isnan(others).any(axis=1)]
    if not np.isfinite(own) or len(others) < 2:
        return False
    unevenness = _unevenness(others)
    jumps = np.sqrt(np.mean(np.diff(np.vstack([line, others]), axis=0) ** 2, axis=1))
    usual = np.median(jumps[1:])
    if own <= (MAX_UNEVEN if is_long else MAX_UNEVEN_OF_FEW):
        centred = np.arange(len(line)) - 0.5 * (len(line) - 1)
        is_inclined = (np.abs(others @ centred / (line @ centred) - 1.0) < SAME_RISE).mean() >= 0.5
        is_next = usual < SMOOTH_JUMP * others.std() and jumps[0] <= JUMP_RATIO * usual
        is_uneven = np.median(unevenness) > max(UNEVEN_RATIO * own, MIN_UNEVEN)
        are_numbers = _are_numbers(line) or _are_numbers(line - 1.0)  # behind that of a corner
        is_position = are_numbers or np.ptp(line) < NEGLIGIBLE * others.std()
        return bool(is_uneven) and (is_position or not (is_inclined or is_next))
    if is_long and np.isinf(unevenness).mean() > 0.5 and jumps[0] > JUMP_RATIO * usual:
        raise ProfileError(
            f"its {place} rises or falls as positions do, but at unequal steps; allowed: equally "
            "spaced positions, or heights alone"
        )
    return False


def _unevenness(lines: np.ndarray) -> np.ndarray:
    """Largest deviation of each line from equal spacing, in steps; infinite unless it rises or falls."""
    n, steps = lines.shape[1], np.diff(lines, axis=1)
    mean = (lines[:, -1] - lines[:, 0]) / (n - 1)
    is_straight = (steps > 0).all(axis=1) | (steps < 0).all(axis=1)
    even = lines[:, :1] + mean[:, np.newaxis] * np.arange(n)
    deviations = np.abs(lines - even).max(axis=1)
    return np.where(is_straight, deviations / np.where(is_straight, np.abs(mean), 1.0), np.inf)


def _are_numbers(axis: np.ndarray) -> bool:
    """Whether positions are the numbers of columns or rows, from 0 or 1 on."""
    return bool(axis.min() in (0.0, 1.0) and (np.abs(np.diff(axis)) == 1.0).all())


class Axis(NamedTuple):
    """Axis of a map.

    `positions`: of its columns or rows; None: none in the file. `are_numbers`: whether they only count.
    `stated`, `in_header`: spacing by the case and by the header [m], None without.
    `key`: of the case, of the spacing. `place`: text of where the positions are.
    """

    positions: np.ndarray | None
    are_numbers: bool
    stated: float | None
    in_header: float | None
    key: str
    place: str

    @property
    def has_positions(self) -> bool:
        """Whether the file has positions that tell the spacing."""
        return self.positions is not None and not self.are_numbers

    @property
    def step(self) -> float:
        """Spacing of the positions in their unit."""
        return float(np.abs(self.positions[-1] - self.positions[0])) / (len(self.positions) - 1)

    @property
    def known(self) -> list[tuple[str, float]]:
        """Spacings [m] that need no unit of positions, by their source."""
        both = (f"{self.key} =", self.stated), ("by its header", self.in_header)
        return [(source, distance) for source, distance in both if distance]


def in_metres(
    found: TextMap, header: str, layout: Layout
) -> tuple[np.ndarray, float, float, tuple[str, ...]]:
    """Heights [m], distances of columns and rows [m], and notes, of a map in a text file.

    Positions without a unit are in the one in which they agree with another spacing of their axis, or nearly
    with that of the other axis; else in the unit of the heights.
    """
    if not found.is_list:
        _check_borders(found.z)
    unit, x_unit = (
        stated or next(iter(units_by(pattern, header)), None)
        for stated, pattern in ((layout.unit, UNIT_OF_HEIGHTS), (layout.x_unit, UNIT_OF_X))
    )
    words = spacings_in(header, found.z.shape, layout.x_unit)
    axes = _axes(found, layout, words, x_unit)
    _check_units(header, (unit, x_unit), any(axis.has_positions for axis in axes), layout, words)
    metres, notes = UNITS[x_unit] if x_unit else None, [found.note] if found.note else []
    distances: list[float | None] = []
    for axis, count in zip(axes, found.z.shape[::-1], strict=True):
        known = axis.known
        if axis.has_positions:
            others = [distance for _, distance in known] or distances
            metres = metres or (_unit_by(axis.step, others[0]) if others else None) or UNITS[unit or "m"]
            known = [*known, ("by its positions", axis.step * metres)]
        if axis.has_positions and not found.is_list:
            notes.append(f"{axis.place.format('positions')}, {1e6 * axis.step * metres:.4g} um apart")
        elif axis.are_numbers:
            notes.append(f"{axis.place.format('numbers')}, left out")
        distances.append(_agreed(known, axis.key, count))
    if distances[0] is None:
        raise ProfileError("a matrix of heights needs spacing = distance of its columns in m")
    return UNITS[unit or "m"] * _rising(found), distances[0], distances[1] or distances[0], tuple(notes)


def _axes(found: TextMap, layout: Layout, words: dict[str, float], x_unit: str | None) -> list[Axis]:
    """Axes along and across; `words`: spacings by the header [m]."""
    has_spacing = bool(layout.spacing or words.get("x"))
    axes = []
    for name, positions, stated, key, place in (
        ("x", found.x, layout.spacing, "spacing", "first line: {} of the columns"),
        ("y", found.y, layout.spacing_across, "spacing_across", "first column: {} of the rows"),
    ):
        may_count = positions is not None and x_unit is None and (has_spacing or not found.is_list)
        are_numbers = may_count and _are_numbers(positions)
        axes.append(Axis(positions, are_numbers, stated, words.get(name), key, place))
    return axes


def _check_units(
    header: str,
    units: tuple[str | None, str | None],
    has_positions: bool,
    layout: Layout,
    words: dict[str, float],
) -> None:
    """Refuse a unit of positions that there are not, and units in a header that belong to nothing known."""
    unit, x_unit = units
    if layout.x_unit and not (has_positions or words):
        raise ProfileError("x_unit: of x, not of spacing, which is in m; leave it out")
    missing = ["unit"] if unit is None else ["x_unit"] if x_unit is None and has_positions else []
    others = [name for name in dict.fromkeys(units_in(header)) if name not in ("m", unit)]
    if missing and others:
        raise ProfileError(
            f"its header names {' and '.join(others)}; write {missing[0]} (unit for the heights, x_unit for "
            "positions; spacing is in m)"
        )


def _rising(found: TextMap) -> np.ndarray:
    """Heights in the order of rising positions."""
    z, x, y = found.z, found.x, found.y
    if x is not None and x[0] > x[-1]:
        z = z[:, ::-1]
    return z[::-1] if y is not None and y[0] > y[-1] else z


def _agreed(known: list[tuple[str, float]], key: str, count: int) -> float | None:
    """Distance [m] by the first of its sources; ProfileError where another one gives another distance.

    `count`: points, of which a width in a header may have as many cells or one less.
    """
    for source, distance in known[1:]:
        if abs(distance / known[0][1] - 1.0) > AGREEMENT + 1.0 / count:
            raise ProfileError(
                f"{known[0][0]} {known[0][1]:g} m, {source} {distance:g} m; allowed: the same; leave {key} "
                "out, or write x_unit for the positions"
            )
    return known[0][1] if known else None


def _unit_by(step: float, distance: float | None) -> float | None:
    """Unit [m] in which positions have a distance [m], or that of the other axis nearly; None: no unit."""
    if distance is None:
        return None
    equal = (unit for unit in UNITS.values() if abs(step * unit / distance - 1.0) <= AGREEMENT)
    alike = (UNITS[name] for name in METRIC if 1.0 / MAX_RATIO <= step * UNITS[name] / distance <= MAX_RATIO)
    return next(equal, None) or next(alike, None)
