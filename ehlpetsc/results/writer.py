"""Writing result files, on rank 0.

The file is written in HDF5's single-writer/multiple-reader mode: all datasets exist from the start, rows are
appended in batches, and ``time`` is written after everything else, so that it vouches for the rows before
it. A reader can therefore open a running job's file, and a killed job leaves one that is whole up to its
last flush.
"""

import contextlib
import os
import time as clock
from pathlib import Path

import numpy as np

from ehlpetsc.errors import OutputError
from ehlpetsc.quantities import FIELDS, STEP_SCALARS, of_every_case
from ehlpetsc.results.datasets import close, create, extend, lay_out, room
from ehlpetsc.results.provenance import earlier_runs, git_commit, versions
from ehlpetsc.results.reader import FORMAT_VERSION, Result, read_result
from ehlpetsc.results.restart_file import load_restart, plain_reason, save_restart

__all__ = [
    "FORMAT_VERSION",
    "OutputError",
    "Result",
    "ResultWriter",
    "load_restart",
    "read_result",
    "save_restart",
]

BATCH_STEPS = 1024  # most steps held in memory
BATCH_BYTES = 2**20  # most of one field held in memory
FLUSH_SECONDS = 2.0


class ResultWriter:
    """Result file of one run.

    A new file is made beside `path` and takes its name once it is complete in structure, so that an older
    result is not lost to a run that fails at its start.

    Parameters
    ----------
    path : str, path-like or None
        None: in memory, for :meth:`image`.
    case_text, title : str
        The case as run, and its title.
    x : ndarray, shape (nx,)
        Nodes [m].
    scalars_attrs : dict
        Root attributes: a, p0, h_scale, u1, u2, ranks, petsc_options ...; ``versions`` may be a dict of more
        versions to name.
    fields : list of str
        Fields to store in a frame, keys of `ehlpetsc.quantities.FIELDS`.
    every : int
        Steps between stored frames.
    precision : {"float64", "float32"}
        Type of the stored fields.
    profiles : dict
        ``{"fast": (s, z, speed) or None, "slow": ...}``; a fourth item may hold attributes (ra, rq, rsk).
    figures : list of str, optional
        Per-step figures, keys of `ehlpetsc.quantities.STEP_SCALARS`; by default those that every case has.
    resume_step : int, optional
        Go on with the file at `path` after this step: what lies beyond is dropped. The file is copied, which
        also repairs one left by a killed run, and replaced when the copy is whole. Without a file at `path` a
        new one begins after that step.
    contact_count : ndarray, shape (nx,), optional
        Steps in contact up to `resume_step`; needed if the file has gone beyond it.

    Raises
    ------
    OutputError
        The file cannot be written, or the one to resume does not fit the run.
    """

    def __init__(
        self,
        path,
        *,
        case_text,
        title,
        x,
        scalars_attrs,
        fields,
        every,
        precision,
        profiles,
        figures=None,
        resume_step=None,
        contact_count=None,
    ):
        self.path = None if path is None else Path(path)
        self.every = every
        self.contact_count = np.zeros(len(x), dtype="i8")
        self.last_step = resume_step
        if contact_count is not None:
            self.contact_count[:] = contact_count
        beside = self.path and self.path.with_name(self.path.name + ".tmp")
        try:
            with self._plain_faults("not created"):
                self._file = create(beside)
                with room(self._file, sum(8 * len(p[0]) * 2 for p in profiles.values() if p)):
                    self._root_attributes(case_text, title, dict(scalars_attrs))
                    lay_out(
                        self._file, x, fields, figures or of_every_case(STEP_SCALARS), precision, profiles
                    )
                if beside:
                    if resume_step is not None and self.path.exists():
                        self._copy_up_to(resume_step, contact_count is None)
                    self._file.swmr_mode = True
                    self._file.flush()
                    os.replace(beside, self.path)
        except OutputError:
            with contextlib.suppress(OSError):
                beside.unlink()
            raise
        self._start_batch()

    def append(self, step, time, fields, scalars, in_contact, frame=None):
        """Take an accepted time step.

        Parameters
        ----------
        step : int
            Number of the step.
        time : float
            Time at its end [s].
        fields : dict of str to ndarray, shape (nx,)
            At least the fields to be stored.
        scalars : dict of str to number
            Per-step scalars, keys of `ehlpetsc.quantities.STEP_SCALARS`; those left out become
            nan, counts 0.
        in_contact : ndarray of bool, shape (nx,)
        frame : bool, optional
            Whether to store the fields; by default if `every` divides the step.

        Raises
        ------
        OutputError
            The disk is full, or the file cannot be written for another reason.
        """
        self.contact_count += in_contact
        row, self._steps_held = self._steps_held, self._steps_held + 1
        self._times[row] = time
        for name, column in self._columns.items():
            column[row] = scalars.get(name, 0 if column.dtype.kind == "i" else np.nan)
        self._columns["step"][row] = step
        if step % self.every == 0 if frame is None else frame:
            self._hold_frame(step, time, fields, in_contact)
        self.last_step = step
        full = self._steps_held == BATCH_STEPS or self._frames_held == len(self._frame_times)
        if full or clock.monotonic() - self._flushed > FLUSH_SECONDS:
            self.flush()

    def flush(self):
        """Hand everything taken so far to the operating system; afterwards a kill does not lose it."""
        self._check_still_there()
        with self._plain_faults("not written on"), room(self._file, self._bytes_held()):
            steps, frames = slice(self._steps_held), slice(self._frames_held)
            for name, column in self._columns.items():
                extend(self._file[f"steps/{name}"], column[steps])
            for name, held in self._frames.items():
                extend(self._file[name], held[frames])
            extend(self._file["step"], self._frame_steps[frames])
            self._file["contact_count"][:] = self.contact_count
            self._file.flush()
            extend(self._file["steps/time"], self._times[steps])
            extend(self._file["time"], self._frame_times[frames])
        self._written_step = self.last_step
        self._start_batch()

    def close(self, status):
        """Write what is left, note how the run ended ("done", "stopped", "not converged") and close."""
        if not self._file:
            return
        self.flush()
        with self._plain_faults("not closed"):
            close(self._file, status)

    def _check_still_there(self):
        """The file of that name must be the one that is written."""
        if self.path is None:
            return
        with contextlib.suppress(OSError):
            if os.path.samestat(os.stat(self.path), os.fstat(self._file.id.get_vfd_handle())):
                return
        with contextlib.suppress(Exception):
            close(self._file, "stopped")
        raise OutputError(f"{self.path}: result file removed or replaced by others during the run")

    def image(self):
        """The bytes of a file in memory, once it is closed."""
        self._file.flush()
        return self._file.id.get_file_image()

    @contextlib.contextmanager
    def _plain_faults(self, what):
        try:
            yield
        except (OSError, RuntimeError) as error:
            whole = getattr(self, "_written_step", None)
            with contextlib.suppress(Exception):  # the fault at hand is the one to tell
                close(self._file, "stopped")
            kept = "" if whole is None else f"; the file is whole up to step {whole}"
            raise OutputError(f"{self.path}: result file {what}, {plain_reason(error)}{kept}") from error

    def _root_attributes(self, case_text, title, more):
        attrs = {
            "format_version": FORMAT_VERSION,
            "title": title,
            "case": case_text,
            "versions": versions(more.pop("versions", {})),
            "git_commit": git_commit(),
            "restarts": 0,
            "history": "[]",
            "status": "running",
        }
        for key, value in (attrs | more).items():
            self._file.attrs[key] = value

    def _copy_up_to(self, step, count_from_file):
        with read_result(self.path) as old:
            self._check_fits(old, step, count_from_file)
            frames = np.count_nonzero(old.step <= step)
            steps = np.count_nonzero(old.steps("step") <= step)
            for name in [*self._frame_fields(), "step", "time"]:
                self._copy_rows(old, name, frames)
            for name in self._file["steps"]:
                self._copy_rows(old, f"steps/{name}", steps)
            if count_from_file:
                self.contact_count[:] = old.contact_count
            self._file["contact_count"][:] = self.contact_count
            self._file.attrs["restarts"] = int(old.attrs["restarts"]) + 1
            self._file.attrs["history"] = earlier_runs(old.attrs, step)
        self._written_step = step

    def _copy_rows(self, old, name, rows):
        for begin in range(0, rows, BATCH_STEPS):
            block = old[name][begin : min(begin + BATCH_STEPS, rows)]
            with room(self._file, block.nbytes):
                extend(self._file[name], block)

    def _check_fits(self, old, step, count_from_file):
        """Refuse to go on with a file that is not an earlier part of the same run."""
        last = max(old.steps("step"), default=None)
        fault = None
        if not np.array_equal(old.x, self._file["x"][:]):
            fault = "it was computed on another mesh"
        elif set(old.fields) != set(self._frame_fields()):
            fault = f"it stores other fields ({', '.join(old.fields)})"
        elif set(old.figures) != set(self._file["steps"]):
            fault = f"it stores other figures of its steps ({', '.join(old.figures)})"
        elif last is not None and last < step:  # None: stopped before its first step
            fault = f"it ends at step {last}, before step {step} of the restart file"
        elif count_from_file and last is not None and last > step:
            fault = f"it goes on to step {last} and the contacts up to step {step} are not known"
        if fault:
            self._file.close()
            raise OutputError(f"{self.path}: cannot be continued, {fault}; give another -ehl_output")

    def _frame_fields(self):
        return [name for name in FIELDS if name in self._file]

    def _bytes_held(self):
        frames = sum(held.itemsize * held.shape[1] for held in self._frames.values())
        return frames * self._frames_held + 8 * (len(self._columns) + 3) * self._steps_held

    def _start_batch(self):
        """Empty the memory that holds steps and frames between flushes."""
        if not hasattr(self, "_columns"):
            self._times = np.empty(BATCH_STEPS)
            figures = {n: d for n, d in self._file["steps"].items() if n != "time"}
            self._columns = {n: np.empty(BATCH_STEPS, dtype=d.dtype) for n, d in figures.items()}
            datasets = {n: self._file[n] for n in self._frame_fields()}
            frames = max(1, BATCH_BYTES // (8 * len(self.contact_count)))
            self._frames = {n: np.empty((frames, d.shape[1]), d.dtype) for n, d in datasets.items()}
            self._frame_times, self._frame_steps = np.empty(frames), np.empty(frames, dtype="i8")
        self._steps_held = self._frames_held = 0
        self._flushed = clock.monotonic()

    def _hold_frame(self, step, time, fields, in_contact):
        row, self._frames_held = self._frames_held, self._frames_held + 1
        self._frame_times[row], self._frame_steps[row] = time, step
        for name, held in self._frames.items():
            held[row] = in_contact if name == "in_contact" else fields[name]
