"""Common parser, text output and exit status of all commands except the run."""

import argparse
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NoReturn

from ehlpetsc import __version__
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
            key = "key of the case; may be repeated"
            self.add_argument("--set", action="append", default=[], metavar="TABLE.KEY=VALUE", help=key)
        overwrites = "replace an existing file" if "overwrite" in options else argparse.SUPPRESS
        self.add_argument("--overwrite", action="store_true", help=overwrites)
        self.add_argument("--version", action="version", version=f"ehlpetsc {__version__}")

    def error(self, message: str) -> NoReturn:
        """End the command with the fault and a hint to the list of options."""
        self.exit(2, f"{self.prog}: {message}; {self.prog} -h lists the options\n" if first_rank() else None)


def put(text: str, chosen: argparse.Namespace) -> None:
    """Print a text on the first rank, or write it to the file of ``-o``."""
    if not first_rank():
        return
    if chosen.output is None:
        print(text, end="" if text.endswith("\n") else "\n")
        return
    try:
        with open(chosen.output, "w" if chosen.overwrite else "x") as file:
            file.write(text)
        print(chosen.output)
    except FileExistsError:
        raise OutputError(f"{chosen.output}: exists; give another -o, or --overwrite to replace it") from None


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
        print(f"{name}: {error}", file=sys.stderr)
    else:
        return ExitStatus.DONE if status is None else status
    return ExitStatus.BAD_INPUT
