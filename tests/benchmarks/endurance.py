"""A long run: ``python3 tests/benchmarks/endurance.py [STEPS]``, 100,000 steps by default.

A wave on one surface passes a coarse contact in pure rolling, a whole number of steps a period. Memory of the
process is read as it runs; load and oil content are compared at equal phases. Printed: memory after 1,000
steps and its greatest value later, and how far load and oil content move.
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))
import numpy as np

from ehlpetsc.base.errors import OutputError
from ehlpetsc.case.loading import load
from ehlpetsc.physics.scales import Scales
from ehlpetsc.results.reader import read_result

POINTS, COURANT = 20, 0.5
PERIOD = round(POINTS / COURANT)  # steps in which the wave moves by its length a
CASE = ROOT / "cases" / "ridge.toml"


def overrides(steps):
    a = Scales.of(load(CASE)).a
    frames = max(steps // (20 * PERIOD), 1) * PERIOD
    wave = f'{{ kind = "sine", amplitude = 0.03e-6, wavelength = {a!r} }}'
    return [
        f"surface.2.synthetic={wave}",
        "motion.slide_roll_ratio=0.0",
        "mesh.inlet=-1.5",
        f"mesh.points_per_half_width={POINTS}",
        "mesh.near_field=5",
        f"time.courant={COURANT}",
        f"time.travel={steps * COURANT / POINTS}",
        f"output.every={frames}",
        'output.fields=["pressure", "film_thickness"]',
    ]


def steps_done(path):
    try:
        with read_result(path) as result:
            return len(result.steps("dt"))
    except (OutputError, OSError):
        return 0


def memory(process):
    """Resident memory [MB], 0 where the process has ended."""
    try:
        text = Path(f"/proc/{process.pid}/status").read_text()
    except OSError:
        return 0.0
    return next((int(line.split()[1]) / 1024 for line in text.splitlines() if line.startswith("VmRSS")), 0.0)


def main(steps=100_000):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.h5"
        words = [sys.executable, "-m", "ehlpetsc", str(CASE), "--output", str(path)]
        for override in overrides(steps):
            words += ["--set", override]
        process = subprocess.Popen(words, cwd=ROOT, stdout=subprocess.DEVNULL)
        first, greatest = 0.0, 0.0
        while process.poll() is None:
            time.sleep(1.0 if not first else 5.0)
            now = memory(process)
            if not first and steps_done(path) >= 1000:
                first = now
            greatest = max(greatest, now)
        print(
            f"exit {process.returncode}; memory after 1,000 steps {first:.1f} MB, greatest {greatest:.1f} MB"
        )
        with read_result(path) as result:
            report(result)


def report(result):
    """Steps, and drift of load and oil content."""
    steps = {name: result.steps(name) for name in ("newton", "retries", "wall", "load_error", "mass_error")}
    count = len(steps["newton"]) - 1
    print(
        f"{count} steps, {steps['newton'].sum() / count:.2f} Newton iterations a step, "
        f"{steps['retries'].sum()} halved, {1e3 * steps['wall'].sum() / count:.2f} ms a step"
    )
    for name in ("load_error", "mass_error"):
        late = steps[name][-count // 10 :]
        print(f"{name}: greatest {steps[name].max():.1e}, of the last tenth {late.max():.1e}")
    # from the second frame on: in the first the wave has not yet been everywhere
    content = np.array([result.frame("film_thickness", k).sum() for k in range(2, len(result.time))])
    change = content / content[0] - 1.0
    print(f"oil content at equal phases: within {np.abs(change).max():.1e}, at the end {change[-1]:.1e}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:2]))
