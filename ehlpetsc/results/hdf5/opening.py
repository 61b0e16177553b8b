"""Opening of result files, also during a run or after a killed run, and their checks."""

import os
from pathlib import Path

import h5py
import numpy as np

from ehlpetsc.errors import OutputError
from ehlpetsc.results.hdf5.attributes import plain
from ehlpetsc.results.hdf5.lazy_dataset import reading

FORMAT_VERSION = 1
"""Version of the layout; a reader refuses files of a later one."""

ATTRIBUTES = {"title": str, "case": str, "status": str, "a": float, "p0": float, "u1": float, "u2": float}
MAX_COMPRESSION = 2000  # largest size of the data of an undamaged file over the size of the file


def open_for_reading(path, **options):
    """Open an HDF5 file, also one that is being written or that a killed writer left open.

    Further options are those of `h5py.File`.

    Raises
    ------
    OutputError
        No such file, or no readable HDF5 file.
    """
    try:
        if not isinstance(path, str | os.PathLike) or isinstance(os.fspath(path), bytes):
            raise OutputError(f"{path!r}: allowed: the name of a result file")
        if not Path(path).is_file():
            raise OutputError(f"{path}: no such file")
        return h5py.File(path, "r", swmr=_marked_as_being_written(path), **options)
    except PermissionError as fault:
        raise OutputError(f"{path}: not read, {fault.strerror}") from fault
    except (OSError, ValueError, RuntimeError) as fault:
        raise OutputError(f"{path}: not an HDF5 file, or a damaged one ({fault})") from fault


def _marked_as_being_written(path):
    """Whether a file has the flag of a live or killed SWMR writer, which only a SWMR reader accepts.

    On other, possibly damaged files a SWMR reader may wait for ever for a writer.
    """
    with open(path, "rb") as raw:
        start = raw.read(12)
    is_hdf5 = start.startswith(b"\x89HDF\r\n\x1a\n") and len(start) == 12
    return is_hdf5 and start[8] >= 3 and bool(start[11] & 4)


def open_result(path, **options):
    """Open and check a result file; further options are those of `h5py.File`.

    Raises
    ------
    OutputError
        Missing, damaged, not a result file, or of a later format version.
    """
    with reading(path):
        file = open_for_reading(path, **options)
    try:
        with reading(path):
            fault = _fault(file)
        if fault:
            raise OutputError(f"{path}: {fault}")
    except OutputError:
        file.close()
        raise
    return file


def _fault(file):
    """Reason why an HDF5 file is not a result; None if it is one."""
    version = file.attrs.get("format_version")
    if version is not None and "damage/s" in file:
        return "a result of post-processing; give the file it was made from"
    if version is None or "x" not in file or "steps" not in file:
        return "an HDF5 file, but not a result of ehlpetsc"
    if not np.isscalar(version) or isinstance(version, str | bytes) or not version >= 1:
        return f"damaged: its format version is {plain(version)!r}"
    if version > FORMAT_VERSION:
        return f"format version {version}, this ehlpetsc reads up to {FORMAT_VERSION}: use a later ehlpetsc"
    for name, kind in ATTRIBUTES.items():
        value = plain(file.attrs.get(name, kind()))
        if not isinstance(value, kind if kind is str else (int, float, np.number)):
            return f"damaged: its attribute {name} is {value!r}"
        if kind is float and not np.isfinite(value):
            return f"damaged: its attribute {name} is {value}"
    for name in ("a", "p0"):
        if name in file.attrs and not file.attrs[name] > 0.0:
            return f"damaged: its attribute {name} is {file.attrs[name]}"
    return _fault_of_datasets(file)


def _fault_of_datasets(file):
    named = str(plain(file.attrs.get("contents", ""))).split()
    lost = [name for name in named if not isinstance(file.get(name), h5py.Dataset)]
    if lost:
        return f"damaged: {lost[0]} is missing, or cannot be read"
    max_bytes = MAX_COMPRESSION * os.fstat(file.id.get_vfd_handle()).st_size
    for name in ("x", "contact_count", *(f"surface/{s}/{v}" for s in ("1", "2") for v in "sz")):
        if name not in file:
            continue
        if not isinstance(file[name], h5py.Dataset) or (file[name].nbytes or 0) > max_bytes:
            return f"damaged: {name} is no dataset, or has more numbers than the file can hold"
    nodes = file["x"].shape
    if nodes is None or len(nodes) != 1 or nodes[0] < 2:
        return f"damaged: x has the shape {nodes}"
    x = file["x"][:]
    if x.dtype.kind != "f" or not (np.isfinite(x).all() and (np.diff(x) > 0.0).all()):
        return "damaged: x are not increasing numbers"
    for name in ("time", "step", *(f"steps/{n}" for n in file["steps"]), *_two_dimensional(file)):
        item = file.get(name)
        if not isinstance(item, h5py.Dataset) or item.dtype.kind not in "fiu" or item.ndim not in (1, 2):
            return f"damaged: {name} is no row of numbers"
        if item.ndim == 2 and item.shape[1:] != nodes:
            return f"damaged: {name} has {item.shape[1]} nodes, x {nodes[0]}"
        if item.ndim == 2 and "/" in name:
            return f"damaged: {name} has the shape {item.shape}"
        if item.nbytes > max_bytes:
            return f"damaged: {name} has {item.shape[0]} rows, more than the file can hold"
    if file["contact_count"].shape != nodes or file["contact_count"].dtype.kind not in "iu":
        return "damaged: contact_count is no number for every node"
    return None


def _two_dimensional(file):
    return [name for name in file if isinstance(file.get(name), h5py.Dataset) and file[name].ndim == 2]
