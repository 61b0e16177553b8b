"""``python3 -m ehlpetsc.study``: how accurate, how fast, how robust.

``CASE.toml``: error against run time, as a table, a CSV file and a picture. ``--extremes``: a table of cases
at the edge of the ranges. ``--contact CASE.toml``: how much solids carry, against mesh, time step, boundary
film and contact model. ``--random N``: N random cases within the ranges, which must end in 0 or 3.
"""

import argparse
import sys
import tempfile
from pathlib import Path

from ehlpetsc import environment
from ehlpetsc.errors import CaseError


def arguments():
    """The command line."""
    parser = argparse.ArgumentParser(
        prog=environment.program("ehlpetsc.study"),
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("case", nargs="?", help="case file")
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="TABLE.KEY=VALUE",
        help="change of the case that all runs share; may be repeated",
    )
    parser.add_argument(
        "--meshes",
        type=int,
        nargs="+",
        default=[50, 100, 200, 400],
        help="points per half width (default: 50 100 200 400)",
    )
    parser.add_argument(
        "--courant",
        type=float,
        nargs="+",
        default=[0.5, 1.0, 2.0, 4.0],
        help="time steps (default: 0.5 1 2 4)",
    )
    parser.add_argument("--ranks", type=int, nargs="+", default=[2], help="ranks besides one (default: 2)")
    parser.add_argument("--damage", action="store_true", help="damage too, by ehlpetsc.post")
    parser.add_argument("--contact", action="store_true", help="how much contact, against mesh and model")
    parser.add_argument(
        "--models",
        nargs="+",
        choices=["direct", "mixed"],
        default=["direct", "mixed"],
        help="contact models (default: both)",
    )
    parser.add_argument(
        "--boundary-films", type=float, nargs="+", default=[10e-9], metavar="M", help="[m] (default: 10e-9)"
    )
    parser.add_argument("--extremes", action="store_true", help="run the table of extremes")
    parser.add_argument("--short", action="store_true", help="its short form: coarser, fewer steps")
    parser.add_argument("--random", type=int, metavar="N", help="run N random cases of 50 steps")
    parser.add_argument("--seed", type=int, default=1, help="of the random cases (default: 1)")
    parser.add_argument("-o", "--output", help="stem of CSV file and picture (default: by what is run)")
    parser.add_argument("--limit", type=float, default=600.0, help="seconds for one run (default: 600)")
    return parser


def main(argv):
    """Run the command; returns its exit status."""
    parser = arguments()
    chosen = parser.parse_args(argv)
    missing = environment.prepare()
    if missing:
        print(environment.advice(missing, argv), file=sys.stderr)
        return 2
    if chosen.extremes:
        return extremes(chosen)
    if chosen.random:
        return random_cases(chosen)
    if not chosen.case:
        parser.error("which case? CASE.toml, --extremes or --random N")
    return (contact if chosen.contact else accuracy)(chosen)


def say(text):
    print(text, flush=True)


def extremes(chosen):
    """The table of extremes."""
    from ehlpetsc.study.extremes import table

    table(f"{chosen.output or 'extremes'}.csv", chosen.short, chosen.limit, say)
    return 0


def random_cases(chosen):
    """Random cases: 1 where one ended in another status than 0 and 3, or left a broken file."""
    from ehlpetsc.study.draws import run_all

    table = f"{chosen.output or 'random'}.csv"
    return 1 if run_all(chosen.random, chosen.seed, table, chosen.limit, say) else 0


def contact(chosen):
    """How much contact there is."""
    from ehlpetsc.study.contact import settings, table

    stem = chosen.output or f"{Path(chosen.case).stem}.contact"
    runs = settings(chosen.models, chosen.meshes, chosen.courant, chosen.boundary_films)
    with tempfile.TemporaryDirectory() as folder:
        table(chosen.case, chosen.set, runs, f"{stem}.csv", folder, chosen.limit, say, chosen.damage)
    say(f"{stem}.csv")
    return 0


def accuracy(chosen):
    """Error against run time."""
    from ehlpetsc.study.accuracy.picture import draw
    from ehlpetsc.study.accuracy.plan import plan
    from ehlpetsc.study.accuracy.table import Study

    stem = chosen.output or Path(chosen.case).stem
    with tempfile.TemporaryDirectory() as folder:
        try:
            study = Study(chosen.case, chosen.set, folder, chosen.limit, chosen.damage)
        except CaseError as error:
            print("\n".join(error.faults), file=sys.stderr)
            return 2
        references, runs = plan(study.case, chosen.meshes, chosen.courant, chosen.ranks)
        rows = study.table(references, runs, f"{stem}.csv", say)
    draw(rows, f"{stem}.png", study.case.title)
    say(f"{stem}.csv, {stem}.png")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
