"""Series of a case: members distributed to groups of ranks, one result file each and one index file.

The index ``OUTPUT.series.json`` contains the varied key, or keys, and for each member its value, result file
(in the folder of the index) and state: "done", "not converged", "stopped", "bad input" or "waiting". Members
with a complete file of the same case text are not computed again; members with a restart file are continued.
"""

import json
import re
import sys
import time as clock
import tomllib
from pathlib import Path

from ehlpetsc.case.combinations import settings_of
from ehlpetsc.case.loading import members
from ehlpetsc.errors import CaseError, ExitStatus, OutputError, UsageError
from ehlpetsc.physics.film_formulas import smooth_films
from ehlpetsc.physics.scales import Scales
from ehlpetsc.results.atomic_write import atomic_write, remove_stale
from ehlpetsc.results.output_guard import Lock, check_index
from ehlpetsc.results.reader import read_result
from ehlpetsc.results.restart_file import load_restart
from ehlpetsc.results.series_index import flat_keys
from ehlpetsc.results.totals import Totals
from ehlpetsc.run.forecast import steps
from ehlpetsc.run.outputs.progress import summary_line
from ehlpetsc.run.ranks import PollingStop, WorkQueue, on_root
from ehlpetsc.run.simulation import Simulation
from ehlpetsc.run.solve import Run
from ehlpetsc.run.warnings import warnings

MAX_NAME_LENGTH = 60  # characters


def named(settings):
    """Names of the members of a series, from the values in which members differ.

    A table among the values is named by the entries that differ. Members have numbers if the names are empty,
    too long or not unique.

    Parameters
    ----------
    settings : list of list of (list of str, value)
        Settings of each member, see `ehlpetsc.case.combinations.settings_of`.

    Returns
    -------
    list of str
        For example ``viscosity=0.002`` or ``viscosity=0.002,entrainment_speed=5.0``.
    """
    flat = [flat_keys({".".join(keys): value for keys, value in member}) for member in settings]
    keys = dict.fromkeys(key for member in flat for key in member)
    differing = [key for key in keys if any(member.get(key) != flat[0].get(key) for member in flat)] or list(
        keys
    )
    label = settings[0][0][0][-1] if len(settings[0]) == 1 else "member"
    names = []
    for number, member in enumerate(flat, 1):
        values = {key.rpartition(".")[2]: member[key] for key in differing if key in member}
        text = ",".join(f"{key}={value}" for key, value in values.items())
        has_list = any(isinstance(value, list) for value in values.values())
        usable = values and len(text) <= MAX_NAME_LENGTH and not has_list
        names.append(text if usable else f"{label}={number}")
    if len(set(names)) < len(names):
        names = [f"{label}={number}" for number in range(1, len(names) + 1)]
    return names


class Member:
    """Member of a series: its value, case and files.

    Attributes
    ----------
    name : str
        For example ``viscosity=0.002``.
    output, restart : Path
    """

    def __init__(self, name, value, case, output):
        self.value, self.case, self.name = value, case, name
        suffix = re.sub(r"[^A-Za-z0-9.+-]", "_", name)
        self.output = output.with_name(f"{output.stem}_{suffix}.h5")
        self.restart = self.output.with_suffix(".restart.h5")

    def state_of_files(self):
        """State of the files: "done", "begun" (with a restart file) or "waiting".

        Files of another case, damaged results and restart files with a wrong checksum count as "waiting".
        """
        try:
            with read_result(self.output) as result:
                if result.attrs["case"] != self.case.text:
                    return "waiting"
                result.check()
                if result.attrs["status"] == "done":
                    return "done"
            if load_restart(self.restart)[1]["case"] == self.case.text:
                return "begun"
        except (OutputError, KeyError):
            pass
        return "waiting"

    def is_of_another_case(self):
        """Whether the result file belongs to another case."""
        try:
            with read_result(self.output) as result:
                return result.attrs["case"] != self.case.text
        except (OutputError, KeyError):
            return False  # no file, or a damaged one, which is computed again

    def weight(self):
        """Sort key that puts the longest members first: nodes times steps, then the thinner film."""
        scales = Scales.of(self.case)
        film = smooth_films(self.case.fluid, scales.E, scales.conditions)[1] if self.case.fluid else 0.0
        return scales.nx * (steps(scales) if self.case.time else 1), -film

    def totals(self):
        """Totals of the run from the result file; empty without a file."""
        try:
            with read_result(self.output) as result:
                return Totals.of_result(result)
        except OutputError:
            return Totals()


class PrefixedStream:
    """Output stream that puts a name before every line."""

    def __init__(self, name, stream):
        self._name, self._stream, self._line = f"[{name}] ", stream, ""

    def write(self, text):
        *lines, self._line = (self._line + text).split("\n")
        # one write for all lines, so that the output of groups does not mix within a line
        self._stream.write("".join(f"{self._name}{line}\n" for line in lines))

    def flush(self):
        self._stream.flush()

    def isatty(self):
        return False  # no bar: several members would draw over each other


