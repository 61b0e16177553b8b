"""Progress and summary of a run, on rank 0."""

from __future__ import annotations

import contextlib
import json
import sys
import time as clock
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

import mpi4py
import numpy as np
import petsc4py
from mpi4py import MPI
from petsc4py import PETSc

from ehlpetsc.base.case import KINDS
from ehlpetsc.base.command_line import SECONDS_IN_PLACE, ProgressLine, duration, in_notebook, on_terminal
from ehlpetsc.base.counts import whole_down
from ehlpetsc.base.errors import ExitStatus, OutputError, OutputLost
from ehlpetsc.base.quantities import FIELDS, STEP_SCALARS, of_case
from ehlpetsc.nonlinear.options import WRITING
from ehlpetsc.results.means import Totals
from ehlpetsc.results.output_guard import OVERWRITE_ADVICE, Lock, check_output_path, file_path, inputs_of
from ehlpetsc.results.writer import Layout, ResultWriter, StoredSurface
from ehlpetsc.run import checkpoint
from ehlpetsc.run.forecast.limits import limits
from ehlpetsc.run.ranks import Deadline, on_root

if TYPE_CHECKING:
    from ehlpetsc.run.simulation import AcceptedState, Simulation


SECONDS_BETWEEN_LINES = 5.0
MIN_RATE_TIME = 1.0  # s after the first step, which includes compilation, before a remaining time is shown


class Output:
    """Observer of a run, which receives every accepted state."""

    def write(self, state: AcceptedState) -> None:
        """Receive a state."""

    def close(self, status: ExitStatus) -> None:
        """End with the run."""


class Progress(Output):
    """Output that shows the steps of a simulation: a line every five seconds, on a terminal one in place."""

    def __init__(self, simulation: Simulation, stream: TextIO | None = None) -> None:
        self._simulation, self._stream = simulation, stream or sys.stdout
        self._in_place = on_terminal(self._stream) or in_notebook()
        self._begun = simulation.dimensionless is not None
        self._samples: list[tuple[float, float]] = []  # wall clock, time of the run, since the first step
        self._shown: float | None = None
        self._pending: dict[str, float] | None = None
        self._ramp = ProgressLine("roughness put under the film", 1.0, self._stream)
        simulation.stepper.show_ramp(self._ramp.reach)

    def write(self, state: AcceptedState) -> None:
        """Show a step, but not the steady start, if it is the first or enough time has passed."""
        self._ramp.clear()
        if not self._begun:
            self._begun = True
            return
        now, self._pending = clock.monotonic(), state.scalars
        wait = SECONDS_IN_PLACE if self._in_place else SECONDS_BETWEEN_LINES
        if self._shown is None or now - self._shown >= wait:
            self._show(now)

    def close(self, status: ExitStatus) -> None:
        """Show the last step if it has not been shown."""
        self._ramp.clear()
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


