"""A series on two ranks against one: ``python3 tests/benchmarks/series_speed.py [TRAVEL]``.

Ten viscosities of cases/fig4.toml, with the inlet nearer, on one rank and on two in turns, so that what else
the machine does falls on both; prints wall clock times and their ratio (2 would be ideal).
"""
import statistics
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve()
sys.path[:0] = [str(HERE.parents[2]), str(HERE.parents[1] / "regression")]
from running import ROOT, run, settings  # noqa: E402

PAIRS = 3


def seconds(ranks, travel):
    """Wall clock time of the series."""
    mesh = ["mesh.inlet=-1.5", "mesh.outlet=1.3", "mesh.points_per_half_width=100"]
    words = settings(*mesh, f"time.travel={travel}")
    with tempfile.TemporaryDirectory() as folder:
        begun = time.perf_counter()
        done = run(ROOT / "cases" / "fig4.toml", *words, cwd=folder, ranks=ranks)
        if done.returncode:
            sys.exit(done.stdout + done.stderr)
        return time.perf_counter() - begun


def main(travel="1.0"):
    times = {1: [], 2: []}
    for number in range(2 * PAIRS):
        ranks = 1 + number % 2
        times[ranks].append(seconds(ranks, travel))
        print(f"{ranks} rank(s): {times[ranks][-1]:.1f} s", flush=True)
    one, two = (statistics.median(times[ranks]) for ranks in (1, 2))
    ratios = [a / b for a, b in zip(times[1], times[2], strict=True)]
    print(f"medians {one:.1f} s and {two:.1f} s: ratio {one / two:.2f}; "
          f"of the pairs {min(ratios):.2f} to {max(ratios):.2f}")


if __name__ == "__main__":
    main(*sys.argv[1:])
