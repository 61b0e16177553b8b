"""The line of progress of a command: on a terminal, with the time remaining; not in a file."""

import io
from types import SimpleNamespace

import pytest

from ehlpetsc.base import command_line as progress_line
from ehlpetsc.base.command_line import ERASE, ProgressLine


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.fixture
def now(monkeypatch):
    """Clock, in an environment without mpirun."""
    time = [100.0]
    monkeypatch.setattr(progress_line, "clock", SimpleNamespace(monotonic=lambda: time[0]))
    for name in ("OMPI_COMM_WORLD_RANK", "EHLPETSC_TERMINAL"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("TERM", "xterm")
    return time


def written(stream, now):
    line = ProgressLine("post a.h5", 8.0, stream)
    for _ in range(2):
        now[0] += 30.0
        line.add(1.0)
    line.clear()
    return stream.getvalue()


def test_line_is_written_over_itself_with_the_time_remaining(now):
    text = written(Terminal(), now)
    assert [entry.rstrip() for entry in text.split("\r")[1:3]] == [
        "post a.h5: 12 %, 3m30s remaining",
        "post a.h5: 25 %, 3m00s remaining",
    ]
    assert "\n" not in text and text.endswith(ERASE)


def test_no_line_in_a_file(now):
    assert written(io.StringIO(), now) == ""


@pytest.mark.parametrize("terminal, shown", [("1", True), ("", False)])
def test_under_mpirun_the_script_knows_whether_there_is_a_terminal(now, monkeypatch, terminal, shown):
    monkeypatch.setenv("OMPI_COMM_WORLD_RANK", "0")
    monkeypatch.setenv("EHLPETSC_TERMINAL", terminal)
    assert bool(written(Terminal(), now)) == shown
