"""Lives of a case with a series: a life for each member, one a rank; means over seeds with their bounds.

The index ``CASE.life.series.json`` lists the lives as that of a series lists its results.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterator
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ehlpetsc.base.errors import CaseError, OutputError, Stopped
from ehlpetsc.base.toml_file import settings_of
from ehlpetsc.life.history import LifeHistory, read_life
from ehlpetsc.life.remarks import limits, smooth_lines
from ehlpetsc.results.index import Index, read_index
from ehlpetsc.results.means import bootstrap_bounds

if TYPE_CHECKING:
    from mpi4py import MPI

    from ehlpetsc.case.tables import Case
    from ehlpetsc.run.ranks import StopRequest

OF_BODIES = ("damaged_share", "pitted_share", "pits", "wear_volume")
OF_SEEDS = [*(f"{name}_{k}" for name in OF_BODIES for k in (1, 2)), "friction"]
Lives = dict[str, list[LifeHistory]]


def run_lives(
    case: Case,
    output: Path,
    comm: MPI.Comm,
    *,
    overwrite: bool = False,
    unresolved: bool = False,
    show: Callable[[str], None] = lambda text: None,
    stop: StopRequest | None = None,
) -> Path:
    """Run or continue the lives of all members of a series; path of their index, on every rank.

    `output`: as of a single life, ``CASE.life.h5``; a member ``seed=1`` has ``CASE_seed_1.life.h5``. `show`
    receives a line of each life that ends. A member that fails does not end the others; then raises
    `CaseError`, `NotConverged`, `OutputError`, `Stopped`.
    """
    from ehlpetsc.life.driver import line_of, run_life
    from ehlpetsc.life.rounds import FAULTS
    from ehlpetsc.run.ranks import WorkQueue, on_root
    from ehlpetsc.run.series import members_of

    stem = output.name.removesuffix(".h5").removesuffix(".life")
    members = members_of(case, output.with_name(f"{stem}.h5"))
    files = [member.output.with_name(f"{member.output.stem}.life.h5") for member in members]
    index = Index(output.with_name(f"{stem}.life.series.json"), case, "members")
    index.rows = [
        {"value": member.value, "file": file.name} for member, file in zip(members, files, strict=True)
    ]
    found: dict[int, Exception | None] = {}

    def solve(number: int, group: MPI.Comm, stop: StopRequest | None) -> Exception | None:
        member = members[number]
        keys: dict[str, Any] = {"overwrite": overwrite, "unresolved": unresolved, "comm": group, "stop": stop}
        try:
            life = run_life(member.case, files[number], **keys)
        except FAULTS as fault:
            return type(fault)(*fault.args)
        show(f"[{member.name}] {line_of(life)}")
        return None

    on_root(comm, index.acquire, overwrite)
    try:
        on_root(comm, index.write)
        queue = WorkQueue(comm, 1, range(len(members)), lambda report: found.update([report]))
        found = queue.compute(solve, stop, lambda: found)
    finally:
        index.release()
    faults = [(members[number].name, fault) for number, fault in sorted(found.items()) if fault]
    if len(found) < len(members) or any(isinstance(fault, Stopped) for _, fault in faults):
        raise Stopped
    if faults:
        lines, kind = [f"{name}: {fault}" for name, fault in faults], type(faults[0][1])
        raise CaseError(lines) if issubclass(kind, CaseError) else kind("\n".join(lines))
    return index.path


def read_lives(path: Path) -> Lives:
    """Lives listed in an index, those that differ only in seeds together, by the other settings.

    OutputError: no index of lives, or none of its lives is there.
    """
    index = read_index(path)
    settings = settings_of(tomllib.loads(index.get("case", "")).get("series", {"key": "", "values": []}))
    lives: Lives = {}
    for row, setting in zip(index.get("members", []), settings, strict=False):
        if (file := path.with_name(row["file"])).exists():
            others = ", ".join(f"{key[-1]} = {value}" for key, value in setting if key[-1] != "seed")
            lives.setdefault(others, []).append(read_life(file))
    if not lives:
        raise OutputError(f"{path}: none of its lives is beside it")
    return lives


def bands(lives: list[LifeHistory]) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """`band` of each of the `OF_SEEDS`."""
    return {name: band(lives, name) for name in OF_SEEDS}


def band(lives: list[LifeHistory], name: str) -> tuple[np.ndarray, np.ndarray]:
    """Passes at which any life has a row, up to the end of the shortest, shape (n,), and mean of a figure
    with its bootstrap bounds, shape (3, n), interpolated between the rows of each life.
    """
    passes = np.unique(np.concatenate([life("passes") for life in lives]))
    passes = passes[passes <= min(life.done for life in lives)]
    begin = [0.0] if name != "friction" else []  # nothing is worn or damaged before the first pass
    values = [np.interp(passes, [*begin, *life("passes")], [*begin, *life(name)]) for life in lives]
    columns = np.array(values).T
    return passes, np.array([(column.mean(), *bootstrap_bounds(column)) for column in columns]).T


def lines_of_ensembles(lives: Lives) -> Iterator[str]:
    """Lines with the mean of each figure over the lives of an ensemble and its bounds (90 %), at the end.

    Then those on the smooth contact of the first one, and on the limits of each life.
    """
    for others, members in lives.items():
        begin = f"{others}: " if others else ""
        for name in OF_SEEDS:
            passes, (mean, low, high) = band(members, name)
            yield (
                f"{begin}{name} after {passes[-1]:.4g} passes, {len(members)} lives: "
                f"{mean[-1]:.4g} ({low[-1]:.4g} to {high[-1]:.4g})"
            )
        yield from (f"{begin}{line}" for line in smooth_lines(members[0].rows[-1]))
        yield from (f"{begin}{line}" for line in dict.fromkeys(chain.from_iterable(map(limits, members))))
