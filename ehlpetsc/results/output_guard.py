"""Checks of an output path, the lock against a second run, and atomic writes.

No command replaces what it reads or what the case of a result names. A text, a table other than the one that
is written, and any file that other programs write too are replaced with --overwrite alone.
"""

from __future__ import annotations

import contextlib
import fcntl
import glob
import os
import socket
import tempfile
import tomllib
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from ehlpetsc.base.environment import first_rank
from ehlpetsc.base.errors import OutputError, not_written

if TYPE_CHECKING:
    import argparse

    from ehlpetsc.case.loading import Case

TEMPORARY = ".tmp.{}@{}.{}"  # process, its machine, and name of the file that it replaces
OVERWRITE_ADVICE = "give another -o, or --overwrite to replace it"
PICTURES = (".png", ".svg", ".pdf", ".eps", ".ps", ".jpg", ".jpeg", ".tif", ".tiff", ".webp")
PAGES = (".html", ".htm")


def file_path(text: str | os.PathLike) -> Path:
    """Path of an output file; OutputError without the name of a file, as that of ``.``."""
    path = Path(text)
    if not path.name:
        raise OutputError(f"{path}: a folder, not a file to write a result to; give the name of a file")
    return path


def check_output_path(path: Path, inputs: Iterable[Path], option: str = "-o") -> None:
    """Refuse an output path, that of `option`, that is an input or cannot be written: OutputError."""
    try:
        exists = path.exists()
        _temporary(path).exists()  # may be too long a name
        tempfile.TemporaryFile(dir=path.parent).close()
    except OSError as error:  # or in a folder that this user may not search
        raise OutputError(not_written(error, path)) from error
    if exists and not path.is_file():
        kind = "a folder" if path.is_dir() else "a device or pipe"
        raise OutputError(f"{path}: {kind}, not a file to write a result to; give another {option}")
    for read in inputs:
        if exists and read.exists() and path.samefile(read):
            raise OutputError(f"{path}: is read by this run ({read}); give another {option}")


def check_derived(path: Path, inputs: Iterable[Path], endings: tuple[str, ...], option: str = "-o") -> None:
    """Refuse a derived output path that is an input or has another ending."""
    check_output_path(path, inputs, option)
    if path.suffix.lower() not in endings:
        raise OutputError(f"{path}: allowed for {option}: a name that ends in {', '.join(endings)}")


def check_new(path: Path, overwrite: bool, option: str = "-o") -> None:
    """Refuse an existing file without `overwrite`."""
    if not overwrite and path.exists():
        raise OutputError(f"{path}: exists; give another {option}, or --overwrite to replace it")


def check_table(path: Path, heading: str, overwrite: bool, option: str = "-o") -> None:
    """Refuse to replace a file that does not begin with the heading of the table, without `overwrite`.

    `heading`: names of the columns, or the first ones that all such tables have.
    """
    if overwrite or not path.exists():
        return
    begin = heading.strip().encode()
    with open(path, "rb") as file:
        first = file.read(len(begin))
    if first != begin:
        raise OutputError(
            f"{path}: exists, and its first line is not that of this table; give another {option}, or "
            "--overwrite to replace it"
        )


class Lock:
    """Lock on an output from :meth:`acquire` to :meth:`release`.

    It is a file lock of the operating system on ``OUTPUT.lock``, which ends with a killed process.
    """

    def __init__(self, path: Path) -> None:
        self._output, self._path = path, path.with_name(path.name + ".lock")
        self._file: TextIO | None = None

    def acquire(self) -> None:
        """Acquire the lock; an OutputError names the process that has it."""
        try:
            file = open(self._path, "a+")
        except OSError as error:
            raise OutputError(not_written(error, self._output)) from error
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            file.seek(0)
            process = file.read().strip() or "another process"
            file.close()
            advice = "wait for it, or give another -o"
            raise OutputError(f"{self._output}: is being written by {process}; {advice}") from None
        except OSError:
            pass  # a file system without locks
        if not (self._path.exists() and os.path.samestat(self._path.stat(), os.fstat(file.fileno()))):
            file.close()  # the previous process removed the file between opening and locking
            return Lock.acquire(self)
        file.truncate(0)
        with contextlib.suppress(OSError):  # on a full disk it locks without a name
            os.write(file.fileno(), f"process {os.getpid()} on {socket.gethostname()}\n".encode())
        self._file = file

    def release(self) -> None:
        """Release the lock; further calls have no effect."""
        if self._file:
            with contextlib.suppress(OSError):
                self._path.unlink()
            self._file.close()
            self._file = None


