"""Stop on request: a signal or the time limit ends a run after the current step."""

from __future__ import annotations

import contextlib
import math
import signal
import sys
import threading
import time as clock
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mpi4py import MPI

SIGNALS = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGUSR1)
GRACE_TIME = 0.4  # s for the current step: mpirun kills one second after it has forwarded a signal


class Interrupted(BaseException):
    """Signal to stop before the run; unlike KeyboardInterrupt, an import does not end the process by it."""


class EarlyStop:
    """Handler of signals before :class:`StopRequest` is installed; raises `Interrupted`.

    The exception is lost inside a callback of numba's compiler; the next handler of signals then reads
    `is_requested`.
    """

    def __init__(self) -> None:
        self.is_requested = False
        previous_hook = sys.unraisablehook
        sys.unraisablehook = lambda lost: (
            None if isinstance(lost.exc_value, Interrupted) else previous_hook(lost)
        )
        _handle(self, SIGNALS)

    def __call__(self, *_: Any) -> None:
        self.is_requested = True
        raise Interrupted


class StopRequest:
    """Stop request of a run: a signal on any rank, or the time limit; 0 minutes: no limit.

    Ignored signals, as SIGHUP under nohup, remain ignored.
    """

    def __init__(self, minutes: float = 0.0, signals: tuple[signal.Signals, ...] = SIGNALS) -> None:
        self.until = clock.monotonic() + 60.0 * minutes if minutes else math.inf
        self._before = _handle(self._request, signals)
        if any(getattr(handler, "is_requested", False) for handler in self._before.values()):
            self._request()

    @classmethod
    @contextlib.contextmanager
    def on_interrupt(cls) -> Iterator[StopRequest]:
        """Stop request by Ctrl-C within a context; other threads than the main one get no signals."""
        is_main = threading.current_thread() is threading.main_thread()
        stop = cls(signals=(signal.SIGINT,) if is_main else ())
        try:
            yield stop
        finally:
            for name, handler in stop._before.items():
                signal.signal(name, handler)

    def _request(self, *_: Any) -> None:
        self.until = min(self.until, clock.monotonic())

    def __call__(self, comm: MPI.Comm) -> bool:
        """Whether to stop; equal on every rank of the communicator."""
        return comm.allreduce(int(clock.monotonic() >= self.until)) > 0

    def overdue(self, comm: MPI.Comm) -> bool:
        """Whether the grace time of the current step is over; equal on every rank of the communicator."""
        return comm.allreduce(int(clock.monotonic() >= self.until + GRACE_TIME)) > 0


def _handle(handler: Callable, signals: tuple[signal.Signals, ...]) -> dict[signal.Signals, Any]:
    """Install a handler of the signals that are not ignored; returns the previous handlers."""
    before = {name: signal.getsignal(name) for name in signals}
    before = {name: previous for name, previous in before.items() if previous not in (signal.SIG_IGN, None)}
    for name in before:
        signal.signal(name, handler)
    return before
