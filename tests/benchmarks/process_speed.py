"""Whole processes: ``python3 tests/benchmarks/process_speed.py``.

5. the smooth steady case at a/200: CPU time after imports, and memory;
6. a rough run with and without stored fields, CPU time, in turns;
"""

import os
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
ROOT = Path(__file__).resolve().parents[2]
ROUGH = ("fluid.viscosity=0.01", "surface.1.scale=0.2", "surface.2.scale=0.2", "mesh.inlet=-1.5")
PYTHON = [sys.executable, "-m", "ehlpetsc"]


def usage(words, folder):
    """Output, CPU seconds and largest memory [MB] of a process."""
    with open(Path(folder) / "words.txt", "w+") as stream:
        process = subprocess.Popen(words, cwd=ROOT, stdout=stream, stderr=subprocess.STDOUT)
        _, status, used = os.wait4(process.pid, 0)
        stream.seek(0)
        text = stream.read()
    assert status == 0, text
    return text, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024


def case(name, folder, *overrides):
    words = [f"cases/{name}.toml", "--output", str(Path(folder) / "run.h5")]
    for override in overrides:
        words += ["--set", override]
    return words


def steady(folder, repeats=5):
    """Figure 5."""
    bare = [
        sys.executable,
        "-c",
        "from ehlpetsc import environment; environment.prepare(); import petsc4py; petsc4py.init(); "
        "import ehlpetsc.run.simulation",
    ]
    imports, whole = [], []
    for _ in range(repeats):
        imports.append(usage(bare, folder)[1])
        whole.append(usage([*PYTHON, *case("table1_smooth", folder)], folder))
    seconds = statistics.median(w[1] for w in whole)
    before = statistics.median(imports)
    print(
        f"5. smooth steady at a/200: CPU {seconds:.2f} s, {seconds - before:.2f} s of it after imports, "
        f"{max(w[2] for w in whole):.0f} MB",
        flush=True,
    )


def output(folder, repeats=5):
    """Figure 6: all fields of every step against one field of none."""
    run = (*ROUGH, "time.travel=1.0")
    off = ("output.every=1000000", 'output.fields=["pressure"]')
    times = {True: [], False: []}
    for _ in range(repeats):
        for on in times:
            words = [*PYTHON, *case("table1_rough", folder, *run, *(() if on else off))]
            times[on].append(usage(words, folder)[1])
    on, without = (statistics.median(times[key]) for key in (True, False))
    print(
        f"6. fields of every step stored {on:.2f} s CPU, none {without:.2f} s: "
        f"{100 * (on / without - 1):.1f} % more",
        flush=True,
    )


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as scratch:
        steady(scratch)
        output(scratch)
