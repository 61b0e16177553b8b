"""Series of a case: members distributed to groups of ranks, one result file each and one index file.

The index ``OUTPUT.series.json`` contains the varied key, or keys, and for each member its value, result file
(in the folder of the index) and state: "done", "not converged", "stopped", "bad input", "output lost" or
"waiting". Members with a complete file of the same case are not computed again, unfinished ones continued.
"""

from __future__ import annotations

import contextlib
import io
import re
import sys
import time as clock
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

from ehlpetsc.base.command_line import ERASE, ProgressLine, on_terminal
from ehlpetsc.base.errors import CaseError, ExitStatus, OutputError, OutputLost, UsageError
from ehlpetsc.base.toml_file import Settings, settings_of
from ehlpetsc.case.loading import members
from ehlpetsc.physics.film_formulas import smooth_films
from ehlpetsc.physics.scales import Scales
from ehlpetsc.results.index import Index
from ehlpetsc.results.means import Totals
from ehlpetsc.results.reader import is_done, read_result
from ehlpetsc.run.forecast.cost import steps
from ehlpetsc.run.forecast.validity import warnings
from ehlpetsc.run.ranks import PollingStop, StopRequest, WorkQueue, on_root
from ehlpetsc.run.recorder import Output, summary_line
from ehlpetsc.run.simulation import AcceptedState, Simulation
from ehlpetsc.run.solve import Run

if TYPE_CHECKING:
    from mpi4py import MPI

    from ehlpetsc.case.tables import Case

MAX_VALUE_LENGTH = 60  # characters
WAITING = "waiting"  # state of a member that is not computed yet
VARIED = ("key", "keys")  # of [series], in the index


def named(settings: list[Settings]) -> list[str]:
    """Names of the members of a series, as ``viscosity=0.002``, from the values in which members differ.

    Members have numbers if these names are too long or not unique, or if values are lists or tables.
    `settings` are those of each member, see `ehlpetsc.base.toml_file.settings_of`.
    """
    columns = [(column[0][0][-1], [value for _, value in column]) for column in zip(*settings, strict=True)]
    differing = [(key, values) for key, values in columns if any(value != values[0] for value in values)]
    names = [
        ",".join(f"{key}={values[n]}" for key, values in differing or columns) for n in range(len(settings))
    ]
    is_plain = not any(isinstance(value, list | dict) for _, values in columns for value in values)
    if is_plain and len(set(names)) == len(names) and max(map(len, names)) <= MAX_VALUE_LENGTH:
        return names
    label = columns[0][0] if len(columns) == 1 else "member"
    return [f"{label}={number}" for number in range(1, len(names) + 1)]


def members_of(case: Case, output: Path) -> list[Member]:
    """Members of the series of a case, with files beside `output`; UsageError if names are not unique."""
    names = named(settings_of(tomllib.loads(case.text)["series"]))
    found = [Member(name, *member, output) for name, member in zip(names, members(case), strict=True)]
    if min(len({m.output for m in found}), len({repr(m.value) for m in found})) < len(found):
        raise UsageError("series.values: two values have the same name; allowed: values that differ")
    return found


class Member:
    """Member of a series: its name, as ``viscosity=0.002``, value, case and result file."""

    def __init__(self, name: str, value: object, case: Case, output: Path) -> None:
        self.value, self.case, self.name = value, case, name
        suffix = re.sub(r"[^A-Za-z0-9.+-]", "_", name)
        self.output = output.with_name(f"{output.stem}_{suffix}.h5")

    def weight(self) -> tuple[int, float]:
        """Sort key that puts the longest members first: nodes times steps, then the thinner film."""
        scales = Scales.of(self.case)
        film = smooth_films(scales, self.case.fluid, scales.conditions)[1] if self.case.fluid else 0.0
        return scales.grid.n * (steps(self.case, scales) if self.case.time else 1), -film

    def totals(self) -> Totals:
        """Totals of the run from the result file; empty without a file."""
        with contextlib.suppress(OutputError, OSError), read_result(self.output) as result:
            return Totals.of_result(result)
        return Totals()


class PrefixedStream(io.TextIOBase):
    """Output stream that puts a name before every line; no terminal, as bars would draw over each other."""

    def __init__(self, name: str, stream: TextIO) -> None:
        self._name, self._stream, self._line = f"[{name}] ", stream, ""
        self._begin = ERASE if on_terminal(stream) else ""

    def write(self, text: str) -> None:
        *lines, self._line = (self._line + text).split("\n")
        # one write for all lines, so that the output of groups does not mix within a line
        if lines:
            self._stream.write(self._begin + "".join(f"{self._name}{line}\n" for line in lines))

    def flush(self) -> None:
        self._stream.flush()


class MemberProgress(Output):
    """Output that adds the steps of a member to the line of its series, if this rank has it."""

    def __init__(self, simulation: Simulation, line: ProgressLine | None, work: float) -> None:
        self._simulation, self._line, self._work, self._share = simulation, line, work, 0.0

    def write(self, state: AcceptedState) -> None:
        """Add the step."""
        share = float(state.time) / self._simulation.end if self._simulation.case.time else 1.0
        if self._line:
            self._line.add(self._work * max(share - self._share, 0.0))
        self._share = max(share, self._share)

    def close(self, status: ExitStatus) -> None:
        """Add steps that are left out."""
        if self._line:
            self._line.add(self._work * (1.0 - self._share))


