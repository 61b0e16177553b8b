"""Attributes of HDF5 files, with strings of fixed length.

HDF5 stores strings of variable length in a heap without a checksum, where one wrong byte makes it crash;
strings of fixed length are in the header of their group or dataset, which has a checksum.
"""

import h5py
import numpy as np

from ehlpetsc.errors import OutputError

MIN_TEXT_BYTES = 16  # so that "running" can be overwritten by "not converged"


def put(item, values):
    """Set attributes of a file, group or dataset.

    Parameters
    ----------
    item : h5py.File, h5py.Group or h5py.Dataset
    values : dict of str to str or number
    """
    for name, value in values.items():
        if isinstance(value, str):
            _put_text(item, name, value.encode())
        else:
            item.attrs[name] = value


def _put_text(item, name, raw):
    kind = h5py.h5t.C_S1.copy()
    kind.set_size(max(len(raw) + 1, MIN_TEXT_BYTES))
    kind.set_cset(h5py.h5t.CSET_UTF8)
    if name in item.attrs:
        del item.attrs[name]
    space = h5py.h5s.create(h5py.h5s.SCALAR)
    attribute = h5py.h5a.create(item.id, name.encode(), kind, space)
    attribute.write(_padded(raw, attribute), mtype=kind)


def change(item, name, text):
    """Overwrite a string attribute in place, allowed while a file is read; it must not become longer."""
    attribute = item.attrs.get_id(name)
    attribute.write(_padded(text.encode(), attribute), mtype=attribute.get_type())


def _padded(raw, attribute):
    return np.array(raw, dtype=f"S{attribute.get_type().get_size()}")


class Attributes(dict):
    """Attributes by name, strings as str; a missing attribute raises an OutputError.

    Parameters
    ----------
    item : h5py.File, h5py.Group or h5py.Dataset
    path : path-like
        Path of the file, for error messages.
    """

    def __init__(self, item, path):
        try:
            super().__init__({name: plain(value) for name, value in item.attrs.items()})
        except (OSError, RuntimeError, ValueError, TypeError, KeyError) as fault:
            raise OutputError(f"{path}: damaged, its attributes cannot be read ({one_line(fault)})") from None
        self._path = path

    def __missing__(self, name):
        raise OutputError(f"{self._path}: damaged, or of another program: it has no attribute {name}")


def plain(value):
    """Value of an attribute; strings as printable str, with bytes that are not UTF-8 replaced."""
    if isinstance(value, str):  # h5py returns such bytes of strings of variable length as lone surrogates
        return value.encode(errors="replace").decode()
    return value.decode(errors="replace") if isinstance(value, bytes) else value


def one_line(fault):
    """First line of the message of an exception, or its type if the message is empty."""
    line = next(iter(str(fault).strip().splitlines()), type(fault).__name__)[:200]
    return "".join(character if character.isprintable() else "?" for character in line)
