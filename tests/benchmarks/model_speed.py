"""Mixed contact beside direct contact: ``python3 tests/benchmarks/model_speed.py [--pairs N]``.

cases/table1_rough.toml whole (a/200, one rank) in both models in turns; processor time of each run, start
included, Newton's iterations a step, and the time of mixed contact over that of direct contact pair by pair.
"""

import argparse
import statistics
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from ehlpetsc.study.runs import run

MODELS = ("direct", "mixed")


def pair(folder):
    """Processor time [s] of both models; a line each."""
    times = []
    for model in MODELS:
        overrides = (f"contact.model={model}", "output.every=100")
        done = run(ROOT / "cases" / "table1_rough.toml", overrides, folder=folder)
        if done.status:
            raise SystemExit(f"{model}: exit {done.status}: {done.message}")
        times.append(done.processor)
        print(
            f"{model:>6}: {done.processor:6.1f} s, {done.newton / done.steps:.2f} iterations a step",
            flush=True,
        )
    return times


def main():
    """Run the pairs; print the median of their proportions."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--pairs", type=int, default=3, help="default: 3")
    with tempfile.TemporaryDirectory() as folder:
        pairs = [pair(folder) for _ in range(parser.parse_args().pairs)]
    found = sorted(mixed / direct for direct, mixed in pairs)
    print(f"mixed over direct: {statistics.median(found):.2f} ({found[0]:.2f} to {found[-1]:.2f})")


if __name__ == "__main__":
    main()
