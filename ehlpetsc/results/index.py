"""Several results: their index, a JSON file beside those of a series, of passes or of lives; their cases."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ehlpetsc.base.errors import ExitStatus, OutputError
from ehlpetsc.base.toml_file import similar_file
from ehlpetsc.case.checking import attribute, in_kind
from ehlpetsc.case.tables import CASE, key_of
from ehlpetsc.results.output_guard import OVERWRITE_ADVICE, Lock, atomic_write, check_output_path, inputs_of
from ehlpetsc.results.reader import Result, read_result

if TYPE_CHECKING:
    from ehlpetsc.case.loading import Case

NOT_OF_A_CASE = "series.", "output."  # tables of keys that do not distinguish results
MAX_NAME_LENGTH = 80  # characters
OTHER_ENDINGS = (".post.h5", ".restart.h5")  # of files next to results that match the same shell pattern


def read_index(path: Path) -> dict:
    """Content of an index file; OutputError."""
    try:
        content = dict(json.loads(path.read_text()))
        for row in (*content.get("members", []), *content.get("passes", [])):
            path.with_name(row["file"].strip())
        return content
    except OSError as error:
        raise OutputError(f"{path}: {error.strerror}{similar_file(path, '*.json')}") from error
    except KeyError as error:
        raise OutputError(f"{path}: not an index of ehlpetsc (a row without {error})") from error
    except (AttributeError, ValueError, TypeError) as error:
        raise OutputError(f"{path}: not an index of ehlpetsc ({error})") from error


class Index(Lock):
    """Index of results of a case, written while they are computed; with a lock.

    `kind` is the name of the list in the file, "members" or "passes"; `rows` are its entries, each with the
    name of a "file" in the folder of the index; `more` are other entries of the file.
    """

    def __init__(self, path: Path, case: Case, kind: str, **more: object) -> None:
        self.path, self.case, self.kind, self.more = path, case, kind, more
        self.rows: list[dict] = []
        super().__init__(path)

    def acquire(self, overwrite: bool = False) -> None:
        """Lock the index until it is released; OutputError if another file would be replaced."""
        check_output_path(self.path, inputs_of(self.case))
        if self.path.exists() and not overwrite and self.kind not in read_index(self.path):
            raise OutputError(f"{self.path}: exists and is not an index of ehlpetsc; {OVERWRITE_ADVICE}")
        super().acquire()

    def stored_rows(self, of_any_case: bool = False) -> list[dict]:
        """Rows in the file; [] if it is missing or, normally, of another case."""
        content = read_index(self.path) if self.path.exists() else {}
        return content.get(self.kind, []) if of_any_case or content.get("case") == self.case.text else []

    def write(self) -> None:
        """Write the file; OutputError."""
        content = {"title": self.case.title, **self.more, self.kind: self.rows, "case": self.case.text}
        atomic_write(self.path, (json.dumps(content, indent=1, default=str) + "\n").encode())


def open_all(paths: Sequence[Path], stack: ExitStack) -> list[Result]:
    """Results of files, closed by `stack`; for an index (.series.json) the existing results of its members.

    Post-processing and restart files among results are ignored. An OutputError if a file cannot be read, or
    if no member of a series has a result.
    """
    result_paths = [path for path in paths if not str(path).endswith(OTHER_ENDINGS)] or paths
    return [stack.enter_context(read_result(file)) for path in result_paths for file in files_of(path)]


def files_of(path: Path) -> list[Path]:
    """Result file of a path, or the existing ones of an index; errors as of :func:`open_all`."""
    path = Path(path)
    if path.suffix != ".json":
        return [path]
    index = read_index(path)
    rows = index.get("passes", index.get("members", []))
    # a file in the place of a member that was refused is that of another case
    files = [path.with_name(row["file"]) for row in rows if row.get("state") != ExitStatus.BAD_INPUT.words]
    existing = [file for file in files if file.exists()]
    if not existing:
        raise OutputError(f"{path}: no member of the series has a result file beside it")
    return existing


def series_values(results: list[Result]) -> tuple[str | None, list[float]]:
    """Dotted key and values of the single number in which the case files of a series differ.

    None and [] if no or several keys differ, or if the values are not numbers.
    """
    differing = differences(results)
    if len(differing) == 1:
        ((key, values),) = differing.items()
        if all(isinstance(value, int | float) for value in values):
            return key, [float(value) for value in values]
    return None, []


def differences(results: list[Result]) -> dict[str, list]:
    """Values of each result, None for a missing key, by the dotted keys in which their case files differ."""
    tables = [flat_keys(tomllib.loads(result.attrs["case"])) for result in results]
    keys = sorted(key for key in set().union(*tables) - {"title"} if not key.startswith(NOT_OF_A_CASE))
    values = {key: [table.get(key) for table in tables] for key in keys}
    return {key: column for key, column in values.items() if any(value != column[0] for value in column)}


def distinguishing_names(results: list[Result]) -> list[str] | None:
    """Names of results from the values in which their cases differ; None if these are not unique.

    For example ``viscosity = 0.002, entrainment_speed = 5``.
    """
    names = _settings(results)
    is_unique = all(names) and len(set(names)) == len(results)
    return names if is_unique and max(map(len, names)) <= MAX_NAME_LENGTH else None


def groups(results: list[Result], varied: str) -> dict[str, list[Result]]:
    """Results by the values in which their cases differ besides the keys that end in `varied`."""
    found: dict[str, list[Result]] = {}
    for name, result in zip(_settings(results, varied), results, strict=True):
        found.setdefault(name, []).append(result)
    return found


def _settings(results: list[Result], varied: str | None = None) -> list[str]:
    """Keys and values in which the case of each result differs from the others, without those `varied`."""
    columns = differences(results)
    keys = [key for key in columns if not (varied and key.endswith(varied))]
    last = [key.rpartition(".")[2] for key in keys]
    labels = [key if last.count(name) > 1 else name for key, name in zip(keys, last, strict=True)]
    pairs = list(zip(keys, labels, strict=True))
    return [
        ", ".join(_setting(result.case, key, label, columns[key][number]) for key, label in pairs)
        for number, result in enumerate(results)
    ]


def _setting(case: Case, key: str, label: str, value: object) -> str:
    if value is None:  # left out: its default
        value = setting_of(case, key)
    if value is None:
        return f"no {label}"
    return f"{label} = {value:g}" if isinstance(value, int | float) else f"{label} = {value}"


def setting_of(case: Case, key: str) -> Any:
    """Value of a dotted key in a case, in SI units; None: left out, without a default."""
    value: Any = case
    for name in key.split("."):
        value = getattr(value, attribute(name), None)
    return value


def key_with_unit(key: str, kind: str) -> str:
    """A dotted key with the unit of its values in a kind of contact."""
    declared = key_of(key, in_kind(CASE, kind))
    return f"{key} [{declared.unit or '1'}]" if declared and declared.kind in (int, float) else key


def flat_keys(table: dict, prefix: str = "") -> dict[str, Any]:
    """Values of nested tables by dotted key."""
    values: dict[str, Any] = {}
    for key, value in table.items():
        values |= flat_keys(value, f"{prefix}{key}.") if isinstance(value, dict) else {prefix + key: value}
    return values


def in_order(results: list[Result]) -> list[Result]:
    """Results of a series sorted by the varied value; other results in their order."""
    key, values = series_values(results)
    return [results[i] for i in np.argsort(values, kind="stable")] if key else results
