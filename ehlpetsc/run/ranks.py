"""Ranks of a run: deadlines and stops, actions of rank 0 alone, a queue of work for groups of ranks.

A signal or the time limit ends a run after the current step.

The first rank distributes the items of the queue and computes at the same time: it answers requests between
its own time steps (:meth:`WorkQueue.serve`), so that no rank only waits and no shared memory is needed.
"""

from __future__ import annotations

import contextlib
import math
import signal
import threading
import time as clock
from collections.abc import Callable, Hashable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

from ehlpetsc.base.errors import CaseError, OutputError, PostError, UsageError

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


REQUEST, ANSWER = 71, 72  # tags of messages
POLL_SECONDS = 0.01  # between two polls of a waiting rank


def on_root(comm: MPI.Comm, action: Callable, *arguments: object) -> Any:
    """Result of `action` on rank 0, on every rank; so is a fault of the user's input."""
    answer = fault = None
    if comm.rank == 0:
        try:
            answer = action(*arguments)
        except (CaseError, OutputError, PostError, UsageError) as error:
            fault = error
    answer, fault = comm.bcast((answer, fault))
    if fault:
        raise fault
    return answer


class WorkQueue:
    """Distributes the items in `order` to groups of `ranks` ranks each; the last has the remaining ranks.

    `on_report` is called on the first rank of the world with each report. `group` is the group of this rank,
    by default split from the world, or that of an earlier queue.
    """

    def __init__(
        self,
        world: MPI.Comm,
        ranks: int,
        order: Sequence[Hashable],
        on_report: Callable[[Any], None],
        group: MPI.Comm | None = None,
    ) -> None:
        self.world, self.on_report = world, on_report
        self.group = group or world.Split(world.rank // ranks, world.rank)
        self._waiting = list(order)
        self._others = -(-world.size // ranks) - 1  # groups that have not received the end of the queue

    def compute(self, solve: Callable, stop: StopRequest | None, result: Callable[[], Any]) -> Any:
        """Compute items until the queue is empty or stopped; `result()` of the first rank, on every rank.

        `solve(item, group, stop)` returns the rest of the report, after the item.
        """
        report, serving = None, PollingStop(self, stop)
        while (item := self.next(report, serving(self.group))) is not None:
            report = item, solve(item, self.group, serving)
        return self.finish(result)

    def next(self, report: object, ending: bool) -> Any:
        """Report on the last item and get the next one, None at the end; collective over the group.

        With `ending` no group gets a further item.
        """
        item = None
        if self.world.rank == 0:
            item = self._next(report, ending)
        elif self.group.rank == 0:
            self.world.send((report, ending), 0, REQUEST)
            _wait(lambda: self.world.iprobe(0, ANSWER))
            item = self.world.recv(source=0, tag=ANSWER)
        return self.group.bcast(item)

    def serve(self) -> None:
        """Answer pending requests on the first rank; to be called often."""
        if self.world.rank != 0:
            return
        from mpi4py import MPI

        status = MPI.Status()
        while self._others and self.world.iprobe(MPI.ANY_SOURCE, REQUEST, status):
            report, ending = self.world.recv(source=status.source, tag=REQUEST)
            item = self._next(report, ending)
            self._others -= item is None
            self.world.send(item, status.source, ANSWER)

    def finish(self, result: Callable[[], Any]) -> Any:
        """Wait until every group is done; `result()` of the first rank, on every rank."""
        if self.world.rank == 0:
            _wait(self._all_ended)
        done = self.world.Ibarrier()  # a rank in a blocking barrier would keep its core busy
        _wait(done.Test)
        return self.world.bcast(result() if self.world.rank == 0 else None)

    def _all_ended(self) -> bool:
        self.serve()
        return not self._others

    def _next(self, report: object, ending: bool) -> Any:
        if report is not None:
            self.on_report(report)
        if ending:
            self._waiting.clear()
        return self._waiting.pop(0) if self._waiting else None


class PollingStop(StopRequest):
    """Stop request that also serves the other groups at every query; `stop` None: no stop."""

    def __init__(self, queue: WorkQueue, stop: StopRequest | None) -> None:
        self._queue, self._stop = queue, stop

    def __call__(self, group: MPI.Comm) -> bool:
        self._queue.serve()
        return self._stop is not None and self._stop(group)

    def overdue(self, group: MPI.Comm) -> bool:
        self._queue.serve()
        return self._stop is not None and self._stop.overdue(group)


def _wait(ready: Callable[[], Any]) -> None:
    while not ready():
        clock.sleep(POLL_SECONDS)
