"""Friction of FZG gears of type C-mod over the speed beside measurements: tables and picture.

``ehlpetsc python cases/paper/cmod.py [MODEL ...] [--store] [-o PICTURE]`` computes `cases/cmod.toml` by each
of `MODELS`, prints friction and the share of the solids beside `data/cmod.csv` on two meshes, of a strip
their mean and scatter over `SEEDS`, and, at 8.3 m/s, the effect of each of `CHANGES`, and draws friction and
share over the speed. Results are files `cmod_MODEL_SPEED_POINTS*.h5`; those that exist are used.
"""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, NamedTuple

import measured_data
import numpy as np
from matplotlib.figure import Figure

from ehlpetsc.analysis.gear_run import GearRun
from ehlpetsc.api import solve
from ehlpetsc.case.loading import load
from ehlpetsc.gears.path import mean_friction
from ehlpetsc.pictures import style

CASE = Path(__file__).parents[1] / "cmod.toml"
BOUNDARY = 0.065  # friction of the solids
SPEED_OF_CHANGES = 8.3  # m/s


def waves(sq: float, border: float, seed: int) -> dict[str, Any]:
    """Isotropic roughness of a flank of Ra 0.2 um from `border` [m] on; waves from 2.5 um on have 0.25 um."""
    roll_off = max(80e-6, 1.0001 * border)  # longer waves have one spectral density
    spectrum = {"sq": sq, "hurst": 0.8, "roll_off": roll_off, "short_cutoff": border}
    return {"synthetic": {"kind": "self-affine", "seed": seed} | spectrum}


def strip(border: float, sq: float, layer: float, width: float, seeds: tuple[int, int]) -> dict[str, Any]:
    """Keys of a strip: waves from `border` [m] on are on the mesh, the others in the layer (rms [m])."""
    return {
        "contact.model": "mixed",
        "contact.asperity_height": layer,
        "mesh.width": width,
        "mesh.inlet": -2.5,
        "surface.1": waves(sq, border, seeds[0]),
        "surface.2": waves(sq, border, seeds[1]),
    }


class Model(NamedTuple):
    """Model of the flanks' roughness: nodes per half-width on its meshes, keys, speeds [m/s] (None: all)."""

    description: str
    meshes: tuple[int, ...]
    keys: dict[str, Any]
    speeds: tuple[float, ...] | None = None


LONG = 79e-6, 0.168e-6, 0.262e-6, 1.0  # border, Sq of a flank and rms of the layer [m], width
SHORT = 40e-6, 0.226e-6, 0.151e-6, 0.5
LONGEST = 158e-6, 0.0845e-6, 0.3328e-6, 1.0
STIFF = {"contact.asperity_stiffness": 0.0261}  # by the roll-off, 80 um; by the border it is half of it
SEEDS = (2, 3), (4, 5), (6, 7)
MODELS = {
    "smooth": Model("smooth flanks", (20, 40), {}),
    "layer": Model(
        "all roughness in the layer",  # rms of both flanks, waves below 80 um
        (20, 40),
        {
            "contact.model": "mixed",
            "contact.asperity_height": 0.354e-6,
            "contact.asperity_stiffness": 0.0278,
        },
    ),
    "strip": Model(
        "strip of isotropic roughness", (20,), strip(*LONGEST, SEEDS[0]) | STIFF, (2.0, 8.3, 20.0)
    ),
}
COLOURS = {"smooth": style.DARK, "layer": style.SINGLE, "strip": style.SECOND}
OTHER_SEEDS = {f"seeds {one}, {two}": strip(*LONGEST, (one, two)) for one, two in SEEDS[1:]}
CHANGES: dict[str, dict[str, Any]] = {
    "isothermal": {"heat": None, "fluid.temperature": 363.15},
    "46 W/(m K) of soft steel": {"heat.conductivity": 46.0},
    "FVA 3 as oil m100": {"fluid.oil": "m100"},
    "half of the time steps' length": {"time.courant": 0.5},
}
CHANGES_OF_STRIPS: dict[str, dict[str, Any]] = {
    "border 79 um, 8 nodes a wave": strip(*LONG, SEEDS[0]) | {"contact.asperity_stiffness": None},
    "border 40 um, a/32, 6.5 nodes a wave": strip(*SHORT, SEEDS[0])
    | {"contact.asperity_stiffness": None, "mesh.points_per_half_width": 32},
    "8 nodes a wave": {"mesh.points_per_half_width": 10},
    "layer as stiff as by the border": {"contact.asperity_stiffness": None},
}
"""Changed keys of the assumptions that friction depends on, by their label; on the coarser mesh."""


class Point(NamedTuple):
    """Speed at the pitch circle [m/s] and of the pinion [1/min], friction, share of the solids."""

    speed: float
    rotation: float
    friction: float
    share: float


DATA = measured_data.read("cmod.csv").columns
MEASURED = tuple(Point(*row) for row in zip(*(DATA[name] for name in Point._fields), strict=True))


class Found(NamedTuple):
    """Mean friction along the path, that of the solids in it, and their mean share of the load."""

    friction: float
    solids: float
    share: float

    def __str__(self) -> str:
        oil = (self.friction - self.solids) / (1.0 - self.share)
        return f"{self.friction:.4f}, share {self.share:.2f}, oil over its own load {oil:.4f}"


