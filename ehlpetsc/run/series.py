"""Series of a case: members distributed to groups of ranks, one result file each and one index file.

The index ``OUTPUT.series.json`` contains the varied key, or keys, and for each member its value, result file
(in the folder of the index) and state: "done", "not converged", "stopped", "bad input" or "waiting". Members
with a complete file of the same case text are not computed again; members with a restart file are continued.
"""

from __future__ import annotations

import contextlib
import re
import sys
import time as clock
import tomllib
from pathlib import Path
from typing import TYPE_CHECKING, Any, TextIO

from ehlpetsc.base.errors import CaseError, ExitStatus, OutputError, UsageError
from ehlpetsc.case.combinations import settings_of
from ehlpetsc.case.loading import members
from ehlpetsc.physics.film_formulas import smooth_films
from ehlpetsc.physics.scales import Scales
from ehlpetsc.results.index import Index, flat_keys
from ehlpetsc.results.means import Totals
from ehlpetsc.results.output_guard import OVERWRITE_ADVICE
from ehlpetsc.results.reader import read_result
from ehlpetsc.results.restart_file import is_restart_of
from ehlpetsc.run.forecast import steps
from ehlpetsc.run.outputs.progress import summary_line
from ehlpetsc.run.ranks import PollingStop, WorkQueue, on_root
from ehlpetsc.run.simulation import Simulation
from ehlpetsc.run.solve import Run
from ehlpetsc.run.warnings import warnings

if TYPE_CHECKING:
    from mpi4py import MPI

    from ehlpetsc.case.tables import Case
    from ehlpetsc.run.stop import StopRequest

MAX_NAME_LENGTH = 60  # characters


def named(settings: list[list[tuple[list[str], Any]]]) -> list[str]:
    """Names of the members of a series, as ``viscosity=0.002``, from the values in which members differ.

    A table among the values is named by the entries that differ. Members have numbers if the names are empty,
    too long or not unique. `settings` are those of each member, see `ehlpetsc.case.combinations.settings_of`.
    """
    flat = [flat_keys({".".join(keys): value for keys, value in member}) for member in settings]
    keys = list(dict.fromkeys(key for member in flat for key in member))
    keys = [key for key in keys if any(member.get(key) != flat[0].get(key) for member in flat)] or keys
    label = settings[0][0][0][-1] if len(settings[0]) == 1 else "member"
    names = []
    for number, member in enumerate(flat, 1):
        values = {key.rpartition(".")[2]: member[key] for key in keys if key in member}
        text = ",".join(f"{key}={value}" for key, value in values.items())
        has_list = any(isinstance(value, list) for value in values.values())
        is_usable = values and len(text) <= MAX_NAME_LENGTH and not has_list
        names.append(text if is_usable else f"{label}={number}")
    if len(set(names)) < len(names):
        names = [f"{label}={number}" for number in range(1, len(names) + 1)]
    return names


def members_of(case: Case, output: Path) -> list[Member]:
    """Members of the series of a case, with files beside `output`."""
    names = named(settings_of(tomllib.loads(case.text)["series"]))
    return [Member(name, *member, output) for name, member in zip(names, members(case), strict=True)]


class Member:
    """Member of a series: its name, as ``viscosity=0.002``, value, case and files."""

    def __init__(self, name: str, value: Any, case: Case, output: Path) -> None:
        self.value, self.case, self.name = value, case, name
        suffix = re.sub(r"[^A-Za-z0-9.+-]", "_", name)
        self.output = output.with_name(f"{output.stem}_{suffix}.h5")
        self.restart = self.output.with_suffix(".restart.h5")

    def state_of_files(self) -> str:
        """State of the files: "done", "begun" (with a restart file) or "waiting".

        Files of another case, damaged results and restart files with a wrong checksum count as "waiting".
        """
        with contextlib.suppress(OutputError, KeyError):
            with read_result(self.output) as result:
                if result.attrs["case"] != self.case.text:
                    return "waiting"
                if result.attrs["status"] == "done":
                    return "done"
            if is_restart_of(self.restart, self.case.text):
                return "begun"
        return "waiting"

    def is_of_another_case(self) -> bool:
        """Whether the result file belongs to another case; a damaged one is computed again."""
        with contextlib.suppress(OutputError, KeyError), read_result(self.output) as result:
            return result.attrs["case"] != self.case.text
        return False

    def weight(self) -> tuple[int, float]:
        """Sort key that puts the longest members first: nodes times steps, then the thinner film."""
        scales = Scales.of(self.case)
        film = smooth_films(self.case.fluid, scales.E, scales.conditions)[1] if self.case.fluid else 0.0
        return scales.nx * (steps(scales) if self.case.time else 1), -film

    def totals(self) -> Totals:
        """Totals of the run from the result file; empty without a file."""
        with contextlib.suppress(OutputError), read_result(self.output) as result:
            return Totals.of_result(result)
        return Totals()


class PrefixedStream:
    """Output stream that puts a name before every line."""

    def __init__(self, name: str, stream: TextIO) -> None:
        self._name, self._stream, self._line = f"[{name}] ", stream, ""

    def write(self, text: str) -> None:
        *lines, self._line = (self._line + text).split("\n")
        # one write for all lines, so that the output of groups does not mix within a line
        self._stream.write("".join(f"{self._name}{line}\n" for line in lines))

    def flush(self) -> None:
        self._stream.flush()

    def isatty(self) -> bool:
        return False  # no bar: several members would draw over each other


