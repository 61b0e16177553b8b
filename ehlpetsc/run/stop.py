"""Stopping on request: a signal or the time limit ends a run after the step in hand."""

import signal
import time as clock

import numpy as np
from mpi4py import MPI

SIGNALS = (signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGUSR1)
GRACE_TIME = 0.4  # s for the step in hand: mpirun kills one second after the signal that it hands on


class StopRequest:
    """Whether the run is to stop: a signal has come on any rank, or the time is over.

    Signals that are ignored, as SIGHUP under nohup, stay so.

    Parameters
    ----------
    minutes : float
        Wall clock time from now on; 0: no limit.
    """

    def __init__(self, minutes=0.0):
        self.until = clock.monotonic() + 60.0 * minutes if minutes else np.inf
        for name in SIGNALS:
            before = signal.getsignal(name)
            if before is not signal.SIG_IGN:
                signal.signal(name, self._ask)
            if getattr(before, "asked", None):  # a signal that came before, and was lost on its way
                self._ask()

    def _ask(self, *_):
        self.until = min(self.until, clock.monotonic())

    def __call__(self, comm):
        """The same answer on every rank of the communicator."""
        return comm.allreduce(clock.monotonic() >= self.until, MPI.LOR)

    def overdue(self, comm):
        """Whether the step in hand has been waited for long enough; the same on every rank."""
        return comm.allreduce(clock.monotonic() >= self.until + GRACE_TIME, MPI.LOR)
