"""Pieces of work are dealt once each, to whoever is free, and no group waits for ever."""

import time

from ehlpetsc.run.series.work_queue import WorkQueue


def deal(ranks, pieces, ending_after=None):
    """Take pieces until none is left: what this rank got, what the first rank was told."""
    from mpi4py import MPI

    told, mine, report = [], [], None
    queue = WorkQueue(MPI.COMM_WORLD, ranks, pieces, told.append)
    while True:
        number = queue.next(report, ending_after is not None and len(mine) >= ending_after)
        if number is None:
            break
        mine.append(number)
        for _ in range(5):
            queue.serve()
            time.sleep(0.001)
        report = number
    status = queue.finish(lambda: sorted(told))
    return MPI.COMM_WORLD.allgather(mine), status, queue.group.size


def test_every_piece_is_dealt_once_and_reported():
    mine, told, size = deal(1, list(range(11)))
    assert size == 1
    assert sorted(sum(mine, [])) == told == list(range(11))
    assert len(mine) == 1 or len(mine[0]) < 11, "the first rank did all by itself"


def test_ranks_of_a_group_get_the_same_pieces():
    from mpi4py import MPI

    mine, told, _ = deal(2, list(range(7)))
    assert told == list(range(7))
    for first in range(0, MPI.COMM_WORLD.size, 2):
        assert all(other == mine[first] for other in mine[first : first + 2])


def test_nothing_more_is_dealt_once_a_group_is_to_stop():
    from mpi4py import MPI

    mine, told, _ = deal(1, list(range(100)), ending_after=2)
    assert max(map(len, mine)) <= 2
    assert len(told) <= 2 * MPI.COMM_WORLD.size


def test_more_groups_than_pieces():
    mine, told, _ = deal(1, [4])
    assert sum(mine, []) == told == [4]
