"""Queue of work for groups of ranks: a free group gets the next item.

The first rank deals and works at the same time: it looks for requests between its own time steps
(:meth:`WorkQueue.serve`), so that no rank is spent on waiting and no shared memory is needed.
"""

import time as clock

from mpi4py import MPI

REQUEST, ANSWER = 71, 72
POLL_SECONDS = 0.01  # between two polls of a waiting rank


class WorkQueue:
    """Distributes the numbers in `order` to groups of `ranks` ranks each.

    Parameters
    ----------
    world : mpi4py communicator
    ranks : int
        Of a group; the last group has what is left.
    order : list of int
        In which the pieces are dealt.
    take : callable
        Called on the first rank of the world with each report.
    group : mpi4py communicator, optional
        Group of this rank in an earlier queue; by default the ranks are split.

    Attributes
    ----------
    group : mpi4py communicator
        The group this rank is in.
    """

    def __init__(self, world, ranks, order, on_report, group=None):
        self.world, self.on_report = world, on_report
        self.group = group or world.Split(world.rank // ranks, world.rank)
        self._waiting = list(order)
        self._others = -(-world.size // ranks) - 1  # groups that are yet to hear that nothing is left

    def next(self, report, ending):
        """Report on the last item and get the next one; collective over the group.

        Parameters
        ----------
        report : object or None
            Handed to `on_report`; that of the group's first rank counts.
        ending : bool
            True: deal nothing more, to no group.

        Returns
        -------
        int or None
            None: nothing left, for good.
        """
        number = None
        if self.world.rank == 0:
            number = self._deal(report, ending)
        elif self.group.rank == 0:
            self.world.send((report, ending), 0, REQUEST)
            wait(lambda: self.world.iprobe(0, ANSWER))
            number = self.world.recv(source=0, tag=ANSWER)
        return self.group.bcast(number)

    def serve(self):
        """Answer pending requests; on the first rank, often."""
        if self.world.rank != 0:
            return
        status = MPI.Status()
        while self._others and self.world.iprobe(MPI.ANY_SOURCE, REQUEST, status):
            report, ending = self.world.recv(source=status.source, tag=REQUEST)
            number = self._deal(report, ending)
            self._others -= number is None
            self.world.send(number, status.source, ANSWER)

    def finish(self, status):
        """Wait until every group is done; the first rank's `status()` on all ranks."""
        if self.world.rank == 0:
            wait(lambda: self.serve() or not self._others)
        done = self.world.Ibarrier()  # a rank in a plain barrier would keep its core busy
        wait(done.Test)
        return self.world.bcast(status() if self.world.rank == 0 else None)

    def _deal(self, report, ending):
        if report is not None:
            self.on_report(report)
        if ending:
            self._waiting.clear()
        return self._waiting.pop(0) if self._waiting else None


class PollingStop:
    """Stop request that serves the other groups at every query, as `run.stop.StopRequest`.

    Parameters
    ----------
    queue : WorkQueue
    stop : run.stop.StopRequest or None
        None: never.
    """

    def __init__(self, queue, stop):
        self._queue, self._stop = queue, stop

    def __call__(self, group):
        self._queue.serve()
        return self._stop is not None and self._stop(group)

    def overdue(self, group):
        self._queue.serve()
        return self._stop is not None and self._stop.overdue(group)


def wait(ready):
    """Poll until `ready()`."""
    while not ready():
        clock.sleep(POLL_SECONDS)
