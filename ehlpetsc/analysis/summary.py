"""Means, percentiles and extremes of every scalar of runs, as CSV.

``ehlpetsc summary RESULT.h5 [...]``, or the index of a series or of passes

One line for each result and scalar, over the time in which both surfaces fill the contact, or over the whole
run if it ends before (column ``from_s``). SI units. Means and percentiles are weighted by the time step.
"""

import contextlib
import csv
import io
from pathlib import Path

import numpy as np

from ehlpetsc.command_parser import CommandParser, exit_status
from ehlpetsc.quantities import STEP_SCALARS
from ehlpetsc.results.atomic_write import atomic_write
from ehlpetsc.results.index import distinguishing_names, in_order, open_all, series_values
from ehlpetsc.results.means import filled_weights, mean, weighted_percentiles
from ehlpetsc.results.output_guard import check_derived

EXCLUDED_SCALARS = ("step", "time", "dt", "wall", "approach")
PERCENTILES = (5.0, 50.0, 95.0)
COLUMNS = tuple("result case scalar unit mean p5 median p95 min max last from_s steps".split())


def statistics(result):
    """Statistics of each scalar of a result.

    Parameters
    ----------
    result : ehlpetsc.results.reader.Result

    Returns
    -------
    list of tuple
        Values of `COLUMNS` from "scalar" on.
    """
    time, dt = result.steps("time"), np.nan_to_num(result.steps("dt"))
    weights = filled_weights(result, or_whole_run=True)
    rows = []
    for name in [name for name in STEP_SCALARS if name in result.scalars and name not in EXCLUDED_SCALARS]:
        values = result.steps(name).astype(float)
        usable = np.isfinite(values) & (weights > 0.0)
        if usable.any():
            v, w = values[usable], weights[usable]
            percentiles = weighted_percentiles(v, w, PERCENTILES)
            reduced = (mean(result, name, weights), *percentiles, v.min(), v.max(), v[-1])
            unit = result[f"steps/{name}"].attrs.get("units", STEP_SCALARS[name].units)
            begin = (time - dt)[usable][0]
            rows.append((name, unit, *(f"{x:.6g}" for x in reduced), f"{begin:.6g}", int(usable.sum())))
    return rows


def table(results):
    """Names of the columns, then the rows of all results."""
    key, values = series_values(results)
    cases = [f"{key} = {v:g}" for v in values] if key else distinguishing_names(results)
    cases = cases or [str(result.attrs["title"]) for result in results]
    rows = [COLUMNS]
    for result, case in zip(results, cases, strict=True):
        rows += [(result.path.name, case, *row) for row in statistics(result)]
    return rows


def main(words):
    """Run the command; returns its exit status: 0 done, 2 bad input."""
    description = "Means, percentiles and extremes of every scalar of runs, as CSV."
    parser = CommandParser("summary", description)
    parser.add_argument("results", nargs="+", metavar="RESULT", help="result files, or the index of a series")
    parser.add_argument("-o", "--output", type=Path, help="CSV file [standard output]")
    chosen = parser.parse_args(words)
    return exit_status("summary", lambda: _run(chosen), output=chosen.output)


def _run(chosen):
    with contextlib.ExitStack() as stack:
        results = in_order(open_all(chosen.results, stack))
        text = io.StringIO()
        csv.writer(text, lineterminator="\n").writerows(table(results))
        if not chosen.output:
            print(text.getvalue(), end="")
            return
        read = [*map(Path, chosen.results), *(result.path for result in results)]
        check_derived(chosen.output, read, {".csv": ",".join(COLUMNS[:4]).encode()})
        atomic_write(chosen.output, text.getvalue().encode())
        print(chosen.output)
