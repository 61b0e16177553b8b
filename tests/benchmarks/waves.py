"""Errors by nodes to the shortest wave.

``python3 tests/benchmarks/waves.py [ROW ...] [--nodes 6 8 12 16 32]``: small waves that move with the film or
past it, on a line and in the plane, and a pass of measured profiles in mixed contact with a layer. Prints
lines of `waves.csv`, the error of each row relative to its value on the finest mesh, and then as comments
that value, the steps, iterations and processor times of the passes. ``--draw PICTURE`` draws `waves.csv`.
"""

from __future__ import annotations

import argparse
import csv
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

from ehlpetsc.pictures import style

FILE = Path(__file__).with_suffix(".csv")
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


def lines(name: str, nodes: list[int]) -> list[str]:
    """Lines of `FILE`: the error of each quantity on each mesh but the finest; comments on cost."""
    run, quantities = ROWS[name]
    found = [run(n) for n in nodes]
    rows = []
    for quantity in quantities:
        *values, finest = (getattr(one, quantity) for one in found)
        errors = [f"{value / finest - 1.0:.4f}" for value in values]
        rows += [f'"{name}: {quantity}",{n},{error}' for n, error in zip(nodes, errors, strict=False)]
        rows.append(f"# {quantity} on {nodes[-1]} nodes: {finest:.4g}")
    cost = [f"{one.steps} steps, {one.newton} iterations, {one.seconds:.1f} s" for one in found]
    return [*rows, f"# {'; '.join(cost)}"]


def stored() -> dict[str, dict[int, float]]:
    """Errors in `FILE` by row and nodes to the shortest wave."""
    errors: dict[str, dict[int, float]] = {}
    with FILE.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            errors.setdefault(row["row"], {})[int(row["nodes"])] = float(row["error"])
    return errors


def draw(picture: str) -> None:
    """Draw the magnitude of all errors over the nodes, on logarithmic axes."""
    figure, panel = style.new_figure(1, 1, (8.0, 4.2))
    waves, mixed = ([name for name in stored() if name.startswith("mixed") == kind] for kind in (False, True))
    for names, line in ((waves, "o-"), (mixed, "s--")):
        for name, colour in zip(names, style.shades(len(names)), strict=True):
            nodes, errors = zip(*stored()[name].items(), strict=True)
            sizes = [100.0 * abs(error) for error in errors]
            label = name.replace("share", "load on the solids")
            panel.plot(nodes, sizes, line, color=colour, lw=1.2, ms=4, label=label)
    panel.set(xscale="log", yscale="log", xlabel="nodes to the shortest wave", ylabel="error [%]")
    panel.set_xticks(NODES, [str(n) for n in NODES])
    panel.minorticks_off()
    panel.yaxis.set_major_formatter("{x:g}")
    panel.grid(lw=0.3)
    style.legend_beside(panel, title="wavelength, slide/roll ratio: quantity")
    style.set_title(
        figure, "Waves of film and pressure in full films (circles), mixed contact with a layer (squares)"
    )
    style.save(figure, picture)


def main() -> None:
    """Run the command."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("rows", nargs="*", default=list(ROWS), help="; ".join(ROWS))
    parser.add_argument("--nodes", nargs="+", type=int, default=NODES, help="to the wave")
    parser.add_argument("--draw", metavar="PICTURE", help="of the stored errors")
    chosen = parser.parse_args()
    if chosen.draw:
        draw(chosen.draw)
        return
    print("row,nodes,error")
    for name in chosen.rows:
        if name not in ROWS:
            parser.error(f"no row {name!r}; there are: {'; '.join(ROWS)}")
        print("\n".join(lines(name, sorted(chosen.nodes))), flush=True)


if __name__ == "__main__":
    main()
