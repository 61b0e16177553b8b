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


def run_regimes(
    case: Case,
    output: str | Path | None = None,
    *,
    comm: MPI.Comm | None = None,
    show: Callable | None = None,
    stop: Any = None,
    **options: bool,
) -> Path:
    """Run a life for each member of a case's series; returns the index.

    Parameters
    ----------
    case
        With tables [life] and [series].
    output
        Its stem begins the files' names; by default ``CASE.life.h5``.
    comm
        Each of its ranks solves a life at a time.
    show
        Receives a line for each completed life, on the first rank.
    options
        `overwrite` and `unresolved` of `run_life`.

    Raises
    ------
    CaseError, OutputError, Stopped
    """
    from ehlpetsc.api import need_solver

    need_solver()
    from mpi4py import MPI

    from ehlpetsc.case.combinations import keys_of
    from ehlpetsc.life.checks import check_case
    from ehlpetsc.results.index import Index
    from ehlpetsc.run.ranks import WorkQueue, on_root
    from ehlpetsc.run.series import members_of

    import_module("ehlpetsc.run.simulation")  # PETSc starts on all ranks together, before they split
    comm, path = comm or MPI.COMM_SELF, Path(f"{Path(case.path).stem}.h5" if output is None else output)
    stem = path.with_name(path.name.removesuffix(".h5").removesuffix(".life") + ".h5")
    members = members_of(case, stem)
    for member in members:
        check_case(member.case)
    files = [member.output.with_name(f"{member.output.stem}.life.h5") for member in members]
    keys = keys_of(tomllib.loads(case.text)["series"])
    index = Index(stem.with_suffix(".life.series.json"), case, "members", keys=keys)
    index.begin(
        {"value": member.value, "file": file.name, "state": "waiting"}
        for member, file in zip(members, files, strict=True)
    )

    def record(report: tuple[int, dict]) -> None:
        number, row = report
        index.rows[number] |= row
        with contextlib.suppress(OutputError):  # of this rank alone; it is written again at the end
            index.write()
        count = sum(row["state"] != "waiting" for row in index.rows)
        if show:
            show(f"{count} of {len(members)}: {members[number].name}: {_words(index.rows[number])}")

    def run(number: int, group: MPI.Comm, stop: PollingStop) -> dict:
        return _run_life(members[number].case, files[number], comm=group, stop=stop, **options)

    on_root(comm, index.acquire, False)
    try:
        on_root(comm, index.write)
        queue = WorkQueue(comm, 1, range(len(members)), record)
        states = queue.compute(run, stop, lambda: {row["state"] for row in index.rows})
        on_root(comm, index.write)
    finally:
        index.release()
    if {"waiting", "stopped"} & states:
        raise Stopped
    return index.path


def _run_life(case: Case, path: Path, **options: Any) -> dict:
    """Run the life of a member; returns its state and figures."""
    from ehlpetsc.life.driver import run_life
    from ehlpetsc.life.history import read_life

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
