"""Each work item is assigned once, to a free group, and no group waits forever."""

import time

from ehlpetsc.run.ranks import WorkQueue


def deal(ranks, pieces, ending_after=None):
    """Take items until none is left: items of this rank, items reported to the first rank."""
    from mpi4py import MPI

    reported, mine, report = [], [], None
    queue = WorkQueue(MPI.COMM_WORLD, ranks, pieces, reported.append)
    while True:
        number = queue.next(report, ending_after is not None and len(mine) >= ending_after)
        if number is None:
            break
        mine.append(number)
        for _ in range(5):
            queue.serve()
            time.sleep(0.001)
        report = number
    status = queue.finish(lambda: sorted(reported))
    return MPI.COMM_WORLD.allgather(mine), status, queue.group.size


def test_every_item_is_assigned_and_reported_once():
    mine, reported, size = deal(1, list(range(11)))
    assert size == 1
    assert sorted(sum(mine, [])) == reported == list(range(11))
    assert len(mine) == 1 or len(mine[0]) < 11, "the first rank did all by itself"


def test_ranks_of_a_group_get_the_same_items():
    from mpi4py import MPI

    mine, reported, _ = deal(2, list(range(7)))
    assert reported == list(range(7))
    for first in range(0, MPI.COMM_WORLD.size, 2):
        assert all(other == mine[first] for other in mine[first : first + 2])


def test_no_item_is_assigned_after_a_stop():
    from mpi4py import MPI

    mine, reported, _ = deal(1, list(range(100)), ending_after=2)
    assert max(map(len, mine)) <= 2
    assert len(reported) <= 2 * MPI.COMM_WORLD.size


def test_more_groups_than_items():
    mine, reported, _ = deal(1, [4])
    assert sum(mine, []) == reported == [4]
