"""HDF5 files of the program: opening, attributes, appended rows, free space."""

from __future__ import annotations

import errno
import os
import resource
import shutil
from collections.abc import Sequence
from pathlib import Path
from typing import Any, BinaryIO

import h5py
import numpy as np

from ehlpetsc.base.errors import OutputError, OutputLost

LIBVER = ("v110", "v110")  # the first with SWMR, that of Debian 12, which cannot read files of newer formats
RESERVE_BYTES = 2**22  # more than HDF5 adds to rows: chunks that are not full, its own structures
BEING_WRITTEN = "already open"  # in the message of HDF5 on a file of a live or killed writer
NO_LOCKS = (errno.ENOLCK, errno.EOPNOTSUPP, errno.ENOSYS, errno.EINVAL)  # of file systems without locks


def open_hdf5(path: str | Path | BinaryIO, mode: str, **options: Any) -> h5py.File:
    """Open an HDF5 file as `h5py.File` does, without a lock on a file system that has none."""
    try:
        return h5py.File(path, mode, **options)
    except OSError as fault:
        if fault.errno not in NO_LOCKS:
            raise
        return h5py.File(path, mode, locking=False, **options)


def open_for_reading(path: str | Path, **options: Any) -> h5py.File:
    """Open an HDF5 file, also one that is being written or that a killed writer left open.

    Further options are those of `h5py.File`; an OutputError if there is no readable HDF5 file.
    """
    if not Path(path).is_file():
        raise OutputError(f"{path}: no such file")
    try:
        return open_hdf5(path, "r", **options)
    except (OSError, ValueError, RuntimeError) as fault:
        if BEING_WRITTEN in str(fault):
            return open_hdf5(path, "r", swmr=True, **options)
        if getattr(fault, "errno", None) == errno.EAGAIN:
            raise OutputError(f"{path}: another process has it open for writing; wait for it") from fault
        raise OutputError(f"{path}: not an HDF5 file, or a damaged one ({fault})") from fault


def plain(value: object) -> Any:
    """Value of an attribute, text as str."""
    return value.decode(errors="replace") if isinstance(value, bytes) else value


def attributes(item: h5py.HLObject) -> dict[str, Any]:
    """Attributes of a file, group or dataset by name."""
    return {name: plain(value) for name, value in item.attrs.items()}


def extend(dataset: h5py.Dataset, rows: Sequence | np.ndarray) -> None:
    """Append rows to a dataset."""
    if len(rows):
        begin = dataset.shape[0]
        dataset.resize(begin + len(rows), axis=0)
        dataset[begin:] = rows


class Place:
    """Place of an HDF5 file that grows: another program may delete or replace the file meanwhile.

    `file`: opened by this process; between its writes its size is constant.
    """

    def __init__(self, path: Path, file: h5py.File) -> None:
        self._path, self._number = Path(path), file.id.get_vfd_handle()
        self.note()

    def note(self) -> None:
        """Note the size after a write."""
        self._size = os.fstat(self._number).st_size

    def check(self) -> None:
        """Raise OutputLost if the file is no longer at its path, or has been written by another program.

        It may then only be closed.
        """
        try:
            is_own = os.path.samestat(os.fstat(self._number), self._path.stat())
        except (FileNotFoundError, NotADirectoryError) as error:
            raise OutputLost(f"{self._path}: deleted during the run ({error.strerror})") from error
        if is_own and os.fstat(self._number).st_size == self._size:
            return
        if is_own:  # written over: closing must not write to it
            nowhere = os.open(os.devnull, os.O_RDWR)
            os.dup2(nowhere, self._number)
            os.close(nowhere)
        raise OutputLost(f"{self._path}: replaced by another file during the run")


def check_space(path: Path, data_bytes: int) -> None:
    """Refuse to write to a full disk, or beyond the limit of file sizes, where HDF5 may crash: OSError."""
    path, needed = Path(path), data_bytes + RESERVE_BYTES
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)[0]
    size = path.stat().st_size if path.exists() else 0
    if shutil.disk_usage(path.parent).free < needed:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))
    if limit != resource.RLIM_INFINITY and limit < size + needed:
        raise OSError(errno.EFBIG, os.strerror(errno.EFBIG), str(path))
