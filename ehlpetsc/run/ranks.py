"""Ranks of a run: actions of rank 0 alone, and a queue of work for groups of ranks.

The first rank distributes the items of the queue and computes at the same time: it answers requests between
its own time steps (:meth:`WorkQueue.serve`), so that no rank only waits and no shared memory is needed.
"""

import time as clock

from ehlpetsc.errors import OutputError


def on_root(comm, action, *arguments):
    """Result of `action` on rank 0, None on the others; its OutputError is raised on every rank."""
    answer = fault = None
    if comm.rank == 0:
        try:
            answer = action(*arguments)
        except OutputError as error:
            fault = str(error)
    fault = comm.bcast(fault)
    if fault:
        raise OutputError(fault)
    return answer


REQUEST, ANSWER = 71, 72  # tags of messages
POLL_SECONDS = 0.01  # between two polls of a waiting rank


class WorkQueue:
    """Distributes the numbers in `order` to groups of `ranks` ranks each.

    Parameters
    ----------
    world : mpi4py communicator
    ranks : int
        Size of a group; the last group has the remaining ranks.
    order : list of int
        Items in the order of their distribution.
    on_report : callable
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
        self._others = -(-world.size // ranks) - 1  # groups that have not received the end of the queue

    def next(self, report, ending):
        """Report on the last item and get the next one; collective over the group.

        Parameters
        ----------
        report : object or None
            Passed to `on_report`; the report of the group's first rank counts.
        ending : bool
            True: distribute no further item, to no group.

        Returns
        -------
        int or None
            None: the queue is empty.
        """
        number = None
        if self.world.rank == 0:
            number = self._next(report, ending)
        elif self.group.rank == 0:
            self.world.send((report, ending), 0, REQUEST)
            wait(lambda: self.world.iprobe(0, ANSWER))
            number = self.world.recv(source=0, tag=ANSWER)
        return self.group.bcast(number)

    def serve(self):
        """Answer pending requests on the first rank; to be called often."""
        if self.world.rank != 0:
            return
        from mpi4py import MPI

        status = MPI.Status()
        while self._others and self.world.iprobe(MPI.ANY_SOURCE, REQUEST, status):
            report, ending = self.world.recv(source=status.source, tag=REQUEST)
            number = self._next(report, ending)
            self._others -= number is None
            self.world.send(number, status.source, ANSWER)

    def finish(self, status):
        """Wait until every group is done; return the first rank's `status()` on all ranks."""
        if self.world.rank == 0:
            wait(lambda: self.serve() or not self._others)
        done = self.world.Ibarrier()  # a rank in a blocking barrier would keep its core busy
        wait(done.Test)
        return self.world.bcast(status() if self.world.rank == 0 else None)

    def _next(self, report, ending):
        if report is not None:
            self.on_report(report)
        if ending:
            self._waiting.clear()
        return self._waiting.pop(0) if self._waiting else None


class PollingStop:
    """Stop request like `run.stop.StopRequest` that also serves the other groups at every query.

    Parameters
    ----------
    queue : WorkQueue
    stop : run.stop.StopRequest or None
        None: no stop.
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
