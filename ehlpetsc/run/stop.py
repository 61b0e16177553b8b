"""Deadlines of a run: a signal or the time limit ends it after the current step, restart files are due."""

from __future__ import annotations

import contextlib
import math
import signal
import threading
import time as clock
from collections.abc import Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mpi4py import MPI

SIGNALS = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGUSR1)
GRACE_TIME = 0.4  # s for the current step: mpirun kills one second after it has forwarded a signal


class Deadline:
    """Wall clock time so many minutes from now on; 0: never."""

    def __init__(self, minutes: float = 0.0) -> None:
        self.until = clock.monotonic() + 60.0 * minutes if minutes else math.inf

    def __call__(self, comm: MPI.Comm) -> bool:
        """Whether it is over; equal on every rank of the communicator."""
        return comm.allreduce(int(clock.monotonic() >= self.until)) > 0


class StopRequest(Deadline):
    """Stop request of a run: a signal on any rank, or the time limit; 0 minutes: no limit.

    Ignored signals, as SIGHUP under nohup, remain ignored.
    """

    def __init__(self, minutes: float = 0.0, signals: tuple[signal.Signals, ...] = SIGNALS) -> None:
        super().__init__(minutes)
        before = {name: signal.getsignal(name) for name in signals}
        self._before = {n: b for n, b in before.items() if b not in (signal.SIG_IGN, None)}
        for name in self._before:
            signal.signal(name, self._request)

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

    def _request(self, *_: object) -> None:
        self.until = min(self.until, clock.monotonic())

    def overdue(self, comm: MPI.Comm) -> bool:
        """Whether the grace time of the current step is over; equal on every rank of the communicator."""
        return comm.allreduce(int(clock.monotonic() >= self.until + GRACE_TIME)) > 0
