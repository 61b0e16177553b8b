"""Restart files: arrays and numbers in HDF5 after a header with a checksum of the content.

The header is the user block of the file, 512 bytes that HDF5 does not use. A file with any wrong byte is
refused before HDF5 reads it.
"""

from __future__ import annotations

import hashlib
import io
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np

from ehlpetsc.base.case import changed_files
from ehlpetsc.base.errors import OutputError
from ehlpetsc.base.toml_file import plain
from ehlpetsc.results.hdf5_file import LIBVER, attributes, open_for_reading
from ehlpetsc.results.output_guard import OVERWRITE_ADVICE, atomic_write

if TYPE_CHECKING:
    from ehlpetsc.case.loading import Case

VERSION = 8  # of the format
HEADER_BYTES = 512
SIGNATURE = b"ehlpetsc restart file %d\n" % VERSION


def save_restart(path: Path, values: dict[str, object]) -> None:
    """Save arrays, numbers and texts to a temporary file, synchronised to disk, then renamed; OutputError."""
    content = io.BytesIO()
    with h5py.File(content, "w", libver=LIBVER, userblock_size=HEADER_BYTES) as file:
        for name, value in values.items():
            (file if isinstance(value, np.ndarray) else file.attrs)[name] = value
    body = content.getbuffer()[HEADER_BYTES:]
    atomic_write(path, _header(body) + bytes(body))


def load_restart(path: Path) -> dict[str, Any]:
    """Values of a file of :func:`save_restart`.

    An OutputError if the file is missing, damaged, no restart file, or of another version.
    """
    try:
        content = Path(path).read_bytes()
    except OSError as error:
        raise OutputError(f"{path}: not read, {error.strerror}") from error
    if not content.startswith(SIGNATURE):
        raise OutputError(f"{path}: not a restart file of this ehlpetsc")
    if content[:HEADER_BYTES] != _header(memoryview(content)[HEADER_BYTES:]):
        raise OutputError(f"{path}: damaged restart file: its content does not agree with its checksum")
    with h5py.File(io.BytesIO(content), "r") as file:
        return {name: file[name][()] for name in file} | plain(dict(file.attrs))


def is_restart_of(path: Path, case: Case) -> bool:
    """Whether a file is an undamaged restart file of a case; an OutputError if a surface file has changed."""
    try:
        values = load_restart(path)
    except OutputError:
        return False
    return _is_of_same(path, values, case)


def _is_of_same(path: Path, values: dict[str, Any], case: Case) -> bool:
    if values["case"] != case.text:
        return False
    check_surfaces(path, values, case.digests)
    return True


def check_surfaces(path: Path, values: dict[str, Any], digests: dict[str, str]) -> None:
    """Refuse values of a restart file of surface files with another content: OutputError."""
    if changed := changed_files(json.loads(values.get("digests", "{}")), digests):
        reason = f"{changed} changed since it was written, and the surface would jump"
        raise OutputError(f"{path}: {reason}; put the file back, {OVERWRITE_ADVICE}")


def restart_of_same(path: Path, restart: Path, case: Case) -> Path | None:
    """Restart file from which the same command continues an unfinished run; None: it begins at time 0.

    A run begins at time 0 if the result of the same case is complete, or if the run was killed before its
    first restart file. Any other file at the path of the result or of the restart file is refused.
    """
    status = None
    if path.exists():
        try:
            with open_for_reading(path) as file:
                attrs = attributes(file)
            status, text = attrs["status"], attrs["case"]
        except (OutputError, KeyError):
            raise OutputError(f"{path}: exists and is not a result of ehlpetsc; {OVERWRITE_ADVICE}") from None
        if text != case.text:
            raise OutputError(f"{path}: holds a run of another case, or of other --set; {OVERWRITE_ADVICE}")
    if status == "done" or not restart.exists():
        return None
    try:
        values = load_restart(restart)
    except OutputError as error:
        raise OutputError(f"{error}; remove it, {OVERWRITE_ADVICE}") from None
    same = _is_of_same(restart, values, case)
    if not same or status is None:
        kind = "whose result is gone" if same else "of another case, or of other --set"
        advice = f"continue with --restart {restart}, {OVERWRITE_ADVICE}"
        raise OutputError(f"{restart}: a restart file waits there, {kind}; {advice}")
    return restart


def _header(body: memoryview) -> bytes:
    checksum = hashlib.sha256(body).hexdigest().encode()
    return (SIGNATURE + b"sha256 %s\n" % checksum).ljust(HEADER_BYTES, b"\0")
