"""Friction of FZG gears of type C-mod over the speed beside measurements: table on two meshes and picture.

``./run_mpi.sh python cases/paper/cmod.py [-o PICTURE]`` computes `cases/cmod.toml` with all roughness of both
flanks in the compliant layer, and as a strip of isotropic roughness; prints friction and the share of the
solids beside `MEASURED` and draws them over the speed. Results are files `cmod_MODEL_SPEED_POINTS.h5`; those
that exist are used.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from ehlpetsc.analysis.gear_run import GearRun
from ehlpetsc.api import solve
from ehlpetsc.case.loading import load
from ehlpetsc.gears.path import mean_friction
from ehlpetsc.pictures import style

CASE = Path(__file__).parents[1] / "cmod.toml"
BOUNDARY = 0.065  # friction of the solids
# of a flank of Ra 0.2 um, waves of 40 um and longer; those from 2.5 um on have 0.25 um
WAVES = {"kind": "self-affine", "sq": 0.226e-6, "hurst": 0.8, "roll_off": 80e-6, "short_cutoff": 40e-6}


class Model(NamedTuple):
    """Model of the flanks' roughness: description, nodes per half-width on two meshes, keys of the case."""

    description: str
    meshes: tuple[int, int]
    keys: dict[str, Any]


MODELS = {
    "layer": Model(
        "all roughness in the layer",  # rms of both flanks, waves below 80 um
        (20, 40),
        {"contact.asperity_height": 0.354e-6, "contact.asperity_stiffness": 0.0278},
    ),
    "strip": Model(
        "strip of isotropic roughness",
        (16, 32),
        {
            "contact.asperity_height": 0.151e-6,  # rms of both flanks, waves below 40 um
            "mesh.width": 0.5,
            "mesh.inlet": -2.5,
            "time.courant": 1.0,
            "surface.1": {"synthetic": WAVES | {"seed": 2}},
            "surface.2": {"synthetic": WAVES | {"seed": 3}},
        },
    ),
}
COLOURS = {"layer": style.SINGLE, "strip": style.SECOND}


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


def found(model: str, rotation: float, points: int, folder: Path = Path()) -> Found:
    """Computed values at a speed of the pinion [1/min], on a mesh of so many nodes per half-width."""
    file = folder / f"cmod_{model}_{rotation:g}_{points}.h5"
    if not file.exists():
        keys = {"contact.model": "mixed", "gears.speed": rotation, "mesh.points_per_half_width": points}
        case = load(CASE, keys | MODELS[model].keys)
        solve(case, file, progress=False).close()
    run = GearRun(file)
    share = np.interp(run.path.rho, run.rho, run.scalars["contact_share"])
    solids = mean_friction(run.path, BOUNDARY * share)
    return Found(mean_friction(run.path, run.friction_on_path()), solids, run.mean("contact_share"))


def draw(computed: dict[str, list[Found]]) -> Figure:
    """Friction with its parts, and the share of the solids, over the speed."""
    figure, panels = style.new_figure(1, 2, (9.0, 4.2))
    speeds = [point.speed for point in MEASURED]
    for model, values in computed.items():
        colour, parts = COLOURS[model], ("of the solids", "of the oil") if model == "layer" else ("", "")
        friction, solids, share = np.array(values).T
        panels[0].plot(speeds, friction, color=colour, label=model)
        panels[0].plot(speeds, solids, "--", color=colour, lw=1.0, label=parts[0])
        panels[0].plot(speeds, friction - solids, ":", color=colour, lw=1.0, label=parts[1])
        panels[1].plot(speeds, share, color=colour, label=model)
    panels[0].plot(speeds, [point.friction for point in MEASURED], "ko", label="measured")
    panels[1].plot(speeds, [point.share for point in MEASURED], "ko", label="by resistance")
    labels = "mean friction coefficient", "share of load on the solids"
    for panel, label in zip(panels, labels, strict=True):
        panel.set(xscale="log", xlabel="speed at the pitch circle [m/s]", ylabel=label)
        panel.set_ylim(0.0, 1.25 * panel.get_ylim()[1])
        panel.xaxis.set_major_formatter("{x:g}")
        panel.grid(lw=0.3)
        panel.legend(loc="upper right", ncols=2, **style.SMALL)
    style.set_title(figure, "FZG type C-mod, 183.4 N m, FVA 3, 90 °C")
    return figure


def main(words: list[str] | None = None) -> None:
    """Print the table and write the picture."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("-o", "--output", default="cmod_friction.png", help="picture [cmod_friction.png]")
    chosen = parser.parse_args(words)
    computed: dict[str, list[Found]] = {}
    for model, (description, points, _) in MODELS.items():
        meshes = ", ".join(f"a/{number}" for number in points)
        print(f"{description}\nspeed [m/s]: measured, share; computed on {meshes}, share, ratio")
        computed[model] = []
        for point in MEASURED:
            both = [found(model, point.rotation, number) for number in points]
            of, last = ", ".join(f"{one.friction:.4f}" for one in both), both[-1]
            print(
                f"{point.speed:g}: {point.friction:.3f}, {point.share:.2f}; {of}, {last.share:.2f}, "
                f"{last.friction / point.friction:.2f}",
                flush=True,
            )
            computed[model].append(last)
    style.save(draw(computed), chosen.output)
    print(chosen.output)


if __name__ == "__main__":
    main()
