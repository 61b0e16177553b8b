"""What is kept of a run: result file, restart file, totals. Rank 0 alone writes files."""

import contextlib
import time as clock
from pathlib import Path

import mpi4py
import numpy as np
import petsc4py
from mpi4py import MPI
from petsc4py import PETSc

from ehlpetsc.errors import ExitStatus, OutputError
from ehlpetsc.nonlinear import events
from ehlpetsc.quantities import FIELDS, STEP_SCALARS, of_case
from ehlpetsc.results.hdf5.datasets import Layout
from ehlpetsc.results.output_guard import Lock, check_place, check_replaceable, inputs_of
from ehlpetsc.results.totals import Totals
from ehlpetsc.results.whole_file import remove_left
from ehlpetsc.results.writer import ResultWriter
from ehlpetsc.run.limits import limits
from ehlpetsc.run.restart import checkpoint
from ehlpetsc.run.restart.way_on import way_on
from ehlpetsc.run.stored_surfaces import body_depths, profiles
from ehlpetsc.stepping.step_control import on_level

MESSAGE_BYTES = 2**30  # MPI counts to twice as many


def on_root(comm, action, *arguments):
    """What `action` returns on rank 0, None on the others; its OutputError is raised on every rank."""
    answer = fault = None
    if comm.rank == 0:
        try:
            answer = action(*arguments)
        except OutputError as error:
            fault = str(error)
    fault = comm.bcast(fault)
    if fault:
        raise OutputError(fault)
    return answer


