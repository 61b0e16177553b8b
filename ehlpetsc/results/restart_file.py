"""Restart files: arrays and numbers in HDF5 after a header with a checksum of the content.

The header is the user block of the file, 512 bytes that HDF5 does not use. It is checked before HDF5 reads
the file: a file with any wrong byte is refused, because it might crash HDF5.
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

VERSION = 3  # of the format
HEADER_BYTES = 512
SIGNATURE = b"ehlpetsc restart file"


def save_restart(path, arrays, attrs):
    """Save a state to a temporary file, synchronised to disk, then renamed.

    Parameters
    ----------
    path : str or path-like
    arrays : dict of str to ndarray
    attrs : dict of str to number or str

    Raises
    ------
    OutputError
        The file cannot be written; an older file does not change.
    """
    path, content = Path(path), io.BytesIO()
    with h5py.File(content, "w", libver="latest", userblock_size=HEADER_BYTES) as file:
        attributes.put(file, attrs)
        for name, array in arrays.items():
            file[name] = array
    body = content.getbuffer()[HEADER_BYTES:]
    try:
        atomic_write(path, _header(body) + bytes(body))
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
        content = path.read_bytes()
    except OSError as error:
        raise OutputError(f"{path}: not read, {error.strerror}") from error
    _check(path, content)
    with h5py.File(io.BytesIO(content), "r") as file:
        return {name: file[name][()] for name in file}, dict(attributes.Attributes(file, path))


def _header(body):
    text = b"%s %d\nsha256 %s\n" % (SIGNATURE, VERSION, hashlib.sha256(body).hexdigest().encode())
    return text.ljust(HEADER_BYTES, b"\0")


def _check(path, content):
    kind, _, version = content[:HEADER_BYTES].partition(b"\n")[0].rpartition(b" ")
    if kind != SIGNATURE:
        is_result = b"format_version" in content or b"restart_version" in content
        other = (
            "a result file, or a restart file of an earlier ehlpetsc"
            if is_result
            else "damaged, or another file"
        )
        raise OutputError(f"{path}: not a restart file of this ehlpetsc, but {other}")
    if version != b"%d" % VERSION:
        file_version = version[:20].decode(errors="replace")
        raise OutputError(f"{path}: a restart file of version {file_version}, this ehlpetsc reads {VERSION}")
    if content[:HEADER_BYTES] != _header(memoryview(content)[HEADER_BYTES:]):
        raise OutputError(f"{path}: damaged restart file: its content does not agree with its checksum")


def restart_of_same(path, restart, case_text):
    """Restart file from which the same command continues an unfinished run; None: it begins at time 0.

    A run begins at time 0 if the result of the same case is complete, or if the run was killed before its
    first restart file. Any other file at the path of the result is refused.

    Parameters
    ----------
    path, restart : Path
        Result file and restart file.
    case_text : str

    Returns
    -------
    Path or None

    Raises
    ------
    OutputError
        Another file is at one of the paths; the message names the options.
    """
    status = _status_of_same(path, case_text) if path.exists() else None
    if status == "done" or not restart.exists():
        return None
    try:
        same = load_restart(restart)[1]["case"] == case_text
    except (OutputError, KeyError) as error:
        raise OutputError(f"{error}; remove it, {OVERWRITE_ADVICE}") from None
    if not same or status is None:
        kind = "whose result is gone" if same else "of another case, or of other --set"
        advice = f"continue with --restart {restart}, {OVERWRITE_ADVICE}"
        raise OutputError(f"{restart}: a restart file waits there, {kind}; {advice}")
    return restart


def _status_of_same(path, case_text):
    """Status of a result; OutputError if the file is not a result, or of another case."""
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
        kind = f"a run{unfinished}" if unfinished else "the result"
        raise OutputError(f"{path}: holds {kind} of another case, or of other --set; {OVERWRITE_ADVICE}")
    return status
