"""Parser and line of progress of the commands."""

from __future__ import annotations

import argparse
import contextlib
import os
import sys
import time as clock
from collections.abc import Callable
from pathlib import Path
from typing import NoReturn, TextIO

from ehlpetsc.base.environment import first_rank
from ehlpetsc.base.errors import (
    CaseError,
    ExitStatus,
    NotConverged,
    OutputError,
    PostError,
    Stopped,
    UsageError,
    not_written,
)
from ehlpetsc.base.version import __version__

OF_SET = "key of the case, left out if VALUE is empty; may be repeated"


class CommandParser(argparse.ArgumentParser):
    """Parser of ``ehlpetsc NAME``; errors are one line, exit status 2.

    It has those of ``-o`` and ``--set`` that `options` names, which a command may define anew with a help of
    its own, and ``--overwrite``, also where pictures and tables are replaced without it.
    """

    def __init__(self, name: str, description: str, options: str = "output set overwrite") -> None:
        keeps = "\n" in description
        formatter = argparse.RawDescriptionHelpFormatter if keeps else argparse.HelpFormatter
        super().__init__(
            prog=f"ehlpetsc {name}",
            description=description.replace("``", ""),
            formatter_class=formatter,
            conflict_handler="resolve",
        )
        if "output" in options:
            self.add_argument("-o", "--output", type=Path, metavar="FILE", help="text file [standard output]")
        if "set" in options:
            self.add_argument("--set", action="append", default=[], metavar="TABLE.KEY=VALUE", help=OF_SET)
        overwrites = "replace an existing file" if "overwrite" in options else argparse.SUPPRESS
        self.add_argument("--overwrite", action="store_true", help=overwrites)
        self.add_argument("--version", action="version", version=f"ehlpetsc {__version__}")

    def error(self, message: str) -> NoReturn:
        """End the command with the fault and a hint to the list of options."""
        self.exit(2, f"{self.prog}: {message}; {self.prog} -h lists the options\n" if first_rank() else None)


def number(least: float, most: float) -> Callable[[str], float]:
    """Type of an option: a number between bounds."""

    def converted(text: str) -> float:
        with contextlib.suppress(ValueError):
            if least <= float(text) <= most:
                return float(text)
        raise argparse.ArgumentTypeError(f"{text}: allowed: a number >= {least:g} and <= {most:g}")

    return converted


def exit_status(
    name: str,
    action: Callable[[], int | None],
    faults: tuple[type[Exception], ...] = (),
    output: Path | str | None = None,
) -> int:
    """Exit status of a command; the message of a failure goes to standard error.

    `name`: name of the command, as ``plot``. `action`: the command, which returns the status; None: done.
    `faults`: further exceptions that mean bad input. `output`: output file, for errors of writing without a
    file name.
    """
    name, faults = f"ehlpetsc {name}", (OutputError, PostError, UsageError, *faults)
    try:
        status = action()
    except Stopped:
        print(f"{name}: stopped; the same command continues")
        return ExitStatus.STOPPED
    except NotConverged as error:
        print(f"{name}: not converged: {error}", file=sys.stderr)
        return ExitStatus.NOT_CONVERGED
    except CaseError as error:
        print("\n".join(error.faults), file=sys.stderr)
    except BrokenPipeError:
        raise
    except OSError as error:
        text = not_written(error, error.filename or output) if error.errno else str(error)  # HDF5 has none
        print(f"{name}: {text}", file=sys.stderr)
    except faults as error:
        if first_rank() or not isinstance(error, UsageError):  # which all ranks have
            print(f"{name}: {error}", file=sys.stderr)
        return getattr(error, "status", ExitStatus.BAD_INPUT)
    else:
        return ExitStatus.DONE if status is None else status
    return ExitStatus.BAD_INPUT


SECONDS_IN_PLACE = 0.2  # between two updates of a line
MIN_SECONDS = 1.0  # before a remaining time is shown
LINE_WIDTH = 70
ERASE = "\r" + " " * LINE_WIDTH + "\r"


def on_terminal(stream: TextIO) -> bool:
    """Whether output is shown on a terminal; under mpirun, which hides it, run_mpi.sh has looked."""
    if "OMPI_COMM_WORLD_RANK" in os.environ:
        return os.environ.get("EHLPETSC_TERMINAL") == "1"
    return stream.isatty() and os.environ.get("TERM") != "dumb"


def in_notebook() -> bool:
    """Whether output is shown in a notebook."""
    shell = sys.modules["IPython"].get_ipython() if "IPython" in sys.modules else None
    return type(shell).__name__ == "ZMQInteractiveShell"


class ProgressLine:
    """Line that is written over itself on a terminal, and nowhere else.

    `total`: work in any unit.
    """

    def __init__(self, label: str, total: float, stream: TextIO | None = None) -> None:
        self._label, self._total, self._stream = label, total, stream or sys.stdout
        self._is_shown = on_terminal(self._stream)
        self._begun, self._shown, self.done = clock.monotonic(), 0.0, 0.0

    def add(self, work: float) -> None:
        """Add work done."""
        self.reach(self.done + work)

    def reach(self, done: float) -> None:
        """Set the work done, and show it if the line is due."""
        self.done, now = done, clock.monotonic()
        if not self._is_shown or now - self._shown < SECONDS_IN_PLACE:
            return
        share, spent = min(self.done / max(self._total, 1e-300), 1.0), now - self._begun
        is_known = spent > MIN_SECONDS and share > 0.0
        remaining = duration(spent * (1.0 - share) / share) if is_known else "?"
        text = f"{self._label}: {100.0 * share:.0f} %, {remaining} remaining"
        print(f"\r{text:{LINE_WIDTH}s}", end="", file=self._stream, flush=True)
        self._shown = now

    def clear(self) -> None:
        """Remove the line, before other output and at the end."""
        if self._shown:
            print(ERASE, end="", file=self._stream, flush=True)
            self._shown = 0.0


def duration(seconds: float) -> str:
    """Duration as text: ``45s``, ``12m05s``, ``3h20m``, ``2d04h``."""
    s = round(seconds)
    if s < 60:
        return f"{s}s"
    if s < 3600:
        return f"{s // 60}m{s % 60:02d}s"
    if s < 86400:
        return f"{s // 3600}h{s % 3600 // 60:02d}m"
    return f"{s // 86400}d{s % 86400 // 3600:02d}h"