class Series:
    """All members of a case with a series, on groups of `ranks` ranks.

    The stem of `output` is the prefix of the members' file names. `overwrite` replaces results of other
    cases. UsageError, OutputError.
    """

    def __init__(
        self,
        world: MPI.Comm,
        case: Case,
        output: Path,
        stop: StopRequest,
        ranks: int = 1,
        overwrite: bool = False,
    ) -> None:
        self.world, self.case, self.stop = world, case, stop
        self.members = members_of(case, output)
        files = [member.output for member in self.members]
        values = {repr(member.value) for member in self.members}
        if min(len(set(files)), len(values)) < len(self.members):
            raise UsageError("series.values: two values have the same name; allowed: values that differ")
        swept = tomllib.loads(case.text)["series"]
        keys = {name: swept[name] for name in ("key", "keys") if name in swept}
        self.index = Index(output.with_name(f"{output.stem}.series.json"), case, "members", **keys)
        on_root(world, self._acquire, overwrite)
        states = world.bcast([m.state_of_files() for m in self.members] if world.rank == 0 else None)
        self.index.begin(
            {"value": m.value, "file": m.output.name, "state": "done" if state == "done" else "waiting"}
            for m, state in zip(self.members, states, strict=True)
        )
        missing = [n for n, state in enumerate(states) if state != "done"]
        missing.sort(key=lambda n: self.members[n].weight(), reverse=True)
        self.queue = WorkQueue(world, ranks, missing, self._note_end)
        self.failures: dict[int, str] = {}
        self.unwritten: OutputError | None = None
        if world.rank == 0:
            self._print_opening(ranks, len(missing))

    def run(self) -> ExitStatus:
        """Run the missing members; returns the exit status."""
        begun = clock.monotonic()
        try:
            on_root(self.world, self.index.write)
            return self.queue.compute(
                self._run_member, self.stop, lambda: self._conclude(clock.monotonic() - begun)
            )
        finally:
            self.index.release()

    def _acquire(self, overwrite: bool) -> None:
        foreign = [str(member.output) for member in self.members if member.is_of_another_case()]
        if foreign and not overwrite:
            reason = f"the result of another case, or of other --set; {OVERWRITE_ADVICE}"
            raise OutputError(f"{', '.join(foreign)}: {reason}")
        self.index.acquire(overwrite, [member.output for member in self.members])

    def _run_member(self, number: int, group: MPI.Comm, stop: PollingStop) -> tuple[ExitStatus, str]:
        """Run one member on a group; returns exit status and failure."""
        member = self.members[number]
        out: Any = PrefixedStream(member.name, sys.stdout)
        err: Any = PrefixedStream(member.name, sys.stderr)
        begun = group.bcast(group.rank == 0 and member.state_of_files() == "begun")
        try:
            run = Run(Simulation(member.case, group), member.output, stop, out, err)
            outcome = run.run(member.restart if begun else None, overwrite=True)  # checked before: it is ours
            return outcome.status, str(outcome.failure or "")
        except (CaseError, OutputError, UsageError) as error:
            if group.rank == 0:
                print(f"ehlpetsc: {error}", file=err, flush=True)
            return ExitStatus.BAD_INPUT, str(error)

    def _note_end(self, report: tuple[int, tuple[ExitStatus, str]]) -> None:
        """Record the end of a member on the first rank."""
        number, (status, failure) = report
        self.index.rows[number]["state"] = status.words
        if failure:
            self.failures[number] = failure
        self._keep_index()

    def _print_opening(self, ranks: int, missing: int) -> None:
        names = ", ".join(m.name for m in self.members)
        print(
            f"series of {len(self.members)} members, {missing} of them to compute, on "
            f"{-(-self.world.size // ranks)} x {ranks} rank(s): {names}"
        )
        names_of: dict[str, list[str]] = {}
        for member in self.members:
            for warning in warnings(member.case, Scales.of(member.case)):
                names_of.setdefault(warning, []).append(member.name)
        for warning, of_members in names_of.items():
            prefix = "" if len(of_members) == len(self.members) else f"{', '.join(of_members)}: "
            print(f"warning: {prefix}{warning}")
        sys.stdout.flush()

    def _keep_index(self) -> None:
        """Write the index in mid-run; an error of the first rank alone must not block the others."""
        try:
            self.index.write()
            self.unwritten = None
        except OutputError as error:
            self.unwritten = error

    def _conclude(self, wall: float) -> ExitStatus:
        """Print the outcome on the first rank; returns the exit status."""
        states = [row["state"] for row in self.index.rows]
        for number, failure in sorted(self.failures.items()):
            print(f"ehlpetsc: {self.members[number].name}: {states[number]}: {failure}", file=sys.stderr)
        self._keep_index()
        if self.unwritten:
            print(f"ehlpetsc: {self.unwritten}", file=sys.stderr)
        sys.stderr.flush()
        if {"waiting", "stopped"} & set(states):
            status = ExitStatus.STOPPED
            print("ehlpetsc: stopped; the same command computes what is missing")
        else:
            faults = (ExitStatus.NOT_CONVERGED, ExitStatus.BAD_INPUT)
            otherwise = ExitStatus.BAD_INPUT if self.unwritten else ExitStatus.DONE
            status = next((s for s in faults if s.words in states), otherwise)
        if not self.unwritten:
            print(f"index: {self.index.path}")
        print(summary_line(status, Totals.of_series(m.totals() for m in self.members), wall), flush=True)
        return status
