"""Checks of a life's case and files, before anything is computed."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from pathlib import Path

from ehlpetsc.base.case import changed_files
from ehlpetsc.base.errors import CaseError, OutputError
from ehlpetsc.case.tables import Case
from ehlpetsc.life.history import LifeHistory, read_life
from ehlpetsc.life.positions import number_of_positions
from ehlpetsc.results.output_guard import check_derived, check_output_path, inputs_of

ENDS = ("passes", "max_solved")  # keys of [life] that may change between calls
NEEDED = ("pressure", "shear_stress_1", "shear_stress_2")


def check_case(case: Case) -> None:
    """Check that a case has a life; CaseError."""
    faults = []
    if case.life is None:
        faults.append("no [life] table; allowed: a case with one")
    if case.series:
        faults.append("[life] with a [series] has a life for each member: allowed here: one of them")
    if case.time is None:
        faults.append("[life] needs [time]: passes of surfaces in motion")
    if not (case.surface.body_1 or case.surface.body_2):
        faults.append("[life] needs a rough surface: jumps are a share of its Rq")
    if case.conditions is not None and 0 in case.conditions.directions():
        faults.append("[life] needs surfaces that move one way: points would pass the contact several times")
    if case.output.every != 1 or not set(NEEDED) <= set(case.output.fields):
        faults.append(f"[life] needs output.every = 1 and the fields {', '.join(NEEDED)}")
    if faults:
        raise CaseError([f"{case.path}: {fault}" for fault in faults])


def pass_file(path: Path, position: int, positions: int) -> Path:
    """Result of the last solved pass in a position of surface 2, in the folder of the life `path`."""
    return path.with_suffix(".pass.h5" if positions == 1 else f".pass{position + 1}.h5")


def check_files(path: Path, case: Case) -> None:
    """Refuse to overwrite an input or a file that is not a life.

    `path`: the life. Raises `OutputError`.
    """
    check_derived(path, inputs_of(case), (".h5",))
    positions = number_of_positions(case)
    for position in range(positions):
        check_output_path(pass_file(path, position, positions), inputs_of(case), "-o")


def _tables_of_surfaces(text: str) -> dict:
    """Tables of a case on which its surfaces depend: without the title and the end of the life."""
    tables = tomllib.loads(text)
    tables.pop("title", None)
    tables["life"] = {name: value for name, value in tables["life"].items() if name not in ENDS}
    return tables


def stored_or_new(case: Case, path: Path, overwrite: bool) -> LifeHistory:
    """Life stored at `path`, or a new one; OutputError if it is the life of another case."""
    if overwrite or not path.exists():
        return LifeHistory(case.text, case.title, digests=case.digests)
    history = read_life(path)
    if _tables_of_surfaces(history.case) != _tables_of_surfaces(case.text):
        raise OutputError(f"{path}: the life of another case; give another -o, or --overwrite to lose it")
    if changed := changed_files(history.digests, case.digests):
        reason = f"{changed} changed since it was written"
        raise OutputError(f"{path}: {reason}; give another -o, or --overwrite to lose it")
    return replace(history, case=case.text)  # which may extend the life
