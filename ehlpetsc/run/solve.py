"""Run of a simulation from time 0 or a restart file to its end, with outputs and messages."""

from __future__ import annotations

import sys
import time as clock
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, TextIO

from mpi4py import MPI

from ehlpetsc.base.case import KINDS
from ehlpetsc.base.errors import ExitStatus, NotConverged, OutputError, OutputLost, Stopped
from ehlpetsc.run.recorder import Output, Progress, Recorder, summary_line

if TYPE_CHECKING:
    from ehlpetsc.run.ranks import StopRequest
    from ehlpetsc.run.simulation import AcceptedState, Simulation


WATCHED_STEPS = 100  # after the first state, before which code is compiled
MIN_SECONDS = 0.5  # of a run whose speed is kept
MAX_WAITING = 0.5  # waiting time over processor time of the rank that waits most


class BusyCores(Output):
    """Output on every rank that compares processor time with wall clock time over the first steps.

    A rank that waits in MPI for another one keeps its core busy: the difference is the time in which the rank
    had no core. `show` receives the note, on rank 0.
    """

    def __init__(self, comm: MPI.Comm, show: Callable[[str], None]) -> None:
        self._comm, self._show, self._count = comm, show, 0
        self._begin = 0.0, 0.0

    def write(self, state: AcceptedState) -> None:
        """Take the time at the first step, and compare after the last one of the first steps."""
        self._count += 1
        times = clock.monotonic(), clock.process_time()
        if self._count == 1:
            self._begin = times
        if self._count != WATCHED_STEPS + 1 or self._comm.size == 1:
            return
        wall, computing = (now - begin for now, begin in zip(times, self._begin, strict=True))
        waiting = self._comm.allreduce(wall / max(computing, 1e-9) - 1.0, MPI.MAX)
        if waiting > MAX_WAITING and self._comm.rank == 0:
            self._show(
                f"note: a rank waits {waiting:.1f} times as long as it computes, as other processes use its "
                "core; all ranks wait for it: -n 1, or a less busy machine, may be faster"
            )


class SpeedMeter(Output):
    """Output of rank 0 that keeps the speed of a finished run for the forecasts of later ones.

    Of a run over time the steps alone count, before which code is compiled.
    """

    def __init__(self, simulation: Simulation) -> None:
        self._case, self._nodes = simulation.case, simulation.scales.grid.n
        self._seconds, self._iterations, self._steps = 0.0, 0, 0

    def write(self, state: AcceptedState) -> None:
        """Add time and iterations of a step."""
        if state.step or self._case.time is None:
            self._seconds += state.scalars["wall"]
            self._iterations += state.scalars["newton"]
            self._steps += 1

    def close(self, status: ExitStatus) -> None:
        """Keep the speed of a run that is long enough to have one."""
        if status is not ExitStatus.DONE or self._seconds < MIN_SECONDS:
            return
        from ehlpetsc.run.forecast.cost import solver_of, work
        from ehlpetsc.run.forecast.speed import keep

        kind = self._case.kind
        keep(solver_of(kind), self._seconds, work(kind, self._nodes, self._iterations, self._steps))


Outcome = tuple[ExitStatus, NotConverged | OutputError | None]  # of a run, with the reason of a failure


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


class Run(Output):
    """Run of a simulation by the command, with messages of rank 0 on `out` and `err`; one of its outputs.

    `progress`: output that shows the steps, by default a `Progress`.
    """

    def __init__(
        self,
        simulation: Simulation,
        output: Path,
        stop: StopRequest | None = None,
        out: TextIO | None = None,
        err: TextIO | None = None,
        progress: Output | None = None,
    ) -> None:
        self.simulation, self.recorder = simulation, Recorder(simulation, output)
        self.stop, self.root = stop, simulation.comm.rank == 0
        self.out, self.err = out or sys.stdout, err or sys.stderr
        self._progress = progress
        self._unused: set[str] = set()

    def run(self, restart: Path | None = None, overwrite: bool = False) -> Outcome:
        """Run to the end, or from a restart file, and print a report; see `Recorder.lock_output`."""
        begun = clock.monotonic()
        try:
            status, failure = self._solve(restart, overwrite)
        except OutputError as error:
            if self.simulation.state is None:  # nothing was computed yet
                raise
            status, failure = error.status, error
        if self.root:
            self._report(status, failure)
        self._print(summary_line(status, self.recorder.totals, clock.monotonic() - begun))
        return status, failure

    def _solve(self, restart: Path | None, overwrite: bool) -> Outcome:
        with self.recorder:
            restart = self.recorder.lock_output(restart, overwrite)
            notes = self.recorder.resume(restart) if restart else []
            self._print(*(f"restart: {note}" for note in notes))
            self._notes = self.simulation.options.loose_tolerances()
            printed: list[Output] = (
                [] if not self.root else [self, self._progress or Progress(self.simulation, self.out)]
            )
            if self.simulation.comm.size == 1:
                printed.append(SpeedMeter(self.simulation))
            of_ranks: list[Output] = [BusyCores(self.simulation.comm, self._print)]
            return solve(self.simulation, [self.recorder, *of_ranks, *printed], self.stop)

    def write(self, state: AcceptedState) -> None:
        """Print the unused options after the first step, when PETSc has read those of the solver."""
        if state.step == 1:
            self._print_unused()

    def _print_unused(self) -> None:
        """Print the unused, probably misspelt options that have not been printed yet."""
        new = self.simulation.options.unused_so_far() - self._unused
        self._unused |= new
        if new:
            self._print(f"note: unused options: -{', -'.join(sorted(new))}")

    def _report(self, status: ExitStatus, failure: Exception | None) -> None:
        recorder, state = self.recorder, self.simulation.dimensionless
        if isinstance(failure, OutputError):
            saved = f"; the same command continues from {recorder.restart}"
            if isinstance(failure, OutputLost):
                saved = f"; --restart {recorder.restart} -o OTHER.h5 continues without the steps before"
            saved = saved if recorder.restart.exists() else ""
            print(f"ehlpetsc: {failure}{saved}", file=self.err, flush=True)
            return
        if failure:
            saved = f". Last good state: {recorder.restart}" if state else ""
            print(f"ehlpetsc: not converged: {failure}{saved}", file=self.err, flush=True)
        elif status is ExitStatus.STOPPED:
            self._print(f"ehlpetsc: {place_of_stop(self.simulation, recorder)}")
        if self.simulation.state is not None:
            case, scalars = self.simulation.case, self.simulation.state.scalars
            self._print(*KINDS[case.kind].part("forecast").found(scalars))
        self._print(*(f"limit: {line}" for line in recorder.limits), *(f"note: {n}" for n in self._notes))
        self._print_unused()
        if state is not None:
            self._print(f"result: {recorder.output}")

    def _print(self, *lines: str) -> None:
        if self.root:
            for line in lines:
                print(line, file=self.out, flush=True)


def place_of_stop(simulation: Simulation, recorder: Recorder) -> str:
    """Step at which a run was stopped, and how it is continued."""
    if simulation.dimensionless is None:
        return "stopped during the steady start, with no restart file; the same command begins anew"
    advice = f"; continue with the same command or --restart {recorder.restart}" if recorder.output else ""
    return f"stopped at step {simulation.dimensionless.step}{advice}"
