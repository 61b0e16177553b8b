"""Profile of a roller given by its points, in the case or in a file, as a table of its kind."""

from __future__ import annotations

from pathlib import Path

from ehlpetsc.base.errors import ProfileError
from ehlpetsc.base.toml_file import Tables
from ehlpetsc.case.checking import Fault
from ehlpetsc.case.conditions import read_table
from ehlpetsc.case.values import show

COLUMNS = {"y": ("y",), "z": ("z", "drop")}  # allowed names of the columns of a file, by key
PLACE = "contact.profile"


def resolve_profile(folder: Path, contact: Tables) -> list[Fault]:
    """Replace the profile in `[contact]`, if it has no kind, by one of kind "table"; returns the faults.

    The points are those of the keys y and z, or of the columns of the file, beside the case file.
    """
    profile = contact["profile"]
    if not isinstance(profile, dict) or "kind" in profile:
        return []
    if "file" not in profile:
        contact["profile"] = {"kind": "table"} | profile
        return []
    file, *others = profile["file"], *(key for key in profile if key != "file")
    if others or not isinstance(file, str):
        given = ", ".join(others) or f"file = {show(file)}"
        return [Fault(PLACE, f"{PLACE}: {given}; allowed: file, its name, and no other key")]
    try:
        columns = read_table(folder / file, {"y": "m", "z": "m"}, COLUMNS)
    except ProfileError as error:
        return [Fault(PLACE, f"{PLACE}.file = {show(file)}: {error}")]
    contact["profile"] = {"kind": "table"} | columns
    return []
