"""Reading of case files: overrides and checks; all faults are reported at once."""

import tomllib
from functools import partial
from pathlib import Path

from ehlpetsc.case.combinations import member_tables, series_faults, settings_of
from ehlpetsc.case.derived.conditions import (
    TableFault,
    conditions_of,
    reversal_faults,
    with_columns,
    with_reference_state,
)
from ehlpetsc.case.derived.measured_layer import resolve_measured_layer
from ehlpetsc.case.derived.oil_grade import with_grade
from ehlpetsc.case.derived.solids import with_material
from ehlpetsc.case.faults import describe, shortened, show
from ehlpetsc.case.profiles import profile_faults
from ehlpetsc.case.schema.validation import ValidationError
from ehlpetsc.case.settings import parsed, put, text_with
from ehlpetsc.case.tables.case import Case
from ehlpetsc.case.toml_text import plain, toml_text
from ehlpetsc.case.units import in_si
from ehlpetsc.errors import CaseError
from ehlpetsc.toml_file import parse_toml, read_text

DICT_NAME = "case"  # name of a case without a file in messages
__all__ = ["Case", "CaseError", "load", "members"]


def load(case, overrides=None):
    """Read and check a case.

    Parameters
    ----------
    case : str, path-like or dict
        TOML file or its tables; profile files of a dict are in the current folder, and heights of
        a surface may be arrays, ``{"surface": {"1": {"x": x, "z": z}}}`` [m].
    overrides : dict, str or iterable of str, optional
        ``{"fluid.viscosity": 0.003}``, None removes the key; or ``table.key=value``, the value in TOML
        syntax, otherwise text.

    Returns
    -------
    Case

    Raises
    ------
    CaseError
        Contains all faults, one message each.

    Examples
    --------
    >>> import ehlpetsc
    >>> case = ehlpetsc.load("cases/table1_smooth.toml", {"fluid.viscosity": 0.003})
    >>> case.fluid.viscosity, case.contact.radius  # Pa s, m
    (0.003, 0.0191)
    """
    path, text = (DICT_NAME, None) if isinstance(case, dict) else (case, read_text(case))
    data = plain(case) if text is None else parse_toml(path, text)
    from_python = isinstance(case, dict) or isinstance(overrides, dict)  # tomlkit is slow on long arrays
    settings, faults = _override(path, data, overrides)
    converted = in_si(path, data, Case)
    measured, unresolved = resolve_measured_layer(path, data)
    settings, faults = settings + converted + measured, faults + [f"{path}: {line}" for line in unresolved]
    if unresolved:
        raise CaseError(faults)
    faults += _faults(path, data)
    if not faults:
        faults += series_faults(path, data, lambda member: _faults(path, member))
    if faults:
        raise CaseError(faults)
    stored, columns = with_columns(data, Path(path).parent)
    text = toml_text(stored) if from_python else text_with(text, [*settings, *columns], stored)
    return _case_from(path, data, text)


def stored_case(text, overrides=None):
    """Case from the text in a result file, without its profile files.

    Parameters
    ----------
    text : str
    overrides : dict or iterable of str, optional
        See `load`.

    Returns
    -------
    Case
        Case with the stored text.

    Raises
    ------
    CaseError
    """
    data = parse_toml(DICT_NAME, text)
    _, faults = _override(DICT_NAME, data, overrides)
    faults += _table_faults(DICT_NAME, data, stored=True)[1]
    if faults:
        raise CaseError(faults)
    return _case_from(DICT_NAME, data, text, stored=True)


def _override(path, data, overrides):
    """Set keys in the tables; returns the settings and a fault for each invalid one."""
    settings, faults = [], []
    items = overrides.items() if isinstance(overrides, dict) else overrides or ()
    for override in [items] if isinstance(items, str | int | float) else list(items):
        try:
            settings.append(parsed(override))
            put(data, *settings[-1])
        except ValueError:
            text_of_override = shortened(" ".join(str(override).split()))  # a fault is one line
            faults.append(
                f"{path}: {text_of_override}: allowed: table.key=value, as in fluid.viscosity=0.003"
            )
    return settings, faults


def members(case):
    """Members of a series: the same case without `[series]`, with one value of each varied key.

    Parameters
    ----------
    case : Case, or an argument of `load`

    Returns
    -------
    list of (value, Case)
        For several keys the value is a tuple.
    """
    case = case if isinstance(case, Case) else load(case)
    data, result = tomllib.loads(case.text), []
    if "series" not in data:
        raise CaseError([f"{case.path}: no [series]: it has no members; solve the case itself"])
    alone = text_with(case.text, [], member_tables(data, []), without="series")
    for settings in settings_of(data["series"]):
        tables = member_tables(data, settings)
        text = partial(text_with, alone, settings, tables)
        values = tuple(value for _, value in settings)
        result.append((values[0] if case.series.key else values, _case_from(case.path, tables, text)))
    return result


def _case_from(path, data, text, stored=False):
    data = with_grade(with_material(data))
    table, _ = _conditions(path, data, stored)
    return Case.of(with_reference_state(data, table), text, Path(path), table)


def _conditions(path, data, stored=False):
    """Conditions over time, or None, and the faults of their table, which is not read for a stored case."""
    try:
        return conditions_of(data, Path(path).parent), []
    except TableFault as error:
        file = data["operation"].get("file")
        return None, [f"operation{f'.file = {show(file)}' if file else ''}: {error}"] * (not stored)


def _faults(path, data):
    """Faults of the tables and of their profile files."""
    case, faults = _table_faults(path, data)
    in_files = profile_faults(Path(path).parent, data.get("surface"), case if not faults else None)
    return faults + [f"{path}: {fault}" for fault in in_files]


def _table_faults(path, data, stored=False):
    """The case, or None, and the faults of its tables."""
    data = with_grade(with_material(data))
    table, faults = _conditions(path, data, stored)
    data = with_reference_state(data, table)
    if "motion" not in data and ("fluid" in data or "time" in data):
        faults.append("motion is missing; allowed: a table (speeds; needed with [fluid] and with [time])")
    case = None
    try:
        case = Case(**data)
    except ValidationError as error:
        faults += describe(error, Case, data)
    if case and table:
        faults += reversal_faults(case, table)
    return case, [f"{path}: {fault}" for fault in faults]
