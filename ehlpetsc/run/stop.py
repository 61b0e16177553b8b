"""Stop on request: a signal or the time limit ends a run after the current step."""

import math
import signal
import sys
import time as clock

SIGNALS = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGUSR1)
GRACE_TIME = 0.4  # s for the current step: mpirun kills one second after it has forwarded a signal


class Interrupted(BaseException):
    """Signal to stop before the run; unlike KeyboardInterrupt, an import does not end the process by it."""


class EarlyStop:
    """Handler of signals before :class:`StopRequest` is installed; raises `Interrupted`.

    Attributes
    ----------
    is_requested : bool
        Whether a signal has arrived. The exception is lost inside a callback of numba's compiler; the next
        handler of signals then reads this attribute.
    """

    def __init__(self):
        self.is_requested = False
        previous_hook = sys.unraisablehook
        sys.unraisablehook = lambda lost: (
            None if isinstance(lost.exc_value, Interrupted) else previous_hook(lost)
        )
        _handle(self)

    def __call__(self, *_):
        self.is_requested = True
        raise Interrupted


class StopRequest:
    """Stop request of a run: a signal on any rank, or the time limit.

    Ignored signals, as SIGHUP under nohup, remain ignored.

    Parameters
    ----------
    minutes : float
        Wall clock time from now on; 0: no limit.
    """

    def __init__(self, minutes=0.0):
        self.until = clock.monotonic() + 60.0 * minutes if minutes else math.inf
        if any(getattr(handler, "is_requested", False) for handler in _handle(self._request)):
            self._request()

    def _request(self, *_):
        self.until = min(self.until, clock.monotonic())

    def __call__(self, comm):
        """Whether to stop; equal on every rank of the communicator."""
        return comm.allreduce(int(clock.monotonic() >= self.until)) > 0

    def overdue(self, comm):
        """Whether the grace time of the current step is over; equal on every rank of the communicator."""
        return comm.allreduce(int(clock.monotonic() >= self.until + GRACE_TIME)) > 0


def _handle(handler):
    """Install a handler of all signals that are not ignored; returns the previous handlers."""
    before = [signal.getsignal(name) for name in SIGNALS]
    for name, previous in zip(SIGNALS, before, strict=True):
        if previous is not signal.SIG_IGN:
            signal.signal(name, handler)
    return before
