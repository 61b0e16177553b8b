"""Atomic writes: a reader finds the old file or the new one, never a part."""

import contextlib
import glob
import os
import secrets
from pathlib import Path


@contextlib.contextmanager
def replacing(path, keep_ending=False):
    """Temporary file beside `path`, for a ``with`` statement: renamed at its end, removed after an error.

    An OSError of the file beside names `path` as its file.

    Parameters
    ----------
    path : path-like
    keep_ending : bool
        Whether the file beside ends as `path` does, for a writer that finds its format there.

    Yields
    ------
    Path
        Of an empty file with the permissions that a new one has.
    """
    path = Path(path)
    ending = f".tmp{path.suffix}" if keep_ending else ".tmp"
    beside = path.with_name(f".{path.name}.{os.getpid()}.{secrets.token_hex(4)}{ending}")
    try:
        os.close(os.open(beside, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
        yield beside
        os.replace(beside, path)
    except BaseException as error:
        with contextlib.suppress(OSError):
            beside.unlink()
        if isinstance(error, OSError) and error.errno and (error.filename or str(beside)) == str(beside):
            raise OSError(error.errno, error.strerror, str(path)) from error
        raise


def atomic_write(path, content):
    """Replace `path` by a file of these bytes, synchronised to disk; after an OSError nothing is left."""
    with replacing(path) as beside, open(beside, "wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())


def remove_stale(path):
    """Remove temporary files of killed runs beside `path`; only with the lock on it."""
    for beside in Path(path).parent.glob(f".{glob.escape(Path(path).name)}.*.tmp*"):
        with contextlib.suppress(OSError):
            beside.unlink()


def os_reason(error):
    """Message of the operating system, without HDF5's own wording."""
    if error.args and "errno = " in str(error):
        code = int(str(error).split("errno = ")[1].split(",")[0])
        return os.strerror(code)
    return os.strerror(error.errno) if getattr(error, "errno", None) else str(error)
