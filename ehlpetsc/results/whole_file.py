"""Small files written whole: a reader finds the old one or the new one, never a part."""

import contextlib
import os
import tempfile
from pathlib import Path


def write_whole(path, content):
    """Write bytes beside `path`, force them to the disk and rename; OSError leaves nothing behind."""
    path = Path(path)
    descriptor, beside = tempfile.mkstemp(prefix=f".{path.name}.", suffix=".tmp", dir=path.parent)
    try:
        with open(descriptor, "wb") as file:
            os.fchmod(file.fileno(), 0o666 & ~_umask())
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        os.replace(beside, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(beside)
        raise


def _umask():
    mask = os.umask(0)
    os.umask(mask)
    return mask
