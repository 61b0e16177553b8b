"""Files that include their units and spacings and need no package to be read.

* SMD and PRF (ISO 5436-2): axes ``CX`` and ``CZ``, optional entries, heights, each ended by ETX or ``EOR``.
* SDF (ISO 25178-71, and BCR-1.0 before it), heights in m over `Zscale`. ASCII: ``NAME = value`` and heights,
  each ended by ``*``. Binary: the same entries of fixed lengths, little-endian.
* GSF 1.0 of Gwyddion: ``NAME = value``, NUL up to a multiple of four bytes, heights as float32.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import NamedTuple

import numpy as np

from ehlpetsc.base.errors import ProfileError
from ehlpetsc.surfaces.files.text import UNIT_OF_NAME, UNITS


class Map(NamedTuple):
    """Heights on a uniform grid.

    `z`: m, positive out of the metal, nan where they are missing, shape (ny, nx).
    `dx`, `dy`: distances of the columns and of the rows [m].
    `notes`: notes on the processing of the numbers.
    """

    z: np.ndarray
    dx: float
    dy: float
    notes: tuple[str, ...] = ()


class Trace(NamedTuple):
    """Abscissas and heights of a profile [m], nan where they are missing, shape (n,)."""

    x: np.ndarray
    z: np.ndarray


SDF_MAGIC = re.compile(rb"\s*([ab])(?:BCR|ISO)-(\d)")
SMD_AXES = re.compile(rb"^\s*CX[\s\0].*\n\s*CZ[\s\0]", re.MULTILINE)
GSF_MAGIC = b"Gwyddion Simple Field 1."
HEAD = 2000  # bytes in which the format is recognised
SMD_UNITS = {"M": 1.0, "MM": 1e-3, "UM": 1e-6, "NM": 1e-9}
AXIS_WORDS = 6  # name, type, number of points, unit, scale, type of the numbers
SDF_TYPES = {3: "<f4", 4: "<i1", 5: "<i2", 6: "<i4", 7: "<f8"}  # of the heights by their number


def read_softgauge(path: Path) -> Map | Trace | None:
    """Map or profile in a file, whatever its ending; None: a file of another format."""
    with open(path, "rb") as file:
        head = file.read(HEAD).replace(b"\r\n", b"\n")
    if magic := SDF_MAGIC.match(head):
        if magic[1] == b"b":
            return _binary_sdf(path.read_bytes(), int(magic[2]))
        return _sdf(path.read_text("latin-1"))
    if head.startswith(GSF_MAGIC):
        return _gsf(path.read_bytes())
    if SMD_AXES.search(head):
        return _smd(path.read_text("latin-1").replace("\0", " "))
    return None


def _smd(text: str) -> Trace:
    records = re.split(r"\x03|^EOR\s*$", text, flags=re.MULTILINE)
    if len(records) < 3:
        raise ProfileError("SMD: fewer than 3 records; allowed: axes, entries and heights, each ended by EOR")
    lines = [line.split() for line in (records[0] + "\n" + records[1]).splitlines()]
    axis_x, axis_z = (next(words for words in lines if words[:1] == [name]) for name in ("CX", "CZ"))
    if len(axis_x) < AXIS_WORDS or len(axis_z) < AXIS_WORDS:
        raise ProfileError("SMD: allowed: CX and CZ with type, points, unit, scale and type of the numbers")
    listed = [words[2] for words in lines if words[:2] == ["SPACING", "CX"] and len(words) > 2]
    spacing = next(iter([*axis_x[AXIS_WORDS:], *listed]), None)
    if spacing is None:
        raise ProfileError("SMD: x without spacing; allowed: equally spaced points, CX I or SPACING CX")
    z = _smd_length(axis_z) * _numbers(records[2], "SMD")
    _check_count(z.size, int(_number(axis_z[2], "SMD")), "CZ", "SMD")
    return Trace(np.arange(z.size) * (_smd_length(axis_x) * _number(spacing, "SMD")), z)


def _smd_length(axis: list[str]) -> float:
    """Length of one in the data of an axis [m]."""
    if axis[3].upper() not in SMD_UNITS:
        raise ProfileError(f"SMD: unit {axis[3]} of {axis[0]}; allowed: m, mm, um, nm")
    return SMD_UNITS[axis[3].upper()] * _number(axis[4], "SMD")


def _sdf(text: str) -> Map | Trace:
    head, _, rest = text.partition("\n*")
    header = _entries(head)
    needed = ("NumPoints", "NumProfiles", "Xscale", "Zscale")
    if missing := [name for name in needed if name.lower() not in header]:
        raise ProfileError(f"SDF: {missing[0]} is missing; allowed: a header with it")
    points, traces = (int(_number(header[name], "SDF")) for name in ("numpoints", "numprofiles"))
    z = _number(header["zscale"], "SDF") * _numbers(rest.partition("*")[0], "SDF")
    _check_count(z.size, points * traces, "NumPoints NumProfiles", "SDF")
    dx, dy = (_number(header.get(name, "1"), "SDF") for name in ("xscale", "yscale"))
    return _by_rows(z.reshape(traces, points), dx, dy)


def _binary_sdf(content: bytes, version: int) -> Map | Trace:
    count = "<u4" if version > 1 else "<u2"
    form = np.dtype(
        [("ids", "S42"), ("points", count), ("traces", count), ("scales", "<f8", 4), ("kinds", "u1", 3)]
    )
    if len(content) < form.itemsize:
        raise ProfileError("SDF: its header is not complete")
    header = np.frombuffer(content, form, 1)[0]
    (dx, dy, scale, _), (compression, kind, _) = header["scales"].tolist(), header["kinds"].tolist()
    if compression or kind not in SDF_TYPES:
        allowed = f"0, and {min(SDF_TYPES)} to {max(SDF_TYPES)}"
        raise ProfileError(f"SDF: compression {compression}, data type {kind}; allowed: {allowed}")
    stored, points, traces = np.dtype(SDF_TYPES[kind]), int(header["points"]), int(header["traces"])
    size = points * traces
    found = (len(content) - form.itemsize) // stored.itemsize
    _check_count(min(found, size), size, "NumPoints NumProfiles", "SDF")
    data = np.frombuffer(content, stored, size, form.itemsize)
    lowest = np.iinfo(stored).min if stored.kind == "i" else np.finfo(stored).min  # a missing height
    z = np.where(data == lowest, np.nan, scale * data.astype(float))
    return _by_rows(z.reshape(traces, points), dx, dy)


def _gsf(content: bytes) -> Map | Trace:
    head = content.partition(b"\0")[0]
    header = _entries(head.decode("utf-8", "replace"))
    if missing := [name for name in ("XRes", "YRes") if name.lower() not in header]:
        raise ProfileError(f"GSF: {missing[0]} is missing; allowed: a header with it")
    nx, ny = (int(_number(header[name], "GSF")) for name in ("xres", "yres"))
    units = []
    for name in ("XYUnits", "ZUnits"):
        stated = header.get(name.lower(), "")
        if stated.lower() not in UNIT_OF_NAME:
            raise ProfileError(f'GSF: {name} = "{stated}"; allowed: a unit of length, as m')
        units.append(UNITS[UNIT_OF_NAME[stated.lower()]])
    begin = 4 * (len(head) // 4 + 1)
    _check_count(min((len(content) - begin) // 4, nx * ny), nx * ny, "XRes YRes", "GSF")
    z = np.frombuffer(content, "<f4", nx * ny, begin).astype(float).reshape(ny, nx)
    dx, dy = (
        units[0] * _number(header.get(name, "1"), "GSF") / count
        for name, count in (("xreal", nx), ("yreal", ny))
    )
    return _by_rows(units[1] * z, dx, dy)


def _by_rows(z: np.ndarray, dx: float, dy: float) -> Map | Trace:
    """Map of heights, shape (ny, nx); of one row the profile."""
    return Map(z, dx, dy) if len(z) > 1 else Trace(dx * np.arange(z.shape[1]), z[0])


def _entries(header: str) -> dict[str, str]:
    """Values of the lines ``name = value`` by their names in lower case."""
    entries = (line.partition("=") for line in header.splitlines() if "=" in line)
    return {name.strip().lower(): value.strip() for name, _, value in entries}


def _numbers(text: str, form: str) -> np.ndarray:
    words = ["nan" if word.upper() == "BAD" else word for word in text.split()]
    return np.array([_number(word, form) for word in words])


def _number(word: str, form: str) -> float:
    try:
        return float(word)
    except ValueError:
        raise ProfileError(f'{form}: "{word[:40]}" is not a number; allowed: numbers, and BAD') from None


def _check_count(found: int, stated: int, name: str, form: str) -> None:
    if found != stated or not found:
        raise ProfileError(f"{form}: {found} heights, {name} = {stated} in its header; allowed: as many")
