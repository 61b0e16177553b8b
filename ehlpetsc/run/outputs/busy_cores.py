"""Note on ranks that wait for cores on which other processes compute."""

from __future__ import annotations

import time as clock
from collections.abc import Callable
from typing import TYPE_CHECKING

from mpi4py import MPI

if TYPE_CHECKING:
    from ehlpetsc.base.errors import ExitStatus
    from ehlpetsc.run.simulation import AcceptedState

STEPS = 100  # after the first state, before which code is compiled
MAX_WAITING = 0.5  # waiting time over processor time of the rank that waits most


class BusyCores:
    """Output on every rank that compares processor time with wall clock time over the first steps.

    A rank that waits in MPI for another one keeps its core busy: the difference is the time in which the rank
    had no core. `show` receives the note, on rank 0.
    """

    def __init__(self, comm: MPI.Comm, show: Callable[[str], None]) -> None:
        self._comm, self._show, self._count = comm, show, 0
        self._begin = 0.0, 0.0

    def write(self, state: AcceptedState) -> None:
        """Take the time at the first step, and compare after the last one of the first steps."""
        self._count += 1
        times = clock.monotonic(), clock.process_time()
        if self._count == 1:
            self._begin = times
        if self._count != STEPS + 1 or self._comm.size == 1:
            return
        wall, computing = (now - begin for now, begin in zip(times, self._begin, strict=True))
        waiting = self._comm.allreduce(wall / max(computing, 1e-9) - 1.0, MPI.MAX)
        if waiting > MAX_WAITING and self._comm.rank == 0:
            self._show(
                f"note: a rank waits {waiting:.1f} times as long as it computes, as other processes use its "
                "core; all ranks wait for it: -n 1, or a less busy machine, may be faster"
            )

    def close(self, status: ExitStatus) -> None:
        """Do nothing: a shorter run needs no note."""
