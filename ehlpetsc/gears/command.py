"""Path of contact of a spur gear pair: ``ehlpetsc gears CASE.toml`` or ``ehlpetsc gears RESULT.h5``.

With a case, prints radius, load, speeds and slide/roll ratio at the points A to E of the ``[gears]`` table
and draws them along the path. ``--csv FILE`` writes the path as a table for ``[operation]``. With a result,
prints friction and losses of the mesh and draws pressure, films and friction along the path and, if
RESULT.post.h5 exists, the damage along both flanks.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from ehlpetsc.base.command_parser import CommandParser, exit_status
from ehlpetsc.base.errors import OutputError
from ehlpetsc.results.output_guard import PICTURES, atomic_write, check_derived


def arguments() -> CommandParser:
    """Parse the command line."""
    parser = CommandParser("gears", __doc__)
    parser.add_argument("case", help="case file with a [gears] table, or a result of one")
    parser.add_argument("-o", "--output", help="picture [CASE.path.png, RESULT.gears.png]")
    parser.add_argument("--no-picture", action="store_true", help="the table alone")
    parser.add_argument("--csv", metavar="FILE.csv", help="the path as a table for [operation]")
    return parser


def main(words: list[str]) -> int:
    """Run the command; returns its exit status."""
    chosen = arguments().parse_args(words)
    return exit_status("gears", lambda: run(chosen), (ValueError,))


def run(chosen: argparse.Namespace) -> None:
    """Print the table, write picture and CSV file."""
    from ehlpetsc.case.loading import gear_tables
    from ehlpetsc.gears.path import path_of_contact
    from ehlpetsc.gears.table import COLUMNS, csv, hertz, rows

    if Path(chosen.case).suffix == ".h5":
        return _run_of(chosen)
    pair, case = gear_tables(chosen.case, chosen.set)
    path = path_of_contact(pair)
    contact = case.get("contact")
    stresses = hertz(path, contact if isinstance(contact, dict) else {})
    target = _picture(chosen)
    if chosen.csv is not None:
        check_derived(
            Path(chosen.csv), [Path(chosen.case)], (".csv", ".txt"), "--csv", ", ".join(COLUMNS).encode()
        )
    print("\n".join(rows(path, stresses)))
    if chosen.csv is not None:
        atomic_write(chosen.csv, csv(path).encode())
        print(chosen.csv)
    if target:
        from ehlpetsc.pictures.gears import draw

        draw(path, stresses, target, str(case.get("title", chosen.case)))
        print(target)


def _run_of(chosen: argparse.Namespace) -> None:
    """Print and draw a result along its path of contact."""
    from ehlpetsc.analysis.gear_run import FlankDamage, GearRun
    from ehlpetsc.pictures.gears import draw_damage, draw_run

    if chosen.csv is not None:
        raise OutputError(f"{chosen.case}: a result; allowed for --csv: a case with a [gears] table")
    gear_run = GearRun(chosen.case)
    post = Path(chosen.case).with_suffix(".post.h5")
    target = _picture(chosen)
    flanks = target and target.with_suffix(".flanks.png")
    if flanks and post.exists():
        check_derived(flanks, [Path(chosen.case), post], PICTURES)
    print("\n".join(gear_run.lines()))
    if target:
        draw_run(gear_run, target)
        print(target)
    if post.exists():
        damage = FlankDamage(post, gear_run.profile_offsets)
        print("\n".join(damage.lines()))
        if flanks:
            draw_damage(damage, gear_run.path.pair, flanks, gear_run.title)
            print(flanks)


def _picture(chosen: argparse.Namespace) -> Path | None:
    """Checked path of the picture; None: no picture."""
    if chosen.no_picture:
        return None
    given = Path(chosen.case)
    kind = "gears" if given.suffix == ".h5" else "path"
    target = Path(f"{given.stem}.{kind}.png" if chosen.output is None else chosen.output)
    check_derived(target, [Path(chosen.case)], PICTURES)
    return target
