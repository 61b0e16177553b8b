"""Reading of case files: overrides and checks; all faults are reported at once."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from ehlpetsc.base.case import kind_of
from ehlpetsc.base.errors import CaseError
from ehlpetsc.base.toml_file import (
    Tables,
    keys_of,
    member_tables,
    parse_toml,
    parsed,
    plain,
    read_text,
    settings_of,
    with_key,
)
from ehlpetsc.case.checking import Fault, check, in_si
from ehlpetsc.case.conditions import with_columns
from ehlpetsc.case.stages import checked, resolved
from ehlpetsc.case.surface_checks import checked_with_surfaces
from ehlpetsc.case.tables import Case, extend, key_of
from ehlpetsc.case.tables.surface import file_digests
from ehlpetsc.case.values import shortened, show
from ehlpetsc.effects.effect import Effect
from ehlpetsc.physics.oil.law import Law

DICT_NAME = "case"  # name of a case without a file in messages
OWN_ADVICE = "; if it is of your own, set EHLPETSC_OWN to the module that defines it"
Overrides = Tables | Iterable[str] | str | None
__all__ = ["Case", "CaseError", "load", "members", "stored_case"]


def load(
    case: str | PathLike | Tables,
    overrides: Overrides = None,
    *,
    laws: Mapping[str, Law] | None = None,
    density_laws: Mapping[str, Law] | None = None,
    shear_laws: Mapping[str, Law] | None = None,
    effects: Iterable[type[Effect]] = (),
) -> Case:
    """Read and check a case; raises `CaseError` with all faults, one message each.

    Parameters
    ----------
    case
        TOML file or its tables; profile files of a dict are in the current folder, and heights of
        a surface may be arrays, ``{"surface": {"1": {"x": x, "z": z}}}`` [m].
    overrides
        ``{"fluid.viscosity": 0.003}``, None removes the key; or ``table.key=value``, the value in TOML
        syntax, otherwise text. ``table.key=`` leaves out a key, ``time=`` a table; so does an empty table,
        ``time={}``, where the table must have keys.
    laws, density_laws, shear_laws, effects
        Viscosity, density and shear laws by name, and effects, of your own. With their keys and quantities
        they are known to the process from then on; names of built-in ones are refused.

    Examples
    --------
    >>> import ehlpetsc
    >>> case = ehlpetsc.load("cases/table1_smooth.toml", {"fluid.viscosity": 0.003})
    >>> case.fluid.viscosity, case.contact.radius  # Pa s, m
    (0.003, 0.0191)
    """
    extend(laws, density_laws, effects, shear_laws)
    if not isinstance(case, dict | str | PathLike):  # a number would be a file descriptor
        raise CaseError([f"{_not_tables(case)}; allowed: the path of a case file, or a dict of its tables"])
    path, text = (DICT_NAME, None) if isinstance(case, dict) else (case, read_text(case))
    data = plain(case) if text is None else parse_toml(path, text)
    folder = Path(path).parent
    written, of_overrides = _overridden(data, overrides)
    kind = kind_of(written)
    tables, faults = resolved(folder, written, kind)
    faults = of_overrides + faults
    found = checked_with_surfaces(folder, tables, kind, {fault.place for fault in faults})
    lines = _lines(path, faults + found.faults)
    if not lines and "series" in tables:
        lines = _series_faults(path, folder, tables)
    if lines:
        raise CaseError(lines)
    # each member of a series has bulk temperatures of its own
    stored = with_columns(tables if "series" in tables else found.tables, folder, kind)
    text = text if stored == data else None
    return _of_files(found.case.copy({"_path": Path(path), "_tables": stored, "_text": text}))


def _not_tables(given: object) -> str:
    if isinstance(given, Case):
        return "a Case, which is loaded already; for other values load its file or tables with them"
    return f"{shortened(repr(given))}: not a case"


def _of_files(case: Case) -> Case:
    """The case with the digests of its surface files."""
    return case.copy({"_digests": file_digests(case)})


def stored_case(text: str, overrides: Overrides = None) -> Case:
    """Case from the text in a result file, which it keeps, without its profile files; raises `CaseError`."""
    tables, faults = _overridden(parse_toml(DICT_NAME, text), overrides)
    kind = kind_of(tables)
    tables, of_units = in_si(tables, kind)
    faults += of_units
    tables, case, found = checked(Path(), tables, kind, is_stored=True)
    if faults + found:
        own = "" if overrides or os.environ.get("EHLPETSC_OWN") else OWN_ADVICE
        raise CaseError([f"{line}{own}" for line in _lines(DICT_NAME, faults + found)])
    return case.copy({"_path": Path(DICT_NAME), "_tables": tables, "_text": text})


def members(case: Case | str | PathLike | Tables) -> list[tuple[Any, Case]]:
    """Values and members of a series: the same case without `[series]`, with one value of each varied key.

    For several keys the value is a tuple.
    """
    case = case if isinstance(case, Case) else load(case)
    data, result = case._tables, []
    if "series" not in data:
        raise CaseError([f"{case.path}: no [series]: it has no members; solve the case itself"])
    for settings in settings_of(data["series"]):
        tables = member_tables(data, settings)
        tables, member, _ = checked(case.path.parent, tables, kind_of(tables))
        values = tuple(value for _, value in settings)
        member = _of_files(member.copy({"_path": case.path, "_tables": tables, "_text": None}))
        result.append((values[0] if case.series.key else values, member))
    return result


def _overridden(data: Tables, overrides: Overrides) -> tuple[Tables, list[Fault]]:
    """Tables with keys set, and a fault for each invalid one."""
    faults = []
    items: Any = overrides.items() if isinstance(overrides, dict) else overrides or ()
    for override in [items] if isinstance(items, str | int | float) else list(items):
        try:
            keys, value = parsed(override)
            data = with_key(data, keys, None if _leaves_out(override, keys, value) else value)
        except ValueError:
            one_line = " ".join(override.split()) if isinstance(override, str) else show(override)
            text = shortened(one_line)
            faults.append(Fault("", f"{text}: allowed: table.key=value, as in fluid.viscosity=0.003"))
    return data, faults


def _leaves_out(override: object, keys: list[str], value: object) -> bool:
    """Whether an override is ``key=``, of a key of the case, or an empty table in place of one with keys."""
    key = key_of(".".join(keys))
    if key and isinstance(override, str) and not override.partition("=")[2].strip():
        return True
    return bool(value == {} and key and key.table and check(key.table, {})[1])


def _series_faults(path: str | PathLike, folder: Path, data: Tables) -> list[str]:
    """Faults of the members of a series, of which the base case has none."""
    lines = []
    for settings in settings_of(data["series"]):
        try:
            member = member_tables(data, settings)
        except ValueError:
            named = ", ".join(show(key) for key in keys_of(data["series"]))
            return [f"{path}: series.key = {named}: allowed: a key of this case"]
        faults = checked_with_surfaces(folder, member, kind_of(member)).faults
        values = ", ".join(show(value) for _, value in settings)
        lines += [f"{line} (series.values: {values})" for line in _lines(path, faults)]
    return lines


def _lines(path: str | PathLike, faults: list[Fault]) -> list[str]:
    """Messages of faults, each once, without consequences of others."""
    own = [fault for fault in faults if not fault.is_consequence] or faults
    return list(dict.fromkeys(f"{path}: {fault.text}" for fault in own))
