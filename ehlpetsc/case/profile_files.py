"""Profile of a roller given by its points, in the case or in a file, as a table of its kind."""

from __future__ import annotations

from pathlib import Path

from ehlpetsc.base.errors import ProfileError
from ehlpetsc.base.toml_file import Tables, with_key
from ehlpetsc.case.checking import Fault
from ehlpetsc.case.conditions import read_table
from ehlpetsc.case.values import show

COLUMNS = {"y": ("y",), "z": ("z", "drop")}  # allowed names of the columns of a file, by key
PLACE = "contact.profile"


def with_profile(folder: Path, tables: Tables) -> tuple[Tables, list[Fault]]:
    """Tables of a case whose profile of a roller, given without a kind, is of kind "table", and the faults.

    The points are those of the keys y and z, or of the columns of the file, beside the case file.
    """
    contact = tables.get("contact")
    profile = contact.get("profile") if isinstance(contact, dict) else None
    if not isinstance(profile, dict) or "kind" in profile:
        return tables, []
    if "file" not in profile:
        return _with_points(tables, profile), []
    file, *others = profile["file"], *(key for key in profile if key != "file")
    if others or not isinstance(file, str):
        given = ", ".join(others) or f"file = {show(file)}"
        return tables, [Fault(PLACE, f"{PLACE}: {given}; allowed: file, its name, and no other key")]
    try:
        columns = read_table(folder / file, {"y": "m", "z": "m"}, COLUMNS)
    except ProfileError as error:
        return tables, [Fault(PLACE, f"{PLACE}.file = {show(file)}: {error}")]
    return _with_points(tables, columns), []


def _with_points(tables: Tables, points: Tables) -> Tables:
    return with_key(tables, PLACE.split("."), {"kind": "table"} | points)
