"""``python3 -m ehlpetsc.study``: how accurate, how fast, how robust.

``CASE.toml``: error against run time. ``--extremes``: a table of cases at the edge of the ranges.
"""
import argparse
import sys

from ehlpetsc import environment


def arguments():
    """The command line."""
    parser = argparse.ArgumentParser(prog="python3 -m ehlpetsc.study", description=__doc__)
    parser.add_argument("--extremes", action="store_true", help="run the table of extremes")
    parser.add_argument("--short", action="store_true", help="its short form: coarser, fewer steps")
    parser.add_argument("-o", "--output", default="extremes.csv", help="CSV file")
    parser.add_argument("--limit", type=float, default=300.0, help="wall clock time of one run [s]")
    return parser


def main(argv):
    """Run the command; returns its exit status."""
    chosen = arguments().parse_args(argv)
    missing = environment.prepare()
    if missing:
        print(environment.advice(missing, argv), file=sys.stderr)
        return 2
    from ehlpetsc.study.extremes import table

    table(chosen.output, chosen.short, chosen.limit, lambda text: print(text, flush=True))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