class Recorder:
    """Keeps a simulation's accepted states.

    Parameters
    ----------
    simulation : run.simulation.Simulation
    output : path-like or None
        Result file; the restart file gets its name too. None: in memory, without a restart file.

    Attributes
    ----------
    totals : results.totals.Totals
    restart : Path
        Restart file.
    limits : list of str
        Limits of the physics that the run went beyond, known on rank 0 once it is closed.
    """

    def __init__(self, simulation, output):
        self.simulation, self.comm = simulation, simulation.comm
        self.output = None if output is None else Path(output)
        self.restart = self.output and self.output.parent / f"{self.output.stem}.restart.h5"
        self.totals, self.limits = Totals(), []
        self._writer, self._opened, self._lock = None, False, None
        self._saved, self._stored = clock.monotonic(), None

    def __enter__(self):
        return self

    def __exit__(self, kind, *_):
        try:
            if kind and self._writer:  # no agreement with other ranks: they may not know of the error
                self._writer.close(ExitStatus.STOPPED.words)
        finally:
            if self._lock:
                self._lock.give_back()

    def reserve(self, restart=None, overwrite=False):
        """Make sure, before anything is computed, that the result may be written; lock it until the end.

        Parameters
        ----------
        restart : path-like, optional
            Restart file to go on from: the result is then continued.
        overwrite : bool
            Whether whatever stands there may be replaced.

        Raises
        ------
        OutputError
        """
        if self.output is not None:
            on_root(self.comm, self._reserve, restart, overwrite)

    def _reserve(self, restart, overwrite):
        case = self.simulation.case
        read = inputs_of(case)
        check_place(self.output, [*read, Path(restart)] if restart else read)
        check_place(self.restart, read)
        self._lock = Lock(self.output)
        self._lock.take()
        for path in (self.output, self.restart):
            remove_left(path)
        if not (restart or overwrite):
            check_replaceable(self.output, self.restart, case.text)

    def resume(self, path):
        """Put the simulation where a restart file was written, and go on with its result.

        Returns
        -------
        list of str
            What to know about it, one line each.
        """
        simulation, model = self.simulation, self.simulation.stepper.problem.model
        found, notes = checkpoint.load(path, simulation.case, simulation.scales, model)
        solution = found.state
        simulation.resume(solution, found.baseline, found.positions)
        self.totals = Totals(found.totals)
        self._open(solution.step, found.contact_count)
        self._note_stored()
        return [f"{path}, step {solution.step}, {1e6 * solution.time:.4f} us", *notes]

    def take(self, state):
        """Keep an accepted state.

        Parameters
        ----------
        state : run.accepted_state.AcceptedState
        """
        if not self._opened:
            self._open()
        with events.OUTPUT:
            on_root(self.comm, self._keeping, self._append, state)
        self.totals.add(state.figures)
        self._note_stored()
        due = clock.monotonic() - self._saved > 60.0 * self.simulation.case.output.checkpoint
        if state.step and self.comm.bcast(due):
            self.checkpoint()
            self._saved = clock.monotonic()

    def checkpoint(self):
        """Write the restart file, where there is one."""
        if self.restart is None:
            return
        on_root(self.comm, self._keeping, self._save)

    def close(self, status):
        """Write what is left and note how the run ended.

        Parameters
        ----------
        status : errors.ExitStatus
        """
        if self._opened:
            on_root(self.comm, self._keeping, self._close, status)

    def image(self):
        """The bytes of a result in memory, on every rank."""
        image = self._writer.image() if self.comm.rank == 0 else None
        if self.comm.size == 1:
            return image
        size = self.comm.bcast(image and len(image))
        whole = np.frombuffer(image, "u1") if image else np.empty(size, "u1")
        for begin in range(0, size, MESSAGE_BYTES):
            self.comm.Bcast(whole[begin : begin + MESSAGE_BYTES])
        return whole.tobytes()

    def _open(self, step=None, count=None):
        on_root(self.comm, self._create, step, count)
        self._opened = True

    def _append(self, state):
        every, steady = self.simulation.case.output.every, self.simulation.case.time is None
        frame = every == 1 or steady or on_level(self.simulation.level(state.time), every)
        self._writer.append(state.step, state.time, state.fields, state.figures, state.in_contact, frame)

    def _keeping(self, action, *arguments):
        """Do what writes; where it cannot, save the last state stored, if that goes, and tell the way on."""
        try:
            action(*arguments)
        except OutputError as error:
            step = self._stored and self._stored.state.step
            with contextlib.suppress(OutputError):
                if self._stored:
                    self._save_restart(self._stored)
            raise OutputError(f"{error}; {way_on(self.restart, self.simulation.case, step)}") from error

    def _note_stored(self):
        """Remember a state to go on from that the result file on rank 0 holds with all before it."""
        state, known = self.simulation.solution, self._writer and self.restart and self.simulation.case.time
        if known and self._writer.written == (state.step, state.time):
            self._stored = self._now()

    def _now(self):
        count, totals = self._writer.contact_count.copy(), dict(self.totals.values)
        return checkpoint.Checkpoint.of(self.simulation, count, totals)

    def _save(self):
        self._writer.flush()
        self._note_stored()
        self._save_restart(self._now())

    def _save_restart(self, state):
        simulation = self.simulation
        model = simulation.stepper.problem.model
        checkpoint.save(self.restart, state, simulation.case, simulation.scales, model)

    def _close(self, status):
        simulation = self.simulation
        for side, name, depth in body_depths(simulation):
            self._writer.put_depth(side, name, depth)
        self.limits = limits(simulation.case, simulation.scales, simulation.roughness, self.totals.values)
        self._writer.close(status.words, self.limits)

    def _create(self, step, count):
        case, scales = self.simulation.case, self.simulation.scales
        stored = of_case(FIELDS, case)
        attributes = {name: getattr(scales, name) for name in ("a", "p0", "u1", "u2")}
        attributes |= {
            "title": case.title,
            "case": case.text,
            "h_scale": scales.h,
            "ranks": self.comm.size,
            "petsc_options": " ".join(f"-{k} {v or ''}".strip() for k, v in PETSc.Options().getAll().items()),
            "versions": libraries(),
        }
        layout = Layout(
            x=scales.x * scales.a,
            fields=[name for name in case.output.fields if name in stored],
            figures=of_case(STEP_SCALARS, case),
            precision=case.output.precision,
            profiles=profiles(self.simulation),
        )
        every = case.output.every
        self._writer = ResultWriter(
            self.output, layout, attributes, every, resume_step=step, contact_count=count
        )


def libraries():
    """Names and versions of what computes, for the result file."""
    petsc = ".".join(map(str, PETSc.Sys.getVersion()))
    mpi = MPI.Get_library_version().split(",")[0].rstrip("\0")
    return {"petsc": petsc, "petsc4py": petsc4py.__version__, "mpi4py": mpi4py.__version__, "mpi": mpi}
