"""Surfaces over their life: ``python3 -m ehlpetsc.life CASE.toml``; of ``OUT.life.h5``, the picture.

Wear and fatigue damage of a pass are multiplied over as many passes as leave the surfaces nearly the same,
see the table [life] of the case; the next pass meets the changed surfaces. The same command continues a life.
"""

import argparse
import sys
from pathlib import Path

from ehlpetsc import environment
from ehlpetsc.command_parser import CommandParser
from ehlpetsc.errors import (
    CaseError,
    ExitStatus,
    NotConverged,
    OutputError,
    PostError,
    Stopped,
    UsageError,
    not_written,
)


def arguments():
    """The command line."""
    parser = CommandParser(
        prog=environment.program("ehlpetsc.life"),
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("case", help="case file with a [life] table, or OUT.life.h5 to draw")
    parser.add_argument("-o", "--output", metavar="FILE.h5", help="default: CASE.life.h5")
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="TABLE.KEY=VALUE",
        help="a key of the case; may be repeated",
    )
    parser.add_argument("--overwrite", action="store_true", help="begin anew")
    parser.add_argument("--no-picture", action="store_true", help="the numbers alone")
    return parser


def main(argv=None):
    """Run the command; returns its exit status."""
    chosen = arguments().parse_args(argv)
    try:
        path = Path(chosen.case) if chosen.case.endswith(".h5") else _run(chosen)
        if path and not chosen.no_picture:
            from ehlpetsc.life.history import read_life
            from ehlpetsc.life.picture import draw

            life, target = read_life(path), _picture(path, [path])
            draw(life, target)
            print(target)
    except CaseError as error:
        print("\n".join(error.faults), file=sys.stderr)
    except Stopped:
        print("ehlpetsc.life: stopped; the same command continues")
        return ExitStatus.STOPPED
    except NotConverged as error:
        print(f"ehlpetsc.life: not converged: {error}", file=sys.stderr)
        return ExitStatus.NOT_CONVERGED
    except (OutputError, PostError, UsageError) as error:
        print(f"ehlpetsc.life: {error}", file=sys.stderr)
    except (OSError, ImportError) as error:
        message = not_written(error) if isinstance(error, OSError) else str(error)
        print(f"ehlpetsc.life: {message}", file=sys.stderr)
    else:
        return ExitStatus.DONE
    return ExitStatus.BAD_INPUT


def _picture(path, inputs):
    """Where the picture of a life goes, checked."""
    from ehlpetsc.results.output_guard import PICTURE_SIGNATURES, check_derived

    target = path.with_suffix(".png")
    check_derived(target, inputs, PICTURE_SIGNATURES)
    return target


def _run(chosen):
    """Run a life; its file on the first rank, else None."""
    from ehlpetsc.api import need_solver
    from ehlpetsc.case.loading import load

    need_solver()
    from mpi4py import MPI

    from ehlpetsc.life.driver import run_life
    from ehlpetsc.results.output_guard import inputs_of
    from ehlpetsc.run.on_root import on_root
    from ehlpetsc.run.stop import StopRequest

    comm, case = MPI.COMM_WORLD, load(chosen.case, chosen.set)
    path = Path(f"{Path(case.path).stem}.life.h5" if chosen.output is None else chosen.output)
    is_root = comm.rank == 0
    if path.name and not chosen.no_picture:
        on_root(comm, _picture, path, inputs_of(case))

    def show(text):
        if is_root:
            print(text, flush=True)

    run_life(case, path, overwrite=chosen.overwrite, comm=comm, show=show, stop=StopRequest())
    show(str(path))
    return path if is_root else None


if __name__ == "__main__":
    sys.exit(main())
