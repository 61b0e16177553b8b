"""Overrides of keys of a case, by --set, from Python and by series."""

from __future__ import annotations

import tomllib
from typing import Any

from ehlpetsc.toml_file import MAX_KEY_PARTS, plain


def parsed(override: object) -> tuple[list[str], Any]:
    """("a.b=value") or ("a.b", value) -> (["a", "b"], value); ValueError: not a setting of a key."""
    if isinstance(override, tuple) and len(override) == 2 and isinstance(override[0], str):
        return override[0].split("."), plain(override[1])
    if not isinstance(override, str):
        raise ValueError(override)
    name, equals, raw = override.partition("=")
    keys = name.strip().split(".")
    if not equals or not all(keys) or len(keys) > MAX_KEY_PARTS:
        raise ValueError(override)
    try:
        table = tomllib.loads(f"value = {raw}")
    except (ValueError, RecursionError):
        table = {}
    return keys, table["value"] if list(table) == ["value"] else raw


def put(tables: dict[str, Any], keys: list[str], value: Any) -> None:
    """Set a key in nested tables, None removes it; ValueError: the parent of the key is not a table."""
    for key in keys[:-1]:
        tables = tables.setdefault(key, {})
        if not isinstance(tables, dict):
            raise ValueError(key)
    if value is None:
        tables.pop(keys[-1], None)
    else:
        tables[keys[-1]] = value
