"""The program given invalid input: ``python3 tests/fuzz/all.py --seed 1 --options 500 --passes 30``.

options  a small case run with one to four PETSc and own options drawn from a list of good and bad ones
passes   passes, series and single runs stopped, killed or robbed of a file, and the same command once more

Counted are done, refused (status 2, with a reason), not converged (3), stopped (4), and what must not be:
traceback, hang, signal, different (status 0 with another answer and no word), changed (an input is not as it
was). Exit status 1 if any of these is not 0.
"""

import argparse
import os
import sys
import tempfile
from collections import Counter
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent), str(HERE.parents[1])]
import numpy as np
from sandbox import BAD, WORDS

from ehlpetsc.base import environment

environment.prepare()
KINDS = ("options", "passes")


def main():
    """Print counts; returns the exit status."""
    form = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=form)
    for name, default in (("seed", 1), *((kind, 0) for kind in KINDS)):
        parser.add_argument(f"--{name}", type=int, default=default, metavar="N")
    chosen, status = vars(parser.parse_args()), 0
    for kind in [kind for kind in KINDS if chosen[kind]]:
        counts = Counter()
        with tempfile.TemporaryDirectory() as folder:
            draw = __import__(f"fuzz_{kind}").Draw(Path(folder))
            for number in range(chosen[kind]):
                word, what = draw(np.random.default_rng([chosen["seed"], KINDS.index(kind), number]))
                counts[word] += 1
                if word in BAD:
                    print(f"{kind} {number}: {word}: {what}", flush=True)
                    status = 1
        counted = ", ".join(f"{word} {counts[word]}" for word in (*WORDS.values(), *BAD) if counts[word])
        print(f"{kind}: {counted}", flush=True)
    return status


if __name__ == "__main__":
    sys.exit(main())
