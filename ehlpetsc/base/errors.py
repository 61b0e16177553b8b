"""Exceptions of the package, exit statuses of its commands, and the message of a failed write.

The message of an error that a user can correct states the fault, its place, and allowed values or a cure.
"""

from __future__ import annotations

import errno
import os
from enum import IntEnum
from pathlib import Path
from typing import TypeGuard


class ExitStatus(IntEnum):
    """Exit status of a command."""

    DONE = 0
    BUG = 1
    BAD_INPUT = 2
    NOT_CONVERGED = 3
    STOPPED = 4
    OUTPUT_LOST = 5

    @property
    def words(self) -> str:
        """Status as text in summaries, result files and indices of series: ``not converged``."""
        return self.name.lower().replace("_", " ")


OF_FULL_DISKS = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO)


def is_of_standard_output(error: BaseException) -> TypeGuard[OSError]:
    """Whether an error is that of a print to a full disk, which has no name of a file."""
    return isinstance(error, OSError) and error.errno in OF_FULL_DISKS and error.filename is None


def not_written(error: Exception, path: str | os.PathLike | None = None) -> str:
    """Message of a failed write: the file, by default that of the error if any, and the system's reason."""
    path, number = path or getattr(error, "filename", None), getattr(error, "errno", None)
    if path is None and is_of_standard_output(error):
        path = "standard output"
    reason = os.strerror(number) if number else str(error)
    if number == errno.ENOENT and path and not (folder := Path(path).parent).exists():
        reason += f": create the folder {folder} first"
    return f"{path}: not written, {reason}" if path else str(error)


class CaseError(Exception):
    """The case cannot be run; `faults` are all faults, one message each."""

    def __init__(self, faults: list[str]) -> None:
        super().__init__(list(faults))
        self.faults: list[str] = self.args[0]

    def __str__(self) -> str:
        return "\n".join(self.faults)


class ProfileError(Exception):
    """A profile or a table of conditions cannot be used; the message names the reason and the cure."""


class UsageError(Exception):
    """The command line is not valid; the message names the allowed values."""


class OutputError(Exception):
    """A result or restart file cannot be read or written; the message states the reason."""

    status = ExitStatus.BAD_INPUT


class OutputLost(OutputError):
    """A result file was deleted or replaced while it was being written."""

    status = ExitStatus.OUTPUT_LOST


class PostError(Exception):
    """A result cannot be post-processed; the message states the reason."""


class SolveFailed(Exception):
    """A solve of the discrete equations failed: by SNES, Gauss-Seidel, or the check of the solution."""

    def __init__(self, method: str, reason: str, iterations: int) -> None:
        super().__init__(f"{method} {reason} after {iterations} iterations")
        self.method, self.reason, self.iterations = method, reason, iterations

    def after(self, iterations: int) -> SolveFailed:
        """The same failure with the iterations of a previous attempt added."""
        return SolveFailed(self.method, self.reason, self.iterations + iterations)


class Stopped(Exception):
    """The run was stopped before it had a state to continue from."""


class NoSteadyStart(Exception):
    """No steady solution was found; the message states the reason."""


class NotConverged(Exception):
    """A time step or steady start did not converge; the message states step, time, reason and a cure.

    `state` is the last accepted state, a `run.simulation.AcceptedState`; None if there is none.
    """

    def __init__(self, message: str, state: object | None = None) -> None:
        super().__init__(message)
        self.state = state
