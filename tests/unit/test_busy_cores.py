"""Ranks that wait for their cores are noticed after the first hundred steps."""

from types import SimpleNamespace

import pytest

from ehlpetsc.run import solve as busy_cores
from ehlpetsc.run.solve import WATCHED_STEPS, BusyCores


@pytest.mark.parametrize("share, ranks, words", [(0.25, 2, "3.0 times"), (0.9, 2, ""), (0.25, 1, "")])
def test_note_of_a_share_of_the_core(monkeypatch, share, ranks, words):
    wall = [0.0]
    times = SimpleNamespace(monotonic=lambda: wall[0], process_time=lambda: share * wall[0])
    monkeypatch.setattr(busy_cores, "clock", times)
    said: list[str] = []
    comm = SimpleNamespace(size=ranks, rank=0, allreduce=lambda value, operation: value)
    output = BusyCores(comm, said.append)
    for step in range(3 * WATCHED_STEPS):
        output.write(SimpleNamespace(step=step))
        wall[0] += 0.01 * (step + 1)
    assert len(said) == bool(words) and all(words in line and "-n 1" in line for line in said)
