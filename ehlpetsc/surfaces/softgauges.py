"""Profiles in the text formats of metrology institutes, whose header holds spacing, unit and scale.

* SMD and PRF (ISO 5436-2): axes ``CX`` and ``CZ``, optional entries, heights, each ended by ETX or ``EOR``.
* ASCII SDF (ISO 25178-71, and BCR-1.0 before it): ``NAME = value``, heights in m over `Zscale`, each ended by
  ``*``.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from ehlpetsc.base.errors import ProfileError

SDF_MAGIC = re.compile(rb"\s*a(BCR|ISO)-\d")
SMD_AXES = re.compile(rb"^\s*CX[\s\0].*\n\s*CZ[\s\0]", re.MULTILINE)
HEAD = 2000  # bytes in which the format is recognised
SMD_UNITS = {"M": 1.0, "MM": 1e-3, "UM": 1e-6, "NM": 1e-9}
AXIS_WORDS = 6  # name, type, number of points, unit, scale, type of the numbers


def read_softgauge(path: Path) -> tuple[np.ndarray, np.ndarray] | None:
    """Abscissas and heights [m] of a profile, nan for missing ones; None: a file of another format.

    Of an areal SDF file the central trace.
    """
    with open(path, "rb") as file:
        head = file.read(HEAD).replace(b"\r\n", b"\n")
    if SDF_MAGIC.match(head):
        return _sdf(path.read_text("latin-1"))
    if SMD_AXES.search(head):
        return _smd(path.read_text("latin-1").replace("\0", " "))
    return None


def _smd(text: str) -> tuple[np.ndarray, np.ndarray]:
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
    return np.arange(z.size) * (_smd_length(axis_x) * _number(spacing, "SMD")), z


def _smd_length(axis: list[str]) -> float:
    """Length of one in the data of an axis [m]."""
    if axis[3].upper() not in SMD_UNITS:
        raise ProfileError(f"SMD: unit {axis[3]} of {axis[0]}; allowed: m, mm, um, nm")
    return SMD_UNITS[axis[3].upper()] * _number(axis[4], "SMD")


def _sdf(text: str) -> tuple[np.ndarray, np.ndarray]:
    head, _, rest = text.partition("\n*")
    entries = (line.partition("=") for line in head.splitlines() if "=" in line)
    header = {name.strip().lower(): value.strip() for name, _, value in entries}
    needed = ("NumPoints", "NumProfiles", "Xscale", "Zscale")
    if missing := [name for name in needed if name.lower() not in header]:
        raise ProfileError(f"SDF: {missing[0]} is missing; allowed: a header with it")
    points, traces = (int(_number(header[name], "SDF")) for name in ("numpoints", "numprofiles"))
    z = _numbers(rest.partition("*")[0], "SDF")
    _check_count(z.size, points * traces, "NumPoints NumProfiles", "SDF")
    trace = z.reshape(traces, points)[traces // 2]
    spacing = _number(header["xscale"], "SDF")
    return np.arange(points) * spacing, _number(header["zscale"], "SDF") * trace


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
