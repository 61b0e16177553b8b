"""Atomic writes: a reader finds the complete old file or the complete new one."""

import contextlib
import glob
import os
import secrets
from pathlib import Path


@contextlib.contextmanager
def replacing(path, keep_ending=False):
    """Context manager of a temporary file next to `path`: renamed at the end, removed after an error.

    Of a symbolic link the target is replaced, and the link stays.

    An OSError of the temporary file names `path` as its file.

    Parameters
    ----------
    path : path-like
    keep_ending : bool
        Whether the temporary file has the suffix of `path`, for writers that derive the format from it.

    Yields
    ------
    Path
        Empty file with the default permissions.
    """
    path = Path(path)
    ending = f".tmp{path.suffix}" if keep_ending else ".tmp"
    target = Path(os.path.realpath(path))
    temporary = target.with_name(f".{target.name}.{os.getpid()}.{secrets.token_hex(4)}{ending}")
    try:
        os.close(os.open(temporary, os.O_CREAT | os.O_EXCL | os.O_WRONLY, 0o666))
        yield temporary
        os.replace(temporary, target)
    except BaseException as error:
        with contextlib.suppress(OSError):
            temporary.unlink()
        ours = isinstance(error, OSError) and (error.filename or str(temporary)) == str(temporary)
        if ours and error.errno:
            raise OSError(error.errno, error.strerror, str(path)) from error
        raise


def atomic_write(path, content):
    """Replace `path` by a file with these bytes, synchronised to disk; errors leave no temporary file."""
    with replacing(path) as temporary, open(temporary, "wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())


def remove_stale(path):
    """Remove the temporary files that killed runs left next to `path`; the caller must have its lock."""
    target = Path(os.path.realpath(path))
    for temporary in target.parent.glob(f".{glob.escape(target.name)}.*.tmp*"):
        with contextlib.suppress(OSError):
            temporary.unlink()


def os_reason(error):
    """Message of the operating system without HDF5's text."""
    if error.args and "errno = " in str(error):
        code = int(str(error).split("errno = ")[1].split(",")[0])
        return os.strerror(code)
    return os.strerror(error.errno) if getattr(error, "errno", None) else str(error)
