"""Recorder of a run: result and restart file, the lock on these files, advice after a failed write."""

import contextlib
from pathlib import Path

from ehlpetsc.errors import ExitStatus, OutputError
from ehlpetsc.results.atomic_write import remove_stale
from ehlpetsc.results.output_guard import Lock, check_output_path, inputs_of
from ehlpetsc.results.restart_file import restart_of_same
from ehlpetsc.results.totals import Totals
from ehlpetsc.run.outputs.restart_file import RestartFile
from ehlpetsc.run.outputs.result_file import ResultFile
from ehlpetsc.run.ranks import on_root
from ehlpetsc.run.restart import checkpoint
from ehlpetsc.run.restart.resume_advice import resume_advice


class Recorder:
    """Output that stores the accepted states of a simulation.

    Parameters
    ----------
    simulation : run.simulation.Simulation
    output : path-like or None
        Result file; the restart file is named after it. None: in memory, without a restart file.

    Attributes
    ----------
    totals : results.totals.Totals
    result : .outputs.result_file.ResultFile
    restart : Path
        Restart file.
    """

    def __init__(self, simulation, output):
        self.simulation, self.comm = simulation, simulation.comm
        self.output = None if output is None else Path(output)
        self.restart = self.output and self.output.parent / f"{self.output.stem}.restart.h5"
        self._lock = None
        self._observe(Totals())

    def _observe(self, totals):
        self.totals = totals
        self.result = ResultFile(self.simulation, self.output, totals)
        self._restart_file = RestartFile(self.simulation, self.restart, self.result, totals)

    def __enter__(self):
        return self

    def __exit__(self, kind, *_):
        try:
            if kind:
                self.result.abandon(ExitStatus.STOPPED)
        finally:
            if self._lock:
                self._lock.release()

    def lock_output(self, restart=None, overwrite=False):
        """Check before the run that the result can be written, and lock it until the end.

        Parameters
        ----------
        restart : path-like, optional
            Restart file from which the run and the result are continued.
        overwrite : bool
            Whether existing files may be replaced.

        Returns
        -------
        path-like or None
            Restart file to resume from: `restart`, otherwise that of an unfinished run of the same case.

        Raises
        ------
        OutputError
        """
        if self.output is None:
            return restart
        return self.comm.bcast(on_root(self.comm, self._lock_files, restart, overwrite))

    def _lock_files(self, restart, overwrite):
        case = self.simulation.case
        inputs = inputs_of(case)
        check_output_path(self.output, [*inputs, Path(restart)] if restart else inputs)
        check_output_path(self.restart, inputs)
        self._lock = Lock(self.output)
        self._lock.acquire()
        for path in (self.output, self.restart):
            remove_stale(path)
        if restart or overwrite:
            return restart
        return restart_of_same(self.output, self.restart, case.text)

    def resume(self, path):
        """Set the simulation to the state of a restart file, and continue its result.

        Returns
        -------
        list of str
            Notes for the user.
        """
        simulation, model = self.simulation, self.simulation.stepper.problem.model
        stored, notes = checkpoint.load(path, simulation.case, simulation.scales, model)
        solution = stored.state
        simulation.resume(solution, stored.baseline, stored.positions)
        self._observe(Totals(stored.totals))
        self.result.open(solution.step, stored.contact_count)
        self._restart_file.note_stored()
        return [f"{path}, step {solution.step}, {1e6 * solution.time:.4f} us", *notes]

    def write(self, state):
        """Store an accepted state.

        Parameters
        ----------
        state : run.accepted_state.AcceptedState
        """
        with self._guard_write():
            self.result.write(state)
            self.totals.add(state.scalars)
            self._restart_file.write(state)

    def checkpoint(self):
        """Write the restart file, if any."""
        with self._guard_write():
            self._restart_file.save()

    def close(self, status):
        """Write the remaining data and the status of the run.

        Parameters
        ----------
        status : errors.ExitStatus
        """
        with self._guard_write():
            self._restart_file.close(status)
            self.result.close(status)

    @contextlib.contextmanager
    def _guard_write(self):
        """Save the last stored state after a failed write, and add advice on resuming to the error."""
        try:
            yield
        except OutputError as error:
            if self.restart is None:
                raise
            step = self._restart_file.stored_step
            if self.comm.rank == 0:
                self._restart_file.save_stored()
            advice = resume_advice(self.restart, self.simulation.case, step) if self.comm.rank == 0 else None
            raise OutputError(f"{error}; {self.comm.bcast(advice)}") from error
