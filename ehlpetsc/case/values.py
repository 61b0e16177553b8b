"""Value of a single key: its type, bounds and choices."""

from __future__ import annotations

import math
from dataclasses import replace
from operator import ge, gt, le, lt
from typing import Any, TypeGuard

from ehlpetsc.base.declarations import Key
from ehlpetsc.base.toml_file import is_plain

MAX_FLOAT = 1e308


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
