"""Writing of result files on rank 0.

The file is written in HDF5's single-writer/multiple-reader mode: all datasets exist from the start, rows are
appended in batches, and ``time`` is written last, so that rows with a time are complete. The file of a
running job can be opened, and the file of a killed job is complete up to its last flush.
"""

import contextlib
import os
import time as clock
from pathlib import Path

import numpy as np

from ehlpetsc.errors import OutputError
from ehlpetsc.results.atomic_write import os_reason, replacing
from ehlpetsc.results.hdf5.attributes import change, put
from ehlpetsc.results.hdf5.batch import Batch
from ehlpetsc.results.hdf5.continuation import copy_up_to
from ehlpetsc.results.hdf5.datasets import close, create, dataset_names, last_row, lay_out, room
from ehlpetsc.results.hdf5.opening import FORMAT_VERSION
from ehlpetsc.results.provenance import git_commit, versions

LIMITS_LENGTH = 2000  # characters reserved for the attribute "limits"
FLUSH_SECONDS = (
    2.0  # between two flushes, if steps are faster; a kill can lose this time and the current step
)


class ResultWriter:
    """Result file of one run.

    A new file is created under a temporary name and renamed when all datasets exist, so that a run that fails
    at its start does not destroy an older result.

    Parameters
    ----------
    path : str, path-like or None
        None: in memory, for :meth:`to_bytes`.
    layout : results.hdf5.datasets.Layout
        Datasets of the file.
    attributes : dict
        Root attributes: title and case (its text), a, p0, h_scale, u1, u2, ranks, petsc_options ...;
        ``versions`` is an optional dict of further versions.
    every : int
        Steps between stored frames.
    resume_step : int, optional
        Continue the file at `path` after this step; later steps are dropped. The file is copied, which
        also repairs a file left by a killed run, and replaced when the copy is complete. Without a file at
        `path` a new one begins after this step.
    contact_count : ndarray, shape (nx,), optional
        Steps in contact up to `resume_step`; required if the file contains later steps.

    Attributes
    ----------
    written : (int, float) or None
        Last complete step in the file and its time [s]; None: no step.

    Raises
    ------
    OutputError
        The file cannot be written, or the one to resume does not fit the run.
    """

    def __init__(self, path, layout, attributes, every=1, *, resume_step=None, contact_count=None):
        self.path = None if path is None else Path(path)
        self.every = every
        self.contact_count = np.zeros(len(layout.x), dtype="i8")
        self.written = None
        if contact_count is not None:
            self.contact_count[:] = contact_count
        replacement = contextlib.nullcontext() if path is None else replacing(self.path)
        with self._plain_faults("not created"), replacement as target:
            self._file = create(target)
            with room(self._file, sum(8 * len(p[0]) * 3 for p in layout.profiles.values() if p)):
                self._root_attributes(attributes)
                lay_out(self._file, layout)
                put(self._file, {"contents": " ".join(dataset_names(self._file))})
            if target:
                if resume_step is not None and self.path.exists():
                    self.contact_count[:] = copy_up_to(self._file, self.path, resume_step, contact_count)
                self._file.swmr_mode = True
                self._file.flush()
        self._last = self.written = last_row(self._file)
        self._batch, self._flushed = Batch(self._file, len(layout.x)), clock.monotonic()

    def append(self, step, time, fields, scalars, in_contact, frame=None):
        """Add an accepted time step to the buffer; write the buffer if it is full.

        Parameters
        ----------
        step : int
            Number of the step.
        time : float
            Time at its end [s].
        fields : dict of str to ndarray, shape (nx,)
            At least the fields to be stored.
        scalars : dict of str to number
            Scalars of the step, keys of `ehlpetsc.quantities.STEP_SCALARS`; missing scalars become nan,
            missing counts 0.
        in_contact : ndarray of bool, shape (nx,)
        frame : bool, optional
            Whether to store the fields; by default if the step is a multiple of `every`.

        Raises
        ------
        OutputError
            The disk is full, or the file cannot be written for another reason.
        """
        self.contact_count += in_contact
        self._batch.hold_step(step, time, scalars)
        if step % self.every == 0 if frame is None else frame:
            self._batch.hold_frame(step, time, fields, in_contact)
        self._last = (step, time)
        if self._batch.full or clock.monotonic() - self._flushed > FLUSH_SECONDS:
            self.flush()

    def flush(self):
        """Write all rows to the file; a killed process then does not lose them."""
        self._check_still_there()
        with self._plain_faults("not written on"), room(self._file, self._batch.size):
            self._batch.write(self.contact_count)
        self.written, self._flushed = self._last, clock.monotonic()

    def put_depth(self, side, name, depth):
        """Store a depth [m] of a surface, "1" or "2", at the points s of its profile."""
        with self._plain_faults("not written on"):
            self._file[f"surface/{side}/{name}"][:] = depth

    def close(self, status, limits=()):
        """Write the remaining rows, store the status and close.

        Parameters
        ----------
        status : str
            "done", "stopped", "not converged".
        limits : sequence of str
            Messages on results outside the validity of the model.
        """
        if not self._file:
            return
        self.flush()
        with self._plain_faults("not closed"):
            close(self._file, status, "\n".join(limits))

    def _check_still_there(self):
        """Refuse to continue if the file has been replaced or removed."""
        if self.path is None:
            return
        with contextlib.suppress(OSError):
            if os.path.samestat(os.stat(self.path), os.fstat(self._file.id.get_vfd_handle())):
                return
        self._close_after_a_fault()
        raise OutputError(f"{self.path}: result file removed or replaced by others during the run")

    def to_bytes(self):
        """Content of a closed file in memory."""
        self._file.flush()
        return self._file.id.get_file_image()

    @contextlib.contextmanager
    def _plain_faults(self, failure):
        try:
            yield
        except OutputError:
            self._close_after_a_fault()
            raise
        except (OSError, RuntimeError) as error:
            self._close_after_a_fault()
            content = f"; {self._content()}" if hasattr(self, "_batch") else ""
            raise OutputError(f"{self.path}: result file {failure}, {os_reason(error)}{content}") from error

    def _content(self):
        if self.written is None:
            return "no step is in it yet"
        step, time = self.written
        return f"the file is whole up to step {step} ({1e6 * time:.4f} us)"

    def _close_after_a_fault(self):
        with contextlib.suppress(Exception):  # the first fault is reported
            close(self._file, "stopped")

    def _root_attributes(self, attributes):
        common = {
            "format_version": FORMAT_VERSION,
            "versions": versions(attributes.get("versions", {})),
            "git_commit": git_commit(),
            "restarts": 0,
            "history": "[]",
            "status": "running",
            "limits": LIMITS_LENGTH * " ",
        }
        put(self._file, attributes | common)
        change(self._file, "limits", "")
