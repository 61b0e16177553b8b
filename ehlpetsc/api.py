"""The Python interface: ``ehlpetsc.solve`` and ``read_result``.

Nothing heavy is imported before it is needed: a result is read and drawn without PETSc and MPI.
"""

from __future__ import annotations

import io
import sys
from collections.abc import Iterable, Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

import h5py

from ehlpetsc.base.environment import need_solver
from ehlpetsc.base.errors import CaseError, ExitStatus, UsageError
from ehlpetsc.results import reader
from ehlpetsc.results.output_guard import PICTURES, check_derived, file_path
from ehlpetsc.results.reader import Section, open_result

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from mpi4py import MPI

    from ehlpetsc.case.tables import Case
    from ehlpetsc.effects.effect import Effect
    from ehlpetsc.physics.oil.law import Law

__all__ = ["Result", "read_result", "solve"]


class Result(reader.Result):
    """Result from a file or in memory, see :class:`ehlpetsc.results.reader.Result`."""

    def plot(
        self,
        path: str | PathLike | None = None,
        step: int | None = None,
        time: float | None = None,
        window: tuple[float, float] | None = None,
        field: str | None = None,
    ) -> Figure:
        """Pressure and film over x/a at the frame nearest to a step or a time [s], contacts marked.

        Of a point contact or strip maps and sections; of a rough line contact the deformed surfaces too.

        Parameters
        ----------
        path
            Picture that is also written, replaced if it exists: ``"film.png"``, ``.svg``, ``.pdf`` ...
        step, time
            By default the frame of :func:`ehlpetsc.pictures.frames.choice.frame_to_show`.
        window
            Limits of x/a.
        field
            Name of a stored field to draw instead of the film.

        Raises
        ------
        UsageError, OutputError
            `path` is no name, not that of a picture, or cannot be written.

        Examples
        --------
        >>> import ehlpetsc
        >>> figure = ehlpetsc.solve("cases/dry_hertz.toml").plot(window=(-1.2, 1.2))
        >>> [axes.get_ylabel() for axes in figure.axes]
        ['pressure [GPa]', 'gap [µm]']
        """
        from ehlpetsc.pictures import style
        from ehlpetsc.pictures.frames import choice as frames

        if path is not None:
            if not isinstance(path, str | PathLike):
                raise UsageError(
                    f"plot: path = {path!r}: allowed: the name of a picture; a step is step={path!r}"
                )
            check_derived(file_path(path), [self.path], PICTURES, "plot")
        from matplotlib import pyplot

        indices, limits = frames.choose_frames([self], step, time), frames.view([self], window)
        choice = frames.Choice([self], indices, limits, field)
        figure = choice.draw(pyplot.figure(layout="constrained"))
        if path is not None:
            style.save(figure, file_path(path))
        return figure

    def section(self, y: float = 0.0) -> Result:
        """Section as that of :class:`ehlpetsc.results.reader.Result`, with :meth:`plot`."""
        return DrawnSection(self, y)


class DrawnSection(Section, Result):
    """Section of a result, see :class:`ehlpetsc.results.reader.Section`."""


def read_result(path: str | PathLike) -> Result:
    """Open a result file, also one that is being written; OutputError if it cannot be read as one."""
    return Result(open_result(Path(path)), Path(path))


def solve(
    case: Case | dict | str | PathLike,
    output: str | PathLike | None = None,
    options: dict | None = None,
    comm: MPI.Comm | None = None,
    *,
    restart: str | PathLike | None = None,
    overwrite: bool = False,
    progress: bool | None = None,
    laws: Mapping[str, Law] | None = None,
    density_laws: Mapping[str, Law] | None = None,
    shear_laws: Mapping[str, Law] | None = None,
    effects: Iterable[type[Effect]] = (),
) -> Result:
    """Solve a case.

    Parameters
    ----------
    case
        Case, or an argument of `ehlpetsc.load`.
    output
        Result file; by default the result is only in memory.
    options
        PETSc options without the dash, ``{"snes_max_it": 50, "snes_monitor": None}``, for this call; they
        override those of the case and of PETSC_OPTIONS.
    comm
        Ranks of the solution, each of which calls this function and gets the result; by default this process
        alone.
    restart
        Restart file to continue from.
    overwrite
        Whether to replace any existing file `output`; otherwise only a complete result of the same case is
        replaced, and an unfinished run of it is continued from its restart file.
    progress
        Whether to show progress; by default on a terminal and in a notebook.
    laws, density_laws, shear_laws, effects
        As of `ehlpetsc.load`.

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
    from ehlpetsc.base.command_line import in_notebook, on_terminal
    from ehlpetsc.case.tables import extend
    from ehlpetsc.run.ranks import StopRequest
    from ehlpetsc.run.recorder import Progress, Recorder
    from ehlpetsc.run.simulation import Simulation
    from ehlpetsc.run.solve import place_of_stop
    from ehlpetsc.run.solve import solve as write_states

    extend(laws, density_laws, effects, shear_laws)
    simulation = Simulation(case, comm, options)
    time = simulation.case.time
    if time is not None and time.passes > 1:
        passes = f"{simulation.case.path}: time.passes = {time.passes}: solve one after the other"
        raise CaseError([f"{passes}, ehlpetsc.Simulation(case, after=the_pass_before)"])
    progress = on_terminal(sys.stdout) or in_notebook() if progress is None else progress
    recorder = Recorder(simulation, None if output is None else Path(output))
    with recorder:
        if begun := recorder.lock_output(None if restart is None else Path(restart), overwrite):
            recorder.resume(begun)
        shown = [Progress(simulation)] if progress and simulation.comm.rank == 0 else []
        with StopRequest.on_interrupt() as stop:
            status, failure = write_states(simulation, [recorder, *shown], stop)
    if failure:
        raise failure
    if status is ExitStatus.STOPPED:
        raise KeyboardInterrupt(place_of_stop(simulation, recorder))
    if output is None:
        return Result(h5py.File(io.BytesIO(recorder.to_bytes()), "r"), Path("memory.h5"))
    return read_result(output)
