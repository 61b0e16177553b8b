"""The command ``ehlpetsc python SCRIPT.py ...``: a script with the Python and the packages of the program."""

from __future__ import annotations

import argparse
import os
import sys
from pathlib import Path

from ehlpetsc.base.command_line import CommandParser, exit_status
from ehlpetsc.base.errors import UsageError

PACKAGE = Path(__file__).parents[2]  # folder from which `import ehlpetsc` is


def main(words: list[str]) -> int:
    """Replace this process by Python with the script; returns the exit status where there is none."""
    parser = CommandParser("python", "Run a script in which import ehlpetsc works.", "")
    parser.add_argument("script", metavar="SCRIPT.py")
    parser.add_argument("arguments", nargs=argparse.REMAINDER, help="of the script")
    chosen = parser.parse_args(words)
    return exit_status("python", lambda: _replace(chosen.script, chosen.arguments))


def _replace(script: str, arguments: list[str]) -> None:
    """Run a script in place of this process; raise `UsageError` without one."""
    if not Path(script).is_file():
        raise UsageError(f"{script}: no such file; allowed: a Python script")
    before = os.environ.get("PYTHONPATH")
    os.environ["PYTHONPATH"] = os.pathsep.join([str(PACKAGE), *([before] if before else [])])
    os.execv(sys.executable, [sys.executable, script, *arguments])
