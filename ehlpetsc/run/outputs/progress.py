"""Progress and summary of a run, on rank 0."""

from __future__ import annotations

import sys
import time as clock
from typing import TYPE_CHECKING, TextIO

from ehlpetsc.base.progress_line import SECONDS_IN_PLACE, duration, in_notebook, on_terminal
from ehlpetsc.base.quantities import STEP_SCALARS

if TYPE_CHECKING:
    from ehlpetsc.base.errors import ExitStatus
    from ehlpetsc.results.means import Totals
    from ehlpetsc.run.simulation import AcceptedState, Simulation

SECONDS_BETWEEN_LINES = 5.0
MIN_RATE_TIME = 1.0  # s after the first step, which includes compilation, before a remaining time is shown


class Progress:
    """Output that shows the steps of a simulation: a line every five seconds, on a terminal one in place."""

    def __init__(self, simulation: Simulation, stream: TextIO | None = None) -> None:
        self._simulation, self._stream = simulation, stream or sys.stdout
        self._in_place = on_terminal(self._stream) or in_notebook()
        self._begun = simulation.solution is not None
        self._samples: list[tuple[float, float]] = []  # wall clock, time of the run, since the first step
        self._shown: float | None = None
        self._pending: dict[str, float] | None = None

    def write(self, state: AcceptedState) -> None:
        """Show a step, but not the steady start, if it is the first or enough time has passed."""
        if not self._begun:
            self._begun = True
            return
        now, self._pending = clock.monotonic(), state.scalars
        wait = SECONDS_IN_PLACE if self._in_place else SECONDS_BETWEEN_LINES
        if self._shown is None or now - self._shown >= wait:
            self._show(now)

    def close(self, status: ExitStatus) -> None:
        """Show the last step if it has not been shown."""
        if self._pending:
            self._show(clock.monotonic())
        if self._in_place and self._shown is not None:
            print(file=self._stream, flush=True)

    def _show(self, now: float) -> None:
        scalars, self._pending = self._pending, None
        columns = [(s.progress, scalars[name], s.dtype) for name, s in STEP_SCALARS.items() if s.progress]
        if self._shown is None:
            headings = [column.heading.rjust(len(column.form.format(0))) for column, *_ in columns]
            print(*headings, "remaining", file=self._stream)
        cells = [c.form.format(int(v) if kind[0] == "i" else c.factor * v) for c, v, kind in columns]
        remaining = self._remaining(now, scalars["time"], self._simulation.end)
        begin, end = ("\r", "") if self._in_place else ("", "\n")
        line = " ".join([*cells, f"{remaining:>9s}"])
        print(begin + line, end=end, file=self._stream, flush=True)
        self._shown = now

    def _remaining(self, now: float, time: float, end: float) -> str:
        """Remaining time from the rate over the last half of the wall clock time; "?": not known yet."""
        if not self._samples or now - self._samples[-1][0] > SECONDS_IN_PLACE:
            self._samples.append((now, time))
        begun = self._samples[0][0]
        since = next(sample for sample in reversed(self._samples) if sample[0] <= begun + 0.5 * (now - begun))
        if now - begun < MIN_RATE_TIME and time < end or time <= since[1]:
            return "0s" if time >= end else "?"
        return duration((now - since[0]) * max(end - time, 0.0) / (time - since[1]))


def summary_line(status: ExitStatus, totals: Totals, wall: float) -> str:
    """Last line of the output of a run.

    `wall`: wall clock time [s].
    """
    return f"ehlpetsc: {status.words} {totals} wall={wall:.1f}"
