"""Wear against fatigue over the life of two surfaces: ``ehlpetsc life CASE.toml``; draws ``OUT.life.h5``.

Wear and fatigue damage of a solved pass are multiplied over the passes in which the surfaces hardly change,
see the table [life] of the case; the next pass is solved with the changed surfaces. The same command
continues a life. A case with [series] runs a life for each member and writes the index
``OUT.life.series.json``. Under mpirun each rank solves a position of surface 2, or a life.
"""

from __future__ import annotations

from argparse import Namespace
from pathlib import Path

from ehlpetsc.base.command_parser import CommandParser, exit_status
from ehlpetsc.base.errors import UsageError


def arguments() -> CommandParser:
    """The command line."""
    parser = CommandParser("life", __doc__)
    parser.add_argument("case", help="case file with a [life] table; OUT.life.h5 to draw")
    parser.add_argument("-o", "--output", metavar="FILE.h5", help="default: CASE.life.h5")
    parser.add_argument("--overwrite", action="store_true", help="start again")
    parser.add_argument(
        "--unresolved", action="store_true", help="run also on a mesh too coarse for the profiles"
    )
    parser.add_argument("--after", type=int, metavar="ROW", help="continue after this row, from 1")
    parser.add_argument("--no-picture", action="store_true", help="do not draw")
    return parser


def main(words: list[str]) -> int:
    """Run the command; returns its exit status."""
    chosen = arguments().parse_args(words)
    return exit_status("life", lambda: _run(chosen), (ImportError,))


def _run(chosen: Namespace) -> None:
    """Run a life or a series of them, where a case is given; draw a life on the first rank."""
    path, is_root = Path(chosen.case), True
    if path.suffix != ".h5":
        path, is_root = _run_lives(chosen)
    elif not chosen.no_picture:
        _check_picture(path, [path])
    if is_root and path.suffix == ".h5" and not chosen.no_picture:
        _draw(path)


def _draw(path: Path) -> None:
    from ehlpetsc.life.history import read_life
    from ehlpetsc.pictures.lives import draw

    target = path.with_suffix(".png")
    draw(read_life(path), target)
    print(target)


def _check_picture(path: Path, inputs: list[Path]) -> None:
    from ehlpetsc.results.output_guard import PICTURES, check_derived

    check_derived(path.with_suffix(".png"), inputs, PICTURES)


def _run_lives(chosen: Namespace) -> tuple[Path, bool]:
    """Run a life or a series of lives; returns its file or index, and whether this is the first rank."""
    from ehlpetsc.api import need_solver
    from ehlpetsc.case.loading import load

    need_solver()
    from mpi4py import MPI

    from ehlpetsc.life.driver import run_life
    from ehlpetsc.life.regimes import run_regimes
    from ehlpetsc.results.output_guard import inputs_of
    from ehlpetsc.run.ranks import on_root
    from ehlpetsc.run.stop import StopRequest

    comm, case = MPI.COMM_WORLD, load(chosen.case, chosen.set)
    output = Path(f"{Path(case.path).stem}.life.h5" if chosen.output is None else chosen.output)

    def show(text: str) -> None:
        if comm.rank == 0:
            print(text, flush=True)

    options = {name: getattr(chosen, name) for name in ("overwrite", "unresolved")}
    options |= {"comm": comm, "show": show, "stop": StopRequest()}
    if case.series:
        if chosen.after:
            raise UsageError("--after: of a life; allowed with a series: left out")
        output = run_regimes(case, output, **options)
    else:
        if output.name and not chosen.no_picture:
            on_root(comm, _check_picture, output, inputs_of(case))
        run_life(case, output, after=chosen.after, **options)
    show(str(output))
    return output, comm.rank == 0
