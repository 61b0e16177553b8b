"""The result file as an output, written by rank 0."""

import mpi4py
import numpy as np
import petsc4py
from mpi4py import MPI
from petsc4py import PETSc

from ehlpetsc.nonlinear import events
from ehlpetsc.quantities import FIELDS, STEP_SCALARS, of_case
from ehlpetsc.results.hdf5.datasets import Layout
from ehlpetsc.results.writer import ResultWriter
from ehlpetsc.run.outputs.limits import limits
from ehlpetsc.run.outputs.stored_surfaces import body_depths, profiles
from ehlpetsc.run.ranks import on_root
from ehlpetsc.stepping.time_stepping import on_level

MESSAGE_BYTES = 2**30  # half of the largest count of MPI


class ResultFile:
    """Result file of a simulation, created with its first state.

    Parameters
    ----------
    simulation : run.simulation.Simulation
    path : Path or None
        None: in memory.
    totals : results.totals.Totals
        Totals of the run, for the limits of the model.

    Attributes
    ----------
    limits : list of str
        Messages of :func:`.limits.limits`, on rank 0, set by :meth:`close`.
    """

    def __init__(self, simulation, path, totals):
        self.simulation, self.comm, self.path, self.totals = simulation, simulation.comm, path, totals
        self.limits, self._writer, self.is_open = [], None, False

    def open(self, step=None, contact_count=None):
        """Create the file; after a restart, continue it after `step` with its contact counts."""
        on_root(self.comm, self._create, step, contact_count)
        self.is_open = True

    def write(self, state):
        """Append the step and, if it is due, a frame."""
        if not self.is_open:
            self.open()
        with events.OUTPUT:
            on_root(self.comm, self._append, state)

    def flush(self):
        """Write the buffered rows; on rank 0."""
        self._writer.flush()

    def close(self, status):
        """Write the remaining rows and the status of the run."""
        if self.is_open:
            on_root(self.comm, self._close, status)

    def abandon(self, status):
        """Close the file on this rank without communication, after an error of this rank."""
        if self._writer:
            self._writer.close(status.words)

    def to_bytes(self):
        """The bytes of a result in memory, on every rank."""
        content = self._writer.to_bytes() if self.comm.rank == 0 else None
        if self.comm.size == 1:
            return content
        size = self.comm.bcast(content and len(content))
        buffer = np.frombuffer(content, "u1") if content else np.empty(size, "u1")
        for begin in range(0, size, MESSAGE_BYTES):
            self.comm.Bcast(buffer[begin : begin + MESSAGE_BYTES])
        return buffer.tobytes()

    def contact_count(self):
        """Steps in contact of each node so far, on rank 0."""
        return self._writer.contact_count.copy()

    def holds(self, state):
        """Whether the file on rank 0 contains a state and all states before it."""
        return self._writer is not None and self._writer.written == (state.step, state.time)

    def _append(self, state):
        every, steady = self.simulation.case.output.every, self.simulation.case.time is None
        frame = every == 1 or steady or on_level(self.simulation.level(state.time), every)
        self._writer.append(state.step, state.time, state.fields, state.scalars, state.in_contact, frame)

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
            scalars=of_case(STEP_SCALARS, case),
            precision=case.output.precision,
            profiles=profiles(self.simulation),
        )
        every = case.output.every
        self._writer = ResultWriter(
            self.path, layout, attributes, every, resume_step=step, contact_count=count
        )


def libraries():
    """Names and versions of the numerical libraries, for the result file."""
    petsc = ".".join(map(str, PETSc.Sys.getVersion()))
    mpi = MPI.Get_library_version().split(",")[0].rstrip("\0")
    return {"petsc": petsc, "petsc4py": petsc4py.__version__, "mpi4py": mpi4py.__version__, "mpi": mpi}
