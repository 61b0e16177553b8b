"""Sentences about keys and values: allowed values, similar keys."""

from __future__ import annotations

import difflib
import json
from collections.abc import Iterable

from ehlpetsc.base.declarations import Key, plain

NAMES = {bool: "true or false", int: "a whole number", float: "a number", str: "text", dict: "a table"}
PLURALS = {int: "whole numbers", float: "numbers", str: "texts"}


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
    return f"{value_text(key)} ({plain(key.text)})"


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
