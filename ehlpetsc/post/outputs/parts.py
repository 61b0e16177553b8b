"""Finished depths beside the output, from which an interrupted run goes on; one run at a time."""

import contextlib
import fcntl
import io
import os
from pathlib import Path

import numpy as np

from ehlpetsc.errors import PostError
from ehlpetsc.results.whole_file import write_whole

MARK = "mark"


class Parts:
    """Finished (surface, depth) results in a folder beside the output, each written whole.

    While it is open no other run with the same output gets in: the folder is locked, and the lock goes with
    the process.

    Parameters
    ----------
    output : path-like
    mark : str
        Fingerprint of the input and of what is asked; parts of another are deleted.

    Raises
    ------
    PostError
        Another run has this output in hand, or the folder's name is taken by something else.
    """

    def __init__(self, output, mark):
        self.folder = Path(f"{output}.parts")
        self._lock(output)
        try:
            if self._stored_mark() != mark:
                self._empty()
                write_whole(self.folder / MARK, mark.encode())
        except BaseException:
            self.remove()
            self.close()
            raise

    def __enter__(self):
        return self

    def __exit__(self, *exception):
        self.close()

    def close(self):
        """Give up the lock, and the folder if nothing in it is finished."""
        if self.folder.is_dir() and not any(self.folder.glob("*.npy")):
            self.remove()
        os.close(self._descriptor)

    def _lock(self, output):
        while True:
            if self.folder.exists() and not self._ours():
                raise PostError(f"{self.folder} is in the way: not a folder of this program; remove it")
            self.folder.mkdir(parents=True, exist_ok=True)
            self._descriptor = os.open(self.folder, os.O_RDONLY | os.O_DIRECTORY)
            try:
                fcntl.flock(self._descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                self.close()
                raise PostError(f"another run is writing {output} just now") from None
            except OSError:  # a file system without locks
                return
            with contextlib.suppress(OSError):  # gone: removed by the run that had the lock
                if os.path.samestat(os.stat(self.folder), os.fstat(self._descriptor)):
                    return
            self.close()

    def _ours(self):
        """Whether all that the folder holds is of this class."""
        if not self.folder.is_dir() or self.folder.is_symlink():
            return False
        return all(p.name == MARK or p.suffix in (".npy", ".tmp") for p in self.folder.iterdir())

    def _empty(self):
        for path in self.folder.iterdir():
            path.unlink()

    def _stored_mark(self):
        mark = self.folder / MARK
        return mark.read_bytes().decode(errors="replace") if mark.is_file() else None

    def _path(self, surface, depth):
        return self.folder / f"{surface}_{depth!r}.npy"

    def has(self, surface, depth):
        """Whether that depth is done."""
        return self._path(surface, depth).is_file()

    def load(self, surface, depth):
        """Array (points, 3) of damage, cycles, peak range."""
        return np.load(self._path(surface, depth))

    def save(self, surface, depth, values):
        """Store one depth."""
        image = io.BytesIO()
        np.save(image, values)
        write_whole(self._path(surface, depth), image.getbuffer())

    def remove(self):
        """Delete all parts: the result holds them, or there is nothing to go on from."""
        with contextlib.suppress(OSError):
            self._empty()
            self.folder.rmdir()
