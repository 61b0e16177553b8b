"""The restart file as an output: written every few minutes, at a stop and after a failed write."""

import contextlib
import time as clock

from ehlpetsc.errors import ExitStatus, OutputError
from ehlpetsc.run.ranks import on_root
from ehlpetsc.run.restart import checkpoint


class RestartFile:
    """Restart file of a simulation, written only for states in the result file.

    Parameters
    ----------
    simulation : run.simulation.Simulation
    path : Path or None
        None: no restart file.
    result : .result_file.ResultFile
    totals : results.totals.Totals
    """

    def __init__(self, simulation, path, result, totals):
        self.simulation, self.comm, self.path = simulation, simulation.comm, path
        self.result, self.totals = result, totals
        self._saved, self._stored = clock.monotonic(), None

    @property
    def stored_step(self):
        """Step up to which the result file is complete, on rank 0; None: unknown."""
        return self._stored and self._stored.state.step

    def write(self, state):
        """Remember a state in the result file; write the restart file if it is due."""
        self.note_stored()
        due = clock.monotonic() - self._saved > 60.0 * self.simulation.case.output.checkpoint
        if state.step and self.comm.bcast(due):
            self.save()
            self._saved = clock.monotonic()

    def close(self, status):
        """Write the file of an unfinished run, and of a pass that is continued by the next one."""
        time = self.simulation.case.time
        needed = status is not ExitStatus.DONE or time is not None and time.passes > 1
        if needed and self.simulation.solution is not None and self.result.is_open:
            self.save()

    def save(self):
        """Write the file for the last state."""
        if self.path is not None:
            on_root(self.comm, self._save)

    def save_stored(self):
        """Write the file, if possible, for the last state in the result file; on rank 0."""
        with contextlib.suppress(OutputError):
            if self._stored:
                self._write(self._stored)

    def note_stored(self):
        """Remember the state up to which the result file on rank 0 is complete."""
        state = self.simulation.solution
        if self.path and self.simulation.case.time and self.result.holds(state):
            self._stored = self._checkpoint()

    def _checkpoint(self):
        return checkpoint.Checkpoint.of(
            self.simulation, self.result.contact_count(), dict(self.totals.values)
        )

    def _save(self):
        self.result.flush()
        self.note_stored()
        self._write(self._checkpoint())

    def _write(self, state):
        simulation = self.simulation
        model = simulation.stepper.problem.model
        checkpoint.save(self.path, state, simulation.case, simulation.scales, model)
