"""Path of contact of a gear pair and runs along it, beside standards: ``ehlpetsc gears CASE.toml``.

With a case, prints radius, load, speeds, film and flash temperature at the points A to E of the ``[gears]``
table and draws them along the path. ``--csv FILE`` writes the path as a table for ``[operation]``. With
results, prints friction and losses of the mesh beside the standards and draws pressure, films and friction
along the path and, if RESULT.post.h5 exists, the damage along both flanks. With the index of a series,
draws them over the torque. ``--run RESULT.h5`` runs a case with ``bulk_temperature = "losses"`` until the
bulk temperatures are those of its own losses. ``--crowned C "10 um"`` prints a case
of the point contact at C of teeth with this crown or end relief at both ends of the face.
"""

from __future__ import annotations

import argparse
from functools import partial
from pathlib import Path

from ehlpetsc.analysis.gear_run import GearRun, lines, panels
from ehlpetsc.base.command_line import CommandParser, exit_status
from ehlpetsc.base.errors import CaseError, OutputError, ProfileError
from ehlpetsc.case.derived import modulus_of, rating_of
from ehlpetsc.case.loading import load
from ehlpetsc.gears.path import path_of_contact
from ehlpetsc.gears.standards import bulk_temperatures
from ehlpetsc.gears.table import HEADING, crowned, csv, rows
from ehlpetsc.results.index import files_of
from ehlpetsc.results.output_guard import PICTURES, atomic_write, check_derived, check_table, inputs_of, put
from ehlpetsc.results.reader import read_result

MAX_RUNS = 6
MAX_BULK_CHANGE = 1.0  # K, of the bulk temperatures by the last run


def main(words: list[str]) -> int:
    """Run the command; returns its exit status."""
    parser = CommandParser("gears", __doc__)
    parser.add_argument("files", nargs="+", help="case file with a [gears] table; its results; their index")
    parser.add_argument("-o", "--output", help="picture [CASE.path.png, RESULT.gears.png]")
    parser.add_argument("--no-picture", action="store_true", help="the table alone")
    parser.add_argument("--csv", metavar="FILE.csv", help="the path as a table for [operation]")
    parser.add_argument(
        "--crowned", nargs=2, metavar=("POINT", "DEPTH"), help="case of the point contact of crowned teeth"
    )
    parser.add_argument(
        "--run", metavar="RESULT.h5", help="repeat the run until bulk temperatures are those of its losses"
    )
    chosen = parser.parse_args(words)
    return exit_status("gears", lambda: run(chosen), (ValueError,))


def run(chosen: argparse.Namespace) -> None:
    """Print the table, write picture and CSV file."""
    file = Path(chosen.files[0])
    if file.suffix in (".h5", ".json"):
        return _compare(chosen)
    if chosen.run:
        return _iterate(chosen, file)
    case = load(file, chosen.set)
    if case.gears is None:
        raise CaseError([f"{file}: no [gears] table; allowed: a case with one"])
    if chosen.crowned:
        return put(crowned(case, modulus_of(case), *chosen.crowned), chosen, inputs_of(case))
    path, modulus, rating = path_of_contact(case.gears.pair), modulus_of(case), rating_of(case, file.parent)
    target = _picture(chosen, "path")
    if chosen.csv is not None:
        check_derived(Path(chosen.csv), inputs_of(case), (".csv", ".txt"), "--csv")
        check_table(Path(chosen.csv), HEADING, chosen.overwrite, "--csv")
    print("\n".join(rows(path, modulus, rating)))
    if chosen.csv is not None:
        atomic_write(Path(chosen.csv), csv(path).encode())
        print(chosen.csv)
    if target:
        from ehlpetsc.pictures.gears import draw

        draw(path, modulus, rating, target, case.title)
        print(target)


def _compare(chosen: argparse.Namespace) -> None:
    """Print and draw results along their paths of contact, those of an index over the torque."""
    from ehlpetsc.pictures.gears import draw_damage, draw_runs, draw_stages

    if chosen.csv is not None:
        raise OutputError(f"{chosen.files[0]}: a result; allowed for --csv: a case with a [gears] table")
    files = [file for given in chosen.files for file in files_of(Path(given))]
    runs = [_run_of(file) for file in files]
    print("\n".join(lines(runs)))
    is_series = any(str(given).endswith(".json") for given in chosen.files)
    target = _picture(chosen, "stages" if is_series else "gears")
    if target is None:
        return
    if is_series:
        pictures = {target: partial(draw_stages, runs)}
    else:
        pictures = {
            target.with_suffix(ending + target.suffix): partial(draw_runs, runs, names=names)
            for ending, names in panels(runs).items()
        }
        damaged = [run for run in runs if run.damage]
        if damaged:
            pictures[target.with_suffix(".flanks" + target.suffix)] = partial(draw_damage, damaged)
    for path in pictures:
        check_derived(path, files, PICTURES)
    for path, draw in pictures.items():
        draw(path)
        print(path)


def _run_of(file: Path) -> GearRun:
    with read_result(file) as result:
        try:
            rating = rating_of(result.case, file.parent)
        except ProfileError:  # a profile file that is no longer beside the result
            rating = None
    return GearRun(file, rating)


def _iterate(chosen: argparse.Namespace, file: Path) -> None:
    """Run a case until the bulk temperatures are those of its computed friction."""
    from ehlpetsc.api import solve

    case = load(file, chosen.set)
    if case.gears is None or case.heat is None:
        raise OutputError(f"{file}: allowed for --run: a case with [gears] and [heat]")
    bulk = case.heat.bulk_temperature
    for number in range(1, MAX_RUNS + 1):
        case = load(file, [*chosen.set, f"heat.bulk_temperature={[round(value, 1) for value in bulk]}"])
        solve(case, chosen.run, overwrite=chosen.overwrite or number > 1).close()
        run = _run_of(Path(chosen.run))
        found = bulk_temperatures(run.rating, run.friction_on_path(), case.gears.heat_transfer)
        used = ", ".join(f"{value:.1f}" for value in bulk)
        print(f"run {number}: bulk temperatures {used} K; by its losses {found[0]:.1f}, {found[1]:.1f} K")
        if max(abs(new - old) for new, old in zip(found, bulk, strict=True)) < MAX_BULK_CHANGE:
            break
        bulk = found
    print(chosen.run)


def _picture(chosen: argparse.Namespace, kind: str) -> Path | None:
    """Checked path of the picture; None: no picture."""
    if chosen.no_picture:
        return None
    stem = Path(chosen.files[0]).stem.removesuffix(".series")
    target = Path(f"{stem}.{kind}.png" if chosen.output is None else chosen.output)
    check_derived(target, [Path(given) for given in chosen.files], PICTURES)
    return target
