"""Value of a single key: its type, bounds and choices, and sentences about them."""

from __future__ import annotations

import difflib
import json
import math
from collections.abc import Iterable
from dataclasses import replace
from operator import ge, gt, le, lt
from typing import Any, TypeGuard

from ehlpetsc.base.declarations import Key, without_backticks
from ehlpetsc.base.toml_file import is_plain

MAX_FLOAT = 1e308
NAMES = {bool: "true or false", int: "a whole number", float: "a number", str: "text", dict: "a table"}
PLURALS = {int: "whole numbers", float: "numbers", str: "texts", dict: "tables"}


class NotAllowed(Exception):
    """A value is not an allowed one."""


def is_number(value: object) -> TypeGuard[float]:
    """Whether a value is a finite number of TOML: an integer is one, true and false are not."""
    return isinstance(value, int | float) and not isinstance(value, bool) and -MAX_FLOAT < value < MAX_FLOAT


def value_of(key: Key, value: object) -> Any:
    """Value with the type of the key; raises `NotAllowed`."""
    if key.kind is dict:
        if key.table or key.variants or not isinstance(value, dict):
            raise NotAllowed
        return dict(value)
    if key.many == "both" and not isinstance(value, list | tuple):
        value = [value, value]
    if not key.many or key.many == "axes" and not isinstance(value, list | tuple):
        return _item(key, value)
    if key.many == "list or matrix" and isinstance(value, list | tuple) and value:
        key = replace(key, many="list")
        if isinstance(value[0], list | tuple):
            rows = [value_of(key, row) for row in value]
            if len(rows) < key.min_items or len(set(map(len, rows))) > 1:
                raise NotAllowed
            return rows
    shortest, longest = (
        (2, 2) if key.many in ("both", "two", "axes") else (key.min_items, key.max_items or math.inf)
    )
    if not isinstance(value, list | tuple) or not shortest <= len(value) <= longest:
        raise NotAllowed
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
            raise NotAllowed
        bounds = ((ge, key.ge), (gt, key.gt), (le, key.le), (lt, key.lt))
        if not all(bound is None or holds(value, bound) for holds, bound in bounds):
            raise NotAllowed
        return key.kind(value)
    if key.kind is bool and is_word(key, value):
        return value
    if not isinstance(value, key.kind) or key.choices and value not in key.choices:
        raise NotAllowed
    longest = key.max_items if key.max_items and not key.many else math.inf
    if isinstance(value, str) and not (is_plain(value) and 0 < len(value) <= longest):
        raise NotAllowed
    return value


def is_word(key: Key, value: object) -> bool:
    """Whether a text stands for a value of the key that follows from other tables."""
    return isinstance(value, str) and value in key.words


def is_allowed(key: Key, value: object) -> bool:
    """Whether the key allows a value by itself, without the keys that it needs."""
    try:
        value_of(key, value)
    except NotAllowed:
        return False
    return True


def value_text(key: Key) -> str:
    """Type, choices, bounds and unit of a key: ``a number >= 1e-09 and <= 100 [m]``."""
    text = _kind(key)
    bounds = ((">", key.gt), (">=", key.ge), ("<", key.lt), ("<=", key.le))
    text += " and".join(f" {sign} {bound:g}" for sign, bound in bounds if bound is not None)
    if key.below:
        text += f", below {key.below}"
    return f"{text} [{key.unit}]" if key.unit else text


def _kind(key: Key) -> str:
    if key.choices:
        choices = ", ".join(f'"{choice}"' for choice in key.choices)
        if key.many == "list":
            return f"a list of {choices}"
        return f"one of {choices}" + (", or a list of two of them" if key.many == "both" else "")
    plural = PLURALS.get(key.kind)
    if key.many in ("both", "axes"):
        return f"{NAMES[key.kind]} or a list of two {plural}"
    if key.many:
        return f"a list{' of two' if key.many == 'two' else ' of' if plural else ''} {plural or ''}".strip()
    words = "".join(f' or "{word}"' for word in key.words if key.kind is bool)
    return f"{NAMES[key.kind]}{words}"


def allowed(key: Key) -> str:
    """Allowed values of a key with its meaning, for messages."""
    return f"{value_text(key)} ({without_backticks(key.text)})"


def celsius(key: Key, value: object) -> str:
    """Hint to degrees Celsius where a number would be allowed as such; "" otherwise."""
    if key.unit != "K" or key.is_difference or not isinstance(value, int | float) or not abs(value) < 1e4:
        return ""
    return f'; "{value:g} degC"?' if key.ge <= value + 273.15 <= key.le else ""


def show(value: object) -> str:
    """Value as in the case file, shortened."""
    try:
        text = json.dumps(value, ensure_ascii=False, default=str)
    except (ValueError, RecursionError):  # integers of thousands of digits, tables in tables without end
        text = "a value too large to print"
    text = "nan" if text == "NaN" else text
    return shortened(text.encode(errors="backslashreplace").decode())


def shortened(text: str) -> str:
    """Text shortened to 60 characters."""
    return text if len(text) <= 60 else text[:57] + "..."


def unknown(where: str, name: str, value: object, names: Iterable[str]) -> str:
    """Fault of a key that does not exist, with a hint to another one."""
    place = where + shortened(name)
    hint = nearest(name, names) or f"allowed: {', '.join(names)}"
    if isinstance(value, dict):
        return f"[{place}]: unknown table; {hint}"
    return f"{place} = {show(value)}: unknown key; {hint}"


def nearest(name: str, names: Iterable[str]) -> str:
    """Hint to the most similar name, "" without one."""
    return "".join(f'did you mean "{close}"?' for close in similar(name, names))


def similar(name: str, names: Iterable[str]) -> list[str]:
    """The most similar name in a list, an empty list without one."""
    return difflib.get_close_matches(shortened(name), list(names), n=1)
