"""Overrides of keys by --set, from Python and by series; the members of a series."""

from __future__ import annotations

import copy
import itertools
import tomllib
from typing import Any

from ehlpetsc.base.toml_file import Tables, plain


def parsed(override: object) -> tuple[list[str], Any]:
    """("a.b=value") or ("a.b", value) -> (["a", "b"], value); ValueError: not a setting of a key."""
    if isinstance(override, tuple) and len(override) == 2 and isinstance(override[0], str):
        return override[0].split("."), plain(override[1])
    if not isinstance(override, str):
        raise ValueError(override)
    name, equals, raw = override.partition("=")
    keys = name.strip().split(".")
    if not equals or not all(keys):
        raise ValueError(override)
    try:
        table = tomllib.loads(f"value = {raw}")
    except (ValueError, RecursionError):
        table = {}
    return keys, table["value"] if list(table) == ["value"] else raw


def put(tables: Tables, keys: list[str], value: object) -> None:
    """Set a key in nested tables, None removes it; ValueError: the parent of the key is not a table."""
    for key in keys[:-1]:
        tables = tables.setdefault(key, {})
        if not isinstance(tables, dict):
            raise ValueError(key)
    if value is None:
        tables.pop(keys[-1], None)
    else:
        tables[keys[-1]] = value


Settings = list[tuple[list[str], Any]]


def keys_of(series: Tables) -> list[str]:
    """Dotted keys that vary over a series, by its table `[series]`."""
    return [series["key"]] if "key" in series else list(series["keys"])


def combinations(series: Tables) -> list[tuple]:
    """Tuples of the values of the keys for each member: of one key, a grid of several, or in parallel."""
    if "key" in series:
        return [(value,) for value in series["values"]]
    if series.get("combine", "grid") == "step":
        return list(zip(*series["values"], strict=True))
    return list(itertools.product(*series["values"]))


def settings_of(series: Tables) -> list[Settings]:
    """Settings of each member: pairs of a split key and its value."""
    keys = [key.split(".") for key in keys_of(series)]
    return [list(zip(keys, values, strict=True)) for values in combinations(series)]


def member_tables(data: Tables, settings: Settings) -> Tables:
    """Tables of one member: tables of the case without `[series]`; ValueError: no such key."""
    member = copy.deepcopy(data)
    del member["series"]
    for keys, value in settings:
        put(member, keys, value)
    return member
