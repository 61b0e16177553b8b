"""Tables of a case file against their keys: values with units converted, checked values, and faults."""

from __future__ import annotations

import keyword
from collections.abc import Collection, Iterator, Set
from dataclasses import replace
from typing import Any, NamedTuple

from ehlpetsc.base.case import KINDS
from ehlpetsc.base.declarations import Key, KeyTable, Refused, without_backticks
from ehlpetsc.base.errors import CaseError
from ehlpetsc.base.toml_file import Tables, copied
from ehlpetsc.base.units import UnitFault, converted
from ehlpetsc.case.tables import CASE, key_of
from ehlpetsc.case.values import (
    NotAllowed,
    allowed,
    celsius,
    is_allowed,
    is_word,
    nearest,
    show,
    similar,
    unknown,
    value_of,
)

NUMBERS_ONLY = {"half-widths", "boundary films"}  # units that are no units of measurement


class Fault(NamedTuple):
    """A fault of the key at a place; a consequence disappears with the other faults."""

    place: str
    text: str
    is_consequence: bool = False


class _Scope(NamedTuple):
    """Scope of a check: tables of the whole case, places of known faults, whether all tables are sound."""

    root: Tables
    known: Collection[str]
    is_sound: bool


def in_si(data: Tables, kind: str) -> tuple[Tables, list[Fault]]:
    """Tables of a case with numbers in SI units in place of texts with a unit, and the faults."""
    faults, table, tables = [], in_kind(CASE, kind), copied(data)
    of_series = _series_entries(tables.get("series"), table)
    for holder, name, key, place in [*entries(tables, table, ""), *of_series]:
        if key and key.kind is float and key.unit not in NUMBERS_ONLY:
            try:
                holder[name] = converted(holder[name], key.unit, key.is_difference)
            except UnitFault as fault:
                is_other = key.point_unit and str(fault).endswith(f"a unit of {key.unit}")
                faults.append(Fault(place, f"{place} = {fault}{KINDS[kind].radii if is_other else ''}"))
    return tables, faults


def in_kind(table: KeyTable, kind: str) -> KeyTable:
    """Table whose keys have their units in a kind of contact."""

    def of_kind(key: Key) -> Key:
        if key.table:
            return replace(key, table=in_kind(key.table, kind))
        return replace(key, unit=key.point_unit) if key.point_unit and KINDS[kind].is_whole else key

    return replace(table, keys={name: of_kind(key) for name, key in table.keys.items()})


def unsound_tables(data: Tables, known: Collection[str] = ()) -> set[str]:
    """Names of the tables of a case with a faulty value or an unknown key: nothing may be derived from them.

    What is missing, and what other keys need, may follow from other tables and counts as sound.
    `known`: places of faults that have been found already.
    """
    names = {place.partition(".")[0] for place in (*known, *_faulty_places(CASE, data, ""))}
    return names | _meant(CASE, data)


def _meant(table: KeyTable, data: Tables) -> set[str]:
    """Keys of a table that unknown ones in it most likely mean."""
    return {key for name in data if name not in table.keys for key in similar(str(name), table.keys)}


def _faulty_places(table: KeyTable, data: Tables, where: str) -> Iterator[str]:
    yield from (f"{where}{name}" for name in data if name not in table.keys)
    for name in table.keys.keys() & data.keys():
        key, value = table.keys[name], data[name]
        if tables := tables_of(key, value, where + name):
            for place, inner, one in tables:
                yield from _faulty_places(inner, one, f"{place}.")
        elif value is not None and not (is_word(key, value) or is_allowed(key, value)):
            yield where + name


def entries(data: Tables, table: KeyTable, where: str) -> Iterator[tuple[Any, Any, Key | None, str]]:
    """Values in tables: their table or list, their key in it, the key of the case, the place."""
    for name, key in table.keys.items():
        value = data.get(name)
        if tables := tables_of(key, value, where + name):
            for place, inner, one in tables:
                yield from entries(one, inner, f"{place}.")
        elif value is not None:
            yield data, name, key, where + name


def _series_entries(series: object, table: KeyTable) -> Iterator[tuple[Any, Any, Key | None, str]]:
    if not isinstance(series, dict) or not isinstance(values := series.get("values"), list):
        return
    if "key" in series:
        yield series, "values", key_of(series["key"], table), "series.values"
    elif isinstance(keys := series.get("keys"), list):
        for number, name in enumerate(keys[: len(values)]):
            yield values, number, key_of(name, table), f"series.values.{number}"


def check(
    table: KeyTable,
    data: Tables,
    where: str = "",
    root: Tables | None = None,
    known: Collection[str] = (),
    is_sound: bool = True,
) -> tuple[Any, list[Fault]]:
    """Checked values of a table, None with faults, and its faults.

    `where`: dotted name of the table with a dot at its end, "" for the whole case. `root`: tables of the
    whole case, by default `data`. `known`: places of faults that have been found already. `is_sound`:
    whether the case has no unsound table; what keys need may otherwise be missing as a consequence.
    """
    scope = _Scope(data if root is None else root, known, is_sound)
    values: Tables = {}
    faults: list[Fault] = []
    others = [str(name) for name in data if name not in table.keys]
    misspelt = _meant(table, data) | {f"[{name}]" for name in _meant(CASE, scope.root)}
    for name, key in table.keys.items():
        place, value = where + name, data.get(name)
        if place in known:
            faults.append(Fault(place, ""))
        elif value is None and not (key.table and key.table.always):
            faults += _missing(place, key, data, scope.root, misspelt & {name, *key.replaced_by})
            values[attribute(name)] = key.default
        else:
            given = {} if value is None else value
            values[attribute(name)], found = _checked(place, table, key, given, data, scope)
            faults += found
    for name in others:
        faults.append(Fault(f"{where}{name}", unknown(where, name, data[name], table.keys)))
    if faults:
        return None, [fault for fault in faults if fault.text]
    result = table.values(values)
    try:
        return (result.copy(table.complete(result)) if table.complete else result), []
    except Refused as refused:
        return None, [_refused(table, data, where, refused)]


