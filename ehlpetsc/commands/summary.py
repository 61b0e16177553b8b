"""Results as CSV: means, percentiles and extremes of every scalar; all steps of a run; one frame.

``ehlpetsc summary RESULT.h5 [...]``, or the index of a series or of passes

One line for each result and scalar, over the time in which both surfaces fill the contact, or over the whole
run if it ends before (column ``from_s``). SI units. Means and percentiles are weighted by the time step.
``--steps`` prints the scalars of every step of one result, ``--frame STEP`` its fields at a stored step,
``--ensemble`` mean and deviation of each scalar over results that differ only in their seeds, by ensemble,
and the bounds within which 90 % of the means of resampled runs lie (bootstrap); with maxima and quantiles of
damage, and lives, where RESULT.post.h5 exists. ``--wide`` prints a row for each result: the keys in which the
cases differ and the mean of every scalar, as columns.
"""

from __future__ import annotations

import argparse
import contextlib
import csv
import io
from collections.abc import Iterable, Sequence
from pathlib import Path

from ehlpetsc.analysis.summary import ensemble_table, frame_table, steps_table, table, wide_table
from ehlpetsc.base.command_line import CommandParser, exit_status
from ehlpetsc.base.errors import UsageError
from ehlpetsc.results.index import in_order, open_all
from ehlpetsc.results.output_guard import atomic_write, check_derived, check_table, inputs_of_result
from ehlpetsc.results.reader import Result


def main(words: Sequence[str]) -> int:
    """Run the command; returns its exit status: 0 done, 2 bad input."""
    parser = CommandParser("summary", __doc__, "output")
    parser.add_argument("results", nargs="+", metavar="RESULT", help="result files, or the index of a series")
    parser.add_argument("-o", "--output", type=Path, help="CSV file [standard output]")
    kinds = parser.add_mutually_exclusive_group()
    kinds.add_argument("--steps", action="store_true", help="scalars of every step of one result, over time")
    kinds.add_argument("--frame", type=int, metavar="STEP", help="fields of one result at a stored step")
    kinds.add_argument("--ensemble", action="store_true", help="mean and deviation over seeds")
    kinds.add_argument("--wide", action="store_true", help="a row for each result, a column for each scalar")
    chosen = parser.parse_args(words)
    return exit_status("summary", lambda: _put_table(chosen), output=chosen.output)


def _put_table(chosen: argparse.Namespace) -> None:
    """Print the rows of a table of results as CSV, or write them to the file of ``-o``."""
    with contextlib.ExitStack() as stack:
        results = in_order(open_all(chosen.results, stack))
        text = io.StringIO()
        csv.writer(text, lineterminator="\n").writerows(_rows(results, chosen))
        if not chosen.output:
            print(text.getvalue(), end="")
            return
        read = [file for result in results for file in inputs_of_result(result.path, result.attrs["case"])]
        check_derived(chosen.output, [*map(Path, chosen.results), *read], (".csv",))
        check_table(chosen.output, text.getvalue().partition("\n")[0], chosen.overwrite)
        atomic_write(chosen.output, text.getvalue().encode())
        print(chosen.output)


def _rows(results: list[Result], chosen: argparse.Namespace) -> Iterable[Sequence]:
    if chosen.ensemble:
        return ensemble_table(results)
    if chosen.wide:
        return wide_table(results)
    if not chosen.steps and chosen.frame is None:
        return table(results)
    if len(results) > 1:
        raise UsageError(f"{len(results)} results; allowed with --steps and --frame: one")
    return steps_table(results[0]) if chosen.steps else frame_table(results[0], chosen.frame)
