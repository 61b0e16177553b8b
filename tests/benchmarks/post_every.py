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


def thin(source, target, every, start):
    """Copy of a result with every so manieth frame."""
    with h5py.File(source) as old, h5py.File(target, "w") as new:
        new.attrs.update(old.attrs)
        for name in ("x", "contact_count", "steps", "surface"):
            old.copy(name, new)
        for name in FRAMED:
            new[name] = old[name][start::every]


def processed(path, output):
    """Post-processing result of a file."""
    run(Job(str(path), str(output), depths=DEPTHS))
    return PostResult(output)


def pairs(whole, part, surface, depth):
    """Damage of each point that passed in both, shape (2, points): from all frames, from the thinned."""
    full = np.interp(part.s, whole.s, whole.damage[surface][depth])
    both = part.complete[surface] & np.isfinite(full)
    return np.stack([full[both], part.damage[surface][depth][both]])


def lost(full, kept):
    """Shares of the damage lost: of the median point, and of the mean."""
    return np.median(1 - kept / full), 1 - kept.mean() / full.mean()


def main(source):
    """Print the table."""
    with tempfile.TemporaryDirectory(dir=os.environ.get("TMPDIR")) as folder:
        whole = processed(source, Path(folder) / "1.post.h5")
        for every in (2, 4, 8):
            parts = []
            for start in (0, every // 2):
                path = Path(folder) / f"{every}_{start}.h5"
                thin(source, path, every, start)
                parts.append(processed(path, f"{path}.post"))
                path.unlink()
            for k, depth in enumerate(DEPTHS):
                found = [[pairs(whole, part, name, k) for name in whole.surfaces] for part in parts]
                for j, name in enumerate(whole.surfaces):
                    show(every, f"{name} surface", depth, [lost(*of_part[j]) for of_part in found])
                show(every, "both surfaces", depth, [lost(*np.concatenate(each, axis=1)) for each in found])


def show(every, what, depth, losses):
    """Print a line: the mean over the two ways to thin."""
    point, mean = 100 * np.mean(losses, axis=0)
    place = f"every {every}, {what}, z/a = {depth:<4g}"
    print(f"{place}: {point:5.1f} % of a point's damage, {mean:5.1f} % of the mean")


if __name__ == "__main__":
    main(sys.argv[1])