class Series:
    """All members of a case.

    Parameters
    ----------
    world : mpi4py communicator
    case : case.loading.Case
        Case with a series.
    output : path-like
        Its stem is the prefix of the members' file names.
    stop : stop.StopRequest
    ranks : int
        Ranks of each member.
    overwrite : bool
        Whether to replace results of other cases.

    Raises
    ------
    UsageError, OutputError
    """

    def __init__(self, world, case, output, stop, ranks=1, overwrite=False):
        self.world, self.case, self.stop = world, case, stop
        output = Path(output)
        self.index = output.parent / f"{output.stem}.series.json"
        self.swept = tomllib.loads(case.text)["series"]
        settings = settings_of(self.swept)
        self.members = [
            Member(name, value, member, output)
            for name, (value, member) in zip(named(settings), members(case), strict=True)
        ]
        files = {member.output for member in self.members}
        if min(len(files), len({repr(setting) for setting in settings})) < len(self.members):
            raise UsageError("series.values: two values have the same name; allowed: values that differ")
        if not overwrite:
            on_root(world, lambda: check_index(self.index, "members", [m.output for m in self.members]))
        foreign = world.bcast(
            [m.output for m in self.members if m.is_of_another_case()] if world.rank == 0 else None
        )
        if foreign and not overwrite:
            raise OutputError(
                f"{', '.join(map(str, foreign))}: the result of another case, or of other --set; "
                "give another -o, or --overwrite to replace it"
            )
        self._lock = Lock(self.index)
        on_root(world, self._lock.acquire)
        on_root(world, remove_stale, self.index)
        self.states = world.bcast([m.state_of_files() for m in self.members] if world.rank == 0 else None)
        self.states = ["waiting" if state == "begun" else state for state in self.states]
        missing = [n for n, state in enumerate(self.states) if state != "done"]
        missing.sort(key=lambda n: self.members[n].weight(), reverse=True)
        self.queue = WorkQueue(world, ranks, missing, self._note_end)
        self.failures, self.unwritten = {}, None
        self._print_opening(ranks, len(missing))

    def run(self):
        """Run the missing members; returns the exit status."""
        begun, report = clock.monotonic(), None
        on_root(self.world, self._write_index)
        while True:
            number = self.queue.next(report, self.stop(self.queue.group))
            if number is None:
                break
            report = (number, *self._run_member(self.members[number]))
        try:
            return self.queue.finish(lambda: self._conclude(clock.monotonic() - begun))
        finally:
            self._lock.release()

    def _run_member(self, member):
        """Run one member on this group; returns exit status and failure."""
        group = self.queue.group
        out, err = PrefixedStream(member.name, sys.stdout), PrefixedStream(member.name, sys.stderr)
        begun = group.bcast(group.rank == 0 and member.state_of_files() == "begun")
        try:
            run = Run(
                Simulation(member.case, group), member.output, PollingStop(self.queue, self.stop), out, err
            )
            outcome = run.run(member.restart if begun else None, overwrite=True)  # checked before: it is ours
            return outcome.status, str(outcome.failure or "")
        except (CaseError, OutputError, UsageError) as error:
            if group.rank == 0:
                print(f"ehlpetsc: {error}", file=err, flush=True)
            return ExitStatus.BAD_INPUT, str(error)

    def _note_end(self, report):
        """Record the end of a member on the first rank."""
        number, status, failure = report
        self.states[number] = status.words
        if failure:
            self.failures[number] = failure
        self._keep_index()

    def _print_opening(self, ranks, missing):
        if self.world.rank:
            return
        names = ", ".join(m.name for m in self.members)
        print(
            f"series of {len(self.members)} members, {missing} of them to compute, on "
            f"{-(-self.world.size // ranks)} x {ranks} rank(s): {names}"
        )
        names_of = {}
        for member in self.members:
            for warning in warnings(member.case, Scales.of(member.case)):
                names_of.setdefault(warning, []).append(member.name)
        for warning, names in names_of.items():
            prefix = "" if len(names) == len(self.members) else f"{', '.join(names)}: "
            print(f"warning: {prefix}{warning}")
        sys.stdout.flush()

    def _keep_index(self):
        """Write the index in mid-run; an error of the first rank alone must not block the others."""
        try:
            self._write_index()
            self.unwritten = None
        except OutputError as error:
            self.unwritten = error

    def _write_index(self):
        entries = [
            {"value": m.value, "file": m.output.name, "state": state}
            for m, state in zip(self.members, self.states, strict=True)
        ]
        index = {
            "title": self.case.title,
            **({"key": self.swept["key"]} if "key" in self.swept else {"keys": self.swept["keys"]}),
            "members": entries,
            "case": self.case.text,
        }
        try:
            atomic_write(self.index, (json.dumps(index, indent=1, default=str) + "\n").encode())
        except OSError as error:
            raise OutputError(f"{self.index}: index file not written, {error.strerror}") from error

    def _conclude(self, wall):
        """Print the outcome on the first rank; returns the exit status."""
        for number, failure in sorted(self.failures.items()):
            print(f"ehlpetsc: {self.members[number].name}: {self.states[number]}: {failure}", file=sys.stderr)
        self._keep_index()
        if self.unwritten:
            print(f"ehlpetsc: {self.unwritten}", file=sys.stderr)
        sys.stderr.flush()
        if any(state in ("waiting", "stopped") for state in self.states):
            status = ExitStatus.STOPPED
            print("ehlpetsc: stopped; the same command computes what is missing")
        else:
            faults = (ExitStatus.NOT_CONVERGED, ExitStatus.BAD_INPUT)
            otherwise = ExitStatus.BAD_INPUT if self.unwritten else ExitStatus.DONE
            status = next((s for s in faults if s.words in self.states), otherwise)
        if not self.unwritten:
            print(f"index: {self.index}")
        totals = Totals.of_series(m.totals() for m in self.members)
        print(summary_line(status, totals, wall), flush=True)
        return status
