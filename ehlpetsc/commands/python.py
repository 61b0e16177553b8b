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
INTERRUPTED = 130  # exit status of a script after Ctrl-C, as shells have it
FAULTS = (CaseError, NotConverged, OutputError, PostError, UsageError)


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
    """Run a script as Python does; Ctrl-C and faults of the user's input are messages without a traceback."""
    before = os.environ.get("PYTHONPATH")
    os.environ["PYTHONPATH"] = os.pathsep.join([str(PACKAGE), *([before] if before else [])])
    sys.path[:1] = [str(Path(script).resolve().parent), str(PACKAGE)]
    sys.argv[:] = [script, *arguments]
    try:
        runpy.run_path(script, run_name="__main__")
    except KeyboardInterrupt as stop:
        return _end(script, str(stop) or "stopped; files written before are complete", INTERRUPTED)
    except FAULTS as fault:
        not_converged = isinstance(fault, NotConverged)
        kind = ExitStatus.NOT_CONVERGED if not_converged else getattr(fault, "status", ExitStatus.BAD_INPUT)
        return _end(script, f"not converged: {fault}" if not_converged else str(fault), kind)
    return ExitStatus.DONE


def _end(script: str, message: str, status: int) -> int:
    if first_rank():
        print(f"{script}: {message}", file=sys.stderr, flush=True)
    return status
