"""Results of a series, opened and sorted by their swept value."""

import contextlib
import json
import tomllib
from pathlib import Path

import numpy as np

from ehlpetsc.command_parser import CommandParser, exit_status
from ehlpetsc.errors import OutputError
from ehlpetsc.results.reader import read_result

MAX_NAME_LENGTH = 80  # characters of a name
DEFAULTS = {
    "contact.model": "direct",
    "contact.boundary_friction": 0.0,
    "contact.minimum_film": 0.0,
    "motion.slide_roll_ratio": 0.0,
    "time.courant": 0.5,
    "time.passes": 1,
    "time.pass_shift": 0.0,
    "output.every": 1,
}  # of keys that a case leaves out
OTHER_ENDINGS = (".post.h5", ".restart.h5")  # beside results, and matched by the same pattern of a shell
WITH_FILM = ("fluid.viscosity", "motion.entrainment_speed")  # keys with which films grow and fall


def open_all(paths, stack):
    """Results of files; of the index of a series (.series.json) those of its members that exist.

    Files of post-processing and restart files among results are left out.

    Parameters
    ----------
    paths : list of path-like
    stack : contextlib.ExitStack
        Closes them.

    Raises
    ------
    OutputError
        A file cannot be read, or no member of a series has one.
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


def command(name, about, report, arguments):
    """Run a command that prints the lines of a report on results.

    Parameters
    ----------
    name : str
        Module of the command.
    about : str
        What it is for.
    report : callable
        Takes the opened results, returns lines.
    arguments : list of str or None

    Returns
    -------
    int
        Exit status: 0 done, 2 bad input.
    """
    parser = CommandParser(name, about)
    parser.add_argument("results", nargs="+", metavar="RESULT", help="index of a series, or result files")
    chosen = parser.parse_args(arguments)

    def run():
        with contextlib.ExitStack() as stack:
            print("\n".join(report(open_all(chosen.results, stack))))

    return exit_status(name, run)


def files_of(path):
    """Result files of a name; of a series' index those of its members that have one.

    Raises
    ------
    OutputError
        As of `open_all`.
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
    there = [file for file in files if file.exists()]
    if not there:
        raise OutputError(f"{path}: no member of the series has a result file beside it")
    return there


def read_index(path):
    """Content of an index file.

    Raises
    ------
    OutputError
    """
    try:
        return json.loads(path.read_text())
    except OSError as error:
        raise OutputError(f"{path}: {error.strerror}") from error
    except ValueError as error:
        raise OutputError(f"{path}: not the index of a series ({error})") from error


def series_values(results):
    """Key and numbers of the one number in which the case files of a series differ.

    Returns
    -------
    key : str or None
        Dotted key, None if no single key differs or it holds no numbers.
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
        By dotted key the value of each result, None where it has none.
    """
    tables = [flat_keys(tomllib.loads(result.attrs["case"])) for result in results]
    keys = sorted(key for key in set().union(*tables) - {"title"} if not key.startswith("series."))
    values = {key: [table.get(key) for table in tables] for key in keys}
    return {key: found for key, found in values.items() if any(value != found[0] for value in found)}


def distinguishing_names(results):
    """Names of results by the values in which their cases differ; None where these are not unique.

    Returns
    -------
    list of str or None
        As ``viscosity = 0.002, entrainment_speed = 5``.
    """
    differing = differences(results)
    last = [key.rpartition(".")[2] for key in differing]
    words = [key if last.count(word) > 1 else word for key, word in zip(differing, last, strict=True)]
    names = [
        ", ".join(_shown(*named) for named in zip(differing, words, row, strict=True))
        for row in zip(*differing.values(), strict=True)
    ]
    if len(set(names)) < len(results) or max(map(len, names)) > MAX_NAME_LENGTH:
        return None
    return names


def _shown(key, word, value):
    value = DEFAULTS.get(key) if value is None else value
    if value is None:  # a key that this case leaves out
        return f"no {word}"
    return f"{word} = {value:g}" if isinstance(value, int | float) else f"{word} = {value}"


def flat_keys(table, prefix=""):
    """Values of nested tables by dotted key."""
    found = {}
    for key, value in table.items():
        found |= flat_keys(value, f"{prefix}{key}.") if isinstance(value, dict) else {prefix + key: value}
    return found


def in_order(results):
    """A series sorted by its swept value; other results as they come."""
    key, values = series_values(results)
    return [results[i] for i in np.argsort(values, kind="stable")] if key else results


def from_thick_to_thin(results):
    """A series sorted so that its film falls along it: viscosity and speed from high to low, others as swept.

    Returns
    -------
    results : list of Result
    values : list of float
    key : str

    Raises
    ------
    OutputError
        They are not a series over numbers.
    """
    key, _ = series_values(results)
    if key is None:
        raise OutputError("not a series: the case files differ in no single number")
    ordered = in_order(results)[:: -1 if key in WITH_FILM else 1]
    return ordered, series_values(ordered)[1], key
