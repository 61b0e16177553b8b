"""Wear against fatigue over the life of two surfaces: ``ehlpetsc life CASE.toml``; draws ``OUT.life.h5``.

Wear and fatigue damage of a solved pass are multiplied over the passes in which the surfaces hardly change,
see the table [life] of the case; the next pass is solved with the changed surfaces. The same command
continues a life. Under mpirun each rank solves a position of surface 2, or lives of a [series]: the command
then prints means over seeds with their bounds (bootstrap, 90 %), also from ``OUT.life.series.json``.
"""

from __future__ import annotations

from argparse import Namespace
from functools import partial
from pathlib import Path

from ehlpetsc.base.command_line import CommandParser, exit_status
from ehlpetsc.base.compiled import announce_compilation
from ehlpetsc.base.environment import other_mpi
from ehlpetsc.base.errors import UsageError
from ehlpetsc.case.loading import load
from ehlpetsc.life.ensemble import bands, lines_of_ensembles, read_lives, run_lives
from ehlpetsc.life.history import read_life
from ehlpetsc.results.output_guard import PICTURES, check_derived, file_path, inputs_of


def main(words: list[str]) -> int:
    """Run the command; returns its exit status."""
    parser = CommandParser("life", __doc__)
    parser.add_argument("case", help="case file with a [life] table; OUT.life.h5 to draw")
    parser.add_argument("-o", "--output", metavar="FILE.h5", help="default: CASE.life.h5")
    parser.add_argument("--overwrite", action="store_true", help="start again")
    parser.add_argument("--unresolved", action="store_true", help="also on a mesh too coarse for profiles")
    parser.add_argument("--no-picture", action="store_true", help="do not draw")
    chosen = parser.parse_args(words)
    return exit_status("life", lambda: _run(chosen), (ImportError,))


def _run(chosen: Namespace) -> None:
    """Run a life, where a case is given, and draw it on the first rank."""
    path = Path(chosen.case)
    if path.suffix == ".json":
        _show_lives(path, not chosen.no_picture)
    elif path.suffix != ".h5":
        _run_life(chosen)
    elif not chosen.no_picture:
        _draw(_picture(path, [path]), path)


def _picture(path: Path, inputs: list[Path]) -> Path:
    """Checked path of the picture of a life."""
    target = path.with_suffix(".png")
    check_derived(target, inputs, PICTURES)
    return target


def _draw(target: Path, path: Path) -> None:
    from ehlpetsc.pictures.lives import draw

    draw(read_life(path), target)
    print(target)


def _show_lives(path: Path, draws: bool) -> None:
    """Print and draw the means of lives with their bounds."""
    lives = read_lives(path)
    print("\n".join(lines_of_ensembles(lives)))
    if draws:
        from ehlpetsc.pictures.lives import draw_ensembles, smooth_label

        target = _picture(path, [path])
        one = next(iter(lives.values()))
        title = f"{one[0].title}: mean of {len(one)} lives, bounds of 90 %; {smooth_label(one[0])}"
        draw_ensembles(title, {others: bands(members) for others, members in lives.items()}, target)
        print(target)


def _run_life(chosen: Namespace) -> None:
    """Run a life and draw it."""
    from ehlpetsc.life import run_life

    case = load(chosen.case, chosen.set)
    from mpi4py import MPI

    from ehlpetsc.run.ranks import StopRequest, on_root

    comm = MPI.COMM_WORLD
    if fault := other_mpi(comm.size):
        raise UsageError(fault)
    output = file_path(f"{Path(case.path).stem}.life.h5" if chosen.output is None else chosen.output)
    show = partial(print, flush=True) if comm.rank == 0 else lambda text: None
    if comm.rank == 0:
        announce_compilation(show)
    options = {"overwrite": chosen.overwrite, "unresolved": chosen.unresolved}
    options |= {"comm": comm, "show": show, "stop": StopRequest()}
    if case.series:
        options["show"] = partial(print, flush=True)  # of every rank
        index = run_lives(case, output, **options)
        if comm.rank == 0:
            print(index)
            _show_lives(index, not chosen.no_picture)
        return
    draws = output.name and not chosen.no_picture
    target = on_root(comm, _picture, output, inputs_of(case)) if draws else None
    run_life(case, output, **options)
    show(str(output))
    if target and comm.rank == 0:
        _draw(target, output)