def found(
    model: str, rotation: float, points: int, folder: Path = Path(), change: str | None = None
) -> Found:
    """Computed values at a speed of the pinion [1/min], on a mesh of so many nodes per half-width."""
    name = f"cmod_{model}_{rotation:g}_{points}" + (f"_{change}" if change else "")
    file = folder / (re.sub(r"\W+", "_", name) + ".h5")
    keys = {"gears.speed": rotation, "mesh.points_per_half_width": points} | MODELS[model].keys
    case = load(CASE, keys | (CHANGES | CHANGES_OF_STRIPS | OTHER_SEEDS).get(change or "", {}))
    if not file.exists():
        solve(case, file, progress=False).close()
    run = GearRun(file)
    if "contact_share" not in run.scalars:
        return Found(mean_friction(run.path, run.friction_on_path()), 0.0, 0.0)
    share = np.interp(run.path.rho, run.rho, run.scalars["contact_share"])
    solids = mean_friction(run.path, BOUNDARY * share)
    return Found(mean_friction(run.path, run.friction_on_path()), solids, run.mean("contact_share"))


def with_seeds(model: str, rotation: float, points: int) -> list[Found]:
    """Computed values of each of `SEEDS`; of a model without them one."""
    others = OTHER_SEEDS if model == "strip" else {}
    return [found(model, rotation, points, change=change) for change in (None, *others)]


def mean(values: list[Found]) -> Found:
    """Mean of computed values."""
    return Found(*np.mean(values, axis=0))


def points_of(model: str) -> list[Point]:
    """Measured points at the speeds of a model."""
    speeds = MODELS[model].speeds
    return [point for point in MEASURED if speeds is None or point.speed in speeds]


def draw(computed: dict[str, list[Found]]) -> Figure:
    """Friction with its parts, and the share of the solids, over the speed."""
    figure, panels = style.new_figure(1, 2, (9.0, 4.2))
    for model, values in computed.items():
        speeds = [point.speed for point in points_of(model)]
        colour, parts = COLOURS[model], ("of the solids", "of the oil") if model == "layer" else ("", "")
        friction, solids, share = np.array(values).T
        panels[0].plot(speeds, friction, color=colour, label=model)
        if model != "smooth":
            panels[0].plot(speeds, solids, "--", color=colour, lw=1.0, label=parts[0])
            panels[0].plot(speeds, friction - solids, ":", color=colour, lw=1.0, label=parts[1])
            panels[1].plot(speeds, share, color=colour, label=model)
    speeds = [point.speed for point in MEASURED]
    panels[0].plot(speeds, [point.friction for point in MEASURED], "ko", label="measured")
    panels[1].plot(
        speeds, [point.share for point in MEASURED], "ko", label="1 - erf(lambda), fitted to discs"
    )
    labels = "mean friction coefficient", "share of load on the solids"
    for panel, label in zip(panels, labels, strict=True):
        panel.set(xscale="log", xlabel="speed at the pitch circle [m/s]", ylabel=label)
        panel.set_ylim(0.0, 1.25 * panel.get_ylim()[1])
        panel.xaxis.set_major_formatter("{x:g}")
        panel.grid(lw=0.3)
        panel.legend(loc="upper right", ncols=2, **style.SMALL)
    style.set_title(figure, "FZG type C-mod, 183.4 N m, FVA 3, 90 °C")
    return figure


def influences(model: str) -> None:
    """Print the effect of each change at `SPEED_OF_CHANGES` on the coarser mesh."""
    (rotation,) = (point.rotation for point in MEASURED if point.speed == SPEED_OF_CHANGES)
    points = MODELS[model].meshes[0]
    print(f"{model} at {SPEED_OF_CHANGES} m/s on a/{points}: {found(model, rotation, points)}")
    for change in CHANGES | (CHANGES_OF_STRIPS if model == "strip" else {}):
        print(f"{change}: {found(model, rotation, points, change=change)}", flush=True)


def main(words: list[str] | None = None) -> None:
    """Print the tables and write the picture."""
    parser = measured_data.parser(__doc__, "cmod_friction.png")
    parser.add_argument("models", nargs="*", choices=[*MODELS, []], metavar="MODEL", help=", ".join(MODELS))
    parser.add_argument("--store", action="store_true", help="friction and shares as columns of the file")
    chosen = parser.parse_args(words)
    computed: dict[str, list[Found]] = {}
    for model in chosen.models or MODELS:
        description, points, *_ = MODELS[model]
        print(
            f"{description}\nspeed [m/s]: measured, share; computed on " + ", ".join(f"a/{n}" for n in points)
        )
        computed[model] = []
        for point in points_of(model):
            of_seeds = [with_seeds(model, point.rotation, number) for number in points]
            both = [mean(values) for values in of_seeds]
            ratio = both[-1].friction / point.friction
            text = "; ".join(map(str, both))
            if len(of_seeds[-1]) > 1:
                friction, _, share = np.std(of_seeds[-1], axis=0, ddof=1)
                text += f"; standard deviation {friction:.4f}, {share:.3f}"
            print(
                f"{point.speed:g}: {point.friction:.3f}, {point.share:.2f}; {text}; ratio {ratio:.2f}",
                flush=True,
            )
            computed[model].append(both[-1])
        influences(model)
    if chosen.store:
        columns = {}
        for model, values in computed.items():
            of_speed = dict(zip(points_of(model), values, strict=True))
            every = [of_speed.get(point, Found(np.nan, np.nan, np.nan)) for point in MEASURED]
            columns |= {model: [f"{value.friction:.4f}" for value in every]}
            columns |= (
                {f"{model}_share": [f"{value.share:.2f}" for value in every]} if model != "smooth" else {}
            )
        measured_data.store("cmod.csv", **columns)
    style.save(draw(computed), chosen.output)
    print(chosen.output)


if __name__ == "__main__":
    main()
