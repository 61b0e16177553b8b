"""File of a life: HDF5, extended by a row for each solved round.

As result files it is written in single-writer/multiple-reader mode, after a check of the disk space.
``figures/passes`` is extended last and thus commits the row: a killed run loses only the round in progress. A
continued life is copied once, up to its last complete row.
"""

import contextlib

import numpy as np

from ehlpetsc.errors import OutputError
from ehlpetsc.results.atomic_write import os_reason, replacing
from ehlpetsc.results.hdf5.attributes import put
from ehlpetsc.results.hdf5.datasets import close, create, extend, room

BODY_DATASETS = {"s": "m", "edges": "m", "height": "m"}  # of a body
ROW_DATASETS = {"wear": "m", "pit": "m", "damage": "1", "failed": "passes", "is_pitted": "1", "volume": "m^2"}
ROW_DATASETS |= {"wear_rate": "m", "damage_rate": "1", "volume_rate": "m^2"}  # of a pass
KIND = "surfaces over their life"
FORMAT = 3
COMMIT_DATASET = "passes"  # of the figures, written last
ROWS, CHUNK = 64, 4096  # in a chunk of a dataset: rows, numbers


class LifeFile:
    """File of a life that grows; created with its first row.

    Parameters
    ----------
    path : Path
    """

    def __init__(self, path):
        self.path, self._file = path, None

    def __enter__(self):
        return self

    def __exit__(self, kind, *_):
        self.close("stopped" if kind else "done")

    def store(self, history):
        """Append the last row of a life, or write all rows if the file is not open yet.

        Parameters
        ----------
        history : history.LifeHistory

        Raises
        ------
        OutputError
        """
        try:
            if self._file is None:
                self._create(history)
            else:
                self._append(history, [len(history.rows) - 1])
        except (OSError, RuntimeError) as error:
            raise OutputError(f"{self.path}: not written, {os_reason(error)}") from error

    def close(self, status):
        """Store the final status and close the file.

        Parameters
        ----------
        status : str
            "done", "stopped", "not converged".
        """
        if self._file:
            with contextlib.suppress(OSError, RuntimeError):  # its rows are complete
                close(self._file, status)
        self._file = None

    def _create(self, history):
        with replacing(self.path) as temporary:
            file = self._file = create(temporary)
            with room(file, 0):
                attributes = {"kind": KIND, "case": history.case, "title": history.title}
                put(file, attributes | {"format_version": FORMAT, "status": "running", "limits": " "})
                _lay_out(file, history)
            self._append(history, range(len(history.rows)))
            file.swmr_mode = True
            file.flush()

    def _append(self, history, numbers):
        for number in numbers:
            values = dict(_values_of(history, number))
            commit = values.pop(f"figures/{COMMIT_DATASET}")
            with room(self._file, sum(value.nbytes for value in values.values())):
                for name, value in values.items():
                    extend(self._file[name], value)
            with room(self._file, commit.nbytes):
                extend(self._file[f"figures/{COMMIT_DATASET}"], commit)


def _values_of(history, number):
    """Names of the datasets and the values that a row appends to each."""
    for name, value in history.rows[number].items():
        yield f"figures/{name}", np.array([value])
    for k, body in enumerate(history.bodies[number], 1):
        for name in ROW_DATASETS:
            yield f"surface/{k}/{name}", np.asarray(getattr(body, name))[None]
    for name, value in history.plastic[number].items():
        yield f"records/{name}", np.atleast_1d(value)
        yield f"lengths/{name}", np.array([np.size(value)])


def _lay_out(file, history):
    for name, value in _values_of(history, 0):
        shape = value.shape[1:]
        rows = CHUNK if name.startswith("records/") else ROWS  # of which a row adds many
        chunk = max(1, min(rows, CHUNK // max(int(np.prod(shape)), 1)))
        file.create_dataset(
            name, (0, *shape), value.dtype, maxshape=(None, *shape), chunks=(chunk, *shape), fletcher32=True
        )
    for k, body in enumerate(history.bodies[0], 1):
        for name, unit in BODY_DATASETS.items():
            file[f"surface/{k}/{name}"] = getattr(body, name)
            put(file[f"surface/{k}/{name}"], {"units": unit})
        for name, unit in ROW_DATASETS.items():
            put(file[f"surface/{k}/{name}"], {"units": unit})
    for name, value in history.plastic[0].items():
        put(file[f"records/{name}"], {"is_number": int(not np.ndim(value))})
