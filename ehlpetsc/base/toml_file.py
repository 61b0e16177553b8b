"""Case files: reading as text, parsing as TOML with messages on faults, writing; overrides, series."""

from __future__ import annotations

import codecs
import difflib
import itertools
import json
import os
import re
import tomllib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ehlpetsc.base.errors import CaseError

MAX_BYTES = 2**26  # of a case file

Tables = dict[str, Any]
"""Tables of a TOML file."""


def read_text(path: str | os.PathLike) -> str:
    """Text of a case file; raises `CaseError`."""
    if not is_plain(os.fspath(path)):  # messages and result files have it in one line
        raise CaseError([f"{ascii(os.fspath(path))}: allowed: a name without line breaks; rename the file"])
    try:
        with open(path, "rb") as file:  # a device has no size and no end
            content = file.read(MAX_BYTES + 1)
        if len(content) > MAX_BYTES:
            raise CaseError([f"{path}: larger than {MAX_BYTES >> 20} MB; allowed: a TOML file of a case"])
        if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)) or b"\0" in content[:2]:
            raise CaseError([f"{path}: UTF-16 text; allowed: UTF-8, to be chosen where the editor saves it"])
        return content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise CaseError([f"{path}: not UTF-8 text (byte {error.start}); allowed: a TOML file"]) from None
    except (OSError, ValueError) as error:
        if isinstance(error, IsADirectoryError):
            raise CaseError([f"{path}: a folder; allowed: a TOML file of a case"]) from None
        reason = getattr(error, "strerror", None) or str(error)
        meant = similar_file(path, "*.toml") if isinstance(error, FileNotFoundError) else ""
        raise CaseError([f"{path}: cannot be read: {reason}{meant}"]) from None


def similar_file(path: str | os.PathLike, pattern: str = "*") -> str:
    """Hint to the file of the same folder with the most similar name, "" without one."""
    known = [file.name for file in Path(path).parent.glob(pattern) if file.is_file()]
    close = difflib.get_close_matches(Path(path).name, known, n=1)
    return f"; did you mean {Path(path).with_name(close[0])}?" if close else ""


def parse_toml(path: str | os.PathLike, text: str) -> Tables:
    """Tables of a TOML text, whose name in messages is `path`; raises `CaseError`."""
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # some errors of number conversions pass tomllib
        raise CaseError([f"{path}: not valid TOML: {error}{_hint(text, str(error))}"]) from None


def _hint(text: str, message: str) -> str:
    """Hint to the cause of a fault of TOML in its line, "" to none."""
    at, lines = re.search(r"at line (\d+)", message), text.splitlines()
    line = (lines[int(at[1]) - 1] if at and int(at[1]) <= len(lines) else "").partition("#")[0].strip()
    number = re.search(r"=\s*([+-]?\d+,\d+)|([+-]?0,0\d+)", line)  # or a list [1,2]
    if number:
        found = number[1] or number[2]
        return f'; "{found}" is written {found.replace(",", ".")}'
    if "overwrite" in message:
        return f"; {line!r}: the table has this key already"
    word = re.fullmatch(r"[\w.-]+\s*=\s*(\w*)", line)
    return f"; {line!r}: {'text needs quotation marks' if word[1] else 'a value is missing'}" if word else ""


def is_plain(text: str) -> bool:
    """Whether a text is one line of UTF-8 without control characters, as HDF5 and PETSc need."""
    return text.isprintable() or not re.search(r"[\x00-\x1f\x7f\ud800-\udfff]", text)


def plain(value: object) -> Any:
    """Dicts, arrays and numpy numbers converted to types of TOML; without None."""
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items() if item is not None}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    return value.tolist() if hasattr(value, "tolist") else value


def copied(tables: Tables) -> Tables:
    """Copy of tables with their tables and lists; rows of maps, lists within lists, are shared."""

    def of(value: object) -> Any:
        if isinstance(value, list):
            return [copied(item) if isinstance(item, dict) else item for item in value]
        return copied(value) if isinstance(value, dict) else value

    return {name: of(value) for name, value in tables.items()}


def toml_text(tables: dict[str, object]) -> str:
    """TOML text of plain tables, with a heading for each table of the first level."""
    lines = [f"{_key(k)} = {_value(v)}" for k, v in tables.items() if not isinstance(v, dict)]
    for name, table in tables.items():
        if isinstance(table, dict):
            lines += ["", f"[{_key(name)}]", *(f"{_key(k)} = {_value(v)}" for k, v in table.items())]
    return "\n".join(lines) + "\n"


def _key(name: str) -> str:
    return name if re.fullmatch(r"[A-Za-z0-9_-]+", name) else json.dumps(name, ensure_ascii=False)


def _value(value: object) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{_key(k)} = {_value(v)}" for k, v in value.items()) + " }"
    if isinstance(value, float):
        return float.__repr__(value)  # nan and inf too are numbers of TOML
    if isinstance(value, list):
        return "[" + ", ".join(map(_value, value)) + "]"
    return json.dumps(value, ensure_ascii=False)


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


def with_key(tables: Tables, keys: Sequence[str], value: object) -> Tables:
    """Nested tables with a key set, without it for None; ValueError: the parent of the key is not a table."""
    key, *below = keys
    if value is None and key not in tables:
        return tables
    if below:
        inner = tables.get(key, {})
        if not isinstance(inner, dict):
            raise ValueError(key)
        return tables | {key: with_key(inner, below, value)}
    if value is None:
        return {name: one for name, one in tables.items() if name != key}
    return tables | {key: value}


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
    member = with_key(data, ["series"], None)
    for keys, value in settings:
        member = with_key(member, keys, value)
    return member