def inputs_of(case: Case) -> list[Path]:
    """Files from which a case is read."""
    sides = (case.surface.body_1, case.surface.body_2)
    folder = Path(case.path).parent
    files = [table.file for table in (*sides, case.operation) if table]
    files += [case.gears.load_file] if case.gears else []
    masks = [(folder / table.file).parent / table.mask for table in sides if table and table.mask]
    return [Path(case.path), *(folder / name for name in files if name), *masks]


NAMES_OF_FILES = "file", "mask", "load_file"  # keys of a case


def inputs_of_result(path: Path, case: str) -> list[Path]:
    """A result file, and the files that the text of its case names, beside it or in the working folder."""
    names = _named(tomllib.loads(case))
    return [path, *(place for name in names for place in (path.parent / name, Path(name)))]


def _named(table: dict) -> Iterator[str]:
    """Names of files in the table of a case and in those within it; of a mask beside its file too."""
    for key, value in table.items():
        if isinstance(value, dict):
            yield from _named(value)
        elif key in NAMES_OF_FILES and isinstance(value, str):
            yield value
            if key == "mask":
                yield str(Path(table.get("file", "")).parent / value)


def put(text: str, chosen: argparse.Namespace, inputs: Iterable[Path] = ()) -> None:
    """Print a text on the first rank, or write it to the file of ``-o``."""
    if not first_rank():
        return
    if chosen.output is None:
        print(text, end="" if text.endswith("\n") else "\n")
        return
    check_output_path(chosen.output, inputs)
    check_new(chosen.output, chosen.overwrite)
    atomic_write(chosen.output, text.encode())
    print(chosen.output)


def _temporary(target: Path) -> Path:
    return target.with_name(TEMPORARY.format(os.getpid(), socket.gethostname(), target.name))


def _is_alive(process: str) -> bool:
    """Whether a process of this machine is alive."""
    try:
        os.kill(int(process), 0)
    except PermissionError:  # of another user
        return True
    except (OSError, OverflowError, ValueError):
        return False
    return True


@contextlib.contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """Context manager of a temporary file beside `path`: renamed at the end, removed after an error.

    It is created within, as a killed process would leave an empty one; that it can be is checked first. An
    error of the system becomes an OutputError. Of processes that write the same file at once the last one
    replaces it. What killed ones of this machine left is removed.
    """
    target = Path(os.path.realpath(path))
    temporary = _temporary(target)
    try:
        of_machine = TEMPORARY.format("*", *map(glob.escape, (socket.gethostname(), target.name)))
        for old in target.parent.glob(of_machine):
            if not _is_alive(old.name.removeprefix(".tmp.").partition("@")[0]):
                old.unlink(missing_ok=True)
        temporary.touch()
        temporary.unlink()
        yield temporary
        temporary.touch()
        os.replace(temporary, target)
    except BaseException as error:
        with contextlib.suppress(OSError):
            temporary.unlink()
        if isinstance(error, OSError) and error.errno:
            raise OutputError(not_written(error, path)) from error
        raise


def atomic_write(path: Path, content: bytes) -> None:
    """Replace `path` by a file with these bytes, synchronised to disk; errors leave no temporary file."""
    with replacing(path) as temporary, open(temporary, "wb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
