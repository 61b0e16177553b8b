"""Speed of post-processing, as ratios to the plain ways: ``python3 tests/benchmarks/post_speed.py [--full]``.

Ratios: FFT stress against direct summation of the same kernels, rainflow with damage against the pure-Python
`rainflow` of PyPI (counting alone; left out where it is not installed). ``--full`` adds a run from a result
file of 0.8 GB: 20,000 body points (4 depths x 5,000) of 6,000 samples each, counted three ways (max3), on one
thread and two.
"""

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests")]
from support.made_loads import Scene, write

from ehlpetsc.post import Material
from ehlpetsc.post.fatigue.accumulate import Counter, Counting
from ehlpetsc.post.stresses.half_plane import StressField, hat


def best(call, repeats=5):
    """Least processor time of a call, s: other work on the machine does not count."""
    times = []
    for _ in range(repeats):
        start = time.process_time()
        call()
        times.append(time.process_time() - start)
    return min(times)


def direct(p, q, kernels, n):
    """Direct summation at every node of one depth: kernels (4, 2n - 1), Toeplitz rows."""
    rows = np.lib.stride_tricks.sliding_window_view(kernels[:, ::-1], n, axis=1)[:, ::-1]
    a, b, c, e = rows
    return c @ p + e @ q, a @ p + b @ q, b @ p + c @ q


def stress_speed(nx=1600, nz=50):
    x = np.linspace(-2.5, 1.5, nx)
    p = np.sqrt(np.clip(1 - x * x, 0, None))
    z = np.linspace(0, 1, nz)
    field = StressField(nx, x[1] - x[0], z)
    fast = best(lambda: field(p, 0.1 * p), 20)
    kernels = -2 / np.pi * hat(np.arange(-(nx - 1), nx), z[10] / (x[1] - x[0]))
    slow = best(lambda: direct(p, 0.1 * p, kernels, nx), 3) * nz
    difference = np.abs(np.stack(direct(p, 0.1 * p, kernels, nx)) - np.stack(field(p, 0.1 * p))[:, 10]).max()
    print(
        f"stress {nx} x {nz} x 3: FFT {fast * 1e3:.2f} ms, direct {slow * 1e3:.0f} ms, "
        f"ratio {slow / fast:.0f}, difference {difference:.1e}"
    )


def histories(points, samples):
    """Hertz passes with three ripples of random phase."""
    rng = np.random.default_rng(0)
    t = np.arange(samples)
    base = -1e9 * np.sqrt(np.clip(1 - ((t - samples / 2) / (samples / 3)) ** 2, 0, None))
    phases = rng.uniform(0, 2 * np.pi, (3, points, 1))
    waves = zip((0.3, 0.1, 0.3), (30, 7, 110), phases, strict=True)
    ripple = sum(size * np.sin(t / length + phase) for size, length, phase in waves)
    parts = base * (1 + 0.7 * ripple), base * (1 + ripple), -0.3 * base * ripple
    return np.stack(parts, axis=1).astype(np.float32)


def counting_speed(points=2000, samples=6000):
    stress, lengths, out = histories(points, samples), np.full(points, samples), np.empty((points, 3))
    rates = {}
    for count in ("sz", "max3"):
        counter = Counter(Material(), Counting(count), samples)
        rates[count] = points * samples / best(lambda c=counter: c(stress, lengths, out)) / 1e6
        print(f"rainflow, component ranges and damage, {count}: {rates[count]:.0f} million samples a second")
    try:
        from rainflow import extract_cycles
    except ImportError:
        print("ratio to PyPI rainflow: not installed")
        return
    few = stress[:10, 1].astype(float).tolist()
    plain = 10 * samples / best(lambda: [list(extract_cycles(row)) for row in few], 2) / 1e6
    print(f"PyPI rainflow, counting alone: {plain:.2f} million a second, ratio {rates['sz'] / plain:.0f}")


def run_speed(path):
    """Wall and processor time of the command on one thread and on two, in turns."""
    scene = Scene(per_width=400, ratio=0.6087, steps=24800)
    write(path, scene, depths=(0.0, 0.01, 0.05, 0.5))
    print(f"file: {path.stat().st_size / 1e6:.0f} MB, {scene.time.size} frames of {scene.x.size} nodes")
    command = [sys.executable, "-m", "ehlpetsc", "post", path, "--surface", "2", "--overwrite", "--jobs"]
    times = {1: [], 2: []}  # wall, processor
    for jobs in (1, 2) * 5:
        before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
        subprocess.run([*command, str(jobs)], check=True, capture_output=True, cwd=ROOT)
        wall, after = time.perf_counter() - start, resource.getrusage(resource.RUSAGE_CHILDREN)
        work = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        times[jobs].append((wall, work))
        peak = after.ru_maxrss / 1e6
        print(f"--jobs {jobs}: {wall:.1f} s, processor {work:.1f} s, memory up to {peak:.2f} GB", flush=True)
    pairs = ", ".join(f"{one[0] / two[0]:.2f}" for one, two in zip(times[1], times[2], strict=True))
    one, two = (np.median(times[jobs], axis=0) for jobs in (1, 2))
    print(
        f"speed-up of two threads over one, pair by pair: {pairs}; one had {100 * one[1] / one[0]:.0f} % of a"
    )
    print(f"processor; processor time of two over one: {two[1] / one[1]:.2f} (1: nothing lost)")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--full", action="store_true")
    chosen = parser.parse_args()
    stress_speed()
    counting_speed()
    if chosen.full:
        with tempfile.TemporaryDirectory(dir=os.environ.get("TMPDIR")) as folder:
            run_speed(Path(folder) / "speed.h5")
