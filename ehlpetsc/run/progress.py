"""Progress and summary of a run, on rank 0."""

import os
import shutil
import sys
import time as clock

SECONDS_BETWEEN_LINES = 5.0
SECONDS_BETWEEN_BARS = 0.2

_COLUMNS = (
    ("step", "{:>8d}"),
    ("time/us", "{:>11.4f}"),
    ("dt/us", "{:>9.5f}"),
    ("newton", "{:>6d}"),
    ("contacts", "{:>8d}"),
    ("h_min/um", "{:>9.5f}"),
    ("p_max/GPa", "{:>9.4f}"),
    ("remaining", "{:>9s}"),
)


def on_terminal(stream):
    """Whether someone watches.

    mpirun gives every rank a terminal, also where its own output goes to a file: that of the process which
    started this one tells, and run_mpi.sh sets TERM.
    """
    if not stream.isatty() or os.environ.get("TERM") == "dumb":
        return False
    if "OMPI_COMM_WORLD_RANK" not in os.environ:
        return True
    try:
        return os.readlink(f"/proc/{os.getppid()}/fd/1").startswith(("/dev/pts/", "/dev/tty"))
    except OSError:
        return True


class Progress:
    """Says how far a run is: fixed-column lines into a file, a bar on a terminal.

    Parameters
    ----------
    begin, end : float
        Time at the start of this run and at its end [s].
    stream : file, optional
        Where to write; standard output by default.
    """

    def __init__(self, begin, end, stream=None):
        self._stream = sys.stdout if stream is None else stream
        self._begin, self._end = begin, end
        self._bar = on_terminal(self._stream)
        self._started = clock.monotonic()
        self._shown = None
        self._pending = None

    def step(self, step, time, scalars):
        """Take note of an accepted step, and show it if it is the first or the last one was shown long ago.

        Parameters
        ----------
        step : int
        time : float
            Time at its end [s].
        scalars : dict
            dt, newton, contacts, h_min, p_max of the step in SI units.
        """
        now = clock.monotonic()
        self._pending = (step, time, scalars)
        wait = SECONDS_BETWEEN_BARS if self._bar else SECONDS_BETWEEN_LINES
        if self._shown is None or now - self._shown >= wait:
            self._show(now)

    def close(self):
        """Show the last step, if it has not been."""
        if self._pending:
            self._show(clock.monotonic())
        if self._bar and self._shown is not None:
            self._stream.write("\n")
            self._stream.flush()

    def _show(self, now):
        step, time, scalars = self._pending
        self._pending = None
        done = (time - self._begin) / (self._end - self._begin) if self._end > self._begin else 1.0
        done = min(max(done, 0.0), 1.0)
        left = duration((now - self._started) * (1.0 - done) / done) if done > 0.0 else "?"
        if self._bar:
            self._draw_bar(done, left, scalars)
        else:
            if self._shown is None:
                self._stream.write(_heading())
            self._stream.write(_line(step, time, scalars, left))
        self._stream.flush()
        self._shown = now

    def _draw_bar(self, done, left, scalars):
        text = (
            f" {100 * done:5.1f} %  h_min {1e6 * scalars['h_min']:.4f} um"
            f"  p_max {1e-9 * scalars['p_max']:.3f} GPa  contacts {scalars['contacts']}  {left} left"
        )
        columns = shutil.get_terminal_size().columns
        width = max(10, columns - len(text) - 3)
        filled = round(done * width)
        bar = f"[{'#' * filled}{'.' * (width - filled)}]{text}"[: columns - 1]
        self._stream.write(f"\r{bar}\x1b[K")


def _heading():
    cells = (name.rjust(len(form.format(*_blank(form)))) for name, form in _COLUMNS)
    return " ".join(cells) + "\n"


def _blank(form):
    return (0,) if "d" in form else ("",) if "s" in form else (0.0,)


def _line(step, time, scalars, left):
    values = (
        step,
        1e6 * time,
        1e6 * scalars["dt"],
        int(scalars["newton"]),
        int(scalars["contacts"]),
        1e6 * scalars["h_min"],
        1e-9 * scalars["p_max"],
        left,
    )
    return " ".join(form.format(value) for (_, form), value in zip(_COLUMNS, values, strict=True)) + "\n"


def duration(seconds):
    """A time span for people: ``45s``, ``12m05s``, ``3h20m``, ``2d04h``."""
    s = round(seconds)
    if s < 60:
        return f"{s}s"
    if s < 3600:
        return f"{s // 60}m{s % 60:02d}s"
    if s < 86400:
        return f"{s // 3600}h{s % 3600 // 60:02d}m"
    return f"{s // 86400}d{s % 86400 // 3600:02d}h"


def summary_line(status, *, steps, newton, h_min, p_max, contacts, load_error, mass_error, wall):
    """The line every run ends with, for grep.

    Parameters
    ----------
    status : str
        "done", "stopped" or "not converged".
    steps, newton, contacts : int
        Accepted steps, Newton iterations of all of them, nodes in contact summed over steps.
    h_min, p_max : float
        Extremes over the run [m, Pa].
    load_error, mass_error : float
        Greatest relative errors over the run.
    wall : float
        Wall clock time [s].
    """
    return (
        f"ehlpetsc: {status} steps={steps} newton={newton} h_min={h_min:.9g} p_max={p_max:.9g}"
        f" contacts={contacts} load_error={load_error:.2e} mass_error={mass_error:.2e} wall={wall:.1f}"
    )
