"""Restart files: the state of a run, written so that a half-written one never replaces a whole one."""

import io
from pathlib import Path

import h5py

from ehlpetsc.errors import OutputError
from ehlpetsc.results.reader import FORMAT_VERSION, open_for_reading
from ehlpetsc.results.whole_file import plain_reason, write_whole


def save_restart(path, arrays, attrs):
    """Save a state: written beside, forced to the disk, then renamed.

    Parameters
    ----------
    path : str or path-like
    arrays : dict of str to ndarray
    attrs : dict of str to scalar or str

    Raises
    ------
    OutputError
        It could not be written; an older file of the name is as it was.
    """
    path = Path(path)
    image = io.BytesIO()  # HDF5 does not end cleanly on a full disk, a plain write does
    with h5py.File(image, "w") as file:
        file.attrs["restart_version"] = FORMAT_VERSION
        for key, value in attrs.items():
            file.attrs[key] = value
        for name, array in arrays.items():
            file[name] = array
    try:
        write_whole(path, image.getbuffer())
    except OSError as error:
        raise OutputError(f"{path}: restart file not written, {plain_reason(error)}") from error


def load_restart(path):
    """Read what `save_restart` wrote.

    Returns
    -------
    arrays : dict of str to ndarray
    attrs : dict

    Raises
    ------
    OutputError
        Missing, damaged, no restart file, or of a later version.
    """
    with open_for_reading(path) as file:
        version = file.attrs.get("restart_version")
        if version is None:
            hint = ", but a result file" if "format_version" in file.attrs else ""
            raise OutputError(f"{path}: not a restart file of ehlpetsc{hint}")
        if version > FORMAT_VERSION:
            raise OutputError(f"{path}: version {version}, this ehlpetsc reads up to {FORMAT_VERSION}")
        try:
            attrs = {key: value for key, value in file.attrs.items() if key != "restart_version"}
            return {name: file[name][()] for name in file}, attrs
        except (OSError, RuntimeError) as error:
            raise OutputError(f"{path}: damaged restart file ({error})") from error
