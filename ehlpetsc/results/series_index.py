"""Results of a series, opened and sorted by the varied value."""

import tomllib
from functools import reduce
from pathlib import Path

import numpy as np

from ehlpetsc.errors import OutputError
from ehlpetsc.results.index import read_index
from ehlpetsc.results.reader import read_result

MAX_NAME_LENGTH = 80  # characters
OTHER_ENDINGS = (".post.h5", ".restart.h5")  # of files next to results that match the same shell pattern


def open_all(paths, stack):
    """Results of files; for the index of a series (.series.json) the existing results of its members.

    Post-processing and restart files among results are ignored.

    Parameters
    ----------
    paths : list of path-like
    stack : contextlib.ExitStack
        Closes the results.

    Raises
    ------
    OutputError
        A file cannot be read, or no member of a series has a result.
    """
    result_paths = [path for path in paths if not str(path).endswith(OTHER_ENDINGS)]
    if not result_paths:
        kinds = {".post.h5": "of post-processing", ".restart.h5": "of a restart"}
        refused = ", ".join(
            f"{path}: a file {kinds[OTHER_ENDINGS[str(path).endswith(OTHER_ENDINGS[1])]]}" for path in paths
        )
        raise OutputError(f"{refused}; give the result, {_result_of(paths[0])}")
    return [stack.enter_context(read_result(file)) for path in result_paths for file in files_of(path)]


def _result_of(path):
    for ending in OTHER_ENDINGS:
        path = str(path).removesuffix(ending)
    return f"{path}.h5"


def files_of(path):
    """Result file of a path, or the existing result files of an index.

    Raises
    ------
    OutputError
        See `open_all`.
    """
    path = Path(path)
    if path.suffix != ".json":
        return [path]
    index = read_index(path)
    try:
        members = index["passes"] if "passes" in index else index["members"]
        files = [path.with_name(member["file"]) for member in members]
    except (ValueError, KeyError, TypeError) as error:
        raise OutputError(f"{path}: not the index of a series ({error})") from error
    existing = [file for file in files if file.exists()]
    if not existing:
        raise OutputError(f"{path}: no member of the series has a result file beside it")
    return existing


def series_values(results):
    """Key and values of the single number in which the case files of a series differ.

    Returns
    -------
    key : str or None
        Dotted key; None if no or several keys differ, or if the values are not numbers.
    values : list of float
    """
    differing = differences(results)
    if len(differing) == 1:
        ((key, values),) = differing.items()
        if all(isinstance(value, int | float) for value in values):
            return key, [float(value) for value in values]
    return None, []


def differences(results):
    """Keys in which the case files of results differ.

    Returns
    -------
    dict of str to list
        Values of each result by dotted key; None for a missing key.
    """
    tables = [flat_keys(tomllib.loads(result.attrs["case"])) for result in results]
    keys = sorted(key for key in set().union(*tables) - {"title"} if not key.startswith("series."))
    values = {key: [table.get(key) for table in tables] for key in keys}
    return {key: column for key, column in values.items() if any(value != column[0] for value in column)}


def distinguishing_names(results):
    """Names of results from the values in which their cases differ; None if these are not unique.

    Returns
    -------
    list of str or None
        For example ``viscosity = 0.002, entrainment_speed = 5``.
    """
    differing = differences(results)
    if not differing:
        return None
    last = [key.rpartition(".")[2] for key in differing]
    labels = [key if last.count(name) > 1 else name for key, name in zip(differing, last, strict=True)]
    names = [
        ", ".join(_setting(result.case, *entry) for entry in zip(differing, labels, values, strict=True))
        for result, *values in zip(results, *differing.values(), strict=True)
    ]
    if len(set(names)) < len(results) or max(map(len, names)) > MAX_NAME_LENGTH:
        return None
    return names


def _setting(case, key, label, value):
    if value is None:  # left out: its default
        value = reduce(lambda table, name: getattr(table, name, None), key.split("."), case)
    if value is None:
        return f"no {label}"
    return f"{label} = {value:g}" if isinstance(value, int | float) else f"{label} = {value}"


def flat_keys(table, prefix=""):
    """Values of nested tables by dotted key."""
    values = {}
    for key, value in table.items():
        values |= flat_keys(value, f"{prefix}{key}.") if isinstance(value, dict) else {prefix + key: value}
    return values


def in_order(results):
    """Results of a series sorted by the varied value; other results in their order."""
    key, values = series_values(results)
    return [results[i] for i in np.argsort(values, kind="stable")] if key else results
