"""The command ``ehlpetsc python SCRIPT.py ...``: a script with the Python and the packages of the program."""

from __future__ import annotations

import argparse
import os
import runpy
import sys
from pathlib import Path

from ehlpetsc.base.command_line import CommandParser, exit_status
from ehlpetsc.base.environment import first_rank
from ehlpetsc.base.errors import CaseError, ExitStatus, NotConverged, OutputError, PostError, UsageError

PACKAGE = Path(__file__).parents[2]  # folder from which `import ehlpetsc` is


def main(words: list[str]) -> int:
    """Run the script in this process; returns its exit status."""
    parser = CommandParser("python", "Run a script in which import ehlpetsc works.", "")
    parser.add_argument("script", metavar="SCRIPT.py")
    parser.add_argument("arguments", nargs=argparse.REMAINDER, help="of the script")
    chosen = parser.parse_args(words)
    return exit_status("python", lambda: _check(chosen.script)) or _run(chosen.script, chosen.arguments)


def _check(script: str) -> None:
    if not Path(script).is_file():
        raise UsageError(f"{script}: no such file; allowed: a Python script")


def _run(script: str, arguments: list[str]) -> int:
    """Run a script as Python does; faults of the user's input are messages without a traceback."""
    before = os.environ.get("PYTHONPATH")
    os.environ["PYTHONPATH"] = os.pathsep.join([str(PACKAGE), *([before] if before else [])])
    sys.path[:1] = [str(Path(script).resolve().parent), str(PACKAGE)]
    sys.argv[:] = [script, *arguments]
    try:
        runpy.run_path(script, run_name="__main__")
    except NotConverged as fault:
        return _end(f"{script}: not converged: {fault}", ExitStatus.NOT_CONVERGED)
    except (CaseError, OutputError, PostError, UsageError) as fault:
        return _end(f"{script}: {fault}", getattr(fault, "status", ExitStatus.BAD_INPUT))
    return ExitStatus.DONE


def _end(message: str, status: int) -> int:
    if first_rank():
        print(message, file=sys.stderr, flush=True)
    return status
