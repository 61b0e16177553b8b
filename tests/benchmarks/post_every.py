"""Damage lost by storing every 2nd, 4th, 8th step: ``python3 tests/benchmarks/post_every.py RESULT.h5``.

RESULT.h5 is stored with every = 1; its frames are thinned, each way from two first frames. Prints per surface
and depth the median over the points of the share lost, and the share of the mean damage, in the end of both
surfaces together; those of cases/table1_damage.toml are in the page of post.
"""

import os
import sys
import tempfile
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
import h5py
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from ehlpetsc.post.run import Job, run
from ehlpetsc.results.post_result import PostResult

DEPTHS = (0.0, 0.01, 0.03, 0.1, 0.5)
FRAMED = ("time", "step", "pressure", "shear_stress_2", "shear_stress_1")


def processed(source, folder, every, start):
    """Post-processing result of every so manieth frame."""
    path = Path(folder) / "thinned.h5"
    with h5py.File(source) as old, h5py.File(path, "w") as new:
        new.attrs.update(old.attrs)
        for name in ("x", "contact_count", "steps", "surface"):
            old.copy(name, new)
        for name in FRAMED:
            new[name] = old[name][start::every]
    output = Path(folder) / f"{every}_{start}.post.h5"
    run(Job(str(path), str(output), depths=DEPTHS))
    return PostResult(output)


def pairs(whole, part, surface, depth):
    """Damage of each point that passed in both, shape (2, points): from all frames, from the thinned."""
    full = np.interp(part.s, whole.s, whole.damage[surface][depth])
    both = part.complete[surface] & np.isfinite(full)
    return np.stack([full[both], part.damage[surface][depth][both]])


def lost(full, kept):
    """Shares of the damage lost [%]: of the median point, and of the mean."""
    return 100 * np.median(1 - kept / full), 100 * (1 - kept.mean() / full.mean())


def main(source, folder):
    """Print the table; each share is the mean over the two first frames."""
    whole = processed(source, folder, 1, 0)
    for every in (2, 4, 8):
        parts = [processed(source, folder, every, start) for start in (0, every // 2)]
        for k, depth in enumerate(DEPTHS):
            found = {name: [pairs(whole, part, name, k) for part in parts] for name in whole.surfaces}
            found["both"] = [np.concatenate(each, axis=1) for each in zip(*found.values(), strict=True)]
            for name, of_parts in found.items():
                point, mean = np.mean([lost(*each) for each in of_parts], axis=0)
                place = f"every {every}, surface {name}, z/a = {depth:<4g}"
                print(f"{place}: {point:5.1f} % of a point's damage, {mean:5.1f} % of the mean")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory(dir=os.environ.get("TMPDIR")) as folder:
        main(sys.argv[1], folder)
