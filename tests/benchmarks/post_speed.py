"""Post-processing of a rough strip: ``python3 tests/benchmarks/post_speed.py``.

Processor time, after compilation, of both criteria at 12 depths of 129 x 129 nodes and 300 frames, in which
29,000 points pass; counts of histories and of those whose planes are sought.
"""

import sys
import tempfile
import time
from pathlib import Path
from unittest import mock

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests")]
from support.made_loads import Scene
from support.made_planes import write_plane

from ehlpetsc.post.criteria import critical_plane
from ehlpetsc.post.run import Job, run
from ehlpetsc.results.post_result import PostResult

DEPTHS = 0.0, 0.01, 0.02, 0.03, 0.05, 0.1, 0.15, 0.2, 0.3, 0.5, 0.7, 1.0
WAVES, HEIGHT, RIPPLE = 60, 0.12e-6, 3e6  # of both surfaces: number, rms [m]; pressure over height [1/m]


def heights(seed, x, y, dx):
    """Isotropic waves of some 16 nodes (ny, nx), periodic across."""
    random = np.random.default_rng(seed)
    along = random.normal(size=WAVES) * np.pi / (4 * dx)
    across = np.rint(random.normal(size=WAVES) * y.size / 8) * 2 * np.pi / (y.size * dx)
    phases = along[:, None] * x + random.uniform(0, 2 * np.pi, WAVES)[:, None]
    z = np.cos(across * y[:, None]) @ np.cos(phases) - np.sin(across * y[:, None]) @ np.sin(phases)
    return HEIGHT * z / np.sqrt(WAVES / 2)


def made(path, frames, depths, points=32):
    """Result file of a strip of 4 `points` + 1 nodes along and across."""
    scene = Scene(per_width=points, ratio=0.5, steps=frames, courant=1.0)
    y, pressure = scene.dx * np.arange(scene.x.size), np.empty((frames, scene.x.size, scene.x.size))
    for k, now in enumerate(scene.time):
        moved = enumerate((scene.u1, scene.u2), 1)
        height = sum(heights(seed, scene.x - u * now, y, scene.dx) for seed, u in moved)
        pressure[k] = np.clip(scene.hertz * (1 + RIPPLE * height), 0, None)
    s = scene.profiles["1"][0]
    maps = {str(seed): heights(seed, s, y, scene.dx) for seed in (1, 2)}
    return str(write_plane(path, scene, "strip", y, pressure, maps, depths=depths))


def post(path):
    """Processor time [s]."""
    begun = time.process_time()
    run(Job(path, path.replace(".h5", ".post.h5"), criteria=("dang-van", "fatemi-socie")))
    return time.process_time() - begun


def main(points=32, frames=300, depths=DEPTHS):
    """Measure and print."""
    sought, search = [], critical_plane._worst_planes

    def counted(grid, law, work, stress, *others):
        """Search that counts the histories."""
        sought.append(len(stress))
        search(grid, law, work, stress, *others)

    with tempfile.TemporaryDirectory() as folder:
        post(made(Path(folder) / "small.h5", (frames * 10) // 13, depths[-1:], points))  # compiles
        path = made(Path(folder) / "strip.h5", frames, depths, points)
        with mock.patch.object(critical_plane, "_worst_planes", counted):
            seconds = post(path)
        result = PostResult(path.replace(".h5", ".post.h5"))
    passed = sum(passed.sum() for passed in result.complete.values()) * result.y.size
    counts = f"{passed} points, {passed * len(depths)} histories, planes sought in {sum(sought)}"
    print(f"{counts}: {seconds:.1f} s of processor time")


if __name__ == "__main__":
    main()
