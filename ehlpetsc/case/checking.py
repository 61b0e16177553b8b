"""Tables of a case file against their keys: values with units converted, checked values, and faults."""

from __future__ import annotations

import keyword
import math
from collections.abc import Collection, Iterator
from dataclasses import replace
from operator import ge, gt, le, lt
from typing import Any, NamedTuple, TypeGuard

from ehlpetsc.base.declarations import Key, KeyTable, Refused, plain
from ehlpetsc.base.errors import CaseError
from ehlpetsc.base.toml_file import Tables, is_plain
from ehlpetsc.base.units import UnitFault, converted
from ehlpetsc.case.messages import allowed, celsius, show, unknown
from ehlpetsc.case.tables import CASE, key_of

NUMBERS_ONLY = {"half-widths", "boundary films"}  # units that are no units of measurement
MAX_FLOAT = 1e308
KINDS = (
    " in a line contact or a strip, of one radius",
    " in a point contact, of two radii",
)  # after the allowed unit of a key

# exceptions of values that follow from unchecked tables: their faults are found by the check of the keys
FAULTY = (ArithmeticError, AttributeError, LookupError, TypeError, ValueError)


class Fault(NamedTuple):
    """A fault of the key at a place; a consequence disappears with the other faults."""

    place: str
    text: str
    is_consequence: bool = False


class _Wrong(Exception):
    """A value is not an allowed one."""


def is_number(value: object) -> TypeGuard[float]:
    """Whether a value is a finite number of TOML: an integer is one, true and false are not."""
    return isinstance(value, int | float) and not isinstance(value, bool) and -MAX_FLOAT < value < MAX_FLOAT


def in_si(data: Tables) -> list[Fault]:
    """Replace the texts with a unit in the tables of a case by numbers in SI units; returns the faults."""
    faults = []
    for holder, name, key, place in [*_entries(data, CASE, ""), *_series_entries(data.get("series"))]:
        if key and key.kind is float and key.unit not in NUMBERS_ONLY:
            try:
                holder[name] = converted(holder[name], in_contact(key, data).unit, key.is_difference)
            except UnitFault as fault:
                is_other = key.point_unit and str(fault).endswith(f"one of {in_contact(key, data).unit}")
                why = KINDS[is_point(data)] if is_other else ""
                faults.append(Fault(place, f"{place} = {fault}{why}"))
    return faults


def is_point(data: Tables) -> bool:
    """Whether the tables of a case describe a point contact, by a pair of radii."""
    contact = data.get("contact")
    return isinstance(contact, dict) and isinstance(contact.get("radius"), list | tuple)


def in_contact(key: Key, data: Tables) -> Key:
    """Key with its unit in the contact of the tables of a case."""
    return replace(key, unit=key.point_unit) if key.point_unit and is_point(data) else key


def _entries(data: Tables, table: KeyTable, where: str) -> Iterator[tuple[Any, Any, Key | None, str]]:
    """Values in tables: their table or list, their key in it, the key of the case, the place."""
    for name, key in table.keys.items():
        value = data.get(name)
        inner = _table_of(key, value)
        if inner and isinstance(value, dict):
            yield from _entries(value, inner, f"{where}{name}.")
        elif value is not None:
            yield data, name, key, where + name


def _series_entries(series: object) -> Iterator[tuple[Any, Any, Key | None, str]]:
    if not isinstance(series, dict) or not isinstance(values := series.get("values"), list):
        return
    if "key" in series:
        yield series, "values", key_of(series["key"]), "series.values"
    elif isinstance(keys := series.get("keys"), list):
        for number, name in enumerate(keys[: len(values)]):
            yield values, number, key_of(name), f"series.values.{number}"


def check(
    table: KeyTable, data: Tables, where: str = "", root: Tables | None = None, known: Collection[str] = ()
) -> tuple[Any, list[Fault]]:
    """Checked values of a table, None with faults, and its faults.

    `where`: dotted name of the table with a dot at its end, "" for the whole case. `root`: tables of the
    whole case, by default `data`. `known`: places of faults that have been found already.
    """
    root = data if root is None else root
    values: Tables = {}
    faults: list[Fault] = []
    for name, declared in table.keys.items():
        place, value, key = where + name, data.get(name), in_contact(declared, root)
        if place in known:
            faults.append(Fault(place, ""))
        elif value is None and not (key.table and key.table.always):
            faults += _missing(place, key, data, root)
            values[attribute(name)] = key.default
        else:
            given = {} if value is None else value
            values[attribute(name)], found = _checked(place, key, given, data, root, known)
            faults += found
    for name in data:
        if name not in table.keys:
            faults.append(Fault(f"{where}{name}", unknown(where, str(name), data[name], table.keys)))
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


