"""Errors by nodes to the shortest wave.

``python3 tests/benchmarks/waves.py [ROW ...] [--nodes 6 8 12 16 32]``: small waves that move with the film or
past it, on a line and in the plane, and a pass of measured profiles in mixed contact with a layer. Each row
is relative to its value on the finest mesh, which is printed beside it; times are processor times of a pass.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(ROOT / "tests")]
from ehlpetsc.base import environment

environment.prepare()
import petsc4py

petsc4py.init(sys.argv[:1])
from support.waves import line_wave, mixed_pass, point_wave

NODES = 6, 8, 12, 16, 32
SHORTEST = 13.4  # a over the shortest wave of the profiles
ROWS: dict[str, tuple[Callable, tuple[str, ...]]] = {  # by name: run on so many nodes a wave, what is printed
    "line, a/4, rolling": (lambda n: line_wave(0.25, n), ("film",)),
    "line, a/4, rolling, half a node a step": (lambda n: line_wave(0.25, n, courant=0.5), ("film",)),
    "line, a/2, rolling": (lambda n: line_wave(0.5, n), ("film",)),
    "point, a/2, rolling": (lambda n: point_wave(0.5, n), ("film",)),
    "line, a/8, slide/roll 0.5, faster": (lambda n: line_wave(0.125, n, 0.5, 1), ("film", "ripple")),
    "line, a/8, slide/roll 0.5, slower": (lambda n: line_wave(0.125, n, 0.5, 2), ("film", "ripple")),
    "line, a/8, slide/roll 1.9, faster": (lambda n: line_wave(0.125, n, 1.9, 1), ("film", "ripple")),
    "line, a/8, slide/roll 4, faster": (lambda n: line_wave(0.125, n, 4.0, 1), ("film", "ripple")),
    "point, a/2, slide/roll 0.5, faster": (lambda n: point_wave(0.5, n, 0.5, 1), ("film", "ripple")),
    "point, a/2, slide/roll 0.5, slower": (lambda n: point_wave(0.5, n, 0.5, 2), ("film", "ripple")),
    "mixed, layer": (
        lambda n: mixed_pass(round(SHORTEST * n), damage=True),
        ("friction", "share", "damage"),
    ),
}


def table(name: str, nodes: list[int]) -> list[str]:
    """Rows of Markdown: each quantity on each mesh, then the time and the iterations of a pass."""
    run, quantities = ROWS[name]
    found = [run(n) for n in nodes]
    rows = []
    for quantity in quantities:
        values = [getattr(one, quantity) for one in found]
        errors = " | ".join(f"{100.0 * (value / values[-1] - 1.0):+.1f} %" for value in values[:-1])
        rows.append(f"| {name}: {quantity} | {errors} | {values[-1]:.4g} |")
    cost = " | ".join(f"{one.steps} steps, {one.newton} iterations, {one.seconds:.1f} s" for one in found)
    return [*rows, f"| cost | {cost} |"]


def main() -> None:
    """Run the command."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("rows", nargs="*", default=list(ROWS), help="; ".join(ROWS))
    parser.add_argument("--nodes", nargs="+", type=int, default=NODES, help="to the wave")
    chosen = parser.parse_args()
    print(f"| nodes | {' | '.join(map(str, chosen.nodes))} |")
    print("|---" * (len(chosen.nodes) + 1) + "|")
    for name in chosen.rows:
        if name not in ROWS:
            parser.error(f"no row {name!r}; there are: {'; '.join(ROWS)}")
        print("\n".join(table(name, sorted(chosen.nodes))), flush=True)


if __name__ == "__main__":
    main()
