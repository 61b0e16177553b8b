"""Index of several results beside them: of a series, of passes or of lives, a JSON file."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import h5py

from ehlpetsc.errors import OutputError
from ehlpetsc.results.atomic_write import atomic_write, remove_stale
from ehlpetsc.results.hdf5_file import open_for_reading
from ehlpetsc.results.output_guard import OVERWRITE_ADVICE, Lock, check_output_path, exists, inputs_of


def read_index(path: Path) -> dict:
    """Content of an index file; OutputError."""
    try:
        return json.loads(path.read_text())
    except OSError as error:
        raise OutputError(f"{path}: {error.strerror}") from error
    except ValueError as error:
        raise OutputError(f"{path}: not the index of a series ({error})") from error


class Index:
    """Index of results of a case, written while they are computed.

    `kind` is the name of the list in the file, "members" or "passes"; `rows` are its entries, each with the
    name of a "file" in the folder of the index; `more` are other entries of the file.
    """

    def __init__(self, path: Path, case: Any, kind: str, **more: object) -> None:
        self.path, self.case, self.kind, self.more = path, case, kind, more
        self.rows: list[dict] = []
        self._lock = Lock(path)

    def acquire(self, overwrite: bool, results: Iterable[Path] = ()) -> None:
        """Lock the index until :meth:`release`; OutputError if a file of another program would be replaced.

        Files named in the index and HDF5 files that cannot be opened may be replaced.
        """
        check_output_path(self.path, inputs_of(self.case))
        if not overwrite:
            named = set()
            if exists(self.path):
                try:
                    named = {row["file"] for row in json.loads(self.path.read_text())[self.kind]}
                except (OSError, ValueError, KeyError, TypeError):
                    reason = f"exists and is not an index of ehlpetsc; {OVERWRITE_ADVICE}"
                    raise OutputError(f"{self.path}: {reason}") from None
            for file in results:
                if file.is_file() and file.stat().st_size and file.name not in named and not _is_ours(file):
                    raise OutputError(f"{file}: exists and is not a result of ehlpetsc; {OVERWRITE_ADVICE}")
        self._lock.acquire()
        remove_stale(self.path)

    def release(self) -> None:
        """Release the lock."""
        self._lock.release()

    def stored_rows(self, of_any_case: bool = False) -> list[dict]:
        """Rows in the file; [] if it is missing, damaged or, normally, of another case."""
        try:
            content = json.loads(self.path.read_text())
            return list(content[self.kind]) if of_any_case or content["case"] == self.case.text else []
        except (OSError, ValueError, KeyError, TypeError):
            return []

    def write(self) -> None:
        """Write the file."""
        content = {"title": self.case.title, **self.more, self.kind: self.rows, "case": self.case.text}
        try:
            atomic_write(self.path, (json.dumps(content, indent=1, default=str) + "\n").encode())
        except OSError as error:
            raise OutputError(f"{self.path}: index not written, {error.strerror}") from error


def _is_ours(path: Path) -> bool:
    """Whether a file is a result, or an HDF5 file too damaged to be recognised."""
    try:
        with open_for_reading(path) as file:
            return "format_version" in file.attrs
    except OutputError:
        return h5py.is_hdf5(path)
