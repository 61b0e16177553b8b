"""A case with [series]: its members dealt to groups of ranks, one result file a member, one index file.

The index ``OUTPUT.series.json`` names the swept key and, for each member, its value, result file (beside the
index) and state: "done", "not converged", "stopped", "bad input" or "waiting". What a member's file holds
already is not computed again: a whole file of the same case text is kept, a restart file of it gone on with.
"""

import json
import os
import re
import sys
import time as clock
from pathlib import Path

from ehlpetsc.case.loading import members
from ehlpetsc.errors import NotConverged, OutputError, UsageError
from ehlpetsc.nonlinear.newton import set_defaults
from ehlpetsc.nonlinear.options import text_of
from ehlpetsc.physics.scales import Scales
from ehlpetsc.results.writer import load_restart, read_result
from ehlpetsc.run.describe import warnings
from ehlpetsc.run.forecast import dowson_higginson, steps
from ehlpetsc.run.progress import summary_line
from ehlpetsc.run.simulation import DONE, NOT_CONVERGED, STOPPED, Run
from ehlpetsc.run.work_queue import Dealer

BAD_INPUT = 2
STATES = {DONE: "done", BAD_INPUT: "bad input", NOT_CONVERGED: "not converged", STOPPED: "stopped"}


class Named:
    """A stream that puts a name before every line; for output only."""

    def __init__(self, name, stream):
        self._name, self._stream, self._line = f"[{name}] ", stream, ""

    def write(self, text):
        *whole, self._line = (self._line + text).split("\n")
        # one write a batch of lines: the groups' output then does not mix within a line
        self._stream.write("".join(f"{self._name}{line}\n" for line in whole))

    def flush(self):
        self._stream.flush()

    def isatty(self):
        return False  # no bar: several members would draw over each other


class Member:
    """One member: its value, case and files.

    Attributes
    ----------
    name : str
        As in ``viscosity=0.002``.
    output, restart : Path
    """

    def __init__(self, number, key, value, case, output):
        word = key.rpartition(".")[2]
        shown = str(value)
        if isinstance(value, dict | list) or len(shown) > 40:
            shown = str(number + 1)
        self.value, self.case, self.name = value, case, f"{word}={shown}"
        plain = re.sub(r"[^A-Za-z0-9.+-]", "_", shown)
        self.output = output.with_name(f"{output.stem}_{word}_{plain}.h5")
        self.restart = self.output.with_suffix(".restart.h5")

    def stands(self):
        """What its files hold of the same case: "done", "begun" (a restart file) or "waiting"."""
        try:
            with read_result(self.output) as result:
                if result.attrs["case"] == self.case.text and result.attrs["status"] == "done":
                    return "done"
            if load_restart(self.restart)[1]["case"] == self.case.text:
                return "begun"
        except (OutputError, KeyError):
            pass
        return "waiting"

    def weight(self):
        """For dealing the longest first: nodes times steps; of equals, the thinner film."""
        scales = Scales.of(self.case)
        film = dowson_higginson(scales, self.case.fluid.pressure_viscosity) if self.case.fluid else 0.0
        return scales.nx * (steps(scales) if self.case.time else 1), -film

    def totals(self):
        """Figures of its run for the summary, from the result file; None without one."""
        try:
            with read_result(self.output) as result:
                of = result.steps
                return {
                    "steps": int(of("step").max(initial=0)),
                    "newton": int(of("newton").sum()),
                    "h_min": of("h_min").min(),
                    "p_max": of("p_max").max(),
                    "contacts": int(of("contacts").sum()),
                    "load_error": of("load_error").max(),
                    "mass_error": of("mass_error").max(),
                }
        except (OutputError, ValueError):
            return None


