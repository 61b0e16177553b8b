"""TOML text of a case of dicts and arrays."""

import json
import re


def plain(value):
    """Dicts, arrays and numpy numbers converted to types of TOML; without None."""
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items() if item is not None}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    return value.tolist() if hasattr(value, "tolist") else value


def toml_text(tables):
    """TOML text of plain tables, with a heading for each table of the first level."""
    simple = [f"{_key(k)} = {_value(v)}\n" for k, v in tables.items() if not isinstance(v, dict)]
    headed = [(k, v) for k, v in tables.items() if isinstance(v, dict)]
    sections = ["".join(f"{_key(k)} = {_value(v)}\n" for k, v in table.items()) for _, table in headed]
    headed_tables = [f"\n[{_key(name)}]\n{text}" for (name, _), text in zip(headed, sections, strict=True)]
    return "".join(simple + headed_tables)


def _key(name):
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else json.dumps(name, ensure_ascii=False)


def _value(value):
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{_key(k)} = {_value(v)}" for k, v in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(_value, value)) + "]"
    return json.dumps(value, ensure_ascii=False)
