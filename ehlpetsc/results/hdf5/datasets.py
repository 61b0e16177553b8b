"""Datasets of a result file, created with dimension scales and extended row by row."""

import contextlib
import itertools
import os
import struct
from dataclasses import dataclass, field

import h5py
import numpy as np

from ehlpetsc.quantities import FIELDS, GROUPS, OTHERS, STEP_SCALARS, of_every_case
from ehlpetsc.results.hdf5 import attributes

CHUNK_BYTES = 65536  # large enough to write fast, small enough that a steady result stays small
CHUNK_STEPS = 512
METADATA_BYTES = 2**20  # more than HDF5 adds to its own structures in one flush
MEMORY_NUMBERS = itertools.count()  # of results in memory
RESERVE_BYTES = 2**16  # more than HDF5 writes on closing
MEMORY_BLOCK = 2**22  # bytes by which a file in memory grows


@dataclass(frozen=True)
class Layout:
    """Layout of a result file.

    Parameters
    ----------
    x : ndarray, shape (nx,)
        Nodes [m].
    fields : list of str
        Fields to store in a frame, keys of `ehlpetsc.quantities.FIELDS`.
    scalars : list of str, optional
        Scalars of the steps, keys of `ehlpetsc.quantities.STEP_SCALARS`; by default those of every case.
    precision : {"float64", "float32"}
        Type of the stored fields.
    profiles : dict
        ``{"1": (s, z, speed) or None, "2": ...}``; an optional fourth item contains attributes (ra, rq, rsk),
        a fifth one names of depths to create, keys of `ehlpetsc.quantities.OTHERS` ("set").
    """

    x: np.ndarray
    fields: list
    scalars: list = field(default_factory=lambda: of_every_case(STEP_SCALARS))
    precision: str = "float64"
    profiles: dict = field(default_factory=dict)


def lay_out(file, layout):
    """Create every dataset of a `Layout`, empty along time."""
    x = layout.x
    _fixed(file, "x", OTHERS["x"], np.asarray(x, dtype=float))
    _growing(file, "time", OTHERS["time"], CHUNK_STEPS)
    for name in [n for n in FIELDS if n in layout.fields]:
        flag = FIELDS[name].dtype == "u1"
        dtype = np.dtype("u1" if flag else layout.precision)
        rows = max(1, CHUNK_BYTES // (len(x) * dtype.itemsize))
        # contact is rare, so that flags compress to almost nothing; floats do not compress enough
        compression = {"compression": "gzip", "compression_opts": 1} if flag else {}
        _growing(file, name, FIELDS[name], rows, len(x), dtype=dtype, **compression)
    _growing(file, "step", OTHERS["step"], CHUNK_STEPS)
    _fixed(file, "contact_count", OTHERS["contact_count"], np.zeros(len(x), dtype="i8"))
    for name in sorted(layout.scalars, key="time".__ne__):  # first the dimension scale of the others
        _growing(file, f"steps/{name}", STEP_SCALARS[name], CHUNK_STEPS)
    for surface, profile in layout.profiles.items():
        if profile is not None:
            _surface(file, f"surface/{surface}", *profile)
    for name, text in GROUPS.items():
        if name in file:
            comment(file[name], text)


def dataset_names(file):
    """Paths of all datasets of a file."""
    names = []
    file.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
    return names


def last_row(file):
    """Number and time [s] of the last step in a file; None: no step."""
    steps, times = file["steps/step"], file["steps/time"]
    return (int(steps[-1]), float(times[-1])) if len(times) else None


def create(path):
    """Create an HDF5 file for writing, None: in memory; OSError if the disk is full."""
    if path is None:
        name = f"result {next(MEMORY_NUMBERS)}"  # for HDF5 two files with one name are one file
        return h5py.File(name, "w", driver="core", block_size=MEMORY_BLOCK, backing_store=False)
    with open(path, "wb") as raw:
        os.posix_fallocate(raw.fileno(), 0, METADATA_BYTES)
    return h5py.File(path, "w", libver="latest")


@contextlib.contextmanager
def room(file, data_bytes):
    """Check the disk space before HDF5 writes, which crashes on a full disk, and flush afterwards.

    A reserve after the data ensures that the file can always be closed.

    Parameters
    ----------
    file : h5py.File
    data_bytes : int
        Size of the rows to be written.

    Raises
    ------
    OSError
        The disk is full, or the quota used up; the file does not change.
    """
    if in_memory(file):
        yield
        return
    descriptor, end = file.id.get_vfd_handle(), file.id.get_filesize()
    chunks = CHUNK_BYTES * len(file) + 8 * CHUNK_STEPS * len(file.get("steps", ()))
    try:
        os.posix_fallocate(descriptor, end, data_bytes + chunks + METADATA_BYTES + RESERVE_BYTES)
    except OSError:
        os.ftruncate(descriptor, end + RESERVE_BYTES)
        raise
    yield
    file.flush()
    os.ftruncate(descriptor, file.id.get_filesize() + RESERVE_BYTES)


def close(file, status, limits=""):
    """Store the status of the run, close the file and free its reserve; a file in memory remains open."""
    if in_memory(file):
        _note_end(file, status, limits)
        return
    descriptor = os.dup(file.id.get_vfd_handle())
    try:
        _note_end(file, status, limits)
        file.close()
        (end,) = struct.unpack_from("<Q", os.pread(descriptor, 48, 0), 28)  # of superblocks 2 and 3
        os.ftruncate(descriptor, end)
    finally:
        os.close(descriptor)


def _note_end(file, status, limits):
    attributes.change(file, "status", status)
    attributes.change(file, "limits", limits)


def in_memory(file):
    """Whether a file is in memory."""
    return file.driver == "core"


def extend(dataset, rows):
    """Append rows to a dataset."""
    if len(rows):
        begin = dataset.shape[0]
        dataset.resize(begin + len(rows), axis=0)
        dataset[begin:] = rows


def _surface(file, name, s, z, speed, statistics=None, depths=()):
    _fixed(file, f"{name}/s", OTHERS["surface/s"], s)
    _fixed(file, f"{name}/z", OTHERS["surface/z"], z)
    for depth in depths:
        _fixed(file, f"{name}/{depth}", OTHERS[f"surface/{depth}"], np.zeros(len(s)))
    attributes.put(file[name], {"speed": speed} | (statistics or {}))


def comment(item, text):
    """Set the description for `h5dump -H` and `h5ls -v`, which do not print values of attributes."""
    h5py.h5o.set_comment(item.id, text.encode())


def _fixed(file, name, field, values):
    values = np.asarray(values)
    checked = {"chunks": values.shape, "fletcher32": True} if values.size else {}
    _describe(file.create_dataset(name, data=values, **checked), field)


def _growing(file, name, field, rows, *width, dtype=None, **compression):
    dataset = file.create_dataset(
        name,
        (0, *width),
        dtype or field.dtype,
        maxshape=(None, *width),
        chunks=(rows, *width),
        fletcher32=True,
        **compression,
    )
    _describe(dataset, field)


def _describe(dataset, field):
    attributes.put(dataset, {"units": field.units, "long_name": field.long_name})
    comment(dataset, f"{field.long_name} [{field.units}] ({', '.join(field.dims)})")
    own_name = dataset.name.rsplit("/", 1)[1]
    if field.dims == (own_name,):
        dataset.make_scale(own_name)
        return
    for axis, dim in enumerate(field.dims):
        dataset.dims[axis].attach_scale(dataset.parent[dim])