class Series:
    """All members of a case.

    Parameters
    ----------
    world : mpi4py communicator
    case : case.Case
        With a series.
    options : petsc4py.PETSc.Options
    stop : stop.StopRequest
    output : path-like
        Its stem begins the members' file names.

    Raises
    ------
    options.UsageError, output.OutputError
    """

    def __init__(self, world, case, options, stop, output):
        if options.hasName("ehl_restart"):
            raise UsageError("-ehl_restart with a [series]: leave it out, begun members are gone on with")
        self.world, self.case, self.options, self.stop = world, case, options, stop
        output = Path(output)
        self.index = output.with_suffix(".series.json")
        self.members = [
            Member(number, case.series.key, value, member, output)
            for number, (value, member) in enumerate(members(case))
        ]
        if len({member.output for member in self.members}) < len(self.members):
            raise UsageError("series.values: two values have the same name; allowed: values that differ")
        ranks = ranks_per_member(options, world.size)
        self.states = world.bcast([m.stands() for m in self.members] if world.rank == 0 else None)
        self.states = ["waiting" if state == "begun" else state for state in self.states]
        missing = [n for n, state in enumerate(self.states) if state != "done"]
        missing.sort(key=lambda n: self.members[n].weight(), reverse=True)
        self.dealer = Dealer(world, ranks, missing, self._take)
        self.failures = {}
        self._announce(ranks, len(missing))

    def go(self):
        """Run what is missing. Returns the exit status."""
        begun = clock.monotonic()
        self._write_index()
        report = None
        while True:
            number = self.dealer.next(report, self.stop(self.dealer.group))
            if number is None:
                break
            report = (number, *self._run(self.members[number]))
        return self.dealer.finish(lambda: self._conclude(clock.monotonic() - begun))

    def _run(self, member):
        """Run one member on this group; its exit status and why it failed."""
        group = self.dealer.group
        entered = set_defaults(self.options, member.case.petsc)
        if self.case.series.key.startswith("petsc."):
            entered.append(self.case.series.key.partition(".")[2])
        out, err = Named(member.name, sys.stdout), Named(member.name, sys.stderr)
        begun = group.bcast(group.rank == 0 and member.stands() == "begun")
        try:
            run = Run(group, member.case, self.options, self._stop, member.output, out, err)
            return run.go(member.restart if begun else None), run.failure
        except (NotConverged, OutputError, UsageError) as error:
            if group.rank == 0:
                print(f"ehlpetsc: {error}", file=err, flush=True)
            return NOT_CONVERGED if isinstance(error, NotConverged) else BAD_INPUT, str(error)
        finally:
            for name in entered:
                self.options.delValue(name)

    def _stop(self, group):
        self.dealer.serve()
        return self.stop(group)

    def _take(self, report):
        """Note on the first rank how a member ended."""
        number, status, failure = report
        self.states[number] = STATES[status]
        if failure:
            self.failures[number] = failure
        self._write_index()

    def _announce(self, ranks, missing):
        if self.world.rank:
            return
        names = ", ".join(m.name for m in self.members)
        print(
            f"series of {len(self.members)} members, {missing} of them to compute, on "
            f"{-(-self.world.size // ranks)} x {ranks} rank(s): {names}"
        )
        said = {}
        for member in self.members:
            for line in warnings(member.case, Scales.of(member.case)):
                said.setdefault(line, []).append(member.name)
        for line, whose in said.items():
            of = "" if len(whose) == len(self.members) else f"{', '.join(whose)}: "
            print(f"warning: {of}{line}")
        sys.stdout.flush()

    def _write_index(self):
        if self.world.rank:
            return
        entries = [
            {"value": m.value, "file": m.output.name, "state": state}
            for m, state in zip(self.members, self.states, strict=True)
        ]
        index = {
            "title": self.case.title,
            "key": self.case.series.key,
            "members": entries,
            "case": self.case.text,
        }
        beside = self.index.with_name(self.index.name + ".tmp")
        try:
            beside.write_text(json.dumps(index, indent=1, default=str) + "\n")
            os.replace(beside, self.index)
        except OSError as error:
            raise OutputError(f"{self.index}: index file not written, {error.strerror}") from error

    def _conclude(self, wall):
        """Say how it ended, on the first rank. Returns the exit status."""
        for number, failure in sorted(self.failures.items()):
            print(f"ehlpetsc: {self.members[number].name}: {self.states[number]}: {failure}", file=sys.stderr)
        sys.stderr.flush()
        self._write_index()
        if any(state in ("waiting", "stopped") for state in self.states):
            status = STOPPED
            print("ehlpetsc: stopped; the same command computes what is missing")
        else:
            status = next((s for s in (NOT_CONVERGED, BAD_INPUT) if STATES[s] in self.states), DONE)
        print(f"index: {self.index}")
        totals = added([m.totals() for m in self.members])
        print(summary_line(STATES[status], wall=wall, **totals), flush=True)
        return status


def added(totals):
    """Figures of several runs as those of one; runs without any are None."""
    known = [t for t in totals if t]
    worst = {"h_min": min, "p_max": max, "load_error": max, "mass_error": max}
    return {
        name: worst.get(name, sum)([t[name] for t in known] or [0])
        for name in ("steps", "newton", "h_min", "p_max", "contacts", "load_error", "mass_error")
    }


def ranks_per_member(options, size):
    """Value of -ehl_ranks_per_member, 1 where it is not given.

    Raises
    ------
    options.UsageError
        Not a whole number from 1 to the number of ranks.
    """
    text = text_of(options, "ehl_ranks_per_member") or "1"
    if not text.isdecimal() or not 1 <= int(text) <= size:
        raise UsageError(f"-ehl_ranks_per_member {text}: allowed: whole numbers 1 to {size}, all ranks")
    return int(text)
