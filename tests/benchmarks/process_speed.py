"""Whole processes: ``python3 tests/benchmarks/process_speed.py``, medians of runs in turns.

Processor time after imports, and memory, of the smooth steady case at a/200; processor time of a rough run
that stores all fields of every step beside that of one that stores none.
"""

import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
IMPORTS = ["-c", "import ehlpetsc; ehlpetsc.Simulation"]
STEADY = ["-m", "ehlpetsc", "cases/table1_smooth.toml"]
KEYS = "fluid.viscosity=0.01 surface.1.scale=0.2 surface.2.scale=0.2 mesh.inlet=-1.5 time.travel=1.0"
ROUGH = ["-m", "ehlpetsc", "cases/table1_rough.toml", *f" {KEYS}".replace(" ", " --set ").split()]
WITHOUT = [*ROUGH, "--set", "output.every=1000000", "--set", 'output.fields=["pressure"]']


def usage(words, output):
    """Processor time [s] and maximum memory [MB] of a process."""
    command = [sys.executable, *words, *(["--overwrite", "-o", output] if words is not IMPORTS else [])]
    environment = os.environ | {"OMP_NUM_THREADS": "1"}
    process = subprocess.Popen(command, cwd=ROOT, env=environment, stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    assert status == 0, words
    return used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


def main(more=(), repeats=5):
    """Measure and print; `more`: words of every run."""
    cases = (IMPORTS, *([*words, *more] for words in (STEADY, ROUGH, WITHOUT)))
    with tempfile.TemporaryDirectory() as folder:
        output = str(Path(folder) / "run.h5")
        runs = [[usage(words, output) for words in cases] for _ in range(repeats)]
    imports, steady, stored, without = (statistics.median(run[k][0] for run in runs) for k in range(4))
    memory, longer = max(run[1][1] for run in runs), 100 * (stored / without - 1)
    print(f"smooth steady, a/200: {steady - imports:.2f} s after {imports:.2f} s of imports, {memory:.0f} MB")
    print(f"rough, fields of every step {stored:.2f} s, none {without:.2f} s: {longer:.1f} % more")


if __name__ == "__main__":
    main()
