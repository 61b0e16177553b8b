"""Cache of finished depths, with which an interrupted run continues."""

import contextlib
import io
from pathlib import Path

import numpy as np

from ehlpetsc.errors import OutputError
from ehlpetsc.results.atomic_write import atomic_write

FINGERPRINT_FILE = "mark"


class DepthCache:
    """Finished (surface, depth) results in a folder next to the output, each written atomically.

    The caller must hold the lock on the output.

    Parameters
    ----------
    output : path-like
    fingerprint : str
        Fingerprint of input and settings; depths with another one are deleted.

    Raises
    ------
    OutputError
        The folder exists with other content.
    """

    def __init__(self, output, fingerprint):
        self.folder = Path(f"{output}.parts")
        if self.folder.exists() and not self._is_ours():
            raise OutputError(f"{self.folder} is in the way: not a folder of this program; remove it")
        self.folder.mkdir(parents=True, exist_ok=True)
        try:
            stored = self.folder / FINGERPRINT_FILE
            if not stored.is_file() or stored.read_bytes() != fingerprint.encode():
                self._empty()
                atomic_write(stored, fingerprint.encode())
        except BaseException:
            self.remove()
            raise

    def __enter__(self):
        return self

    def __exit__(self, *exception):
        if self.folder.is_dir() and not any(self.folder.glob("*.npy")):
            self.remove()

    def _is_ours(self):
        if not self.folder.is_dir() or self.folder.is_symlink():
            return False
        return all(p.name == FINGERPRINT_FILE or p.suffix in (".npy", ".tmp") for p in self.folder.iterdir())

    def _empty(self):
        for path in self.folder.iterdir():
            path.unlink()

    def _path(self, surface, depth):
        return self.folder / f"{surface}_{depth!r}.npy"

    def has(self, surface, depth):
        """Whether a depth is finished."""
        return self._path(surface, depth).is_file()

    def load(self, surface, depth):
        """Array (points, columns) of damage, cycles, peak range, criteria."""
        return np.load(self._path(surface, depth))

    def save(self, surface, depth, values):
        """Store one depth."""
        image = io.BytesIO()
        np.save(image, values)
        atomic_write(self._path(surface, depth), image.getbuffer())

    def remove(self):
        """Delete all depths, once they are in the result or cannot be continued."""
        with contextlib.suppress(OSError):
            self._empty()
            self.folder.rmdir()
