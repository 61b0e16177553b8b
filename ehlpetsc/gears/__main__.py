"""Path of contact of a spur gear pair: ``python3 -m ehlpetsc.gears CASE.toml``, or of a run, ``RESULT.h5``.

Of a case, prints radius, load, speeds and slide/roll ratio at the points A to E of the ``[gears]`` table and
draws them along the path. ``--csv FILE`` writes the path as a table for ``[operation]``. Of a result, prints
friction and losses of the mesh and draws pressure, films and friction along the path; where it has been
post-processed, RESULT.post.h5, also the damage along both flanks.
"""

import argparse
import sys
import tomllib
from pathlib import Path

from ehlpetsc import environment
from ehlpetsc.command_parser import CommandParser
from ehlpetsc.errors import CaseError, ExitStatus, OutputError, not_written


def arguments():
    """The command line."""
    parser = CommandParser(
        prog=environment.program("ehlpetsc.gears"),
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("case", help="case file with a [gears] table, or a result of one")
    parser.add_argument("-o", "--output", help="picture (default: CASE.gears.png)")
    parser.add_argument("--no-picture", action="store_true", help="the table alone")
    parser.add_argument("--csv", metavar="FILE", help="the path as a table for [operation]")
    return parser


def main(argv=None):
    """Run the command; returns its exit status."""
    chosen = arguments().parse_args(argv)
    try:
        run(chosen)
    except CaseError as error:
        print("\n".join(error.faults), file=sys.stderr)
    except OutputError as error:
        print(f"ehlpetsc.gears: {error}", file=sys.stderr)
    except (OSError, ValueError) as error:
        told = not_written(error) if isinstance(error, OSError) else str(error)
        print(f"ehlpetsc.gears: {told}", file=sys.stderr)
    else:
        return ExitStatus.DONE
    return ExitStatus.BAD_INPUT


def run(chosen):
    """Print the table, write picture and CSV file."""
    from ehlpetsc.gears.path import path_of_contact
    from ehlpetsc.gears.table import csv, hertz, rows

    if Path(chosen.case).suffix == ".h5":
        return _run_of(chosen)
    case = _read(chosen.case)
    if not isinstance(case.get("gears"), dict):
        raise CaseError([f"{chosen.case}: no [gears] table; allowed: a case with one"])
    try:
        path = path_of_contact(case["gears"])
    except CaseError as error:
        raise CaseError([f"{chosen.case}: {fault}" for fault in error.faults]) from None
    contact = case.get("contact")
    stresses = hertz(path, contact if isinstance(contact, dict) else {})
    print("\n".join(rows(path, stresses)))
    if chosen.csv:
        _check_target(chosen.csv, chosen.case)
        Path(chosen.csv).write_text(csv(path), encoding="utf-8")
        print(chosen.csv)
    if not chosen.no_picture:
        from ehlpetsc.gears.picture import draw

        target = chosen.output or f"{Path(chosen.case).stem}.gears.png"
        _check_target(target, chosen.case)
        draw(path, stresses, target, str(case.get("title", chosen.case)))
        print(target)


def _run_of(chosen):
    """Print and draw a result along its path of contact."""
    from ehlpetsc.gears.along_path import GearRun
    from ehlpetsc.gears.flanks import FlankDamage

    found = GearRun(chosen.case)
    print("\n".join(found.lines()))
    if not chosen.no_picture:
        target = chosen.output or f"{Path(chosen.case).stem}.gears.png"
        _check_target(target, chosen.case)
        found.draw(target)
        print(target)
    post = Path(chosen.case).with_suffix(".post.h5")
    if post.exists():
        damage = FlankDamage(post, found.begins)
        print("\n".join(damage.lines()))
        if not chosen.no_picture:
            flanks = Path(target).with_suffix(".flanks.png")
            damage.draw(found.path.pair, flanks, found.title)
            print(flanks)


def _read(path):
    try:
        return tomllib.loads(Path(path).read_bytes().decode("utf-8-sig"))
    except OSError as error:
        raise CaseError([f"{path}: cannot be read: {error.strerror}"]) from None
    except (ValueError, RecursionError) as error:
        raise CaseError([f"{path}: not valid TOML: {error}"]) from None


def _check_target(target, case):
    if Path(target).resolve() == Path(case).resolve():
        raise ValueError(f"{target}: is the case; give another file")


if __name__ == "__main__":
    sys.exit(main())
