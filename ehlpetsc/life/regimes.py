"""Lives of a case with [series]: one for each member, distributed over the ranks, and the winning mechanism.

The index ``OUT.life.series.json`` lists for each life its settings, file and figures. Existing lives of the
same case are continued.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from mpi4py import MPI

from ehlpetsc.base.errors import CaseError, NotConverged, OutputError, PostError, Stopped, UsageError
from ehlpetsc.case.tables import Case
from ehlpetsc.life.checks import check_case
from ehlpetsc.life.driver import run_life
from ehlpetsc.life.history import LifeHistory, read_life
from ehlpetsc.run.ranks import PollingStop, on_root
from ehlpetsc.run.series import WAITING, compute_rows, index_of, members_of
from ehlpetsc.run.stop import StopRequest


def winner(life: LifeHistory) -> str:
    """Mechanism that wins a life: "fatigue", "wear" or "neither".

    Fatigue: cells have broken out, or, with `break_out = "none"`, failed at the surface. Wear: none has, and
    at the rates of the last solved round every cell reaches the surface with a damage below 1. Neither:
    damage would reach 1 after the end of the life.
    """
    if any(life(f"pits_{k}")[-1] for k in (1, 2)):
        return "fatigue"
    ahead = max(life(f"damage_ahead_{k}")[-1] for k in (1, 2))
    return "wear" if ahead < 1.0 else "neither"


def outcome(life: LifeHistory) -> dict:
    """Figures of a life for the index.

    They are "winner", "passes", "solved", "friction"; the larger pitted share of both surfaces;
    "first_failure" in passes, None where no cell fails; "damage_ahead" as of `body.LifeBody.damage_ahead`,
    None without wear.
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


def run_regimes(
    case: Case,
    output: str | Path | None = None,
    *,
    comm: MPI.Comm | None = None,
    show: Callable[[str], None] = lambda text: None,
    stop: StopRequest | None = None,
    **options: bool,
) -> Path:
    """Run a life for each member of a case's series, one a rank of `comm` at a time; returns the index.

    The stem of `output` begins the files' names, by default ``CASE.life.h5``. `show` receives a line for each
    completed life, on the first rank. Options are `overwrite` and `unresolved` of `run_life`. CaseError,
    OutputError, Stopped.
    """
    comm, path = comm or MPI.COMM_SELF, Path(f"{Path(case.path).stem}.h5" if output is None else output)
    stem = path.with_name(path.name.removesuffix(".h5").removesuffix(".life") + ".h5")
    members = members_of(case, stem)
    for member in members:
        check_case(member.case)
    files = [member.output.with_name(f"{member.output.stem}.life.h5") for member in members]
    index = index_of(case, stem.with_suffix(".life.series.json"), members, files)

    def show_row(number: int) -> None:
        count = sum(row["state"] != WAITING for row in index.rows)
        show(f"{count} of {len(members)}: {members[number].name}: {_words(index.rows[number])}")

    def run(number: int, group: MPI.Comm, stop: PollingStop) -> dict:
        return _run_life(members[number].case, files[number], comm=group, stop=stop, **options)

    on_root(comm, index.acquire, False)
    try:
        compute_rows(comm, index, list(range(len(members))), run, stop, on_row=show_row)
        on_root(comm, index.write)
    finally:
        index.release()
    if {WAITING, "stopped"} & {row["state"] for row in index.rows}:
        raise Stopped
    return index.path


def _run_life(case: Case, path: Path, **options: Any) -> dict:
    """Run the life of a member; returns its state and figures."""
    try:
        return {"state": "done"} | outcome(run_life(case, path, **options))
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
