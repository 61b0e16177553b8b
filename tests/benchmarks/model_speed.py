"""Mixed contact beside direct contact: ``python3 tests/benchmarks/model_speed.py [--pairs N]``.

cases/table1_rough.toml whole (a/200, one rank) in both models in turns: processor time of each run, Newton
iterations per step, and the time of mixed contact over that of direct contact, pair by pair.
"""

import argparse
import statistics
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

import ehlpetsc


def seconds(model: str) -> float:
    """Processor time [s] of a run, printed with its Newton iterations per step."""
    case = ehlpetsc.load(ROOT / "cases" / "table1_rough.toml", [f"contact.model={model}", "output.every=100"])
    begun = time.process_time()
    result = ehlpetsc.solve(case, progress=False)
    used = time.process_time() - begun
    print(f"{model:>6}: {used:6.1f} s, {result.steps('newton').mean():.2f} iterations per step", flush=True)
    return used


def main() -> None:
    """Run the pairs; print the median of their ratios."""
    parser = argparse.ArgumentParser(description=__doc__.partition(":")[0])
    parser.add_argument("--pairs", type=int, default=3, help="default: 3")
    pairs = [(seconds("direct"), seconds("mixed")) for _ in range(parser.parse_args().pairs)]
    ratios = sorted(mixed / direct for direct, mixed in pairs)
    print(f"mixed over direct: {statistics.median(ratios):.2f} ({ratios[0]:.2f} to {ratios[-1]:.2f})")


if __name__ == "__main__":
    main()