def _missing(place: str, key: Key, data: Tables, root: Tables) -> list[Fault]:
    if not key.required:
        return []
    given = [name for name in key.replaced_by if (root.get(name[1:-1]) if name[0] == "[" else data.get(name))]
    text = f"{place} is missing" + (f", and does not follow from {given[0]}" if given else "")
    instead = "".join(f", or {name}" for name in key.replaced_by if not given)
    return [Fault(place, f"{text}; allowed: {allowed(key)}{instead}", bool(given))]


def _checked(
    place: str, key: Key, value: object, data: Tables, root: Tables, known: Collection[str]
) -> tuple[Any, list[Fault]]:
    """Value of a key and its faults."""
    inner = _table_of(key, value)
    if inner and isinstance(value, dict):
        unmet = [need for need in inner.needs if not _holds(need, root)]
        result, faults = check(inner, value, f"{place}.", root, known)
        needs = [Fault(place, f"{place}: needs {' and '.join(unmet)}")] if unmet else []
        return result, needs + faults
    try:
        result = _value(key, value)
        if key.below and is_number(limit := data.get(key.below)) and result >= limit:
            raise _Wrong
    except _Wrong:
        if isinstance(value, dict) and key.kind is not dict:
            return None, [Fault(place, f"{place}: a table here; allowed: {allowed(key)}")]
        hint = celsius(key, value)
        return None, [Fault(place, f"{place} = {show(value)}: allowed: {allowed(key)}{hint}")]
    unmet = [need for need in key.needs if result != key.default and not _holds(need, root)]
    of_need = f"{place} = {show(value)}: needs {' and '.join(unmet)} ({plain(key.text)})"
    return (None, [Fault(place, of_need)]) if unmet else (result, [])


def _table_of(key: Key, value: object) -> KeyTable | None:
    """Table of the value of a key; of several that of its kind."""
    if key.variants and isinstance(value, dict):
        kind = value.get("kind")
        return key.variants.get(kind) if isinstance(kind, str) else None
    return key.table


def _value(key: Key, value: object) -> Any:
    """Value with the type of the key."""
    if key.kind is dict:
        if key.table or key.variants or not isinstance(value, dict):
            raise _Wrong
        return dict(value)
    if key.many == "both" and not isinstance(value, list | tuple):
        value = [value, value]
    if not key.many or key.many == "axes" and not isinstance(value, list | tuple):
        return _item(key, value)
    if key.many == "list or matrix" and isinstance(value, list | tuple) and value:
        key = replace(key, many="list")
        if isinstance(value[0], list | tuple):
            rows = [_value(key, row) for row in value]
            if len(rows) < key.min_items or len(set(map(len, rows))) > 1:
                raise _Wrong
            return rows
    shortest, longest = (
        (2, 2) if key.many in ("both", "two", "axes") else (key.min_items, key.max_items or math.inf)
    )
    if not isinstance(value, list | tuple) or not shortest <= len(value) <= longest:
        raise _Wrong
    items = _numbers(key, value) if key.kind is float else [_item(key, item) for item in value]
    return items if key.many == "list" else tuple(items)


def _numbers(key: Key, values: list | tuple) -> list[float]:
    """Items of a list of numbers, of which a measured map has a million."""
    if not set(map(type, values)) <= {int, float}:
        return [_item(key, value) for value in values]
    extremes = (min(values), max(values)) if len(values) > 2 and all(map(math.isfinite, values)) else values
    for value in extremes:
        _item(key, value)
    return [float(value) for value in values]


def _item(key: Key, value: object) -> Any:
    if key.kind is object:
        return value
    if key.kind in (int, float):
        if not is_number(value) or key.kind is int and not isinstance(value, int):
            raise _Wrong
        bounds = ((ge, key.ge), (gt, key.gt), (le, key.le), (lt, key.lt))
        if not all(bound is None or holds(value, bound) for holds, bound in bounds):
            raise _Wrong
        return key.kind(value)
    if not isinstance(value, key.kind) or key.choices and value not in key.choices:
        raise _Wrong
    longest = key.max_items if key.max_items and not key.many else math.inf
    if isinstance(value, str) and not (is_plain(value) and 0 < len(value) <= longest):
        raise _Wrong
    return value


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
