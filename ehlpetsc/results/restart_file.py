"""Restart files: arrays and numbers in HDF5, behind a head that holds a checksum over all of it.

The head is the file's user block, 512 bytes that HDF5 leaves alone. It is checked before HDF5 reads the file:
a file that differs from what was written in any byte is refused, as it might crash HDF5.
"""

import hashlib
import io
from pathlib import Path

import h5py

from ehlpetsc.errors import OutputError
from ehlpetsc.results.atomic_write import atomic_write, os_reason
from ehlpetsc.results.hdf5 import attributes
from ehlpetsc.results.hdf5.opening import open_result
from ehlpetsc.results.output_guard import OVERWRITE_ADVICE

VERSION = 3
HEADER_BYTES = 512  # bytes
MARK = b"ehlpetsc restart file"


def save_restart(path, arrays, attrs):
    """Save a state: written beside, forced to the disk, then renamed.

    Parameters
    ----------
    path : str or path-like
    arrays : dict of str to ndarray
    attrs : dict of str to number or str

    Raises
    ------
    OutputError
        It could not be written; an older file of the name is as it was.
    """
    path, image = Path(path), io.BytesIO()
    with h5py.File(image, "w", libver="latest", userblock_size=HEADER_BYTES) as file:
        attributes.put(file, attrs)
        for name, array in arrays.items():
            file[name] = array
    body = image.getbuffer()[HEADER_BYTES:]
    try:
        atomic_write(path, _head(body) + bytes(body))
    except OSError as error:
        raise OutputError(f"{path}: restart file not written, {os_reason(error)}") from error


def load_restart(path):
    """Read a file of `save_restart`.

    Returns
    -------
    arrays : dict of str to ndarray
    attrs : dict

    Raises
    ------
    OutputError
        Missing, damaged, no restart file, or of another version.
    """
    path = Path(path)
    try:
        if not path.is_file():
            raise OutputError(f"{path}: no such file")
        whole = path.read_bytes()
    except OSError as error:
        raise OutputError(f"{path}: not read, {error.strerror}") from error
    _check(path, whole)
    with h5py.File(io.BytesIO(whole), "r") as file:
        return {name: file[name][()] for name in file}, dict(attributes.Attributes(file, path))


def _head(body):
    text = b"%s %d\nsha256 %s\n" % (MARK, VERSION, hashlib.sha256(body).hexdigest().encode())
    return text.ljust(HEADER_BYTES, b"\0")


def _check(path, whole):
    kind, _, version = whole[:HEADER_BYTES].partition(b"\n")[0].rpartition(b" ")
    if kind != MARK:
        known = b"format_version" in whole or b"restart_version" in whole
        other = (
            "a result file, or a restart file of an earlier ehlpetsc" if known else "damaged, or another file"
        )
        raise OutputError(f"{path}: not a restart file of this ehlpetsc, but {other}")
    if version != b"%d" % VERSION:
        shown = version[:20].decode(errors="replace")
        raise OutputError(f"{path}: a restart file of version {shown}, this ehlpetsc reads {VERSION}")
    if whole[:HEADER_BYTES] != _head(memoryview(whole)[HEADER_BYTES:]):
        raise OutputError(f"{path}: damaged restart file: its content does not agree with its checksum")


def restart_of_same(path, restart, case_text):
    """Restart file from which the same command continues an unfinished run; None: it begins at time 0.

    A run begins at time 0 where the result of the very same case is complete, or where it was killed before
    its first restart file. Any other file at the path of the result is refused.

    Parameters
    ----------
    path, restart : Path
        The result file and the restart file beside it.
    case_text : str

    Returns
    -------
    Path or None

    Raises
    ------
    OutputError
        With the options to choose from.
    """
    status = _status_of_same(path, case_text) if path.exists() else None
    if status == "done" or not restart.exists():
        return None
    try:
        same = load_restart(restart)[1]["case"] == case_text
    except (OutputError, KeyError) as error:
        raise OutputError(f"{error}; remove it, {OVERWRITE_ADVICE}") from None
    if not same or status is None:
        which = "whose result is gone" if same else "of another case, or of other -ehl_set"
        way = f"continue with -ehl_restart {restart}, {OVERWRITE_ADVICE}"
        raise OutputError(f"{restart}: a restart file waits there, {which}; {way}")
    return restart


def _status_of_same(path, case_text):
    """Status of a result; OutputError where it is none, or of another case."""
    try:
        with open_result(path) as file:
            status, case = (
                attributes.plain(file.attrs.get("status")),
                attributes.plain(file.attrs.get("case")),
            )
    except OutputError:
        raise OutputError(f"{path}: exists and is not a result of ehlpetsc; {OVERWRITE_ADVICE}") from None
    if case != case_text:
        unfinished = "" if status == "done" else f" that is {status}, not done"
        what = f"a run{unfinished}" if unfinished else "the result"
        raise OutputError(f"{path}: holds {what} of another case, or of other -ehl_set; {OVERWRITE_ADVICE}")
    return status
