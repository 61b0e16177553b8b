"""Errors by nodes to the shortest wave.

``python3 tests/benchmarks/waves.py [ROW ...] [--nodes 6 8 12 16 32]``: small waves that move with the film or
past it, on a line and in the plane, and a pass of measured profiles in mixed contact with a layer. Prints
lines of `waves.csv`, the error of each row relative to its limit, extrapolated from both finest meshes by the
order of `ORDERS`, and then as comments the limit, the steps, iterations and processor times of the passes.
``--draw PICTURE`` draws `waves.csv`.
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

environment.need_solver()
import petsc4py

petsc4py.init(sys.argv[:1])
from support.waves import line_wave, mixed_pass, point_wave

from ehlpetsc.analysis.convergence import SPOT_ORDER, extrapolated
from ehlpetsc.pictures import style

FILE = Path(__file__).with_suffix(".csv")
NODES = 6, 8, 12, 16, 32
ORDERS = {"film": 2.0, "ripple": 2.0, "friction": SPOT_ORDER, "share": SPOT_ORDER, "damage": SPOT_ORDER}
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
    """Lines of `FILE`: the error of each quantity on each mesh; comments on its limit and on cost."""
    run, quantities = ROWS[name]
    found = [run(n) for n in nodes]
    rows = []
    for quantity in quantities:
        values = [getattr(one, quantity) for one in found]
        limit = extrapolated(nodes[-2:], values[-2:], ORDERS[quantity])
        rows += [
            f'"{name}: {quantity}",{n},{value / limit - 1.0:.4f}'
            for n, value in zip(nodes, values, strict=True)
        ]
        rows.append(f"# limit of {quantity}: {limit:.4g}")
    cost = [f"{one.steps} steps, {one.newton} iterations, {one.seconds:.1f} s" for one in found]
    return [*rows, f"# {'; '.join(cost)}"]


def stored() -> dict[str, dict[int, float]]:
    """Errors in `FILE` by row and nodes to the shortest wave."""
    errors: dict[str, dict[int, float]] = {}
    with FILE.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            errors.setdefault(row["row"], {})[int(row["nodes"])] = float(row["error"])
    return errors


PANELS = {"Waves of the film": "film", "Ripples of the pressure": "ripple", "Mixed contact with a layer": ""}


def draw(picture: str) -> None:
    """Draw the magnitude of all errors over the nodes, on logarithmic axes: a panel for each of `PANELS`."""
    figure, panels = style.new_figure(1, len(PANELS), (11.0, 5.0), sharey=True)
    for panel, (title, quantity) in zip(panels, PANELS.items(), strict=True):
        rows = {name: row for name, row in stored().items() if name.startswith("mixed") != bool(quantity)}
        shown = [name for name in rows if name.endswith(quantity)]
        for name, colour in zip(shown, style.shades(len(shown)), strict=True):
            nodes, errors = zip(*rows[name].items(), strict=True)
            label = (
                name.removesuffix(f": {quantity}")
                .removeprefix("mixed, layer: ")
                .replace("share", "load on the solids")
            )
            sizes = [100.0 * abs(error) for error in errors]
            panel.plot(nodes, sizes, "o-", color=colour, lw=1.2, ms=4, label=label)
        panel.set(xscale="log", yscale="log", xlabel="nodes to the shortest wave")
        panel.set_xticks(NODES, [str(n) for n in NODES])
        panel.minorticks_off()
        panel.grid(lw=0.3)
        panel.legend(
            loc="upper center",
            bbox_to_anchor=(0.5, -0.2),
            title=title,
            labelspacing=0.2,
            frameon=False,
            **style.SMALL,
        )
    panels[0].set_ylabel("error [%]")
    panels[0].yaxis.set_major_formatter("{x:g}")
    style.set_title(figure, "Errors by wavelength, slide/roll ratio, surface; magnitudes")
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