class Recorder(Output):
    """Output that stores the accepted states of a simulation.

    The restart file is written every few minutes, at a stop, and where the result is lost.

    `output`: result file; the restart file is named after it. None: in memory, without a restart file.

    `totals`: totals of all steps so far. `limits`: messages of
    :func:`ehlpetsc.run.forecast.limits.limits`, on rank 0, set by :meth:`close`. `restart`: restart file.
    """

    def __init__(self, simulation: Simulation, output: Path | None) -> None:
        self.simulation, self.comm = simulation, simulation.comm
        self.output: Any = None if output is None else file_path(output)
        self.restart = self.output and self.output.with_name(f"{self.output.stem}.restart.h5")
        self.totals = Totals()
        self.limits: list[str] = []
        self._boundary_friction = 0.0  # maximum so far, which effects may change
        self._lock: Lock | None = None
        self._writer: Any = None  # a ResultWriter, on rank 0
        self._continues = True  # a file at the path of the result, if any, after a restart
        self._is_open, self._next_save = False, Deadline(simulation.case.output.checkpoint)

    def __enter__(self) -> Recorder:
        return self

    def __exit__(self, kind: type | None, *_: object) -> None:
        try:
            if kind and self._writer:  # without communication: only this rank may have failed
                self._writer.close(ExitStatus.STOPPED.words)
        finally:
            if self._lock:
                self._lock.release()

    def lock_output(self, restart: Path | None = None, overwrite: bool = False) -> Path | None:
        """Check before the run that the result can be written, and lock it until the end.

        Returns the restart file to resume from: `restart`, otherwise that of an unfinished run of the same
        case. An OutputError if existing files may not be replaced and not `overwrite`.
        """
        return on_root(self.comm, self._lock_files, restart, overwrite) if self.output else restart

    def _lock_files(self, restart: Path | None, overwrite: bool) -> Path | None:
        case, inputs = self.simulation.case, inputs_of(self.simulation.case)
        check_output_path(self.output, [*inputs, Path(restart)] if restart else inputs)
        check_output_path(self.restart, inputs)
        if restart and self.output.exists():
            self._continues = checkpoint.is_earlier_part(self.output, restart)
        if not (self._continues or overwrite):
            raise OutputError(f"{self.output}: no earlier part of the run of {restart}; {OVERWRITE_ADVICE}")
        if case.output.xdmf and self.output.suffix == ".xdmf":
            raise OutputError(f"{self.output}: output.xdmf = true writes this file too; give another -o")
        self._lock = Lock(self.output)
        self._lock.acquire()
        return (
            restart if restart or overwrite else checkpoint.restart_of_same(self.output, self.restart, case)
        )

    def resume(self, path: Path) -> list[str]:
        """Set the simulation to the state of a restart file and continue its result; notes for the user."""
        stored, notes = checkpoint.load(path, self.simulation.case, self.simulation.scales)
        state = stored.state
        self.simulation.resume(state, stored.baseline)
        self.totals = Totals(stored.totals)
        self._open(state.step, stored.contact_count)
        return [f"{path}, step {state.step}, {1e6 * state.time:.4f} us", *notes]

    def write(self, state: AcceptedState) -> None:
        """Store an accepted state; write the restart file if it is due."""
        if not self._is_open:
            self._open()
        self.totals.add(state.scalars)
        solved = self.simulation.dimensionless and self.simulation.dimensionless.solution
        if solved:
            friction = float(np.max(solved.inputs.boundary_friction))
            self._boundary_friction = max(self._boundary_friction, friction)
        with WRITING:
            on_root(self.comm, self._append, state)
        if state.step and self._next_save(self.comm):
            self.checkpoint()
            self._next_save = Deadline(self.simulation.case.output.checkpoint)

    def checkpoint(self) -> None:
        """Write the restart file, if any, for the last state."""
        if self.restart is not None:
            on_root(self.comm, self._save)

    def close(self, status: ExitStatus) -> None:
        """Write the remaining data and the status of the run, and the restart file of an unfinished run.

        A pass that is continued by the next one also leaves a restart file.
        """
        time = self.simulation.case.time
        if not self._is_open:
            return
        if status is not ExitStatus.DONE or time is not None and time.passes > 1:
            self.checkpoint()
        with self._kept_if_lost():
            on_root(self.comm, self._close, status)

    def to_bytes(self) -> bytes:
        """The bytes of a result in memory, on every rank."""
        return self.comm.bcast(self._writer.to_bytes() if self.comm.rank == 0 else b"")

    def _open(self, step: int | None = None, contact_count: np.ndarray | None = None) -> None:
        """Create the result; after a restart, continue it after `step` with its contact counts."""
        on_root(self.comm, self._create, step, contact_count)
        self._is_open = True

    def _create(self, step: int | None, count: np.ndarray | None) -> None:
        case, scales = self.simulation.case, self.simulation.scales
        stored = of_case(FIELDS, case)
        attributes = {name: getattr(scales, name) for name in ("a", "b", "p0", "u1", "u2")}
        attributes |= {
            "title": case.title,
            "case": case.text,
            "digests": json.dumps(case.digests),
            "h_scale": scales.h,
            "ranks": self.comm.size,
            "petsc_options": " ".join(
                f"-{k} {v or ''}".strip() for k, v in self.simulation.options.values.items()
            ),
            "versions": libraries(),
        }
        self._surfaces = stored_surfaces(self.simulation)
        layout = Layout(
            x=scales.x * scales.a,
            fields=[name for name in case.output.fields if name in stored],
            scalars=of_case(STEP_SCALARS, case),
            precision=case.output.precision,
            surfaces=self._surfaces,
            y=scales.grid.axes[0] * scales.a if len(scales.grid.axes) > 1 else None,
            kind=case.kind,
        )
        before = step if self._continues else None
        self._writer = ResultWriter(self.output, layout, attributes, resume_step=before, contact_count=count)

    def _append(self, state: AcceptedState) -> None:
        every, steady = self.simulation.case.output.every, self.simulation.case.time is None
        frame = every == 1 or steady or self._passes_frame(float(state.time), float(state.dt), every)
        with self._kept_if_lost():
            self._writer.append(state.step, state.time, state.fields, state.scalars, state.in_contact, frame)

    def _passes_frame(self, time: float, dt: float, every: int) -> bool:
        """Whether a step of `dt` to a time [s] ends on or passes one of every so many time levels."""
        if not dt > 0.0:  # the state at time 0
            return True
        before, after = (
            self.simulation.operation.level(t, self.simulation.scales.dt) for t in (time - dt, time)
        )
        return whole_down(after / every) > whole_down(before / every)

    def _close(self, status: ExitStatus) -> None:
        simulation, surfaces = self.simulation, self._surfaces
        points = tuple(surfaces[side].s if side in surfaces else None for side in ("1", "2"))
        for effect in simulation.stepper.effects:
            record = simulation.dimensionless.records[effect.name]
            for name, pair in effect.on_surfaces(record, points).items():
                for side, depth in zip(("1", "2"), pair, strict=True):
                    if depth is not None:
                        self._writer.put_depth(side, name, depth)
        self.totals = Totals(self.totals.values, self._writer.means(simulation.case))
        figures = self.totals.values | self.totals.means
        friction = max(self._boundary_friction, simulation.case.contact.boundary_friction)
        self.limits = limits(simulation.case, simulation.scales, simulation.roughness, figures, friction)
        self._writer.close(status.words, self.limits)
        if simulation.case.output.xdmf and self.output:
            from ehlpetsc.results.exports import write_xdmf

            write_xdmf(self.output)

    @contextlib.contextmanager
    def _kept_if_lost(self) -> Iterator[None]:
        """Write the restart file if the result is lost meanwhile: what is computed can be continued."""
        try:
            yield
        except OutputLost:
            if self.comm.rank == 0:
                with contextlib.suppress(OutputError):  # the folder may be lost too
                    self._save_state()
            raise

    def _save(self) -> None:
        with self._kept_if_lost():
            self._writer.flush()
        self._save_state()

    def _save_state(self) -> None:
        checkpoint.save(self.restart, self.simulation, self._writer.contact_count, self.totals.values)


