"""Datasets of a result, read on demand; errors of HDF5 become an OutputError with the name of the file.

HDF5 may crash on a damaged file or never return. `announced_to` passes the name of the dataset that is being
read to a process that monitors the reader.
"""

import contextlib

import numpy as np

from ehlpetsc.errors import OutputError
from ehlpetsc.results.hdf5.attributes import Attributes, one_line

_listeners, _names = [], []


@contextlib.contextmanager
def announced_to(listener):
    """Call listener(name) before each read in the ``with`` statement, listener("") after the last one."""
    _listeners.append(listener)
    try:
        yield
    finally:
        _listeners.remove(listener)


def _call_listeners():
    for listener in _listeners:
        listener(_names[-1] if _names else "")


@contextlib.contextmanager
def reading(path, name=""):
    """Context manager that converts exceptions of HDF5 on a damaged file to an OutputError."""
    _names.append(name or "the file")
    _call_listeners()
    try:
        yield
    except (OSError, RuntimeError, KeyError, AttributeError, ValueError, TypeError, MemoryError) as fault:
        place = f"{path}: {name}" if name else f"{path}"
        raise OutputError(f"{place}: cannot be read, the file is damaged ({one_line(fault)})") from None
    finally:
        _names.pop()
        _call_listeners()


class LazyDataset:
    """Dataset of a file; slices of it are arrays.

    Attributes
    ----------
    name : str
    shape, dtype, ndim, chunks
        See `h5py.Dataset`.
    """

    def __init__(self, dataset, path):
        self._dataset, self._path = dataset, path
        self.name, self.shape, self.dtype = dataset.name, dataset.shape, dataset.dtype
        self.ndim, self.chunks = dataset.ndim, dataset.chunks

    def __getitem__(self, index):
        with reading(self._path, self.name):
            return self._dataset[index]

    def __len__(self):
        return self.shape[0]

    def __array__(self, dtype=None, copy=None):
        return np.asarray(self[()], dtype=dtype)

    @property
    def attrs(self):
        """Attributes, strings as str."""
        return Attributes(self._dataset, self._path)
