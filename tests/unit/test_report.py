"""What a run says: progress, the summary line, long compilation, ranks that wait for their cores."""

import io
import re
from types import SimpleNamespace

import pytest
from numba.core import event

from ehlpetsc.base import command_line as progress_line
from ehlpetsc.base import compiled
from ehlpetsc.base.command_line import ERASE, ProgressLine
from ehlpetsc.base.compiled import COMPILING, announce_compilation
from ehlpetsc.base.errors import ExitStatus
from ehlpetsc.results.means import Totals
from ehlpetsc.run import recorder as report
from ehlpetsc.run import solve as busy_cores
from ehlpetsc.run.solve import WATCHED_STEPS, BusyCores

SCALARS = dict(dt=1.5e-7, newton=4, contacts=2, h_min=0.1234e-6, p_max=1.25e9)


class Terminal(io.StringIO):
    """A stream with isatty() true."""

    def isatty(self):
        return True


@pytest.fixture
def clock(monkeypatch):
    """A clock set by hand: a list whose last item is the time."""
    times = [100.0]
    monkeypatch.setattr(report.clock, "monotonic", lambda: times[-1])
    return times


def started(begin, end, stream):
    """Progress of a run from a time to its end [s]."""
    dimensionless, stepper = SimpleNamespace(time=begin), SimpleNamespace(show_ramp=lambda show: None)
    return report.Progress(SimpleNamespace(dimensionless=dimensionless, stepper=stepper, end=end), stream)


def show(progress, step, time):
    progress.write(SimpleNamespace(scalars=SCALARS | {"step": step, "time": time}))


def run(stream, clock, seconds_a_step, steps=100):
    progress = started(0.0, steps * 1e-6, stream)
    for step in range(1, steps + 1):
        clock.append(clock[-1] + seconds_a_step)
        show(progress, step, step * 1e-6)
    progress.close(ExitStatus.DONE)
    return stream.getvalue()


def test_progress_lines_are_few_with_fixed_columns_and_count_from_a_restart(clock):
    lines = run(io.StringIO(), clock, seconds_a_step=1.0).splitlines()
    assert len(lines) == 1 + 20 + 1  # heading, one each five seconds, last
    assert len({len(line) for line in lines}) == 1
    names = ["step", "time/us", "dt/us", "newton", "h_min/um", "p_max/GPa", "contacts", "remaining"]
    assert lines[0].split() == names
    assert lines[1].split() == ["1", "1.0000", "0.15000", "4", "0.12340", "1.2500", "2", "?"]
    assert lines[-1].split()[::7] == ["100", "0s"]
    stream = io.StringIO()
    progress = started(50e-6, 100e-6, stream)
    for step in (55, 60):
        clock.append(clock[-1] + 5.0)
        show(progress, step, step * 1e-6)
    assert stream.getvalue().split()[-1] == "40s"


def test_remaining_time_follows_the_recent_rate(clock):
    """Smooth steps of 10 ms, then rough ones of 100 ms: at half of the run 50 s are left, not 27 s."""
    progress = started(0.0, 1.0, stream := io.StringIO())
    for step in range(1, 501):
        clock.append(clock[-1] + (0.01 if step <= 200 else 0.1))
        show(progress, step, step * 1e-3)
    progress.close(ExitStatus.DONE)
    last = stream.getvalue().split()[-1]
    assert last in ("49s", "50s", "51s")


def test_progress_on_a_terminal_is_one_line_in_place(clock, monkeypatch):
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.delenv("OMPI_COMM_WORLD_RANK", raising=False)
    _, line, *rest = run(Terminal(), clock, seconds_a_step=1.0, steps=10).split("\n")
    drawn = line.split("\r")[1:]
    assert len(drawn) == 10 and len(set(map(len, drawn))) == 1 and rest == [""]
    assert drawn[4].split()[::7] == ["5", "5s"]


@pytest.mark.parametrize(
    "seconds, text",
    [(0.4, "0s"), (59.4, "59s"), (59.6, "1m00s"), (725, "12m05s"), (12000, "3h20m"), (187200, "2d04h")],
)
def test_durations_are_formatted(seconds, text):
    assert report.duration(seconds) == text


def test_summary_line_is_parsable():
    figures = dict(steps=120, newton=600, h_min=0.0, p_max=1.23456789e9, contacts=27)
    figures |= dict(load_error=2.5e-12, mass_error=3e-4)
    means = dict(friction_coefficient=0.04, film_central=2e-7, lambda_ratio=0.5, mean_gap_ratio=1.5)
    given = {"step" if name == "steps" else name: value for name, value in figures.items()}
    totals = Totals(given | dict(friction_coefficient=0.05, retries=3), means)
    line = report.summary_line(ExitStatus.DONE, totals, 12.34)
    assert line.startswith("ehlpetsc: done steps=")
    values = {key: float(value) for key, value in re.findall(r"(\w+)=(\S+)", line)}
    assert values == figures | means | {"wall": 12.3}


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


def test_line_is_written_over_itself_with_the_time_remaining_but_not_in_a_file(now):
    text = written(Terminal(), now)
    shown = [entry.rstrip() for entry in text.split("\r")[1:3]]
    assert shown == ["post a.h5: 12 %, 3m30s remaining", "post a.h5: 25 %, 3m00s remaining"]
    assert "\n" not in text and text.endswith(ERASE)
    assert written(io.StringIO(), now) == ""


@pytest.mark.parametrize("terminal, shown", [("1", True), ("", False)])
def test_under_mpirun_the_script_knows_whether_there_is_a_terminal(now, monkeypatch, terminal, shown):
    monkeypatch.setenv("OMPI_COMM_WORLD_RANK", "0")
    monkeypatch.setenv("EHLPETSC_TERMINAL", terminal)
    assert bool(written(Terminal(), now)) == shown


@pytest.mark.parametrize("seconds, said", [((0.2, 0.3), []), ((0.8, 0.8, 2.0, 0.1), [COMPILING])])
def test_long_compilation_is_announced_once(monkeypatch, seconds, said):
    now, shown, registered = [0.0], [], []
    monkeypatch.setattr(compiled, "clock", SimpleNamespace(monotonic=lambda: now[0]))
    monkeypatch.setattr(event, "register", lambda kind, listener: registered.append(listener))
    announce_compilation(shown.append)
    (listener,) = registered
    for length in seconds:
        for _ in range(2):  # of a function and of one that it calls
            listener.on_start(None)
        now[0] += length
        for _ in range(2):
            listener.on_end(None)
    assert shown == said


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