class Series:
    """All members of a case with a series, one a rank at a time.

    The stem of `output` is the prefix of the members' file names. `overwrite` replaces results of other
    cases. UsageError, OutputError.
    """

    def __init__(
        self, world: MPI.Comm, case: Case, output: Path, stop: StopRequest, overwrite: bool = False
    ) -> None:
        self.world, self.stop, self.overwrite = world, stop, overwrite
        self.members = members_of(case, output)
        varied = {name: value for name, value in tomllib.loads(case.text)["series"].items() if name in VARIED}
        index = Index(output.with_name(f"{output.stem}.series.json"), case, "members", **varied)
        index.rows = [
            {"value": member.value, "file": member.output.name, "state": WAITING} for member in self.members
        ]
        self.index = index

    def run(self) -> ExitStatus:
        """Run the missing members; returns the exit status."""
        begun, index = clock.monotonic(), self.index
        on_root(self.world, index.acquire, self.overwrite)
        try:
            missing = on_root(self.world, self._missing)
            self._show_progress(missing)
            on_root(self.world, index.write)
            queue = WorkQueue(self.world, 1, missing, self._record)
            index.rows[:] = queue.compute(self._run_member, self.stop, lambda: index.rows)
            if self.world.rank == 0:
                self._line.clear()
                self._report(clock.monotonic() - begun)
            self._write_index()
        finally:
            index.release()
        return self._status()

    def _write_index(self) -> None:
        try:
            on_root(self.world, self.index.write)
        except OutputError as error:  # its folder is lost with the members
            raise OutputLost(str(error)) if self._status() is ExitStatus.OUTPUT_LOST else error from error

    def _show_progress(self, missing: list[int]) -> None:
        """Begin the line of progress, on a terminal, which the first rank writes."""
        self._work = {number: float(self.members[number].weight()[0]) for number in missing}
        self._is_in_line, self._own = on_terminal(sys.stdout), set[int]()
        self._line: Any = None
        if self.world.rank == 0:
            self._line = ProgressLine(f"series, {len(missing)} members", sum(self._work.values()))

    def _record(self, report: tuple[int, dict]) -> None:
        """Write the row of a member that has ended to the index, on the first rank."""
        number, row = report
        self.index.rows[number] |= row
        with contextlib.suppress(OutputError):  # of the first rank alone; it is written again at the end
            self.index.write()
        if number not in self._own:  # of another rank
            self._line.add(self._work[number])

    def _missing(self) -> list[int]:
        """Numbers of the members without a complete result, the longest first; prints the opening."""
        missing = []
        for number, member in enumerate(self.members):
            if is_done(member.output, member.case.text, member.case.digests):
                self.index.rows[number]["state"] = ExitStatus.DONE.words
            else:
                missing.append(number)
        self._print_opening(len(missing))
        return sorted(missing, key=lambda n: self.members[n].weight(), reverse=True)

    def _status(self) -> ExitStatus:
        states = {row["state"] for row in self.index.rows}
        if {WAITING, ExitStatus.STOPPED.words} & states:
            return ExitStatus.STOPPED
        failed = (ExitStatus.OUTPUT_LOST, ExitStatus.NOT_CONVERGED, ExitStatus.BAD_INPUT)
        return next((status for status in failed if status.words in states), ExitStatus.DONE)

    def _run_member(self, number: int, group: MPI.Comm, stop: PollingStop) -> dict[str, Any]:
        """Run one member on a group; returns its state and the reason of a failure."""
        member = self.members[number]
        out: Any = PrefixedStream(member.name, sys.stdout)
        err: Any = PrefixedStream(member.name, sys.stderr)
        try:
            simulation, work = Simulation(member.case, group), self._work[number]
            progress = MemberProgress(simulation, self._line, work) if self._is_in_line else None
            self._own.add(number)
            run = Run(simulation, member.output, stop, out, err, progress)
            status, failure = run.run(overwrite=self.overwrite)
        except (CaseError, OutputError, UsageError) as error:
            return {"state": ExitStatus.BAD_INPUT.words, "reason": str(error)}
        return {"state": status.words} | ({"reason": str(failure)} if failure else {})

    def _print_opening(self, missing: int) -> None:
        names = ", ".join(m.name for m in self.members)
        print(
            f"series of {len(self.members)} members, {missing} of them to compute, on "
            f"{self.world.size} rank{'s' * (self.world.size > 1)}: {names}"
        )
        names_of: dict[str, list[str]] = {}
        for member in self.members:
            for warning in warnings(member.case, Scales.of(member.case)):
                names_of.setdefault(warning, []).append(member.name)
        for warning, of_members in names_of.items():
            prefix = "" if len(of_members) == len(self.members) else f"{', '.join(of_members)}: "
            print(f"warning: {prefix}{warning}")
        sys.stdout.flush()

    def _report(self, wall: float) -> None:
        """Print the outcome on the first rank."""
        status = self._status()
        for member, row in zip(self.members, self.index.rows, strict=True):
            if "reason" in row:
                print(
                    f"ehlpetsc: {member.name}: {row['state']}: {row['reason']}", file=sys.stderr, flush=True
                )
        if status is ExitStatus.STOPPED:
            print("ehlpetsc: stopped; the same command computes what is missing")
        if self.index.path.exists():
            print(f"index: {self.index.path}")
        print(summary_line(status, Totals.of_series(m.totals() for m in self.members), wall), flush=True)
