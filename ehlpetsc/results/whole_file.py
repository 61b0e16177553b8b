"""Files written whole: a reader finds the old one or the new one, never a part."""

import contextlib
import glob
import os
import tempfile
from pathlib import Path


@contextlib.contextmanager
def replacing(path):
    """A file beside `path` to write to, for a ``with`` statement: renamed at its end, gone after an error.

    Yields
    ------
    Path
        Of an empty file with the permissions that a new one has.
    """
    path = Path(path)
    descriptor, name = tempfile.mkstemp(prefix=f".{path.name}.", suffix=".tmp", dir=path.parent)
    beside = Path(name)
    try:
        os.fchmod(descriptor, 0o666 & ~_umask())
        os.close(descriptor)
        yield beside
        os.replace(beside, path)
    except BaseException:
        with contextlib.suppress(OSError):
            beside.unlink()
        raise


def write_whole(path, content):
    """Write bytes, forced to the disk, in the place of `path`; OSError leaves nothing behind."""
    with replacing(path) as beside, open(beside, "wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())


def remove_left(path):
    """Remove what killed runs have left beside `path`; for who has the lock on it."""
    for beside in Path(path).parent.glob(f".{glob.escape(Path(path).name)}.*.tmp"):
        with contextlib.suppress(OSError):
            beside.unlink()


def plain_reason(error):
    """What the operating system said, without HDF5's own wording."""
    if error.args and "errno = " in str(error):
        code = int(str(error).split("errno = ")[1].split(",")[0])
        return os.strerror(code)
    return os.strerror(error.errno) if getattr(error, "errno", None) else str(error)


def _umask():
    mask = os.umask(0)
    os.umask(mask)
    return mask