def values_of(table: KeyTable, data: Tables) -> Any:
    """Checked values of a single table; raises `CaseError`."""
    values, faults = check(table, data, f"{table.name}." if table.name else "")
    if faults:
        raise CaseError([fault.text for fault in faults])
    return values


def _missing(place: str, key: Key, data: Tables, root: Tables, misspelt: Set[str]) -> list[Fault]:
    """Fault of a required key; a consequence where it follows from others, or if one of them is misspelt."""
    if not key.required:
        return []
    given = [name for name in key.replaced_by if (root.get(name[1:-1]) if name[0] == "[" else name in data)]
    text = f"{place} is missing" + (f", and does not follow from {given[0]}" if given else "")
    instead = "".join(f", or {name}" for name in key.replaced_by if not given)
    return [Fault(place, f"{text}; allowed: {allowed(key)}{instead}", bool(given or misspelt))]


def _checked(
    place: str, table: KeyTable, key: Key, value: object, data: Tables, scope: _Scope
) -> tuple[Any, list[Fault]]:
    """Value of a key of a table and its faults."""
    if tables := tables_of(key, value, place):
        inner = tables[0][1]
        unmet = [need for need in inner.needs if not _holds(need, scope.root)]
        needs = [Fault(place, f"{place}: needs {' and '.join(unmet)}", not scope.is_sound)] if unmet else []
        found = [check(inner, one, f"{at}.", *scope) for at, _, one in tables if one or not key.many]
        faults = [fault for _, of_one in found for fault in of_one]
        if key.many:
            given = iter(result for result, _ in found)
            of_bodies = [next(given) if one else None for _, _, one in tables]
            return (*of_bodies, None)[:2] if found else None, needs + faults
        return found[0][0], needs + faults
    try:
        result = value_of(key, value)
        limit = data.get(key.below) if key.below else None
        if limit is not None and is_allowed(table.keys[key.below], limit) and result >= limit:
            raise NotAllowed
    except NotAllowed:
        if key.variants and isinstance(value, dict) and "kind" in value:
            return None, [Fault(place, _unknown_kind(place, key.variants, value["kind"]))]
        if isinstance(value, dict) and key.kind is not dict:
            return None, [Fault(place, f"{place}: a table here; allowed: {allowed(key)}")]
        hint = celsius(key, value)
        text = f"{place} = {show(value)}: allowed: {allowed(key)}{hint}"
        return None, [Fault(place, text, is_word(key, value) and not scope.is_sound)]
    unmet = [need for need in key.needs if result != key.default and not _holds(need, scope.root)]
    of_need = f"{place} = {show(value)}: needs {' and '.join(unmet)} ({without_backticks(key.text)})"
    return (None, [Fault(place, of_need, not scope.is_sound)]) if unmet else (result, [])


def _unknown_kind(place: str, variants: Collection[str], kind: object) -> str:
    """Fault of a table whose kind is not one of several."""
    names = ", ".join(f'"{name}"' for name in variants)
    hint = f"; {close}" if (close := nearest(str(kind), variants)) else ""
    return f"{place}.kind = {show(kind)}: allowed: one of {names}{hint}"


def _table_of(key: Key, value: object) -> KeyTable | None:
    """Table of the value of a key; of several that of its kind."""
    if key.variants and isinstance(value, dict):
        kind = value.get("kind")
        return key.variants.get(kind) if isinstance(kind, str) else None
    return key.table


def tables_of(key: Key, value: object, place: str) -> list[tuple[str, KeyTable, Tables]]:
    """Place, declaration and keys of the table that a value is, or of those of both bodies; [] of others."""
    inner = _table_of(key, value)
    if inner is None or isinstance(value, dict):
        return [(place, inner, value)] if inner and isinstance(value, dict) else []
    both = value if isinstance(value, list | tuple) and key.many == "both" else ()
    is_pair = len(both) == 2 and all(isinstance(one, dict) for one in both)
    return [(f"{place}.{i}", inner, one) for i, one in enumerate(both, 1)] if is_pair else []


def _holds(need: str, root: Tables) -> bool:
    """Whether a need of a key is met by the tables of a case, see :class:`ehlpetsc.base.declarations.Key`."""
    place, equals, wanted = (part.strip() for part in need.partition("="))
    left_out = place.endswith(" left out")
    place = place.removesuffix(" left out").strip("[]")
    value: Any = root
    for name in place.split("."):
        value = value.get(name) if isinstance(value, dict) else None
    if equals:
        key = key_of(place)
        return (key.default if value is None and key else value) == wanted.strip('"')
    return (value is None) == left_out


def _refused(table: KeyTable, data: Tables, where: str, refused: Refused) -> Fault:
    if not refused.key:
        place = where.rstrip(".") or "case"
        return Fault(place, f"{place}: {refused}")
    place, key = where + refused.key, table.keys[refused.key]
    if data.get(refused.key) is None:
        return Fault(place, f"{place} is missing; allowed: {allowed(key)}")
    reason = str(refused) or f"allowed: {allowed(key)}"
    return Fault(place, f"{place} = {show(data[refused.key])}: {reason}")


def attribute(name: str) -> str:
    """Attribute of a key: `lambda_`, `body_1`."""
    return f"body_{name}" if name.isdigit() else f"{name}_" if keyword.iskeyword(name) else name
