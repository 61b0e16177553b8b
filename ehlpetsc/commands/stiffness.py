"""Stiffness and damping of a smooth contact in oil: ``ehlpetsc stiffness CASE.toml --frequencies HZ ...``.

Solves the contact under a load that is modulated by a share at each frequency, and fits the approach of the
bodies: CSV with K and C, and with the quasi-static stiffness between two steady loads at frequency 0.
"""

from __future__ import annotations

import argparse
import csv
import io
from collections.abc import Sequence
from pathlib import Path

from ehlpetsc.base.command_line import CommandParser, exit_status
from ehlpetsc.base.errors import UsageError
from ehlpetsc.case.loading import load
from ehlpetsc.results.output_guard import atomic_write, check_derived, check_table, inputs_of

COLUMNS = "frequency_Hz stiffness_N_per_m damping_N_s_per_m misfit steps".split()
AMPLITUDE = 0.01  # of the load
MIN_FREQUENCY, MAX_FREQUENCY, MAX_AMPLITUDE = 1e-3, 1e9, 0.5


def main(words: Sequence[str]) -> int:
    """Run the command; returns its exit status: 0 done, 2 bad input, 3 no convergence."""
    parser = CommandParser("stiffness", __doc__, "output set overwrite")
    parser.add_argument("case", help="case file of a smooth point contact or roller")
    parser.add_argument("-o", "--output", type=Path, metavar="FILE.csv", help="CSV file [standard output]")
    parser.add_argument("--frequencies", nargs="+", type=float, default=[], metavar="HZ", help="of the load")
    text = "of the modulation over the load [%(default)s]"
    parser.add_argument("--amplitude", type=float, default=AMPLITUDE, help=text)
    chosen = parser.parse_args(words)
    return exit_status("stiffness", lambda: _run(chosen), output=chosen.output)


def _run(chosen: argparse.Namespace) -> None:
    for frequency in chosen.frequencies:
        if not MIN_FREQUENCY <= frequency <= MAX_FREQUENCY:
            raise UsageError(
                f"--frequencies {frequency:g}: allowed: {MIN_FREQUENCY:g} to {MAX_FREQUENCY:g} Hz"
            )
    if not 0.0 < chosen.amplitude <= MAX_AMPLITUDE:
        raise UsageError(f"--amplitude {chosen.amplitude:g}: allowed: above 0 and at most {MAX_AMPLITUDE:g}")
    case = load(chosen.case, chosen.set)
    if chosen.output:
        check_derived(chosen.output, inputs_of(case), (".csv",))
        check_table(chosen.output, ",".join(COLUMNS), chosen.overwrite)
    from ehlpetsc.run.stiffness import responses

    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for found in responses(case, chosen.frequencies, chosen.amplitude):
        writer.writerow([f"{value:.6g}" for value in found])
    if chosen.output is None:
        print(text.getvalue(), end="")
        return
    atomic_write(chosen.output, text.getvalue().encode())
    print(chosen.output)
