"""Text of every key of a case file, from the table of keys; cases to begin with."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

from ehlpetsc.base.declarations import Key, KeyTable, without_backticks
from ehlpetsc.base.errors import UsageError
from ehlpetsc.case.tables import CASE
from ehlpetsc.case.values import nearest, value_text

EXAMPLES = ("line", "roller", "gears", "point", "strip")  # files beside this one


def tables() -> dict[str, KeyTable]:
    """Tables of a case file by name, "" for the keys at the top, in the order of the file."""
    return {"": CASE} | dict(_below(CASE, ""))


def _below(table: KeyTable, above: str) -> Iterator[tuple[str, KeyTable]]:
    for name, key in table.keys.items():
        if key.table:
            if own_keys(key.table):
                yield above + name, key.table
            yield from _below(key.table, f"{above}{name}.")
        variants = key.variants or {}
        for variant in {id(one): one for one in variants.values()}.values():
            kinds = [kind for kind, one in variants.items() if one is variant]
            yield f"{above}{name} ({', '.join(kinds)})", variant


def own_keys(table: KeyTable) -> dict[str, Key]:
    """Keys of a table that are no tables."""
    return {name: key for name, key in table.keys.items() if not key.table}


def value_of(key: Key) -> str:
    """Allowed values of a key, and its needs."""
    return f"{value_text(key)}; needs {' and '.join(key.needs)}" if key.needs else value_text(key)


def default_of(key: Key) -> str:
    """Default of a key, or "required"."""
    if key.required:
        return "required" + (f" without {' or '.join(key.replaced_by)}" if key.replaced_by else "")
    return "" if key.default is None else json.dumps(key.default)


def keys(name: str | None = None) -> str:
    """Keys with meaning, allowed values and default, a line each, followed by the equation of the key.

    `name` is a table, as "fluid", "surface.1" or "grade", or a key or its symbol, as "asperity_height" or
    "alpha".
    """
    every, lines = tables(), []
    for place, table in every.items():
        if name is None or _is_of(place, name):
            same = place.replace("surface.2", "surface.1") if name is None else place
            lines += [f"[{place}]" if place else "top-level keys"]
            lines += [f"  as [{same}]"] if same != place else _lines("  ", own_keys(table))
        elif not place.startswith("surface.2") or name.startswith("surface.2"):
            found = {f"{place}.{key}".lstrip("."): table.keys[key] for key in own_keys(table)}
            chosen = [
                key for key in found if f".{key}".endswith(f".{name}") or f"`{name}`" in found[key].text
            ]
            lines += _lines("", {key: found[key] for key in chosen})
    if lines:
        return "\n".join(lines)
    above, _, last = name.rpartition(".")
    known = every[above].keys if above in every and above else {k for t in every.values() for k in t.keys}
    places = ", ".join(place for place in every if place and " " not in place)
    raise UsageError(f"{name}: no such table or key; {nearest(last, sorted(known)) or f'tables: {places}'}")


def _is_of(place: str, name: str) -> bool:
    """Whether a table is the one of a name or within it; of both surfaces the first, unless named in full."""
    path = place.partition(" (")[0]
    ends_with_it = path.endswith(f".{name}") and not path.startswith("surface.2")
    return ends_with_it or f"{path}.".startswith(f"{name}.")


def _lines(indent: str, chosen: dict[str, Key]) -> list[str]:
    lines = []
    for name, key in chosen.items():
        default = default_of(key)
        parts = [
            without_backticks(key.text),
            value_of(key),
            default if key.required or not default else f"default {default}",
        ]
        lines.append(f"{indent}{name}: {'; '.join(filter(None, parts))}")
        if key.equation:
            lines.append(f"{indent}    {without_backticks(key.equation)}")
    return lines


def template(kind: str = EXAMPLES[0]) -> str:
    """Text of a case to begin with."""
    return Path(__file__).with_name(f"{kind}.toml").read_text()
