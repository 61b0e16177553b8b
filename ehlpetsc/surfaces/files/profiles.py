"""Measured profiles: text in many layouts, and the formats of instruments."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ehlpetsc.base.errors import ProfileError
from ehlpetsc.surfaces.files.headers import units_named
from ehlpetsc.surfaces.files.instruments import read_instrument, read_once
from ehlpetsc.surfaces.files.softgauges import Map, Trace, read_softgauge
from ehlpetsc.surfaces.files.text import UNITS, Layout, text_columns, units_in
from ehlpetsc.surfaces.files.text_maps import (
    MIN_MATRIX_COLUMNS,
    MIN_POINTS,
    has_no_x,
    has_positions,
    listed,
)
from ehlpetsc.surfaces.filters import groups, held, spikes, without_no_data

TEXT_ENDINGS = {".csv", ".txt", ".dat", ".asc", ".prf", ".prn", ".tsv", ".xyz", ""}
MIN_MEASURED_POINTS = 50  # profiles with fewer are made by hand, without missing points
SPACING_VARIATION = 0.02  # relative, of equally spaced points
MIN_EQUAL_FRACTION = 0.9  # of equal spacings in files with missing lines
MAX_ABSCISSA = 1e6  # m: beyond it squares and cubes of a spline overflow


@read_once
def read_profile(path: Path, layout: Layout) -> tuple[np.ndarray, np.ndarray, tuple[str, ...]]:
    """Abscissas, from 0 on, and heights of a profile file.

    Text: columns of numbers, by default two, x and z in metres, separated by comma, semicolon, tab or blanks;
    header lines, ``#`` comments, decimal comma, UTF-8, UTF-16 or Latin-1, x rising or falling. Any other
    format as of :func:`.instruments.read_instrument`, of a map the central trace.

    Returns X and z [m], X increasing, heights positive out of the metal, shape (n,), and notes on the
    processing of the numbers.
    """
    if path.suffix.lower() == ".npy":
        raise ProfileError("a map of heights, not a profile; allowed: text, x and z in m")
    is_text = path.suffix.lower() in TEXT_ENDINGS and read_softgauge(path) is None
    read = _from_text(path, layout) if is_text else _trace(read_instrument(path, layout))
    x, z, notes = checked(*read, layout)
    x.flags.writeable = z.flags.writeable = False
    return x, z, notes


def _trace(found: Map | Trace) -> Trace:
    """Profile, of a map its middle row."""
    if isinstance(found, Trace):
        return found
    return Trace(found.dx * np.arange(found.z.shape[1]), found.z[len(found.z) // 2])


def _from_text(path: Path, layout: Layout) -> tuple[np.ndarray, np.ndarray]:
    columns, header = text_columns(path, layout.decimal, layout.header_lines)
    if columns.shape[1] <= 2 and len(columns) >= MIN_MEASURED_POINTS:  # one line of heights, or of x and of z
        columns = columns.T
    count, numeric = len(columns), [k for k, c in enumerate(columns, 1) if not np.isnan(c).all()]
    chosen = layout.columns or tuple(numeric)
    if max(chosen) > count:
        raise ProfileError(f"columns = {list(chosen)}: the file has {count}")
    if empty := set(chosen) - set(numeric):
        raise ProfileError(
            f"columns = {list(chosen)}: no numbers in column {min(empty)}; allowed: {numeric}, from 1"
        )
    _check_map(columns, header, chosen)
    named = units_in(header) or units_named(header)
    if layout.unit is None and set(named) - {"m"}:
        raise ProfileError(
            f"its header names {' and '.join(dict.fromkeys(named))}, which a file need not mean for both "
            f'columns; write unit = "{named[-1]}" for the heights'
            + (f' and x_unit = "{named[0]}"' if named[0] != named[-1] else "")
        )
    if len(chosen) > 2:
        raise ProfileError(
            f"{count} columns; write columns = [1, 2] for x and z, counted from 1, or columns = [2] and "
            "spacing for heights alone; where commas are decimal, semicolons or tabs must part the numbers"
        )
    if (len(chosen) == 1) != (layout.spacing is not None):
        raise ProfileError(
            "heights alone need spacing = distance of the points in m, x and z none: write columns = [2] "
            'for the heights alone, or decimal = "," where the comma is decimal'
        )
    z = UNITS[layout.unit or "m"] * columns[chosen[-1] - 1]
    if len(chosen) == 1:
        return layout.spacing * np.arange(z.size), z
    return UNITS[layout.x_unit or layout.unit or "m"] * columns[chosen[0] - 1], z


def _check_map(columns: np.ndarray, header: str, chosen: tuple[int, ...]) -> None:
    """Refuse a map of heights as a profile: none of its columns is x, a trace across is short."""
    count, lines = columns.shape
    if found := listed(columns, header):
        size = "x y z of {1} x {0} points".format(*found.z.shape)
    elif count >= MIN_MATRIX_COLUMNS and (
        lines < min(count, MIN_MEASURED_POINTS) if len(chosen) == 1 else has_no_x(columns, chosen[0] - 1)
    ):
        size = f"{count} columns in {lines} lines without an equally spaced x"
    elif len(chosen) > 2 and lines >= MIN_POINTS and has_positions(columns, header):
        size = f"{count} columns in {lines} lines with positions"
    else:
        return
    raise ProfileError(
        f"{size}: a map of heights, not a profile; points and strips read it, a line contact one line of it "
        "in a file of its own, with spacing = distance of its points [m]"
    )


def checked(x: np.ndarray, z: np.ndarray, layout: Layout) -> tuple[np.ndarray, np.ndarray, tuple[str, ...]]:
    """Profile from x = 0 on with increasing x and filled gaps; ProfileError for a faulty one."""
    x, notes = np.array(x, float), []
    z, no_data = without_no_data(z, UNITS[layout.unit or "m"])
    bad = ~(np.abs(x) < MAX_ABSCISSA) | (np.abs(z) >= MAX_ABSCISSA)
    if bad.any():
        raise ProfileError(
            f"point {bad.argmax() + 1} is not a number below {MAX_ABSCISSA:g} m; allowed: finite x and z"
        )
    if x.size < 4:
        raise ProfileError(f"{x.size} points; allowed: at least 4")
    step = np.diff(x)
    if (step < 0).all():
        x, z, step = x[::-1], z[::-1], -step[::-1]
        notes.append("x falls in the file: read from its end")
    if (step <= 0).any():
        k = (step <= 0).argmax()
        raise ProfileError(
            f"x = {x[k + 1]:g} follows x = {x[k]:g}; allowed: x increasing or falling, every x once, "
            "or spacing and columns for the heights alone"
        )
    x, z = _with_missing_lines(x, z)
    is_missing, is_spike = np.isnan(z), spikes(z)
    if is_missing.any():
        notes.append(_note_of_gaps(x, is_missing, layout.fill_gaps, no_data))
    if (is_held := held(z)).any():
        notes.append(_note_of_held_heights(x, is_held))
    if is_spike.any():
        notes.append(_note_of_spikes(x, is_spike, layout.bridge_spikes))
        is_missing |= is_spike & layout.bridge_spikes
    if is_missing.any():
        x, z = _bridged(x, z, is_missing)
    return x - x[0], z, tuple(notes)


def _with_missing_lines(x: np.ndarray, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Profile with nan for every missing point of an equally spaced file."""
    step = np.diff(x)
    usual = np.median(step)
    equal, wide = np.abs(step - usual) <= SPACING_VARIATION * usual, step > 1.5 * usual
    is_measured = x.size >= MIN_MEASURED_POINTS and equal.mean() >= MIN_EQUAL_FRACTION
    if not (is_measured and wide.any() and (equal | wide).all()):
        return x, z
    counts = np.rint(step / usual)
    if counts.sum() > 2 * x.size:
        worst = x[step.argmax()]
        raise ProfileError(
            f"points {usual:.3g} m apart, and none for {step.max():.3g} m behind x = {worst:g}; "
            "allowed: no more than half of the points missing"
        )
    places = np.concatenate([[0.0], np.cumsum(counts)])
    number = np.arange(int(places[-1]) + 1)
    heights = np.full(number.size, np.nan)
    heights[places.astype(int)] = z
    return np.interp(number, places, x), heights


