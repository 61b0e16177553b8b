"""Ensembles of runs that differ in seeds alone: means with bootstrap intervals.

``ehlpetsc ensemble OUTPUT.series.json [-o OUTPUT.ensemble.csv]``

A scalar of a run is the mean over the time in which the roughness of both surfaces fills the contact (over
the whole run if it ends before) or, for minimum films and maximum pressures, the extreme. Members whose cases
differ only in seeds form one ensemble; several ensembles, as of a grid over seeds and speeds, are listed one
by one. If RESULT.post.h5 exists, quantiles of damage are included.
"""

from __future__ import annotations

import argparse
import contextlib
import csv
import io
import json
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ehlpetsc.base.command_parser import CommandParser, exit_status
from ehlpetsc.base.errors import OutputError, not_written
from ehlpetsc.effects.quantities import STEP_SCALARS
from ehlpetsc.results.index import differences, open_all
from ehlpetsc.results.means import filled_weights, mean
from ehlpetsc.results.output_guard import atomic_write, check_derived
from ehlpetsc.results.post_result import PostResult, damage_beside
from ehlpetsc.results.reader import Result

QUANTILES = (0.5, 0.9, 0.99)  # of damage over the points of a surface
EXTREMES = {"h_min": min, "p_max": max, "oil_pressure": max, "mass_error": max, "load_error": max}
EXCLUDED_SCALARS = ("step", "time", "dt", "wall", "load", "approach")
RESAMPLES = 2000  # default of the bootstrap
MAX_RESAMPLES = 100_000
CONFIDENCE = 0.95  # of the intervals
TABLES = {".csv": b"ensemble,figure,units,runs,", ".json": b'"ensemble":'}  # suffixes and signatures
COLUMNS = ("ensemble", "figure", "units", "runs", "mean", "low", "high", "min", "max")


@dataclass(frozen=True)
class Ensemble:
    """Runs that differ in their seeds.

    Attributes
    ----------
    name
        Keys and values in which it differs from the other ensembles; "" for a single ensemble.
    values
        Values of the keys in which ensembles differ.
    scalars
        Scalars of every run by name, shape (runs,).
    """

    name: str
    values: dict
    scalars: dict[str, np.ndarray]


def run_scalars(result: Result) -> dict[str, float]:
    """Scalars of one run, by name; OutputError without a time step.

    Means over the time in which the roughness of both surfaces fills the contact, or over the whole run if it
    never does; extremes of the scalars in `EXTREMES`. If RESULT.post.h5 exists, also quantiles of damage and
    flash temperatures [K].
    """
    if not len(result.steps("time")):
        raise OutputError(f"{result.path}: no time step in it")
    weights = filled_weights(result, or_whole_run=True)
    selected = weights > 0.0
    scalars = {}
    for name in result.scalars:
        values = result.steps(name)[selected].astype(float)
        if name in EXCLUDED_SCALARS or not np.isfinite(values).all():
            continue
        reduce = EXTREMES.get(name)
        scalars[name] = float(reduce(values)) if reduce else mean(result, name, weights)
    post = damage_beside(result)
    return scalars | _damage(post) | _flash_temperatures(post) if post else scalars


def _damage(post: PostResult) -> dict[str, float]:
    """Quantiles of damage over the points of each surface, at every depth."""
    quantiles = {}
    for surface in post.surfaces:
        for depth, values in zip(post.z, post.passed(surface), strict=True):
            for quantile in QUANTILES if values.size else ():
                name = f"damage_{surface} z/a={depth:g} q={quantile:g}"
                quantiles[name] = float(np.quantile(values, quantile))
    return quantiles


def _flash_temperatures(post: PostResult) -> dict[str, float]:
    """Maximum and median flash temperature [K] over the points of each surface; {} without heat."""
    scalars = {}
    for side, temperatures in post.temperatures.items():
        flash = temperatures.flash[np.isfinite(temperatures.flash)]
        if flash.size:
            scalars[f"flash_temperature_{side} largest"] = float(flash.max())
            scalars[f"flash_temperature_{side} q=0.5"] = float(np.median(flash))
    return scalars


def bootstrap(
    values: Sequence[float] | np.ndarray,
    resamples: int = RESAMPLES,
    seed: int = 1,
    confidence: float = CONFIDENCE,
) -> tuple[float, float]:
    """Confidence interval of a mean: percentiles of the means of samples with replacement (Efron 1979).

    nan for less than two values.
    """
    runs = np.asarray(values, dtype=float)
    if runs.size < 2:
        return np.nan, np.nan
    draws = np.random.default_rng(seed).integers(runs.size, size=(resamples, runs.size))
    tail = 50.0 * (1.0 - confidence)
    low, high = np.percentile(runs[draws].mean(axis=1), (tail, 100.0 - tail))
    return float(low), float(high)


def _units(name: str) -> str:
    if name.startswith("flash_temperature"):
        return "K"
    return STEP_SCALARS[name].units if name in STEP_SCALARS else "1"


