"""Lives of a case with [series]: one for each member, distributed over the ranks, and the winning mechanism.

The index ``OUT.life.series.json`` lists for each life its settings, file and figures. Existing lives of the
same case are continued.
"""

from __future__ import annotations

import contextlib
import tomllib
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ehlpetsc.base.errors import CaseError, NotConverged, OutputError, PostError, Stopped, UsageError

if TYPE_CHECKING:
    from mpi4py import MPI

    from ehlpetsc.case.tables import Case
    from ehlpetsc.life.history import LifeHistory
    from ehlpetsc.run.ranks import PollingStop
    from ehlpetsc.run.series import Member


WEAR, FATIGUE, NEITHER = "wear", "fatigue", "neither"


def winner(life: LifeHistory) -> str:
    """Mechanism that wins a life: "fatigue", "wear" or "neither".

    Fatigue: cells have broken out, or, with `break_out = "none"`, failed at the surface. Wear: none has, and
    at the rates of the last solved round every cell reaches the surface with a damage below 1. Neither:
    damage would reach 1 after the end of the life.
    """
    if any(life(f"pits_{k}")[-1] for k in (1, 2)):
        return FATIGUE
    ahead = max(life(f"damage_ahead_{k}")[-1] for k in (1, 2))
    return WEAR if ahead < 1.0 else NEITHER


def outcome(life: LifeHistory) -> dict:
    """Figures of a life for the index.

    Returns
    -------
    "winner", "passes", "solved", "friction"; the larger pitted share of both surfaces; "first_failure" in
    passes, None where no cell fails; "damage_ahead" as of `body.LifeBody.damage_ahead`, None without wear.
    """
    last = life.rows[-1]
    return {
        "winner": winner(life),
        "passes": last["passes"],
        "solved": life.solved,
        "first_failure": _number(life.first_failure),
        "pitted_share": max(last["pitted_share_1"], last["pitted_share_2"]),
        "damage_ahead": _number(max(last["damage_ahead_1"], last["damage_ahead_2"])),
        "friction": last["friction"],
    }


def _number(value: float) -> float | None:
    """A number for JSON; None: infinite."""
    return float(value) if np.isfinite(value) else None


def _stem(output: Path) -> Path:
    return output.with_name(output.name.removesuffix(".h5").removesuffix(".life") + ".h5")


def run_regimes(
    case: Case,
    output: str | Path | None = None,
    *,
    overwrite: bool = False,
    unresolved: bool = False,
    comm: MPI.Comm | None = None,
    show: Callable | None = None,
    stop: Any = None,
) -> Path:
    """Run a life for each member of a case's series.

    Parameters
    ----------
    case
        With tables [life] and [series].
    output
        Its stem begins the files' names; by default ``CASE.life.h5``.
    overwrite, unresolved
        As of `run_life`.
    comm
        Each of its ranks solves a life at a time.
    show
        Receives a line for each completed life, on the first rank.

    Returns
    -------
    The index.

    Raises
    ------
    CaseError, OutputError, Stopped
    """
    from ehlpetsc.api import need_solver

    need_solver()
    from mpi4py import MPI

    from ehlpetsc.run.ranks import on_root

    import_module("ehlpetsc.run.simulation")  # PETSc starts on all ranks together, before they split
    comm = comm or MPI.COMM_SELF
    lives = _Lives(
        case, Path(f"{Path(case.path).stem}.life.h5" if output is None else output), overwrite, unresolved
    )
    on_root(comm, lives.index.acquire, False)
    try:
        return lives.run(comm, show or (lambda text: None), stop)
    finally:
        lives.index.release()


class _Lives:
    def __init__(self, case: Case, output: Path, overwrite: bool, unresolved: bool) -> None:
        from ehlpetsc.case.combinations import keys_of
        from ehlpetsc.life.checks import check_case
        from ehlpetsc.results.index import Index
        from ehlpetsc.run.series import members_of

        if case.life is None:
            raise CaseError([f"{case.path}: no [life] table; allowed: a case with one"])
        keys = keys_of(tomllib.loads(case.text)["series"])
        self.overwrite, self.unresolved = overwrite, unresolved
        self.index = Index(_stem(output).with_suffix(".life.series.json"), case, "members", keys=keys)
        self.members = members_of(case, _stem(output))
        for member in self.members:
            check_case(member.case)
        self.index.begin(
            {"value": member.value, "file": self.file(member).name, "state": "waiting"}
            for member in self.members
        )

    @staticmethod
    def file(member: Member) -> Path:
        return member.output.with_name(f"{member.output.stem}.life.h5")

    def run(self, comm: MPI.Comm, show: Callable[[str], None], stop: Any) -> Path:
        from ehlpetsc.run.ranks import WorkQueue, on_root

        rows = self.index.rows

        def record(report: tuple[int, dict]) -> None:
            number, row = report
            rows[number] |= row
            with contextlib.suppress(OutputError):  # of this rank alone; it is written again at the end
                self.index.write()
            count = sum(row["state"] != "waiting" for row in rows)
            show(f"{count} of {len(rows)}: {self.members[number].name}: {_words(rows[number])}")

        on_root(comm, self.index.write)
        queue = WorkQueue(comm, 1, range(len(self.members)), record)
        states = queue.compute(self._run_life, stop, lambda: {row["state"] for row in rows})
        on_root(comm, self.index.write)
        if {"waiting", "stopped"} & states:
            raise Stopped
        return self.index.path

    def _run_life(self, number: int, group: MPI.Comm, stop: PollingStop) -> dict:
        from ehlpetsc.life.driver import run_life
        from ehlpetsc.life.history import read_life

        member = self.members[number]
        path = self.file(member)
        try:
            life = run_life(
                member.case, path, overwrite=self.overwrite, unresolved=self.unresolved, comm=group, stop=stop
            )
            return {"state": "done"} | outcome(life)
        except Stopped:
            return {"state": "stopped"}
        except NotConverged as error:
            state = {"state": "not converged", "reason": str(error)}
            return state | (outcome(read_life(path)) if path.exists() else {})
        except (CaseError, OutputError, PostError, UsageError) as error:
            return {"state": "bad input", "reason": str(error)}


def _words(row: dict) -> str:
    if "winner" not in row:
        return f"{row['state']}: {row.get('reason', '')}".rstrip(": ")
    failed = f"first failure after {row['first_failure']:.3g}, " if row["first_failure"] else ""
    return f"{row['winner']} after {row['passes']:.3g} passes, {failed}pitted {row['pitted_share']:.1%}"