def _note_of_gaps(x: np.ndarray, is_missing: np.ndarray, longest: float | None, no_data: str) -> str:
    """Note on missing heights; ProfileError if a gap is longer than `longest` [m].

    `no_data`: which of them have a no-data value.
    """
    present = np.flatnonzero(~is_missing)
    missing = x.size - present.size
    if present.size < 4:
        raise ProfileError(f"{present.size} heights are not missing{no_data}; allowed: at least 4")
    gaps = np.diff(x[present]) * (np.diff(present) > 1)
    ends = max(x[present[0]] - x[0], x[-1] - x[present[-1]])
    widest = max(gaps.max(), ends)
    if longest is None or widest > longest:
        worst = x[present[gaps.argmax()]] if gaps.max() >= ends else x[0] if present[0] else x[present[-1]]
        raise ProfileError(
            f"{missing} heights missing{no_data}, the longest gap {widest:.3g} m behind x = {worst:g}; "
            f"write fill_gaps = {widest * 1.01:.2g} or more to have the spline bridge gaps of that length [m]"
        )
    return (
        f"{missing} missing heights filled or, at the ends, cut off{no_data}; "
        f"longest gap {1e6 * widest:.3g} um"
    )


def _note_of_held_heights(x: np.ndarray, is_held: np.ndarray) -> str:
    count, place = np.count_nonzero(is_held), 1e6 * (x[is_held.argmax()] - x[0])
    return (
        f"equal heights in a row: {count}, from x = {place:.4g} um on, of drop-outs or the end of the range; "
        "nan in their place and fill_gaps bridge them"
    )


def _note_of_spikes(x: np.ndarray, is_spike: np.ndarray, are_bridged: bool) -> str:
    place, action = 1e6 * (x[is_spike.argmax()] - x[0]), "; bridge_spikes = true bridges them"
    found = f"spikes: {groups(is_spike)} with {np.count_nonzero(is_spike)} points in all"
    return f"{found}, the first at x = {place:.4g} um{', bridged' if are_bridged else action}"


def _bridged(x: np.ndarray, z: np.ndarray, is_missing: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Profile with missing heights filled by the spline, and cut off at its ends."""
    from scipy.interpolate import CubicSpline

    present = np.flatnonzero(~is_missing)
    inside = slice(present[0], present[-1] + 1)
    return x[inside], CubicSpline(x[present], z[present])(x[inside])
