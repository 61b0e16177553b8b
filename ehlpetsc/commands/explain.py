"""The command ``ehlpetsc explain``: summary of a case before its run."""

from __future__ import annotations

import argparse
import sys

from ehlpetsc.base.command_line import CommandParser, ProgressLine, exit_status
from ehlpetsc.base.errors import CaseError
from ehlpetsc.case.loading import load
from ehlpetsc.physics.scales import Scales
from ehlpetsc.results.output_guard import inputs_of, put
from ehlpetsc.run.forecast.domain import refusals
from ehlpetsc.run.forecast.explain import explain
from ehlpetsc.surfaces.motion.roughness import Roughness


def main(words: list[str]) -> int:
    """Run the command ``ehlpetsc explain``; returns its exit status."""
    parser = CommandParser("explain", "Summary of a case before its run: film, lambda ratio, run time.")
    parser.add_argument("case", metavar="CASE.toml")
    chosen = parser.parse_args(words)
    return exit_status("explain", lambda: _explain(chosen))


def _explain(chosen: argparse.Namespace) -> None:
    """Print the summary; raise `CaseError` for a case that a run refuses."""
    # of large maps, which take most of the time
    progress = ProgressLine("explain: surfaces", 3.0, sys.stderr)
    progress.reach(0.0)
    case = load(chosen.case, chosen.set)
    progress.reach(1.0)
    rough = Roughness.of(case, Scales.of(case))
    progress.reach(2.0)
    text = explain(case, rough)
    progress.clear()
    put(text, chosen, inputs_of(case))
    if faults := refusals(case, Scales.of(case)):
        raise CaseError(faults)
