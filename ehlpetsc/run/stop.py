"""Stopping on request: a signal or the time limit ends a run after the step in hand."""

import signal
import time as clock

import numpy as np
from mpi4py import MPI

SIGNALS = (signal.SIGTERM, signal.SIGINT, signal.SIGUSR1)


class StopRequest:
    """Whether the run is to stop: SIGTERM, SIGINT or SIGUSR1 has come on any rank, or the time is over.

    Parameters
    ----------
    minutes : float
        Wall clock time from now on; 0: no limit.
    """

    def __init__(self, minutes=0.0):
        self.asked = False
        self.until = clock.monotonic() + 60.0 * minutes if minutes else np.inf
        for name in SIGNALS:
            signal.signal(name, self._ask)

    def _ask(self, *_):
        self.asked = True

    def __call__(self, comm):
        """The same answer on every rank of the communicator."""
        return comm.allreduce(self.asked or clock.monotonic() > self.until, MPI.LOR)