def ensembles(results: list[Result]) -> list[Ensemble]:
    """Ensembles of results whose cases differ only in keys named seed, in order of their first results."""
    differing = {
        key: values for key, values in differences(results).items() if key.rpartition(".")[2] != "seed"
    }
    groups: dict[str, tuple[dict, list]] = {}
    for number, result in enumerate(results):
        conditions = {key: values[number] for key, values in differing.items()}
        key = json.dumps(conditions, default=str)
        groups.setdefault(key, (conditions, []))[1].append(run_scalars(result))
    made = []
    for conditions, runs in groups.values():
        shared = [name for name in runs[0] if all(name in run for run in runs)]
        name = ", ".join(f"{key.rpartition('.')[2]} = {value}" for key, value in conditions.items())
        made.append(Ensemble(name, conditions, {n: np.array([run[n] for run in runs]) for n in shared}))
    return made


def table(all_ensembles: list[Ensemble], resamples: int = RESAMPLES, seed: int = 1) -> list[dict]:
    """Rows of the table, one for each scalar of each ensemble, with the keys `COLUMNS`."""
    rows = []
    for ensemble in all_ensembles:
        for name, values in ensemble.scalars.items():
            low, high = bootstrap(values, resamples, seed)
            row = (
                ensemble.name,
                name,
                _units(name),
                values.size,
                values.mean(),
                low,
                high,
                values.min(),
                values.max(),
            )
            rows.append(dict(zip(COLUMNS, row, strict=True)))
    return rows


def write(rows: list[dict], path: Path) -> None:
    """Write the table as CSV, or as JSON if the name ends in .json; OutputError."""
    table = io.StringIO(newline="")
    if Path(path).suffix.lower() == ".json":
        plain = [{k: None if v != v else v for k, v in row.items()} for row in rows]
        json.dump(plain, table, indent=1, default=float)
    else:
        writer = csv.DictWriter(table, COLUMNS)
        writer.writeheader()
        writer.writerows(rows)
    try:
        atomic_write(path, table.getvalue().encode())
    except OSError as error:
        raise OutputError(not_written(error, path)) from None


def text(rows: list[dict]) -> list[str]:
    """Lines of the table, for printing."""
    widths = [max(len(name), *(len(str(row[name])) for row in rows)) for name in COLUMNS[:4]]
    lines = [" ".join(f"{n:<{w}}" for n, w in zip(COLUMNS, widths, strict=False))]
    lines[0] += "".join(f"{name:>12}" for name in COLUMNS[4:])
    for row in rows:
        line = " ".join(f"{row[n]!s:<{w}}" for n, w in zip(COLUMNS, widths, strict=False))
        lines.append(line + "".join(f"{row[name]:>12.4g}" for name in COLUMNS[4:]))
    return lines


def arguments(argv: Sequence[str]) -> argparse.Namespace:
    """Parse the command line."""
    parser = CommandParser("ensemble", __doc__)
    parser.add_argument("results", nargs="+", metavar="RESULT", help="index of a series, or result files")
    parser.add_argument("-o", "--output", type=Path, help="table, .csv or .json [OUTPUT.ensemble.csv]")
    samples = f"of the bootstrap, 1 to {MAX_RESAMPLES} [{RESAMPLES}]"
    parser.add_argument(
        "--resamples", type=_whole_number_within(1, MAX_RESAMPLES), default=RESAMPLES, help=samples
    )
    parser.add_argument("--seed", type=_whole_number_within(0, 2**63), default=1, help="of the bootstrap [1]")
    return parser.parse_args(argv)


def _whole_number_within(low: int, high: int) -> Callable[[str], int]:
    """Argument type: integer in a range."""

    def number(text: str) -> int:
        if not text.isascii() or not text.isdigit() or not low <= int(text[:20]) <= high:
            raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from {low} to {high}")
        return int(text)

    return number


def main(words: Sequence[str]) -> int:
    """Run the command; returns its exit status: 0 done, 2 bad input."""
    chosen = arguments(words)
    stem = chosen.results[0].removesuffix(".series.json").removesuffix(".h5")
    output = chosen.output or Path(f"{stem}.ensemble.csv")
    return exit_status("ensemble", lambda: _run(chosen, output), (tomllib.TOMLDecodeError,), output)


def _run(chosen: argparse.Namespace, output: Path) -> None:
    with contextlib.ExitStack() as stack:
        results = open_all(chosen.results, stack)
        read = [*map(Path, chosen.results), *(result.path for result in results)]
        check_derived(output, read, tuple(TABLES), signature=TABLES.get(output.suffix.lower(), b""))
        found = ensembles(results)
    if len(found) == len(results) > 1:
        raise OutputError(
            f"{len(results)} results of as many conditions: no two differ in their seeds alone; "
            "ehlpetsc summary lists single runs"
        )
    rows = table(found, chosen.resamples, chosen.seed)
    write(rows, output)
    print("\n".join(text(rows)))
    print(output)
