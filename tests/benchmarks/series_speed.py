"""A series on two ranks against one: ``python3 tests/benchmarks/series_speed.py [TRAVEL [PAIRS]]``.

Ten viscosities of cases/fig4.toml, with the inlet nearer, on one rank and on two in turns, so that what else
the machine does falls on both. Two ratios, 2 being ideal: of wall clock times, which mean something on two
cores that are free; and of processor times, that of the one rank over that of the busier of two, which shows
what the dealing is worth on any machine.
"""

import os
import statistics
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve()
sys.path[:0] = [str(HERE.parents[2]), str(HERE.parents[1])]
from support import running

RANK = "--rank"  # first argument of this file where it stands for one rank of the program


def as_rank(arguments):
    """Run the program and note the processor time it took."""
    from ehlpetsc.__main__ import main as run_program
    from ehlpetsc.environment import prepare

    prepare()
    status = run_program(arguments)
    Path(f"cpu.{os.environ.get('OMPI_COMM_WORLD_RANK', '0')}").write_text(str(time.process_time()))
    return status


def times(ranks, travel):
    """Wall clock time of the series, and processor time of its busiest rank."""
    mesh = ["mesh.inlet=-1.5", "mesh.outlet=1.3", "mesh.points_per_half_width=100"]
    words = running.settings(*mesh, f"time.travel={travel}")
    with tempfile.TemporaryDirectory() as folder:
        begun = time.perf_counter()
        done = running.run(running.ROOT / "cases" / "fig4.toml", *words, cwd=folder, ranks=ranks)
        wall = time.perf_counter() - begun
        if done.returncode:
            sys.exit(done.stdout + done.stderr)
        return wall, max(float(file.read_text()) for file in Path(folder).glob("cpu.*"))


def main(travel="1.0", pairs="3"):
    running.TAMPERED = str(HERE)
    plain = running.command
    running.command = lambda *words, ranks, tampered: plain(*words, ranks=ranks, tampered=(RANK,))
    found = {1: [], 2: []}
    for number in range(2 * int(pairs)):
        ranks = 1 + number % 2
        found[ranks].append(times(ranks, travel))
        wall, processor = found[ranks][-1]
        print(f"{ranks} rank(s): {wall:.1f} s, processor {processor:.1f} s", flush=True)
    for name, one, two in zip(
        ("wall clock", "processor"), zip(*found[1], strict=True), zip(*found[2], strict=True), strict=True
    ):
        ratios = [a / b for a, b in zip(one, two, strict=True)]
        print(
            f"{name}: {statistics.median(one):.1f} s over {statistics.median(two):.1f} s, "
            f"ratio of the pairs {statistics.median(ratios):.2f} ({min(ratios):.2f} to {max(ratios):.2f})"
        )


if __name__ == "__main__":
    if sys.argv[1:2] == [RANK]:
        sys.exit(as_rank(sys.argv[2:]))
    main(*sys.argv[1:])
