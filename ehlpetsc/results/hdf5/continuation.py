"""Continuation of a result: check that it is an earlier part of the same run, and copy its rows."""

import numpy as np

from ehlpetsc.errors import OutputError
from ehlpetsc.results.hdf5 import attributes
from ehlpetsc.results.hdf5.batch import frame_fields
from ehlpetsc.results.hdf5.datasets import extend, room
from ehlpetsc.results.provenance import earlier_runs
from ehlpetsc.results.reader import read_result

ROWS_PER_BLOCK = 1024  # copied at once
SCALE_TOLERANCE = 1e-9  # relative: speeds and scales nearer than this are equal


def copy_up_to(file, path, step, contact_count):
    """Copy all rows up to a step of an earlier part of the run.

    Parameters
    ----------
    file : h5py.File
        New file with all datasets.
    path : path-like
        Earlier file.
    step : int
    contact_count : ndarray of int, shape (nx,), or None
        Steps in contact up to `step`; None: from the earlier file.

    Returns
    -------
    ndarray of int, shape (nx,)
        Steps in contact.

    Raises
    ------
    OutputError
        The earlier file is damaged, or not an earlier part of this run.
    """
    with read_result(path) as old:
        try:
            fault = _misfit(file, old, step, contact_count is None)
            if fault:
                raise OutputError(f"{path}: cannot be continued, {fault}; give another -o")
            count = old.contact_count if contact_count is None else contact_count
            _copy(file, old, step, count)
        except (KeyError, ValueError, TypeError, OverflowError) as damage:
            words = attributes.one_line(damage)
            raise OutputError(f"{path}: cannot be continued, it is damaged ({words})") from damage
    return count


def _copy(file, old, step, count):
    frames = np.count_nonzero(old.step <= step)
    steps = np.count_nonzero(old.steps("step") <= step)
    for name in [*frame_fields(file), "step", "time"]:
        _copy_rows(file, old, name, frames)
    for name in file["steps"]:
        _copy_rows(file, old, f"steps/{name}", steps)
    file["contact_count"][:] = count
    restarts = int(old.attrs["restarts"]) + 1
    attributes.put(file, {"restarts": restarts, "history": earlier_runs(old.attrs, step)})


def _copy_rows(file, old, name, rows):
    for begin in range(0, rows, ROWS_PER_BLOCK):
        block = old[name][begin : min(begin + ROWS_PER_BLOCK, rows)]
        with room(file, block.nbytes):
            extend(file[name], block)


def _misfit(file, old, step, count_from_file):
    """Reason why a file is not an earlier part of the same run; None if it is one."""
    last = max(old.steps("step"), default=None)
    if not np.array_equal(old.x, file["x"][:]):
        return "it was computed on another mesh, or for another half width"
    if set(old.fields) != set(frame_fields(file)):
        return f"it stores other fields ({', '.join(old.fields)})"
    if set(old.scalars) != set(file["steps"]):
        return f"it stores other figures of its steps ({', '.join(old.scalars)})"
    if last is not None and last < step:  # None: stopped before its first step
        return f"it ends at step {last}, before step {step} of the restart file"
    if count_from_file and last is not None and last > step:
        return f"it continues to step {last} and the contacts up to step {step} are unknown"
    for name, quantity in (("p0", "maximum Hertz pressure"), ("u1", "speed"), ("u2", "speed")):
        if name in file.attrs and not np.isclose(
            old.attrs[name], file.attrs[name], rtol=SCALE_TOLERANCE, atol=0.0
        ):
            return f"it was computed for another {quantity} ({name} = {old.attrs[name]:.6g})"
    return None