def libraries() -> dict[str, str]:
    """Versions of the numerical libraries by name, for the result file."""
    petsc = ".".join(map(str, PETSc.Sys.getVersion()))
    mpi = MPI.Get_library_version().split(",")[0].rstrip("\0")
    return {"petsc": petsc, "petsc4py": petsc4py.__version__, "mpi4py": mpi4py.__version__, "mpi": mpi}


def stored_surfaces(simulation: Simulation) -> dict[str, StoredSurface]:
    """Rough surfaces, and the points of smooth ones that pass the mesh where effects have depths, by side."""
    depths = [name for effect in simulation.stepper.effects for name in effect.surface]
    rough, scales = simulation.roughness, simulation.scales
    surfaces = {}
    for side, speed, extent in zip("12", (scales.u1, scales.u2), simulation.operation.extent(), strict=True):
        profile = rough and rough.side(side)
        if profile:
            surfaces[side] = StoredSurface(profile.s, profile.z, speed, profile.statistics, depths)
        elif depths:
            ends = scales.x[[0, -1]] * scales.a
            s = np.arange(ends[0] - extent[1], ends[1] - extent[0], scales.spacing)
            smooth = np.zeros((*scales.grid.shape[:-1], len(s)))
            letter = KINDS[simulation.case.kind].mean_height[0].lower()
            flat = dict.fromkeys((f"{letter}a", f"{letter}q", f"{letter}sk"), 0.0)
            surfaces[side] = StoredSurface(s, smooth, speed, flat, depths)
    return surfaces
