"""Stopping on request: a signal or the time limit ends a run after the step in hand."""

import math
import signal
import sys
import time as clock

SIGNALS = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGUSR1)
GRACE_TIME = 0.4  # s for the step in hand: mpirun kills one second after the signal that it hands on


class Interrupted(BaseException):
    """A signal to stop before the run; Python would end by a KeyboardInterrupt inside an import itself."""


class EarlyStop:
    """Handler of the signals that come before a :class:`StopRequest` takes over: each is an `Interrupted`.

    Attributes
    ----------
    asked : bool
        Whether a signal has come. One inside a callback of numba's compiler is lost there: the next handler
        of signals looks here.
    """

    def __init__(self):
        self.asked = False
        previous_hook = sys.unraisablehook
        sys.unraisablehook = lambda lost: (
            None if isinstance(lost.exc_value, Interrupted) else previous_hook(lost)
        )
        _handle(self)

    def __call__(self, *_):
        self.asked = True
        raise Interrupted


class StopRequest:
    """Whether the run is to stop: a signal has come on any rank, or the time is over.

    Signals that are ignored, as SIGHUP under nohup, stay so.

    Parameters
    ----------
    minutes : float
        Wall clock time from now on; 0: no limit.
    """

    def __init__(self, minutes=0.0):
        self.until = clock.monotonic() + 60.0 * minutes if minutes else math.inf
        if any(getattr(handler, "asked", False) for handler in _handle(self._ask)):
            self._ask()

    def _ask(self, *_):
        self.until = min(self.until, clock.monotonic())

    def __call__(self, comm):
        """Whether to stop; equal on every rank of the communicator."""
        return comm.allreduce(int(clock.monotonic() >= self.until)) > 0

    def overdue(self, comm):
        """Whether the step in hand has had its grace time; the same answer on every rank."""
        return comm.allreduce(int(clock.monotonic() >= self.until + GRACE_TIME)) > 0


def _handle(handler):
    """Install a handler of all signals that are not ignored; returns the previous handlers."""
    before = [signal.getsignal(name) for name in SIGNALS]
    for name, known in zip(SIGNALS, before, strict=True):
        if known is not signal.SIG_IGN:
            signal.signal(name, handler)
    return before
