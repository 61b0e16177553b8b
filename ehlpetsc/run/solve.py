"""Run of a simulation from time 0 or a restart file to its end, with outputs and messages."""

import contextlib
import sys
import time as clock
from dataclasses import dataclass

from ehlpetsc.errors import ExitStatus, NotConverged, OutputError, Stopped
from ehlpetsc.results.means import means
from ehlpetsc.results.reader import read_result
from ehlpetsc.results.totals import Totals
from ehlpetsc.run.outputs.progress import ProgressOutput, SlowSteps, summary_line
from ehlpetsc.run.outputs.recorder import Recorder


@dataclass(frozen=True)
class Outcome:
    """Outcome of a run.

    Attributes
    ----------
    status : errors.ExitStatus
    failure : errors.NotConverged, errors.OutputError or None
    wall : float
        Wall clock time [s].
    """

    status: ExitStatus
    failure: NotConverged | None
    wall: float


def solve(simulation, outputs, stop=None):
    """Write the states of a simulation to outputs until its end, a stop or a step that does not converge.

    Parameters
    ----------
    simulation : run.simulation.Simulation
    outputs : list
        See :mod:`ehlpetsc.run.outputs`.
    stop : run.stop.StopRequest, optional

    Returns
    -------
    status : errors.ExitStatus
    failure : errors.NotConverged or None
    """
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
    """Output that prints the unused, probably misspelt options after the first time step.

    Parameters
    ----------
    options : nonlinear.options.RunOptions
    show : callable
        Prints a line.
    """

    def __init__(self, options, show):
        self._options, self._show, self._noted = options, show, None

    def write(self, state):
        """Print the note after the first step, when PETSc has read the options of the solver."""
        if state.step >= 1 and self._noted is None:
            self.note()

    def close(self, status):
        """Do nothing: at the end of a run its report prints the note."""

    def note(self):
        """Print the unused options that have not been printed yet."""
        noted = self._noted or set()
        new = self._options.unused_so_far() - noted
        self._noted = noted | new
        if new:
            self._show(f"note: unused options: -{', -'.join(sorted(new))}")


class Run:
    """Run of a simulation by the command, with outputs and messages.

    Parameters
    ----------
    simulation : run.simulation.Simulation
    output : path-like
    stop : run.stop.StopRequest, optional
    out, err : file, optional
        Streams of rank 0; default: standard output and error.
    """

    def __init__(self, simulation, output, stop=None, out=None, err=None):
        self.simulation, self.recorder = simulation, Recorder(simulation, output)
        self.stop, self.root = stop, simulation.comm.rank == 0
        self.out, self.err = out or sys.stdout, err or sys.stderr
        self._unused = UnusedOptions(simulation.options, self._print)

    def run(self, restart=None, overwrite=False):
        """Run to the end and print a report.

        Parameters
        ----------
        restart : path-like, optional
            Restart file to resume from.
        overwrite : bool
            See `Recorder.lock_output`.

        Returns
        -------
        Outcome
        """
        begun = clock.monotonic()
        try:
            status, failure = self._solve(restart, overwrite)
        except OutputError as error:
            if self.simulation.state is None:  # nothing was computed yet
                raise
            outcome = Outcome(ExitStatus.BAD_INPUT, error, clock.monotonic() - begun)
            if self.root:
                print(f"ehlpetsc: {error}", file=self.err, flush=True)
            self._print(self._summary(outcome))
            return outcome
        outcome = Outcome(status, failure, clock.monotonic() - begun)
        if self.root:
            self._report(outcome)
        return outcome

    def _solve(self, restart, overwrite):
        with self.simulation.options, self.recorder:
            restart = self.recorder.lock_output(restart, overwrite)
            notes = self.recorder.resume(restart) if restart else []
            self._print(*(f"restart: {note}" for note in notes))
            self._notes = self.simulation.options.loose_tolerances()
            printed = []
            if self.root:
                slow = SlowSteps(self.simulation.comm.size, self._print)
                printed = [self._unused, ProgressOutput(self.simulation, self.out), slow]
            return solve(self.simulation, [self.recorder, *printed], self.stop)

    def _report(self, outcome):
        recorder, state = self.recorder, self.simulation.solution
        if outcome.failure:
            saved = f". Last good state: {recorder.restart}" if state else ""
            print(f"ehlpetsc: not converged: {outcome.failure}{saved}", file=self.err, flush=True)
        elif outcome.status is ExitStatus.STOPPED and state is None:
            self._print("ehlpetsc: stopped during the steady start; nothing to continue from")
        elif outcome.status is ExitStatus.STOPPED:
            advice = f"continue with --restart {recorder.restart} or the same command"
            self._print(f"ehlpetsc: stopped at step {state.step}; {advice}")
        for line in recorder.limits:
            self._print(f"limit: {line}")
        for note in self._notes:
            self._print(f"note: {note}")
        self._unused.note()
        if state is not None:
            self._print(f"result: {recorder.output}")
        self._print(self._summary(outcome))

    def _summary(self, outcome):
        """Last line of the output, with means from the result file."""
        totals = self.recorder.totals
        if self.root and totals.values and outcome.status is not ExitStatus.BAD_INPUT:
            with contextlib.suppress(OutputError), read_result(self.recorder.output) as result:
                totals = Totals(totals.values, means(result))
        return summary_line(outcome.status, totals, outcome.wall)

    def _print(self, *lines):
        if self.root:
            for line in lines:
                print(line, file=self.out, flush=True)
