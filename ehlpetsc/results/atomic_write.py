"""Atomic writes: a reader finds the complete old file or the complete new one."""

from __future__ import annotations

import contextlib
import glob
import os
import secrets
from collections.abc import Iterator
from pathlib import Path


@contextlib.contextmanager
def replacing(path: Path, keep_ending: bool = False) -> Iterator[Path]:
    """Context manager of an empty temporary file next to `path`: renamed at the end, removed after an error.

    An OSError of the temporary file names `path` as its file. With `keep_ending` the temporary file has the
    suffix of `path`, for writers that derive the format from it.
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
        if isinstance(error, OSError) and error.errno and error.filename in (None, str(temporary)):
            raise OSError(error.errno, error.strerror, str(path)) from error
        raise


def atomic_write(path: Path, content: bytes) -> None:
    """Replace `path` by a file with these bytes, synchronised to disk; errors leave no temporary file."""
    with replacing(path) as temporary, open(temporary, "wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())


def remove_stale(path: Path) -> None:
    """Remove the temporary files that killed runs left next to `path`; the caller must have its lock."""
    target = Path(os.path.realpath(path))
    for temporary in target.parent.glob(f".{glob.escape(target.name)}.*.tmp*"):
        with contextlib.suppress(OSError):
            temporary.unlink()


def os_reason(error: Exception) -> str:
    """Message of the operating system without HDF5's text."""
    if error.args and "errno = " in str(error):
        code = int(str(error).split("errno = ")[1].split(",")[0])
        return os.strerror(code)
    number = getattr(error, "errno", None)
    return os.strerror(number) if number else str(error)
