"""Running-in: repeated passes of the same parts of both bodies, each with the surfaces of the previous pass.

Each pass is a separate run with a result ``OUTPUT.passK.h5``. The index ``OUTPUT.passes.json`` contains the
surfaces after each pass, for ``ehlpetsc plot OUTPUT.passes.json --running-in``.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from ehlpetsc.base.case import KINDS
from ehlpetsc.base.errors import ExitStatus
from ehlpetsc.base.quantities import STEP_SCALARS, unit_in
from ehlpetsc.results.index import Index
from ehlpetsc.results.means import RUN_IN, SHIFTED_IN_A_ROW, pass_summary, passes_to_run_in
from ehlpetsc.results.reader import is_done, read_result
from ehlpetsc.run.checkpoint import is_restart_of, pass_of
from ehlpetsc.run.ranks import StopRequest, on_root
from ehlpetsc.run.simulation import Simulation
from ehlpetsc.run.solve import Run

if TYPE_CHECKING:
    from mpi4py import MPI

    from ehlpetsc.case.tables import Case


class Passes:
    """All passes of a case; the stem of `output` is the prefix of their file names."""

    def __init__(self, comm: MPI.Comm, case: Case, output: Path, stop: StopRequest | None = None) -> None:
        self.comm, self.case, self.stop = comm, case, stop
        self.stem = output.with_name(output.name.removesuffix(".h5"))
        self.index = Index(self.stem.with_name(f"{self.stem.name}.passes.json"), case, "passes")

    def file(self, number: int) -> Path:
        """Result file of a pass."""
        return self.stem.with_name(f"{self.stem.name}.pass{number}.h5")

    def run(self, restart: Path | None = None, overwrite: bool = False) -> ExitStatus:
        """Run every unfinished pass; a finished series of passes is run again.

        `restart` is the restart file to continue from, by default that of the last pass of the same case;
        `overwrite` replaces existing files and begins with the first pass. Returns the status of the last
        pass that was run; OutputError.
        """
        on_root(self.comm, self.index.acquire, overwrite)
        try:
            return self._run(restart, overwrite)
        finally:
            self.index.release()

    def _run(self, restart: Path | None, overwrite: bool) -> ExitStatus:
        if not overwrite:
            restart = restart or on_root(self.comm, self._unfinished)
        first = on_root(self.comm, pass_of, restart) if restart else 1
        if first > 1:
            rows = on_root(self.comm, self.index.stored_rows, True)
            self.index.rows[:] = [row for row in rows if row["pass"] < first]
        simulation, status = None, ExitStatus.DONE
        for number in range(first, self.case.time.passes + 1):
            simulation = Simulation(self.case, self.comm, after=simulation, pass_number=number)
            self._print(f"pass {number} of {self.case.time.passes}")
            status, _ = Run(simulation, self.file(number), self.stop).run(restart, overwrite)
            if status is not ExitStatus.DONE:
                return status
            on_root(self.comm, self._note, number)
            restart = None
        self._print_end()
        return status

    def _unfinished(self) -> Path | None:
        """Restart file of the last unfinished pass; None if there is none."""
        noted, of_case = (
            {row["pass"] for row in self.index.stored_rows()},
            (self.case.text, self.case.digests),
        )
        passes = range(1, self.case.time.passes + 1)
        begun = next((n for n in passes if n not in noted or not is_done(self.file(n), *of_case)), 0)
        for number in range(begun, 0, -1):
            restart = self.file(number).with_suffix(".restart.h5")
            if self.file(number).exists() and is_restart_of(restart, self.case):
                return restart
        return None

    def _note(self, number: int) -> None:
        """Add a complete pass to the index."""
        with read_result(self.file(number)) as result:
            row: dict[str, Any] = {"pass": number, "file": self.file(number).name} | pass_summary(result)
            unit = unit_in(STEP_SCALARS["set_volume"], self.case.kind)
        before = self.index.rows[-1]["set_volume"] if self.index.rows else 0.0
        row["added"] = row.get("set_volume", 0.0) - before
        self.index.rows.append(row)
        self.index.write()
        self._print(line(row, unit, KINDS[self.case.kind].mean_height))

    def _print_end(self) -> None:
        rows, shift = self.index.rows, self.case.time.pass_shift
        self._print(f"passes: {self.index.path}")
        if number := passes_to_run_in(rows, SHIFTED_IN_A_ROW if shift else 1):
            self._print(f"run in: from pass {number} on each adds less than {RUN_IN:.0%} of the first one's")
        if len(rows) > 1 and not shift:
            self._print("the same asperities have met in every pass; time.pass_shift brings others together")

    def _print(self, text: str) -> None:
        if self.comm.rank == 0:
            print(text, flush=True)


def line(row: dict, unit: str, mean_height: str) -> str:
    """Printed line of a pass.

    `unit`: of the plastic deformation, m^2 or m^3. `mean_height`: name of the mean deviation of heights.
    """
    deformed, added = (f"{1e6 ** int(unit[-1]) * row[name]:.4g} u{unit}" for name in ("set_volume", "added"))
    texts = [f"pass {row['pass']}: set {deformed}, added {added}"]
    for side in ("1", "2"):
        if row[side]:
            texts.append(f"{mean_height} {side} {1e6 * row[side]['ra']:.4f} um")
    if row.get("contact_share") is not None:
        texts.append(f"share on solids {row['contact_share']:.4f}")
    return ", ".join(texts)
