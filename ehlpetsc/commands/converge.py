"""Error of a case: runs on three meshes, their order, extrapolated means and error bars.

``ehlpetsc converge CASE.toml [--nodes 8 12 16] -o OUT.csv``

Runs the case on n, 3/2 n and 2 n nodes per half-width, n that of the case, or on so many nodes to its
shortest wave. Time steps become shorter with the mesh (``time.courant``). Under mpirun each rank runs a mesh.
Friction, load on the solids and films are means over the time in which both surfaces fill the contact;
``--damage`` adds the mean damage of each surface and depth. Without an order, as of extremes at single nodes,
the value is that on the finest mesh and the bar the range of all three. Each member of a series is converged.
The results are OUT_*.h5; the same command continues after a stop. OUT.png draws error against time.
"""

from __future__ import annotations

import csv
import io
import tomllib
from argparse import Namespace
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ehlpetsc.analysis.convergence import MESHES, Convergence, columns, convergence, rows
from ehlpetsc.base.command_line import CommandParser, exit_status
from ehlpetsc.base.environment import need_solver, other_mpi
from ehlpetsc.base.errors import CaseError, ExitStatus, OutputError, Stopped, UsageError
from ehlpetsc.case.loading import load
from ehlpetsc.results.index import open_all
from ehlpetsc.results.output_guard import PICTURES, atomic_write, check_derived, check_table, inputs_of

if TYPE_CHECKING:
    from mpi4py import MPI

    from ehlpetsc.case.tables import Case

RATIOS = 1.0, 1.5, 2.0  # of the nodes to those of the case
KEY = "mesh.points_per_half_width"


def main(words: list[str]) -> int:
    """Run the command; returns its exit status."""
    parser = CommandParser("converge", __doc__)
    parser.add_argument("case", help="case file")
    parser.add_argument("-o", "--output", type=Path, metavar="OUT.csv", help="default: CASE.converge.csv")
    parser.add_argument(
        "--nodes", nargs=MESHES, type=float, metavar="N", help="to the shortest wave of both surfaces"
    )
    parser.add_argument("--damage", action="store_true", help="also fatigue damage, as post computes it")
    parser.add_argument("--no-picture", action="store_true", help="do not draw")
    chosen = parser.parse_args(words)
    return exit_status("converge", lambda: _run(chosen), (ImportError,))


def _run(chosen: Namespace) -> int | None:
    """Run what is missing on all ranks, then evaluate the results on the first one."""
    need_solver()
    from mpi4py import MPI

    from ehlpetsc.run.ranks import on_root

    comm = MPI.COMM_WORLD
    if fault := other_mpi(comm.size):
        raise UsageError(fault)
    case, target = on_root(comm, _prepared, chosen)
    status = _solve(comm, case, target.with_suffix(".h5"), chosen.overwrite)
    if status is ExitStatus.STOPPED:
        raise Stopped
    return on_root(comm, _evaluate, case, target, chosen) or status


def _prepared(chosen: Namespace) -> tuple[Case, Path]:
    """The case as a series over three meshes, and the checked CSV file."""
    case = load(chosen.case, chosen.set)
    target = chosen.output or Path(f"{case.path.stem}.converge.csv")
    check_derived(target, inputs_of(case), (".csv",))
    check_table(target, ",".join(columns(())[:2]), chosen.overwrite)
    if not chosen.no_picture:
        check_derived(target.with_suffix(".png"), inputs_of(case), PICTURES)
    series = over_meshes(tomllib.loads(case.text).get("series"), meshes(case, chosen.nodes))
    overrides: list[Any] = [*chosen.set, ("series", series)]
    return load(chosen.case, overrides), target


def meshes(case: Case, nodes: list[float] | None) -> list[Any]:
    """Values of `KEY`: three of increasing fineness, by default in the `RATIOS`.

    `nodes`: to the shortest wave of both surfaces.
    """
    mesh = case.mesh
    ratios: tuple[float, ...] = RATIOS
    if nodes:
        if sorted(set(nodes)) != nodes or nodes[0] <= 0.0:
            raise UsageError(f"--nodes {' '.join(f'{n:g}' for n in nodes)}: allowed: three that increase")
        ratios = tuple(n / nodes_to_wave(case) for n in nodes)
    along = [round(ratio * mesh.points_per_half_width) for ratio in ratios]
    if mesh.points_across is None:
        return along
    return [list(pair) for pair in zip(along, (round(r * mesh.points_across) for r in ratios), strict=True)]


def nodes_to_wave(case: Case) -> float:
    """Nodes of the case to the shortest wave of both surfaces; UsageError of smooth ones."""
    from ehlpetsc.physics.scales import Scales
    from ehlpetsc.run.forecast.mesh_error import waves
    from ehlpetsc.surfaces.motion.roughness import Roughness

    scales = Scales.of(case)
    found = waves(case, scales, Roughness.of(case, scales))
    if not found:
        raise UsageError("--nodes: to the shortest wave, but both surfaces are smooth; leave it out")
    return min(shortest for _, shortest in found.values()) / scales.spacing


def over_meshes(series: dict | None, points: list[Any]) -> dict[str, Any]:
    """Table [series] of a case over three meshes: of all its members, where it is a series."""
    from ehlpetsc.base.toml_file import combinations, keys_of

    if series is None:
        return {"key": KEY, "values": points}
    members = [(*member, n) for member in combinations(series) for n in points]
    values = [list(column) for column in zip(*members, strict=True)]
    return {"keys": [*keys_of(series), KEY], "values": values, "combine": "step"}


def _solve(comm: MPI.Comm, case: Case, output: Path, overwrite: bool) -> ExitStatus:
    """Run the members without a result."""
    from ehlpetsc.physics.scales import Scales
    from ehlpetsc.run.forecast.domain import refusals
    from ehlpetsc.run.ranks import StopRequest
    from ehlpetsc.run.series import Series

    if faults := refusals(case, Scales.of(case)):
        raise CaseError(faults)
    return Series(comm, case, output, StopRequest(), overwrite).run()


def _evaluate(case: Case, target: Path, chosen: Namespace) -> ExitStatus | None:
    """Print, store and draw the convergence of all cases."""
    index = target.with_suffix(".series.json")
    with ExitStack() as stack:
        results = open_all([index], stack)
        if chosen.damage:
            _damage([result.path for result in results])
        cases = convergence(results)
    if not cases:
        raise OutputError(f"{index}: no case has results on {MESHES} meshes")
    _put(cases, target)
    if not chosen.no_picture:
        from ehlpetsc.pictures.convergence import draw

        draw(case.title, cases, picture := target.with_suffix(".png"))
        print(picture)
    return None


def _damage(paths: list[Path]) -> None:
    """Damage beside each result, computed where it is missing."""
    from ehlpetsc.post.run import Job, run

    for path in paths:
        job = Job(str(path), str(path.with_suffix(".post.h5")))
        if not job.is_done():
            run(job)


def _put(cases: list[Convergence], target: Path) -> None:
    """Print a table, and write it as CSV."""
    table = [columns(cases[0].points), *rows(cases)]
    shown = table if len(cases) > 1 else [row[1:] for row in table]
    widths = [max(map(len, column)) for column in zip(*shown, strict=True)]
    for row in shown:
        print("  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip())
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(table)
    atomic_write(target, text.getvalue().encode())
    print(target)
