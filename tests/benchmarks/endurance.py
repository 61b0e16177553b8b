"""A long run: ``python3 tests/benchmarks/endurance.py [STEPS]``, 100,000 steps by default.

A wave on one surface passes a coarse contact in pure rolling, a whole number of steps a period. Printed:
memory after 1,000 steps and its maximum later, and the drift of load and oil content at equal phases.
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

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


def command(steps, path):
    wave = f'{{ kind = "sine", amplitude = 0.03e-6, wavelength = {Scales.of(load(CASE)).a!r} }}'
    keys = [f"mesh.points_per_half_width={POINTS}", f"time.courant={COURANT}", f"surface.2.synthetic={wave}"]
    keys += ["motion.slide_roll_ratio=0.0", "mesh.inlet=-1.5", "mesh.near_field=5"]
    keys += [f"time.travel={steps * COURANT / POINTS}", 'output.fields=["pressure", "film_thickness"]']
    keys += [f"output.every={max(steps // (20 * PERIOD), 1) * PERIOD}"]
    sets = [word for key in keys for word in ("--set", key)]
    return [sys.executable, "-m", "ehlpetsc", CASE, "--output", path, *sets]


def steps_done(path):
    try:
        with read_result(path) as result:
            return len(result.steps("dt"))
    except (OutputError, OSError):
        return 0


def memory(process):
    """Resident memory [MB], 0 where the process has ended."""
    try:
        lines = Path(f"/proc/{process.pid}/status").read_text().splitlines()
    except OSError:
        return 0.0
    return next((int(line.split()[1]) / 1024 for line in lines if line.startswith("VmRSS")), 0.0)


def main(steps=100_000):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "run.h5"
        environment = os.environ | {"OMP_NUM_THREADS": "1"}
        process = subprocess.Popen(command(steps, path), cwd=ROOT, env=environment, stdout=subprocess.DEVNULL)
        first, highest = 0.0, 0.0
        while process.poll() is None:
            time.sleep(1.0 if not first else 5.0)
            now = memory(process)
            first = first or (now if steps_done(path) >= 1000 else 0.0)
            highest = max(highest, now)
        print(f"exit {process.returncode}; memory after 1,000 steps {first:.1f} MB, maximum {highest:.1f} MB")
        with read_result(path) as result:
            report(result)


def report(result):
    """Steps, and drift of load and oil content."""
    steps = {name: result.steps(name) for name in ("newton", "retries", "wall", "load_error", "mass_error")}
    count = len(steps["newton"]) - 1
    newton, wall = steps["newton"].sum() / count, 1e3 * steps["wall"].sum() / count
    print(
        f"{count} steps of {newton:.2f} Newton iterations and {wall:.2f} ms, {steps['retries'].sum()} halved"
    )
    for name in ("load_error", "mass_error"):
        late = steps[name][-count // 10 :]
        print(f"{name}: maximum {steps[name].max():.1e}, of the last tenth {late.max():.1e}")
    # from the second frame on: in the first the wave has not yet been everywhere
    content = np.array([result.frame("film_thickness", k).sum() for k in range(2, len(result.time))])
    change = content / content[0] - 1.0
    print(f"oil content at equal phases: within {np.abs(change).max():.1e}, at the end {change[-1]:.1e}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:2]))
