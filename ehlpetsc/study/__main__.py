"""Studies of accuracy, speed and robustness: ``ehlpetsc study``.

``CASE.toml``: error over run time, as a table, a CSV file and a picture. ``--extremes``: a table of cases
at the edge of the ranges; with ``--far`` forty cases far beyond; with ``--models mixed`` in mixed contact.
``--contact CASE.toml``: load on the solids over mesh, time step, boundary film and contact model.
``--random N``: N random cases within the ranges, of both contact models, which must end with status 0 or 3.
"""

import os
import sys
import tempfile
from pathlib import Path

from ehlpetsc import environment
from ehlpetsc.command_parser import CommandParser, exit_status
from ehlpetsc.errors import CaseError, OutputError

VALUE_LISTS = {  # type, default, description
    "--meshes": (int, [50, 100, 200, 400], "points per half width"),
    "--courant": (float, [0.5, 1.0, 2.0, 4.0], "time steps"),
    "--ranks": (int, [2], "ranks besides one"),
    "--boundary-films": (float, [10e-9], "boundary films of --contact [m]"),
}
SWITCHES = {
    "--damage": "damage too, by ehlpetsc.post",
    "--contact": "how much contact, against mesh and model",
    "--extremes": "run the table of extremes",
    "--short": "its short form: coarser, fewer steps",
    "--far": "of --extremes, instead: forty lines far beyond the ranges",
}


def arguments():
    """Parse the command line."""
    parser = CommandParser("ehlpetsc.study", __doc__.partition(":")[0] + ".\n" + __doc__.partition("\n")[2])
    add = parser.add_argument
    add("case", nargs="?", help="case file")
    shared = "change of the case that all runs share; may be repeated"
    add("--set", action="append", default=[], metavar="TABLE.KEY=VALUE", help=shared)
    for name, (kind, default, text) in VALUE_LISTS.items():
        shown = " ".join(f"{value:g}" for value in default)
        add(name, type=kind, nargs="+", default=default, metavar="N", help=f"{text} (default: {shown})")
    for name, text in SWITCHES.items():
        add(name, action="store_true", help=text)
    models = ["direct", "mixed", "compliant"]
    shown = "contact models (default: direct mixed); compliant: with --extremes"
    add("--models", nargs="+", choices=models, default=models[:2], help=shown)
    add("--random", type=int, metavar="N", help="run N random cases of 50 steps")
    add("--seed", type=int, default=1, help="of the random cases (default: 1)")
    add("-o", "--output", help="stem of CSV file and picture (default: by what is run)")
    add("--limit", type=float, default=600.0, help="seconds for one run (default: 600)")
    return parser


def main(argv=None):
    """Run the command; returns its exit status."""
    parser = arguments()
    chosen = parser.parse_args(argv)
    missing = environment.prepare()
    if missing:
        print(environment.advice(missing, argv), file=sys.stderr)
        return 2
    if not (chosen.extremes or chosen.random or chosen.case):
        parser.error("which case? CASE.toml, --extremes or --random N")
    run = accuracy
    if chosen.extremes or chosen.random:
        run = extremes if chosen.extremes else random_cases
    elif chosen.contact:
        run = contact
    return exit_status("ehlpetsc.study", lambda: run(chosen))


def say(text):
    print(text, flush=True)


def check_outputs(head, *outputs, case=None):
    """Refuse, before any run, outputs that are files of the case, other files, or not writable.

    `head` are the names of the first columns of the table.
    """
    from ehlpetsc.results.output_guard import PICTURE_SIGNATURES, check_derived, inputs_of

    for path in outputs:
        kinds = PICTURE_SIGNATURES | {".csv": ",".join(head[:3]).encode()}
        check_derived(Path(path), inputs_of(case) if case else (), kinds)
        if not Path(path).parent.is_dir():
            raise OutputError(f"{path}: not written, No such file or directory")
        if not os.access(Path(path).parent, os.W_OK):
            raise OutputError(f"{path}: its folder cannot be written to; give another -o")


def extremes(chosen):
    """Run the table of extremes."""
    from ehlpetsc.study.extremes import COLUMNS, table

    model = chosen.models[0] if len(chosen.models) == 1 else None  # None: model of each case
    path = f"{chosen.output or 'extremes'}.csv"
    check_outputs(COLUMNS, path)
    table(path, chosen.short, chosen.limit, say, far=chosen.far, model=model)


def random_cases(chosen):
    """Run random cases; status 1 if one ended with another status than 0 and 3, or left a damaged file."""
    from ehlpetsc.study.random_cases import COLUMNS, run_all

    table = f"{chosen.output or 'random'}.csv"
    check_outputs(COLUMNS, table)
    return 1 if run_all(chosen.random, chosen.seed, table, chosen.limit, say) else 0


def contact(chosen):
    """Run the study of the amount of contact."""
    from ehlpetsc.case.loading import load
    from ehlpetsc.study.contact import COLUMNS, settings, table
    from ehlpetsc.study.runs import check_damage

    if "compliant" in chosen.models:
        raise CaseError(["--models compliant: --contact takes direct and mixed; leave it out"])
    stem = chosen.output or f"{Path(chosen.case).stem}.contact"
    case = load(chosen.case, chosen.set)
    check_outputs(COLUMNS, f"{stem}.csv", case=case)
    if chosen.damage:
        check_damage(case, "1", min(chosen.meshes))
    runs = settings(chosen.models, chosen.meshes, chosen.courant, chosen.boundary_films)
    with tempfile.TemporaryDirectory() as folder:
        table(chosen.case, chosen.set, runs, f"{stem}.csv", folder, chosen.limit, say, chosen.damage)
    say(f"{stem}.csv")


def accuracy(chosen):
    """Run the study of error over run time."""
    from ehlpetsc.study.accuracy.picture import draw
    from ehlpetsc.study.accuracy.plan import plan
    from ehlpetsc.study.accuracy.table import COLUMNS, Study
    from ehlpetsc.study.runs import check_damage
    from ehlpetsc.study.setting import MESH

    stem = chosen.output or Path(chosen.case).stem
    with tempfile.TemporaryDirectory() as folder:
        study = Study(chosen.case, chosen.set, folder, chosen.limit, chosen.damage)
        check_outputs(COLUMNS, f"{stem}.csv", f"{stem}.png", case=study.case)
        references, runs = plan(study.case, chosen.meshes, chosen.courant, chosen.ranks)
        if chosen.damage:
            check_damage(study.case, "2", min(setting.values[MESH] for setting in (*references, *runs)))
        rows = study.table(references, runs, f"{stem}.csv", say)
    draw(rows, f"{stem}.png", study.case.title)
    say(f"{stem}.csv, {stem}.png")


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
