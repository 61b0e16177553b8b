"""Running-in: repeated passes of the same parts of both bodies, each with the surfaces of the previous pass.

Each pass is a separate run with a result ``OUTPUT.passK.h5``. The index ``OUTPUT.passes.json`` contains the
surfaces after each pass, for ``ehlpetsc plot OUTPUT.passes.json --running-in``.
"""

import contextlib
import json
from pathlib import Path

from ehlpetsc.errors import ExitStatus, OutputError
from ehlpetsc.results.atomic_write import atomic_write, remove_stale
from ehlpetsc.results.output_guard import Lock, check_index, check_output_path, inputs_of
from ehlpetsc.results.reader import read_result
from ehlpetsc.results.restart_file import load_restart
from ehlpetsc.results.running_in import RUN_IN, SHIFTED_IN_A_ROW, pass_summary, passes_to_run_in
from ehlpetsc.run.ranks import on_root
from ehlpetsc.run.restart.checkpoint import pass_of
from ehlpetsc.run.simulation import Simulation
from ehlpetsc.run.solve import Run


class Passes:
    """All passes of a case.

    Parameters
    ----------
    comm : mpi4py communicator
    case : case.loading.Case
    output : path-like
        Its stem is the prefix of the passes' file names.
    stop : stop.StopRequest, optional
    """

    def __init__(self, comm, case, output, stop=None):
        self.comm, self.case, self.stop = comm, case, stop
        output = Path(output)
        self.stem = output.with_name(output.name.removesuffix(".h5"))
        self.index = self.stem.with_name(f"{self.stem.name}.passes.json")
        self.rows = []

    def file(self, number):
        """Result file of a pass."""
        return self.stem.with_name(f"{self.stem.name}.pass{number}.h5")

    def restart(self, number):
        """Restart file of a pass."""
        return self.file(number).with_suffix(".restart.h5")

    def run(self, restart=None, overwrite=False):
        """Run every unfinished pass; a finished series of passes is run again.

        Parameters
        ----------
        restart : path-like, optional
            Restart file to continue from; by default that of the last pass of the same case.
        overwrite : bool
            Whether to replace existing files and begin with the first pass.

        Returns
        -------
        errors.ExitStatus
            Status of the last pass that was run.

        Raises
        ------
        OutputError
        """
        on_root(self.comm, lambda: check_output_path(self.index, inputs_of(self.case)))
        lock = Lock(self.index)
        on_root(self.comm, lock.acquire)
        on_root(self.comm, remove_stale, self.index)
        try:
            return self._run(restart, overwrite)
        finally:
            lock.release()

    def _run(self, restart, overwrite):
        if not overwrite:
            on_root(self.comm, lambda: check_index(self.index, "passes"))
            restart = restart or self.comm.bcast(on_root(self.comm, self._unfinished))
        first = self.comm.bcast(on_root(self.comm, pass_of, restart)) if restart else 1
        if first > 1:
            self.rows = self.comm.bcast(on_root(self.comm, self._rows_before, first))
        simulation, status = None, ExitStatus.DONE
        for number in range(first, self.case.time.passes + 1):
            simulation = Simulation(self.case, self.comm, after=simulation, pass_number=number)
            self._print(f"pass {number} of {self.case.time.passes}")
            outcome = Run(simulation, self.file(number), self.stop).run(restart, overwrite)
            status, restart = outcome.status, None
            if status is not ExitStatus.DONE:
                return status
            on_root(self.comm, self._note, number, simulation)
        self._print_end()
        return status

    def _unfinished(self):
        """Restart file of the last unfinished pass; None if there is none."""
        index, passes = self._read_index(), range(1, self.case.time.passes + 1)
        noted = {row["pass"] for row in index["passes"]} if index["case"] == self.case.text else ()
        begun = next((n for n in passes if n not in noted or not self._is_done(n)), None)
        for number in range(begun or 0, 0, -1):
            if self.file(number).exists() and self._is_of_case(self.restart(number)):
                return self.restart(number)
        return None

    def _is_done(self, number):
        with contextlib.suppress(OutputError), read_result(self.file(number)) as result:
            return result.attrs["case"] == self.case.text and result.attrs["status"] == "done"
        return False

    def _is_of_case(self, path):
        with contextlib.suppress(OutputError, KeyError):
            return load_restart(path)[1]["case"] == self.case.text
        return False

    def _rows_before(self, first):
        """Index entries of the passes before pass `first`."""
        return [row for row in self._read_index()["passes"] if row["pass"] < first]

    def _read_index(self):
        """Case text and entries of the index; None and [] if it is missing or damaged."""
        try:
            index = json.loads(self.index.read_text())
            return {"case": index["case"], "passes": [row for row in index["passes"] if row["pass"] > 0]}
        except (OSError, ValueError, KeyError, TypeError):
            return {"case": None, "passes": []}

    def _note(self, number, simulation):
        with read_result(self.file(number)) as result:
            summary = pass_summary(result)
        row = {"pass": number, "file": self.file(number).name} | summary
        before = self.rows[-1]["set_volume"] if self.rows else 0.0
        row["added"] = row.get("set_volume", 0.0) - before
        self.rows.append(row)
        text = json.dumps({"title": self.case.title, "case": self.case.text, "passes": self.rows}, indent=1)
        try:
            atomic_write(self.index, text.encode())
        except OSError as error:
            pass_state = f"{self.file(number).name} is whole"
            raise OutputError(f"{self.index}: index not written, {error.strerror}; {pass_state}") from error
        self._print(line(row))

    def _print_end(self):
        if self.comm.rank != 0:
            return
        self._print(f"passes: {self.index}")
        shift = self.case.time.pass_shift
        number = passes_to_run_in(self.rows, SHIFTED_IN_A_ROW if shift else 1)
        if number:
            self._print(f"run in: from pass {number} on each adds less than {RUN_IN:.0%} of the first one's")
        if len(self.rows) > 1 and not shift:
            self._print("the same asperities have met in every pass; time.pass_shift brings others together")

    def _print(self, text):
        if self.comm.rank == 0:
            print(text, flush=True)


def line(row):
    """Printed line of a pass."""
    texts = [
        f"pass {row['pass']}: set {1e12 * row['set_volume']:.4g} um^2, added {1e12 * row['added']:.4g} um^2"
    ]
    for side in ("1", "2"):
        if row[side]:
            texts.append(f"Ra {side} {1e6 * row[side]['ra']:.4f} um")
    if row.get("contact_share") is not None:
        texts.append(f"share on solids {row['contact_share']:.4f}")
    return ", ".join(texts)
