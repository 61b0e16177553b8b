"""Buffer of steps and frames between two flushes of a result file."""

import numpy as np

from ehlpetsc.quantities import FIELDS
from ehlpetsc.results.hdf5.datasets import extend

MAX_STEPS = 1024  # in the buffer
MAX_FIELD_BYTES = 2**20  # of each field in the buffer


def frame_fields(file):
    """Names of the fields in a result file."""
    return [name for name in FIELDS if name in file]


class Batch:
    """Rows of a result file that have not been written yet.

    Parameters
    ----------
    file : h5py.File
        File with all datasets.
    nodes : int
    """

    def __init__(self, file, nodes):
        self._file = file
        scalars = {name: d for name, d in file["steps"].items() if name != "time"}
        self._times = np.empty(MAX_STEPS)
        self._columns = {name: np.empty(MAX_STEPS, dtype=d.dtype) for name, d in scalars.items()}
        frames, fields = max(1, MAX_FIELD_BYTES // (8 * nodes)), {n: file[n] for n in frame_fields(file)}
        self._frames = {name: np.empty((frames, d.shape[1]), d.dtype) for name, d in fields.items()}
        self._frame_times, self._frame_steps = np.empty(frames), np.empty(frames, dtype="i8")
        self._held = self._frames_held = 0

    @property
    def full(self):
        """Whether the buffer is full."""
        return self._held == MAX_STEPS or self._frames_held == len(self._frame_times)

    @property
    def size(self):
        """Size of the rows in bytes."""
        frames = sum(held.itemsize * held.shape[1] for held in self._frames.values())
        return frames * self._frames_held + 8 * (len(self._columns) + 3) * self._held

    def hold_step(self, step, time, scalars):
        """Add the scalars of a step; missing scalars become nan, missing counts 0."""
        row, self._held = self._held, self._held + 1
        self._times[row] = time
        for name, column in self._columns.items():
            column[row] = scalars.get(name, 0 if column.dtype.kind == "i" else np.nan)
        self._columns["step"][row] = step

    def hold_frame(self, step, time, fields, in_contact):
        """Add the fields of a step."""
        row, self._frames_held = self._frames_held, self._frames_held + 1
        self._frame_times[row], self._frame_steps[row] = time, step
        for name, held in self._frames.items():
            held[row] = in_contact if name == "in_contact" else fields[name]

    def write(self, contact_count):
        """Write the rows; the times last, because rows without a time do not count."""
        file, steps, frames = self._file, slice(self._held), slice(self._frames_held)
        for name, column in self._columns.items():
            extend(file[f"steps/{name}"], column[steps])
        for name, held in self._frames.items():
            extend(file[name], held[frames])
        extend(file["step"], self._frame_steps[frames])
        file["contact_count"][:] = contact_count
        file.flush()
        extend(file["steps/time"], self._times[steps])
        extend(file["time"], self._frame_times[frames])
        self._held = self._frames_held = 0
