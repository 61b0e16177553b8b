"""A run from its beginning, or a restart file, to its end: states are taken, kept and told of."""

import contextlib
import sys
import time as clock
from dataclasses import dataclass
from functools import partial

from ehlpetsc.errors import ExitStatus, NotConverged, OutputError, Stopped
from ehlpetsc.results.reader import read_result
from ehlpetsc.results.totals import Totals, means
from ehlpetsc.run.progress import Progress, summary_line
from ehlpetsc.run.recorder import Recorder


@dataclass(frozen=True)
class Outcome:
    """How a run ended.

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


def record(simulation, recorder, stop=None, stream=None, after_first=None):
    """Keep the states of a simulation up to its end, where it does not converge or is to stop.

    Parameters
    ----------
    simulation : run.simulation.Simulation
    recorder : run.recorder.Recorder
    stop : run.stop.StopRequest, optional
        Asked before every time step with the communicator whether to end there, and in every iteration
        whether to wait no longer for the step in hand.
    stream : file, optional
        Where to show progress, on rank 0.
    after_first : callable, optional
        Called once, after the first time step: PETSc has then read the options of its solver.

    Returns
    -------
    status : errors.ExitStatus
    failure : errors.NotConverged or None
    """
    progress = status = failure = None
    while status is None:
        begun = simulation.solution is not None
        asked = stop and (stop.overdue if begun else stop)
        simulation.watch = stop and partial(_end_where_asked, asked, simulation.comm)
        if simulation.finished:
            status = ExitStatus.DONE
        elif begun and stop and stop(simulation.comm):
            status = ExitStatus.STOPPED
        else:
            if stream and begun and progress is None:
                progress = Progress(simulation.solution.time, simulation.end, stream)
            try:
                recorder.take(simulation.advance())
                if after_first and simulation.state.step >= 1:
                    after_first()
                    after_first = None
            except NotConverged as error:
                status, failure = ExitStatus.NOT_CONVERGED, error
            except Stopped:
                status = ExitStatus.STOPPED
            if progress and status is None:
                progress.step(simulation.state.figures)
    if progress:
        progress.close()
    if status is not ExitStatus.DONE and begun:
        recorder.checkpoint()
    recorder.close(status)
    return status, failure


def _end_where_asked(asked, comm):
    if asked(comm):
        raise Stopped


class Run:
    """A simulation that is recorded and told of, for the command.

    Parameters
    ----------
    simulation : run.simulation.Simulation
    output : path-like
    stop : callable, optional
        As of `record`.
    out, err : file, optional
        Where rank 0 speaks; standard output and error by default.
    """

    def __init__(self, simulation, output, stop=None, out=None, err=None):
        self.simulation, self.recorder = simulation, Recorder(simulation, output)
        self.stop, self.root = stop, simulation.comm.rank == 0
        self.out, self.err = out or sys.stdout, err or sys.stderr
        self._noted = set()

    def run(self, restart=None, overwrite=False):
        """Run to the end, tell how it ended.

        Parameters
        ----------
        restart : path-like, optional
            Restart file to go on from.
        overwrite : bool
            As of `Recorder.reserve`.

        Returns
        -------
        Outcome
        """
        begun = clock.monotonic()
        try:
            status, failure = self._record(restart, overwrite)
        except OutputError as error:
            if self.simulation.state is None:  # nothing was computed yet
                raise
            outcome = Outcome(ExitStatus.BAD_INPUT, error, clock.monotonic() - begun)
            if self.root:
                print(f"ehlpetsc: {error}", file=self.err, flush=True)
            self._say(self._summary(outcome))
            return outcome
        outcome = Outcome(status, failure, clock.monotonic() - begun)
        if self.root:
            self._report(outcome)
        return outcome

    def _record(self, restart, overwrite):
        with self.simulation.options, self.recorder:
            self.recorder.reserve(restart, overwrite)
            notes = self.recorder.resume(restart) if restart else []
            self._say(*(f"restart: {note}" for note in notes))
            self._looser = self.simulation.options.looser()
            stream = self.out if self.root else None
            return record(self.simulation, self.recorder, self.stop, stream, self._note_unread)

    def _note_unread(self):
        """Print options that nobody has read so far: most likely misspelt."""
        ignored = self.simulation.options.unread_so_far() - self._noted
        self._noted |= ignored
        if ignored:
            self._say(f"note: options that nobody read: -{', -'.join(sorted(ignored))}")

    def _report(self, outcome):
        recorder, state = self.recorder, self.simulation.solution
        if outcome.failure:
            saved = f". Last good state: {recorder.restart}" if state else ""
            print(f"ehlpetsc: not converged: {outcome.failure}{saved}", file=self.err, flush=True)
        elif outcome.status is ExitStatus.STOPPED and state is None:
            self._say("ehlpetsc: stopped during the steady start; nothing to go on with")
        elif outcome.status is ExitStatus.STOPPED:
            self._say(f"ehlpetsc: stopped at step {state.step}; go on with -ehl_restart {recorder.restart}")
        for line in recorder.limits:
            self._say(f"limit: {line}")
        for line in self._looser:
            self._say(f"note: {line}")
        self._note_unread()
        if state is not None:
            self._say(f"result: {recorder.output}")
        self._say(self._summary(outcome))

    def _summary(self, outcome):
        """The last line, with the means of what the result file holds by now."""
        totals = self.recorder.totals
        if self.root and totals.values and outcome.status is not ExitStatus.BAD_INPUT:
            with contextlib.suppress(OutputError), read_result(self.recorder.output) as result:
                totals = Totals(totals.values, means(result))
        return summary_line(outcome.status, totals, outcome.wall)

    def _say(self, *lines):
        if self.root:
            for line in lines:
                print(line, file=self.out, flush=True)
