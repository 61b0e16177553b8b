"""HDF5 files of the program: opening, attributes, appended rows, free space, provenance."""

from __future__ import annotations

import contextlib
import errno
import json
import os
import platform
import resource
import shutil
import subprocess
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from pathlib import Path
from typing import Any, BinaryIO

import h5py
import numpy as np

from ehlpetsc.base.errors import OutputError, OutputLost, not_written
from ehlpetsc.base.toml_file import similar_file
from ehlpetsc.base.version import __version__
from ehlpetsc.results.output_guard import replacing

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
    if Path(path).is_dir():
        raise OutputError(f"{path}: a folder; allowed: a file of HDF5")
    if not Path(path).is_file():
        raise OutputError(f"{path}: no such file{similar_file(path, '*.h5')}")
    try:
        return open_hdf5(path, "r", **options)
    except (OSError, ValueError, RuntimeError) as fault:
        if BEING_WRITTEN in str(fault):
            return open_hdf5(path, "r", swmr=True, **options)
        if getattr(fault, "errno", None) == errno.EAGAIN:
            raise OutputError(f"{path}: another process has it open for writing; wait for it") from fault
        if isinstance(fault, PermissionError):
            raise OutputError(f"{path}: cannot be read: {os.strerror(errno.EACCES)}") from fault
        raise OutputError(f"{path}: not an HDF5 file, or a damaged one ({fault})") from fault


def attribute_value(value: object) -> Any:
    """Value of an attribute, text as str."""
    return value.decode(errors="replace") if isinstance(value, bytes) else value


def attributes(item: h5py.HLObject) -> dict[str, Any]:
    """Attributes of a file, group or dataset by name."""
    return {name: attribute_value(value) for name, value in item.attrs.items()}


def extend(dataset: h5py.Dataset, rows: Sequence | np.ndarray) -> None:
    """Append rows to a dataset."""
    if len(rows):
        begin = dataset.shape[0]
        dataset.resize(begin + len(rows), axis=0)
        dataset[begin:] = rows


class GrowingFile:
    """HDF5 file that is extended while others may read it, complete up to its last flush.

    Between the writes of this process its size is constant: another program may delete or replace the file
    meanwhile, which then ends in OutputLost, and leaves the other file as it is.

    `path`: None: in memory, not begun by :meth:`_begin`.
    """

    _file: Any = None  # an h5py.File
    _size: int | None = None  # after the last write; None: not begun, or closed

    def __init__(self, path: Path | None) -> None:
        self.path = path

    def _begin(self, fill: Callable[[h5py.File], None]) -> None:
        """Create the file, filled, under a temporary name and rename it: a failure keeps an older file."""
        with replacing(self.path) as temporary:
            self._file = open_hdf5(temporary, "w", libver=LIBVER)
            fill(self._file)
            self._file.swmr_mode = True  # single writer, multiple readers
            self._file.flush()
        self._size = self._state().st_size

    def _end(self, status: str) -> None:
        """Set the status, a text of fixed length, and close the file."""
        self._size = None
        self._file.attrs.modify("status", np.bytes_(status.encode()))
        self._file.close()

    @contextlib.contextmanager
    def _writing(self) -> Iterator[None]:
        """Write to the file if it is in its place; after an error close it.

        An error of HDF5 or the system becomes an OutputError.
        """
        try:
            if self._size is not None:
                self._check()
            yield
            if self._size is not None:
                self._size = self._state().st_size
        except (OutputError, OSError, RuntimeError) as error:
            with contextlib.suppress(Exception):  # the first fault is reported
                self._file.close() if isinstance(error, OutputLost) else self._end("stopped")
            if isinstance(error, OutputError):
                raise
            raise OutputError(not_written(error, self.path)) from error

    def _state(self) -> os.stat_result:
        return os.fstat(self._file.id.get_vfd_handle())

    def _check(self) -> None:
        """Raise OutputLost if the file is no longer at its path, or has been written by another program.

        It may then only be closed.
        """
        try:
            is_own = os.path.samestat(self._state(), self.path.stat())
        except (FileNotFoundError, NotADirectoryError) as error:
            raise OutputLost(f"{self.path}: deleted during the run ({error.strerror})") from error
        if is_own and self._state().st_size == self._size:
            return
        if is_own:  # written over: closing must not write to it
            nowhere = os.open(os.devnull, os.O_RDWR)
            os.dup2(nowhere, self._file.id.get_vfd_handle())
            os.close(nowhere)
        raise OutputLost(f"{self.path}: replaced by another file during the run")


def check_space(path: Path, data_bytes: int) -> None:
    """Refuse to write to a full disk, or beyond the limit of file sizes, where HDF5 may crash: OSError."""
    path, needed = Path(path), data_bytes + RESERVE_BYTES
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)[0]
    size = path.stat().st_size if path.exists() else 0
    if shutil.disk_usage(path.parent).free < needed:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))
    if limit != resource.RLIM_INFINITY and limit < size + needed:
        raise OSError(errno.EFBIG, os.strerror(errno.EFBIG), str(path))


def versions(other_versions: dict[str, str]) -> str:
    """Names and versions in one line: of Python and its libraries, then of `other_versions` (by name)."""
    common = {
        "ehlpetsc": __version__,
        "python": platform.python_version(),
        "numpy": np.__version__,
        "h5py": h5py.__version__,
        "hdf5": h5py.version.hdf5_version,
    }
    return ", ".join(f"{name} {version}" for name, version in (common | other_versions).items())


@cache
def git_commit() -> str:
    """Commit of the checkout of the package, ``-dirty`` if changed; "" outside a checkout."""
    top = Path(__file__).resolve().parents[2]
    if not (top / ".git").exists():
        return ""
    command = ["git", "-C", str(top), "describe", "--always", "--dirty", "--abbrev=40", "--exclude=*"]
    try:
        answer = subprocess.run(command, capture_output=True, text=True, timeout=10, check=True)
    except (OSError, subprocess.SubprocessError):
        return ""  # no git, or a checkout of another user
    return answer.stdout.strip()


def earlier_runs(attrs: dict[str, Any], last_step: int) -> str:
    """JSON list of the configurations of all runs before a restart; `attrs` describes the last one."""
    runs = json.loads(attrs.get("history", "[]"))
    keys = ("case", "petsc_options", "ranks", "versions", "git_commit")
    last_run = {key: attrs[key] for key in keys if key in attrs}
    run = {key: value if isinstance(value, str) else int(value) for key, value in last_run.items()}
    return json.dumps([*runs, {"up_to_step": int(last_step), **run}])
