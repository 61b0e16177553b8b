"""The program given invalid input: ``python3 tests/fuzz/all.py --seed 1 --options 500 --results 500 ...``.

options   a small case run with one to four PETSc and own options drawn from a list of good and bad ones
results   results, some of them cut off or foreign, given to the commands that read them
passes    passes, series and single runs stopped, killed or robbed of a file, and the same command once more
python    calls from Python with arguments drawn from lists of good and bad ones

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
os.environ["HDF5_USE_FILE_LOCKING"] = "FALSE"
HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent), str(HERE.parent / "unit"), str(HERE.parents[1])]
import numpy as np
from sandbox import BAD, WORDS

from ehlpetsc.base import environment

environment.prepare()
# calls from Python import PETSc, after which nothing may be forked
KINDS = ("results", "options", "passes", "python")
LATE = ("python",)


def fuzz(seed, show=False, keep=None, **numbers):
    """Counts by kind and outcome."""
    found = {}
    for kind in sorted(KINDS, key=LATE.__contains__):
        if not numbers.get(kind):
            continue
        counts = found[kind] = Counter()
        with tempfile.TemporaryDirectory() as folder:
            draw = __import__(f"fuzz_{kind}").Draw(Path(folder))
            for number in range(numbers[kind]):
                word, what = draw(np.random.default_rng([seed, KINDS.index(kind), number]))
                counts[word] += 1
                if show or word in BAD:
                    print(f"{kind} {number}: {word}: {what}", flush=True)
                if word in BAD and keep:
                    Path(keep).mkdir(parents=True, exist_ok=True)
                    draw.keep(Path(keep) / f"{kind}_{seed}_{number}")
        counted = ", ".join(f"{word} {counts[word]}" for word in (*WORDS.values(), *BAD) if counts[word])
        print(f"{kind}: {counted}", flush=True)
    return found


def main():
    """Print counts; returns the exit status."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seed", type=int, default=1)
    for kind in KINDS:
        parser.add_argument(f"--{kind}", type=int, default=0, metavar="N")
    parser.add_argument("--keep", metavar="FOLDER", help="keep the files of what must not be")
    parser.add_argument("--show", action="store_true", help="a line a draw")
    found = fuzz(**vars(parser.parse_args()))
    return int(any(counts[word] for counts in found.values() for word in BAD))


if __name__ == "__main__":
    sys.exit(main())
