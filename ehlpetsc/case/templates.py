"""Cases to begin with: a roller, a gear pair, a case with every key in comments."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path

from ehlpetsc.case.key_page import tables
from ehlpetsc.case.messages import value_text
from ehlpetsc.command_parser import CommandParser, exit_status, put
from ehlpetsc.keys import Key

EXAMPLES = ("roller", "gears")  # files beside this one
LEFT_OUT = ("surface.2", "post", "series")  # in a full template


def template(kind: str = "roller") -> str:
    """Text of a case: "roller", "gears", or "full" with all other keys in comments."""
    example = Path(__file__).with_name(f"{kind if kind in EXAMPLES else EXAMPLES[0]}.toml").read_text()
    return example if kind in EXAMPLES else _full(tomllib.loads(example))


def _full(example: dict) -> str:
    lines = []
    for place, table in tables().items():
        if place.split(" ")[0] in LEFT_OUT or " (" in place:
            continue
        values = example.get(place, {}) if place else example
        if place:
            lines += ["", f"[{place}]" if values else f"# [{place}]"]
        for name, key in table.keys.items():
            if name in values and not isinstance(values[name], dict):
                lines.append(f"{name} = {json.dumps(values[name])}  # {_comment(key)}")
            elif not key.table and key.kind is not dict:
                shown = "..." if key.default is None else json.dumps(key.default)
                lines.append(f"# {name} = {shown}  # {_comment(key)}")
    return "\n".join(lines) + "\n"


def _comment(key: Key) -> str:
    return f"{key.text}; {value_text(key)}"


def main(words: list[str]) -> int:
    """Run the command ``ehlpetsc template``; returns its exit status."""
    parser = CommandParser("template", "A commented case file to begin with.")
    kinds = [*EXAMPLES, "full"]
    parser.add_argument("kind", nargs="?", choices=kinds, default="roller", help="full: with every key")
    chosen = parser.parse_args(words)
    return exit_status("template", lambda: put(template(chosen.kind), chosen))
