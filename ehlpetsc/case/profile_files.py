"""Profiles of bodies given by their points, in the case or in a file, as tables of their kind."""

from __future__ import annotations

from pathlib import Path

from ehlpetsc.base.errors import ProfileError
from ehlpetsc.base.toml_file import Tables, with_key
from ehlpetsc.case.checking import Fault
from ehlpetsc.case.conditions import Columns, read_table
from ehlpetsc.case.values import show

POINTS = {"profile": "y", "profile_along": "x"}
"""Keys of [contact] that are profiles, and the distance of their points."""
HEIGHTS: Columns = {"z": ("z", "drop")}  # allowed names of the column of a file


def with_profiles(folder: Path, tables: Tables) -> tuple[Tables, list[Fault]]:
    """Tables of a case whose profiles, given without a kind, are of kind "table", and the faults.

    The points are those of the keys, or of the columns of the file, beside the case file.
    """
    faults: list[Fault] = []
    for name, distance in POINTS.items():
        given = tables["contact"].get(name)
        if isinstance(given, dict) and "kind" not in given:
            place = f"contact.{name}"
            try:
                points = _points(folder, given, distance) if "file" in given else given
            except ProfileError as error:
                faults.append(Fault(place, f"{place}{error}"))
            else:
                tables = with_key(tables, ["contact", name], {"kind": "table"} | points)
    return tables, faults


def _points(folder: Path, given: Tables, distance: str) -> Tables:
    """Points of a file; raises `ProfileError` with a message that follows the place."""
    file, *others = given["file"], *(key for key in given if key != "file")
    if others or not isinstance(file, str):
        keys = ", ".join(others) or f"file = {show(file)}"
        raise ProfileError(f": {keys}; allowed: file, its name, and no other key")
    try:
        names = {distance: (distance,), **HEIGHTS}
        return read_table(folder / file, {distance: "m", "z": "m"}, names)
    except ProfileError as error:
        raise ProfileError(f".file = {show(file)}: {error}") from None
