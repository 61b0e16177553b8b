"""Friction of FZG gears of type C-mod over the speed beside measurements: table on two meshes and picture.

``./run_mpi.sh python cases/paper/cmod.py [-o PICTURE]`` computes `cases/cmod.toml` with all roughness of both
flanks in the compliant layer, on a/20 and a/40, prints friction and the share of the solids beside `MEASURED`
and draws them over the speed. Results are files `cmod_SPEED_POINTS.h5`; those that exist are used.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from ehlpetsc.analysis.gear_run import GearRun
from ehlpetsc.api import solve
from ehlpetsc.case.loading import load
from ehlpetsc.gears.path import mean_friction
from ehlpetsc.pictures import style

CASE = Path(__file__).parents[1] / "cmod.toml"
MESHES = (20, 40)  # nodes per half-width
BOUNDARY = 0.065  # friction of the solids
LAYER = {  # rms of two flanks of Ra 0.2 um, waves below 80 um
    "contact.model": "mixed",
    "contact.asperity_height": 0.354e-6,
    "contact.asperity_stiffness": 0.0278,
}


class Point(NamedTuple):
    """Speed at the pitch circle [m/s] and of the pinion [1/min], friction, share of the solids."""

    speed: float
    rotation: float
    friction: float
    share: float


MEASURED = (
    Point(0.5, 130.5, 0.063, 0.90),
    Point(2.0, 522.0, 0.060, 0.74),
    Point(5.0, 1305.0, 0.055, 0.53),
    Point(8.3, 2166.0, 0.050, 0.38),
    Point(20.0, 5218.0, 0.034, 0.14),
)
"""Hinterstoisser 2014, by the fit of Arana et al. (2.5 %); share by electric resistance, 1 - erf(lambda)."""


class Found(NamedTuple):
    """Mean friction along the path, that of the solids in it, and their mean share of the load."""

    friction: float
    solids: float
    share: float


def found(rotation: float, points: int, folder: Path = Path()) -> Found:
    """Computed values at a speed of the pinion [1/min], on a mesh of so many nodes per half-width."""
    file = folder / f"cmod_{rotation:g}_{points}.h5"
    if not file.exists():
        case = load(CASE, LAYER | {"gears.speed": rotation, "mesh.points_per_half_width": points})
        solve(case, file, progress=False).close()
    run = GearRun(file)
    share = np.interp(run.path.rho, run.rho, run.scalars["contact_share"])
    solids = mean_friction(run.path, BOUNDARY * share)
    return Found(mean_friction(run.path, run.friction_on_path()), solids, run.mean("contact_share"))


def draw(computed: list[Found]) -> Figure:
    """Friction with its parts, and the share of the solids, over the speed."""
    figure, panels = style.new_figure(1, 2, (9.0, 4.2))
    speeds = [point.speed for point in MEASURED]
    friction, solids, share = np.array(computed).T
    dark, middle, light = style.shades(3)
    panels[0].plot(speeds, friction, color=dark, label="computed")
    panels[0].plot(speeds, solids, "--", color=middle, label="of the solids")
    panels[0].plot(speeds, friction - solids, ":", color=light, label="of the oil")
    panels[0].plot(speeds, [point.friction for point in MEASURED], "o", color=dark, label="measured")
    panels[1].plot(speeds, share, color=dark, label="computed")
    panels[1].plot(speeds, [point.share for point in MEASURED], "o", color=dark, label="by resistance")
    labels = "mean friction coefficient", "share of load on the solids"
    for panel, label in zip(panels, labels, strict=True):
        panel.set(xscale="log", xlabel="speed at the pitch circle [m/s]", ylabel=label)
        panel.set_ylim(bottom=0.0)
        panel.xaxis.set_major_formatter("{x:g}")
        panel.grid(lw=0.3)
        panel.legend(loc="center left", **style.SMALL)
    style.set_title(figure, "FZG type C-mod, 183.4 N m, FVA 3, 90 °C, all roughness in the layer")
    return figure


def main(words: list[str] | None = None) -> None:
    """Print the table and write the picture."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("-o", "--output", default="cmod_friction.png", help="picture [cmod_friction.png]")
    chosen = parser.parse_args(words)
    print(
        "speed [m/s]: measured, share; computed on " + ", ".join(f"a/{n}" for n in MESHES) + ", share, ratio"
    )
    computed = []
    for point in MEASURED:
        meshes = [found(point.rotation, points) for points in MESHES]
        of = ", ".join(f"{mesh.friction:.4f}" for mesh in meshes)
        last = meshes[-1]
        print(
            f"{point.speed:g}: {point.friction:.3f}, {point.share:.2f}; {of}, {last.share:.2f}, "
            f"{last.friction / point.friction:.2f}",
            flush=True,
        )
        computed.append(last)
    style.save(draw(computed), chosen.output)
    print(chosen.output)


if __name__ == "__main__":
    main()
