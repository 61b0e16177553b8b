"""Post-processing of damaged files: ``python3 tests/fuzz/post.py --flips 2000 --structures 300 --seed 1``.

Flips: one bit of a result file, as the solver writes it, is turned over; every second one in a byte that is
not raw data and not 0. Structures: one to three datasets, groups or attributes are taken away, or replaced
by something else. Each file is processed by the command in a process of its own, with a time limit.

Counted are

done        exit 0: the flip is in what is not read, or in a digit of a number
refused     exit 2 with a line that names the file and the reason; of these, how often HDF5 crashed or hung
traceback, hang, signal, litter
            what must not be: an exit by an exception, none within the limit, by a signal; files left behind

Exit status 1 if any of the last four is not 0; these files are kept.
"""

import argparse
import os
import sys
import tempfile
from collections import Counter
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ["HDF5_USE_FILE_LOCKING"] = "FALSE"
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
sys.path.insert(0, str(Path(__file__).resolve().parent))
from hdf5_damage import Flips, Structures
from sandbox import process
from support.made_loads import CASE, LOAD, P0, A, Scene

from ehlpetsc.post import command, subprocess_guard
from ehlpetsc.results.hdf5.datasets import Layout
from ehlpetsc.results.writer import ResultWriter

LIMIT = 120  # s a case
READ_LIMIT = 8  # s for one read, before HDF5 is taken to hang
BAD = ("traceback", "hang", "signal", "litter")
FIELDS = ["pressure", "film_thickness", "shear_stress_1", "shear_stress_2", "in_contact"]
ALL = ("2", "1")


def write_base(path):
    """A small result by the solver's own writer."""
    scene = Scene(per_width=10, ratio=0.5, travel=7.0)
    case = CASE.format(
        mean=scene.mean,
        ratio=scene.ratio,
        points=scene.points,
        time="[time]\ntravel = 7.0",
        every=1,
        depths=[0.1],
        post="b = -0.09",
    )
    attrs = dict(
        title="fuzz",
        case=case,
        a=A,
        p0=P0,
        h_scale=A * A / 0.0191,
        u1=scene.u1,
        u2=scene.u2,
        ranks=1,
        petsc_options="-a 1",
    )
    profiles = {name: (*scene.profiles[name], u) for name, u in (("1", scene.u1), ("2", scene.u2))}
    writer = ResultWriter(path, Layout(scene.x, FIELDS, profiles=profiles), attrs)
    for k, at in enumerate(scene.time):
        p = scene.pressure(k)
        fields = dict(zip(FIELDS, (p, 1e-7 + 0 * p, -0.05 * p, 0.05 * p, p < 0), strict=True))
        scalars = dict(
            dt=scene.time[1],
            p_max=p.max(),
            h_min=1e-7,
            load=p.sum() * scene.dx,
            friction=0.05 * p.sum() * scene.dx,
        )
        writer.append(k, at, fields, scalars, p < 0)
    writer.close("done")
    assert abs(scalars["load"] / LOAD - 1) < 1e-9


def outcome(status, report, path):
    """One word; "refused" only with a line that names the file and why."""
    if status is None:
        return "hang"
    if status < 0:
        return "signal"
    if "Traceback" in report or status not in (0, 2):
        return "traceback"
    output = path.with_suffix(".post.h5")
    left = [p for p in path.parent.iterdir() if ".parts" in p.name or ".tmp" in p.name]
    if left or status == 2 and output.exists():
        return "litter"
    if status == 2:
        reasons = [line for line in report.splitlines() if line.startswith(f"ehlpetsc.post: {path}: ")]
        return "refused" if reasons else "traceback"
    return "done"


def run(spoil, number, seed, pictures, keep, show):
    """Counts by outcome over `number` spoiled files."""
    counts = Counter(dict.fromkeys(("done", "refused", *BAD), 0))
    for k in range(number):
        with tempfile.TemporaryDirectory(dir=os.environ.get("TMPDIR")) as folder:
            path = Path(folder) / "run.h5"
            what = spoil(np.random.default_rng([seed, k]), k, path)
            options = ["--pictures", str(path.parent / "pictures")] if pictures and k % pictures == 0 else []
            words = [str(path), *options]
            status, report = process(
                lambda words=words: command.main(words, subprocess_guard.SubprocessGuard(command.say)),
                path.with_suffix(".report"),
                LIMIT,
            )
            word = outcome(status, report, path)
            counts[word] += 1
            counts["refused as HDF5 crashed"] += "HDF5 crashes" in report
            counts["refused as HDF5 hung"] += "does not return" in report
            if show or word in BAD:
                print(f"{k}: {what}: {word} {status}: {report.strip()[:2000]}", flush=True)
            if word in BAD and keep:
                Path(keep).mkdir(parents=True, exist_ok=True)
                path.rename(Path(keep) / f"{type(spoil).__name__}_{seed}_{k}.h5")
    return counts


def fuzz(flips, structures, seed, pictures=0, keep=None, show=False):
    """Counts by outcome of both kinds; `pictures`: every so manieth file is also drawn."""
    subprocess_guard.MAX_READ_SECONDS = READ_LIMIT
    with tempfile.TemporaryDirectory(dir=os.environ.get("TMPDIR")) as folder:
        base = Path(folder) / "run.h5"
        write_base(base)
        assert command.main([str(base)]) == 0  # and compiled, before processes are forked
        kinds = {"flips": (Flips(base), flips), "structures": (Structures(base), structures)}
    found = {}
    for name, kind in kinds.items():
        found[name] = run(*kind, seed, pictures, keep, show)
        print(f"{name}: " + ", ".join(f"{word} {count}" for word, count in found[name].items()), flush=True)
    return found


def main():
    """Print counts; returns the exit status."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--flips", type=int, default=2000)
    parser.add_argument("--structures", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--pictures", type=int, default=0, metavar="N", help="also draw every Nth file")
    parser.add_argument("--keep", metavar="FOLDER", help="keep the files of what must not be there")
    parser.add_argument("--show", action="store_true", help="a line a file")
    chosen = parser.parse_args()
    found = fuzz(**vars(chosen))
    return int(any(counts[word] for counts in found.values() for word in BAD))


if __name__ == "__main__":
    sys.exit(main())
