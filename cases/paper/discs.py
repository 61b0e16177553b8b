"""Friction of twin discs beside measurements: table on two meshes and picture.

``./run_mpi.sh python cases/paper/discs.py [-o PICTURE]`` computes `cases/discs.toml` with the oils and
    speeds of
`MEASURED` on a/30 and a/60, prints measured and computed friction with their ratio, and draws them over the
slide/roll ratio.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from ehlpetsc.case.loading import load
from ehlpetsc.pictures import style
from ehlpetsc.run.simulation import Simulation

CASE = Path(__file__).parents[1] / "discs.toml"
RATIOS = (0.01, 0.03, 0.1, 0.3)
DENSE = np.geomspace(0.003, 0.4, 15)  # of the curves
SHIFTS = (0.95, 1.0, 1.05)  # of measured points, so that their bars do not overlap
MESHES = (30, 60)  # nodes per half-width
BAND = 0.005  # of the measured coefficients
PANELS = {"FVA 3": ("m100",), "at 4 m/s": ("m100", "n100", "pao100")}
NAMES = {"m100": "FVA 3, mineral", "n100": "N100, naphthenic", "pao100": "PAO100"}


class Curve(NamedTuple):
    """Friction coefficients of an oil at a mean speed [m/s] over `RATIOS`."""

    oil: str
    speed: float
    friction: tuple[float, float, float, float]


MEASURED = (
    Curve("m100", 1.0, (0.0273, 0.0368, 0.0458, 0.0470)),
    Curve("m100", 4.0, (0.0314, 0.0394, 0.0436, 0.0391)),
    Curve("m100", 8.0, (0.0338, 0.0394, 0.0378, 0.0280)),
    Curve("n100", 4.0, (0.0530, 0.0530, 0.0530, 0.0530)),
    Curve("pao100", 4.0, (0.0062, 0.0137, 0.0216, 0.0233)),
)
"""1 GPa, 60 degrees C, smooth: Mann 1995, by the fit of Arana et al., Proc. IMechE J 233 (2019) 303."""


def friction(oil: str, speed: float, ratio: float, points: int) -> float:
    """Computed friction coefficient at a slide/roll ratio, on a mesh of so many nodes per half-width."""
    keys = {"fluid.oil": oil, "motion.entrainment_speed": speed, "motion.slide_roll_ratio": float(ratio)}
    case = load(CASE, keys | {"series": None, "mesh.points_per_half_width": points})
    (state,) = Simulation(case)
    return float(state.scalars["friction_coefficient"])


def draw() -> Figure:
    """Friction over the slide/roll ratio, for the speeds of FVA 3 and for three oils at one speed."""
    figure, panels = style.new_figure(1, 2, (9.0, 4.2), sharey=True)
    curves = {
        of: [friction(*of, ratio, MESHES[0]) for ratio in DENSE]
        for of in {(m.oil, m.speed) for m in MEASURED}
    }
    for panel, (title, oils) in zip(panels, PANELS.items(), strict=True):
        shown = [m for m in MEASURED if m.oil in oils and (len(oils) == 1 or m.speed == 4.0)]
        for measured, colour, shift in zip(shown, style.shades(len(shown)), SHIFTS, strict=True):
            label = f"{measured.speed:g} m/s" if len(oils) == 1 else NAMES[measured.oil]
            panel.plot(DENSE, curves[measured.oil, measured.speed], color=colour, lw=1.4, label=label)
            bars = dict(fmt="o", ms=4, lw=0.8, capsize=2, color=colour)
            panel.errorbar(np.array(RATIOS) * shift, measured.friction, yerr=BAND, **bars)
        panel.set(xscale="log", xlabel=style.UNITS["motion.slide_roll_ratio"], ylim=(0.0, 0.06))
        panel.set_title(title, fontsize="medium")
        panel.xaxis.set_major_formatter("{x:g}")
        panel.grid(lw=0.3)
        panel.legend(loc="lower right", **style.SMALL)
    panels[0].set_ylabel("friction coefficient")
    style.set_title(figure, "Twin discs, 1 GPa, 60 °C: computed (lines) and measured (points, ± 0.005)")
    return figure


def main(words: list[str] | None = None) -> None:
    """Print the table and write the picture."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("-o", "--output", default="discs.png", help="picture [discs.png]")
    chosen = parser.parse_args(words)
    print("oil, speed [m/s], slide/roll ratio: measured; computed on " + ", ".join(f"a/{n}" for n in MESHES))
    for measured in MEASURED:
        for ratio, value in zip(RATIOS, measured.friction, strict=True):
            found = [friction(measured.oil, measured.speed, ratio, points) for points in MESHES]
            at = f"{measured.oil}, {measured.speed:g}, {ratio:g}: {value:.4f}"
            print(f"{at}; {found[0]:.4f}, {found[1]:.4f}; ratio {found[1] / value:.3f}", flush=True)
    style.save(draw(), chosen.output)
    print(chosen.output)


if __name__ == "__main__":
    main()
