"""Run of a simulation from time 0 or a restart file to its end, with outputs and messages."""

from __future__ import annotations

import sys
import time as clock
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, Protocol, TextIO

from ehlpetsc.base.errors import ExitStatus, NotConverged, OutputError, Stopped
from ehlpetsc.run.outputs.progress import ProgressOutput, summary_line
from ehlpetsc.run.outputs.recorder import Recorder

if TYPE_CHECKING:
    from ehlpetsc.nonlinear.options import RunOptions
    from ehlpetsc.run.accepted_state import AcceptedState
    from ehlpetsc.run.simulation import Simulation
    from ehlpetsc.run.stop import StopRequest


class Output(Protocol):
    """Observer of a run on every rank, see `ehlpetsc.run.solve.Output`."""

    def write(self, state: AcceptedState) -> None: ...

    def close(self, status: ExitStatus) -> None: ...


class Outcome(NamedTuple):
    """Outcome of a run; `wall` is its wall clock time [s]."""

    status: ExitStatus
    failure: NotConverged | OutputError | None
    wall: float


def solve(
    simulation: Simulation, outputs: list[Output], stop: StopRequest | None = None
) -> tuple[ExitStatus, NotConverged | None]:
    """Write the states of a simulation to outputs until its end, a stop or a step that does not converge."""
    status, failure = ExitStatus.DONE, None
    try:
        for state in simulation.states(stop):
            for output in outputs:
                output.write(state)
    except NotConverged as error:
        status, failure = ExitStatus.NOT_CONVERGED, error
    except Stopped:
        status = ExitStatus.STOPPED
    for output in outputs:
        output.close(status)
    return status, failure


class UnusedOptions:
    """Output that prints the unused, probably misspelt options after the first time step."""

    def __init__(self, options: RunOptions, show: Callable[[str], None]) -> None:
        self._options, self._show = options, show
        self._noted: set[str] | None = None

    def write(self, state: AcceptedState) -> None:
        """Print the note after the first step, when PETSc has read the options of the solver."""
        if state.step >= 1 and self._noted is None:
            self.note()

    def close(self, status: ExitStatus) -> None:
        """Do nothing: at the end of a run its report prints the note."""

    def note(self) -> None:
        """Print the unused options that have not been printed yet."""
        noted = self._noted or set()
        new = self._options.unused_so_far() - noted
        self._noted = noted | new
        if new:
            self._show(f"note: unused options: -{', -'.join(sorted(new))}")


class Run:
    """Run of a simulation by the command, with outputs and messages of rank 0 on `out` and `err`."""

    def __init__(
        self,
        simulation: Simulation,
        output: Path,
        stop: StopRequest | None = None,
        out: TextIO | None = None,
        err: TextIO | None = None,
    ) -> None:
        self.simulation, self.recorder = simulation, Recorder(simulation, output)
        self.stop, self.root = stop, simulation.comm.rank == 0
        self.out, self.err = out or sys.stdout, err or sys.stderr
        self._unused = UnusedOptions(simulation.options, self._print)

    def run(self, restart: Path | None = None, overwrite: bool = False) -> Outcome:
        """Run to the end, or from a restart file, and print a report; see `Recorder.lock_output`."""
        begun = clock.monotonic()
        try:
            status, failure = self._solve(restart, overwrite)
        except OutputError as error:
            if self.simulation.state is None:  # nothing was computed yet
                raise
            outcome = Outcome(ExitStatus.BAD_INPUT, error, clock.monotonic() - begun)
            if self.root:
                saved = f"; the same command continues from {self.recorder.restart}"
                saved = saved if self.recorder.restart.exists() else ""
                print(f"ehlpetsc: {error}{saved}", file=self.err, flush=True)
            self._print(summary_line(outcome.status, self.recorder.totals, outcome.wall))
            return outcome
        outcome = Outcome(status, failure, clock.monotonic() - begun)
        if self.root:
            self._report(outcome)
        return outcome

    def _solve(self, restart: Path | None, overwrite: bool) -> tuple[ExitStatus, NotConverged | None]:
        with self.simulation.options, self.recorder:
            restart = self.recorder.lock_output(restart, overwrite)
            notes = self.recorder.resume(restart) if restart else []
            self._print(*(f"restart: {note}" for note in notes))
            self._notes = self.simulation.options.loose_tolerances()
            printed: list[Output] = []
            if self.root:
                printed = [self._unused, ProgressOutput(self.simulation, self.out)]
            return solve(self.simulation, [self.recorder, *printed], self.stop)

    def _report(self, outcome: Outcome) -> None:
        recorder, state = self.recorder, self.simulation.solution
        if outcome.failure:
            saved = f". Last good state: {recorder.restart}" if state else ""
            print(f"ehlpetsc: not converged: {outcome.failure}{saved}", file=self.err, flush=True)
        elif outcome.status is ExitStatus.STOPPED:
            self._print(f"ehlpetsc: {place_of_stop(self.simulation, recorder)}")
        for line in recorder.limits:
            self._print(f"limit: {line}")
        for note in self._notes:
            self._print(f"note: {note}")
        self._unused.note()
        if state is not None:
            self._print(f"result: {recorder.output}")
        self._print(summary_line(outcome.status, self.recorder.totals, outcome.wall))

    def _print(self, *lines: str) -> None:
        if self.root:
            for line in lines:
                print(line, file=self.out, flush=True)


def place_of_stop(simulation: Simulation, recorder: Recorder) -> str:
    """Step at which a run was stopped, and how it is continued."""
    if simulation.solution is None:
        return "stopped during the steady start; nothing to continue from"
    advice = f"; continue by the same, or with --restart {recorder.restart}" if recorder.output else ""
    return f"stopped at step {simulation.solution.step}{advice}"
