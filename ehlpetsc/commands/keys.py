"""The commands ``ehlpetsc keys`` and ``ehlpetsc template``."""

from __future__ import annotations

from ehlpetsc.base.command_line import CommandParser, exit_status
from ehlpetsc.case.keys import EXAMPLES, keys
from ehlpetsc.case.keys import template as example
from ehlpetsc.results.output_guard import put


def main(words: list[str]) -> int:
    """Run the command ``ehlpetsc keys``; returns its exit status."""
    parser = CommandParser("keys", "Keys of a case file: meaning, unit, bounds, default.", "output overwrite")
    parser.add_argument(
        "key", nargs="?", metavar="TABLE or KEY", help="as fluid, contact.load or alpha (default: all)"
    )
    chosen = parser.parse_args(words)
    return exit_status("keys", lambda: put(keys(chosen.key), chosen))


def template(words: list[str]) -> int:
    """Run the command ``ehlpetsc template``; returns its exit status."""
    parser = CommandParser("template", "A commented case file to begin with.", "output overwrite")
    parser.add_argument("kind", nargs="?", choices=EXAMPLES, default=EXAMPLES[0])
    chosen = parser.parse_args(words)
    return exit_status("template", lambda: put(example(chosen.kind), chosen))
