"""The Python interface: ``ehlpetsc.load``, ``solve``, ``Simulation`` and ``read_result``.

Nothing heavy is imported before it is needed: a result is read and drawn without PETSc and MPI.
"""

import io
import sys
from pathlib import Path

import h5py
import numpy as np

from ehlpetsc import environment
from ehlpetsc.case.loading import load, members
from ehlpetsc.errors import CaseError, ExitStatus, UsageError
from ehlpetsc.results import reader
from ehlpetsc.results.reader import open_result

__all__ = ["Result", "load", "members", "read_result", "solve"]


class Result(reader.Result):
    """Result from a file or in memory, see :class:`ehlpetsc.results.reader.Result`."""

    def plot(self, step=None, time=None, window=None):
        """Pressure and film over x/a at one stored frame, contacts marked.

        Parameters
        ----------
        step : int, optional
        time : float, optional
            [s]; the nearest frame is drawn, by default that of :func:`.plot.panels.frames.frame_to_show`.
        window : (float, float), optional
            Limits of x/a.

        Returns
        -------
        matplotlib.figure.Figure

        Examples
        --------
        >>> import ehlpetsc
        >>> figure = ehlpetsc.solve("cases/dry_hertz.toml").plot(window=(-1.2, 1.2))
        >>> [axes.get_ylabel() for axes in figure.axes]
        ['pressure [GPa]', 'gap [µm]']
        """
        from matplotlib import pyplot

        from ehlpetsc.pictures import frames, labels

        (index,), ((colour,), *_) = frames.choose_frames([self], step, time), labels.series_colours([self])
        window = self._window(window)
        figure, axes = pyplot.subplots(2, 1, figsize=(8.0, 5.2), sharex=True, layout="constrained")
        frames.pressure_and_film(axes, [self], [index], [colour], window or frames.default_window([self]))
        frames.frame_legend(axes, self, index, colour)
        title = ": ".join(filter(None, [self.attrs["title"], frames.instant([self], [index])]))
        axes[0].set_title(title, fontsize="medium")
        return figure

    def _window(self, window):
        """Limits of x/a that contain nodes."""
        if window is None:
            return None
        ends = self.x[[0, -1]] / self.attrs["a"]
        try:
            low, high = map(float, window)
            inside = np.count_nonzero((self.x >= low * self.attrs["a"]) & (self.x <= high * self.attrs["a"]))
        except (TypeError, ValueError):
            inside = 0
        if inside < 2:
            allowed = f"two limits of x/a with nodes between them, from {ends[0]:g} to {ends[1]:g}"
            raise UsageError(f"window = {window!r}: allowed: {allowed}")
        return low, high


def refuse_passes(case):
    """Refuse a case of several passes, which has several results."""
    if case.time is not None and case.time.passes > 1:
        passes = f"{case.path}: time.passes = {case.time.passes}: solve one after the other"
        raise CaseError([f"{passes}, ehlpetsc.Simulation(case, after=the_pass_before)"])


def read_result(path):
    """Open a result file, also one that is being written.

    Parameters
    ----------
    path : str or path-like

    Returns
    -------
    Result

    Raises
    ------
    OutputError
        Missing, damaged, not a result file, or of a later format version.
    """
    return Result(open_result(path), path)


def solve(case, output=None, options=None, comm=None, *, restart=None, overwrite=False, progress=None):
    """Solve a case.

    Parameters
    ----------
    case : case.loading.Case, or an argument of `load`
    output : path-like, optional
        Result file; by default the result is only in memory.
    options : dict, optional
        PETSc options without the dash, ``{"snes_max_it": 50, "snes_monitor": None}``, for this call; they
        override those of the case and of PETSC_OPTIONS.
    comm : mpi4py communicator, optional
        Ranks of the solution, each of which calls this function and gets the result; by default this process
        alone.
    restart : path-like, optional
        Restart file to continue from.
    overwrite : bool
        Whether to replace any existing file `output`; otherwise only a complete result of the same case is
        replaced, and an unfinished run of it is continued from its restart file.
    progress : bool, optional
        Whether to show progress; by default on a terminal and in a notebook.

    Returns
    -------
    Result

    Raises
    ------
    CaseError
        The case is faulty; the message lists all faults.
    NotConverged
        Its `state` is the last accepted state, which with `output` is also in the restart file.
    UsageError, OutputError
        An impossible option, a file that cannot be read or written.
    KeyboardInterrupt
        Ctrl-C, after the current time step; with `output` the same call continues.

    Examples
    --------
    >>> import ehlpetsc
    >>> result = ehlpetsc.solve("cases/dry_hertz.toml")
    >>> print(f"{result.pressure.max() / result.attrs['p0']:.2f} p0 on {len(result.x)} nodes")
    1.00 p0 on 1001 nodes
    """
    need_solver()
    from ehlpetsc.run.outputs.progress import ProgressOutput, in_notebook, on_terminal
    from ehlpetsc.run.outputs.recorder import Recorder
    from ehlpetsc.run.simulation import Simulation
    from ehlpetsc.run.solve import solve as hand_to
    from ehlpetsc.run.stop import StopRequest

    simulation = Simulation(case, comm, options)
    refuse_passes(simulation.case)
    if progress is None:
        progress = on_terminal(sys.stdout) or in_notebook()
    recorder = Recorder(simulation, output)
    with simulation.options, recorder:
        restart = recorder.lock_output(restart, overwrite)
        if restart is not None:
            recorder.resume(restart)
        shown = [ProgressOutput(simulation, sys.stdout)] if progress and simulation.comm.rank == 0 else []
        with StopRequest.on_interrupt() as stop:
            status, failure = hand_to(simulation, [recorder, *shown], stop)
    if failure:
        raise failure
    if status is ExitStatus.STOPPED:
        raise KeyboardInterrupt(_place_of_stop(simulation, recorder))
    if output is None:
        return Result(h5py.File(io.BytesIO(recorder.to_bytes()), "r"), Path("memory.h5"))
    return read_result(output)


def _place_of_stop(simulation, recorder):
    if simulation.solution is None:
        return "stopped during the steady start; nothing to continue from"
    advice = f"; the same call continues from {recorder.restart}" if recorder.output else ""
    return f"stopped at step {simulation.solution.step}{advice}"


def need_solver():
    """Find Debian's PETSc; ImportError with advice if a package is missing."""
    missing = environment.prepare()
    if missing:
        raise ImportError(environment.advice(missing, []))
