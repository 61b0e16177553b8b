"""Progress of a command: one line on a terminal, with the time remaining."""

from __future__ import annotations

import os
import sys
import time as clock
from typing import TextIO

SECONDS_IN_PLACE = 0.2  # between two updates of a line
MIN_SECONDS = 1.0  # before a remaining time is shown
WIDTH = 70
ERASE = "\r" + " " * WIDTH + "\r"


def on_terminal(stream: TextIO) -> bool:
    """Whether output is shown on a terminal; under mpirun, which hides it, run_mpi.sh has looked."""
    if "OMPI_COMM_WORLD_RANK" in os.environ:
        return os.environ.get("EHLPETSC_TERMINAL") == "1"
    return stream.isatty() and os.environ.get("TERM") != "dumb"


def in_notebook() -> bool:
    """Whether output is shown in a notebook."""
    shell = sys.modules["IPython"].get_ipython() if "IPython" in sys.modules else None
    return type(shell).__name__ == "ZMQInteractiveShell"


class ProgressLine:
    """Line that is written over itself on a terminal, and nowhere else.

    `total`: work in any unit.
    """

    def __init__(self, label: str, total: float, stream: TextIO | None = None) -> None:
        self._label, self._total, self._stream = label, total, stream or sys.stdout
        self._is_shown = on_terminal(self._stream)
        self._begun, self._shown, self.done = clock.monotonic(), 0.0, 0.0

    def add(self, work: float) -> None:
        """Add work done."""
        self.reach(self.done + work)

    def reach(self, done: float) -> None:
        """Set the work done, and show it if the line is due."""
        self.done, now = done, clock.monotonic()
        if not self._is_shown or now - self._shown < SECONDS_IN_PLACE:
            return
        share, spent = min(self.done / max(self._total, 1e-300), 1.0), now - self._begun
        is_known = spent > MIN_SECONDS and share > 0.0
        remaining = duration(spent * (1.0 - share) / share) if is_known else "?"
        text = f"{self._label}: {100.0 * share:.0f} %, {remaining} remaining"
        print(f"\r{text:{WIDTH}s}", end="", file=self._stream, flush=True)
        self._shown = now

    def clear(self) -> None:
        """Remove the line, before other output and at the end."""
        if self._shown:
            print(ERASE, end="", file=self._stream, flush=True)
            self._shown = 0.0


def duration(seconds: float) -> str:
    """Duration as text: ``45s``, ``12m05s``, ``3h20m``, ``2d04h``."""
    s = round(seconds)
    if s < 60:
        return f"{s}s"
    if s < 3600:
        return f"{s // 60}m{s % 60:02d}s"
    if s < 86400:
        return f"{s // 3600}h{s % 3600 // 60:02d}m"
    return f"{s // 86400}d{s % 86400 // 3600:02d}h"
