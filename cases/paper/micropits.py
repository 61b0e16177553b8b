"""Damage of rough strips by ensembles: the table and the picture of `cases/micropitting.md`.

``ehlpetsc python cases/paper/micropits.py FOLDER [SCENE ...] [--store] [-o PICTURE]`` computes one pass of
each seed of the scenes, by default of all, skips lives that are in the folder, and prints shares of the
surface with D above 0.1, which ``--store`` writes to `data/micropits.csv`. With the scene `first` it draws
the signs of the chosen ones. Under mpirun ranks share the lives.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any, NamedTuple

import measured_data
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ehlpetsc.life.body import LifeBody
from ehlpetsc.life.ensemble import read_lives
from ehlpetsc.life.history import LifeHistory
from ehlpetsc.pictures import style
from ehlpetsc.results.means import bootstrap_bounds
from ehlpetsc.results.post_result import DAMAGED

CASE = Path(__file__).parent.parent / "micropitting.toml"
PASSES, RING_PASSES = 1.5e7, 720e3  # of which shares are: of the scene, of the tests of rings
FILE = "micropits.csv"
COLUMNS = ("scene", "seeds", *(f"{name}_{side}" for side in "12" for name in ("share", "low", "high")))
COMMON = {
    "life.max_solved": 1,
    "life.damage_jump": 1.0,
    "mesh.width": 1.0,
    "mesh.points_per_half_width": 16,
    "wear.coefficient": 1e-19,
}
SEEDS = "surface.1.synthetic.seed", "surface.2.synthetic.seed"


class Scene(NamedTuple):
    """Label, settings beside `COMMON`, seeds of surface 1; surface 2 has seeds 1000 above."""

    label: str
    settings: dict[str, Any] = {}
    seeds: tuple[int, ...] = (1, 2, 3)
    passes: float = PASSES


def bearing(radius: float, viscosity: float, speed: float, ratio: float) -> dict[str, Any]:
    """Settings of a roller on an inner ring at 1.5 GPa [m, Pa s, m/s]."""
    pressure, modulus = 1.5e9, 226.37e9
    return {
        "contact.radius": radius,
        "contact.load": 2.0 * np.pi * radius * pressure**2 / modulus,
        "fluid.viscosity": viscosity,
        "fluid.pressure_viscosity": 20.8e-9,
        "fluid.eyring_stress": 3e6,
        "motion.entrainment_speed": speed,
        "motion.slide_roll_ratio": ratio,
        "mesh.width": 1.25,
    }


def pair(rq_1: float, rq_2: float) -> Scene:
    """Rings NU 209 of these roughnesses [um], of the spectrum of the scene, 1 m/s, 0.0094 Pa s."""
    waves = {"kind": "self-affine", "hurst": 0.8, "roll_off": 150e-6, "short_cutoff": 90e-6, "seed": 0}
    surfaces = {f"surface.{k}.synthetic": waves | {"sq": 1e-6 * rq} for k, rq in enumerate((rq_1, rq_2), 1)}
    settings = bearing(4.576e-3, 0.0094, 1.0, 0.02) | surfaces
    if rq_1 + rq_2 > 0.5:  # solids touch beyond the smooth contact
        settings |= {"mesh.inlet": -2.6, "mesh.outlet": 2.2, "time.travel": 10.0}
    return Scene(f"{rq_1:g} on {rq_2:g} µm", settings, passes=RING_PASSES)


def skewed(celsius: int, viscosity: float) -> Scene:
    """Rings NU 211: skewed surfaces, VG 68 at a temperature [Pa s]."""
    surfaces = {
        f"surface.{k}.synthetic": {
            "kind": "ground",
            "ra": ra,
            "correlation": 40e-6,
            "correlation_across": 40e-6,
            "skewness": skewness,
            "seed": 0,
        }
        for k, (ra, skewness) in enumerate(((0.26e-6, -1.17), (0.0575e-6, 1.21)), 1)
    }
    return Scene(f"{celsius} °C", bearing(5.077e-3, viscosity, 2.24, 0.015) | surfaces)


SCENES = {
    "first": Scene("ten seeds", seeds=tuple(range(1, 11))),
    "second": Scene("ten others", seeds=tuple(range(11, 21))),
    "fine": Scene("a/24", {"mesh.points_per_half_width": 24}, (1, 2, 3, 4, 5)),
    "wide": Scene("width 2 a", {"mesh.width": 2.0}),
    "long": Scene("travel 16 a", {"time.travel": 16.0}),
    "rolling": Scene("0.02", {"motion.slide_roll_ratio": 0.02}),
    "thin": Scene("0.3", {"motion.entrainment_speed": 0.43}),
    "thick": Scene("3", {"motion.entrainment_speed": 13.5}),
    "pair_1": pair(0.05, 0.26),
    "pair_2": pair(0.05, 1.0),
    "pair_3": pair(0.5, 0.05),
    "pair_4": pair(0.5, 0.5),
    "cold": skewed(66, 0.0192),
    "warm": skewed(73, 0.0151),
    "hot": skewed(98, 0.0074),
    "transverse": Scene("across", {"surface.1.synthetic.peklenik": 0.25}),
    "along": Scene(
        "along",
        {
            "surface.1.synthetic.peklenik": 4.0,
            "surface.1.synthetic.roll_off": 600e-6,
            "surface.1.synthetic.short_cutoff": 360e-6,
        },
    ),
    "ridges": Scene("ridges", {"mesh.width": None}),
}
SCENE = "scene"  # the first seeds of the scene, of as many as are compared with them
SHORT = {"mesh.points_per_half_width": 8, "time.travel": 5.0}
SIGNS = {  # title of a panel, with the published sign: its scenes; sign 6 is drawn over depth
    "1. rough and smooth surface: the smooth one is damaged more": (
        "first",
        "second",
        "wide",
        "long",
        "fine",
    ),
    "2. slide/roll ratio: worst at 0.01 to 0.02": ("rolling", SCENE),
    "3. lambda: worst near 1.1": ("thin", SCENE, "thick"),
    "4. Rq of rings NU 209: 0.05 on 1.0 µm alone pits": ("pair_1", "pair_2", "pair_3", "pair_4"),
    "5. temperature of NU 211: worst at 73 °C": ("cold", "warm", "hot"),
    "7. lay: changes the area": ("transverse", SCENE, "along", "ridges"),
}
SCENE_LABELS = {"2": "0.25", "3": "0.84", "7": "isotropic"}  # of a sign's number
Ensembles = dict[str, list[LifeHistory]]


def compute(name: str, folder: Path, is_short: bool = False) -> list[LifeHistory]:
    """Lives of a scene, computed unless they are there; of every rank."""
    from mpi4py import MPI

    from ehlpetsc.case.loading import load
    from ehlpetsc.life.ensemble import run_lives

    scene = SCENES[name]
    settings = COMMON | scene.settings
    if is_short:
        scene, settings = scene._replace(seeds=scene.seeds[:2]), settings | SHORT
    series: dict[str, Any] = {"key": SEEDS[0], "values": list(scene.seeds)}
    if "surface.2.synthetic" in settings:
        values = [scene.seeds, [1000 + seed for seed in scene.seeds]]
        series = {"keys": list(SEEDS), "values": values, "combine": "step"}
    case = load(CASE, settings | {"series": series})
    index = run_lives(case, folder / f"{name}.life.h5", MPI.COMM_WORLD, unresolved=True, show=print)
    return next(iter(read_lives(index).values()))


def share(body: LifeBody, passes: float) -> float:
    """Share of the columns with a damaged cell after equal passes without wear."""
    return float((passes * body.damage_rate.max(axis=0) > DAMAGED).mean())


def shares(lives: list[LifeHistory], passes: float) -> np.ndarray:
    """Shares of both surfaces of each life, shape (2, lives)."""
    return np.array([[share(body, passes) for body in life.bodies[-1]] for life in lives]).T


def lines(ensembles: Ensembles) -> list[str]:
    """Table: means with their bounds (90 %), and, over the same seeds of the scene, their ratio."""
    found = []
    for name, lives in ensembles.items():
        scene = SCENES[name]
        values = shares(lives, scene.passes)
        text = ["{:.1f} % ({:.1f} to {:.1f})".format(*100 * statistics(one)) for one in values]
        last = [life.rows[-1] for life in lives]
        friction, pressure = (np.mean([row[key] for row in last]) for key in ("friction", "p_max"))
        line = f"{name}, {scene.label}, {len(lives)} seeds: surface 1 {text[0]}, surface 2 {text[1]}"
        if name in ("second", "fine", "wide", "long") and "first" in ensembles:
            paired = len(lives) if name == "fine" else None  # same seeds, same surfaces
            reference = shares(ensembles["first"][:paired], PASSES).mean(axis=1)
            line += ", {:+.1f} and {:+.1f} % of the first".format(
                *100 * (values.mean(axis=1) / reference - 1)
            )
        found.append(f"{line}; friction {friction:.4f}, {pressure / 1e9:.2f} GPa")
    return found


def store(ensembles: Ensembles) -> None:
    """Write means and bounds of the shares, as percentages, to `FILE`."""
    rows = []
    for name, lives in ensembles.items():
        values = [100 * statistics(one) for one in shares(lives, SCENES[name].passes)]
        rows.append((name, len(lives), *(f"{value:.1f}" for value in np.ravel(values))))
    columns = (map(str, column) for column in zip(*rows, strict=True))
    measured_data.store(FILE, **dict(zip(COLUMNS, columns, strict=True)))


def statistics(values: np.ndarray) -> np.ndarray:
    """Mean and its bounds."""
    return np.array([values.mean(), *bootstrap_bounds(values)])


def bars(axes: Axes, labels: list[str], values: list[np.ndarray]) -> None:
    """Shares of both surfaces with bounds, one below the other."""
    for k, side in enumerate("12"):
        mean, low, high = 100 * np.array([statistics(one[k]) for one in values]).T
        at = np.arange(len(labels)) + 0.4 * k - 0.2
        axes.barh(at, mean, 0.38, color=style.SURFACES[side])
        axes.errorbar(mean, at, xerr=(mean - low, high - mean), fmt="none", color=style.DARK, lw=1, capsize=2)
    axes.set_yticks(range(len(labels)), labels, fontsize="small")
    axes.set_ylim(len(labels) - 0.5, -0.5)


def draw(ensembles: Ensembles) -> Figure:
    """Row of each sign, over one axis of shares; beside them the damage over depth."""
    figure = Figure(figsize=(10.0, 8.5), layout="constrained")
    grid = figure.add_gridspec(
        len(SIGNS), 2, width_ratios=(2, 1), height_ratios=[1 + len(names) for names in SIGNS.values()]
    )
    first = None
    for row, (title, names) in enumerate(SIGNS.items()):
        axes = figure.add_subplot(grid[row, 0], sharex=first)
        first, labels, values = first or axes, [], []
        for name in (name for name in names if name in (SCENE, *ensembles)):
            lives = ensembles["first"][:3] if name == SCENE else ensembles[name]
            passes = PASSES if name == SCENE else SCENES[name].passes
            labels.append(SCENE_LABELS[title[0]] if name == SCENE else SCENES[name].label)
            values.append(shares(lives, passes))
        if values:
            bars(axes, labels, values)
        axes.set_title(title, fontsize="medium", loc="left")
        axes.tick_params(labelbottom=row == len(SIGNS) - 1)
    axes.set_xlabel("damaged share [%]")
    over_depth(figure.add_subplot(grid[:, 1]), ensembles["first"])
    ends = f"{PASSES:,.0f} passes (4: {RING_PASSES:,.0f})"
    style.set_title(figure, f"Surface with D above {DAMAGED:g} to 20 µm deep after {ends}; bounds of 90 %")
    return figure


def over_depth(axes: Axes, lives: list[LifeHistory]) -> None:
    """Damage that 1 % of the surface exceeds in a pass, at each depth."""
    for k, side in enumerate("12"):
        bodies = [life.bodies[-1][k] for life in lives]
        edges = 1e6 * bodies[0].edges
        values = np.array([np.quantile(body.damage_rate, 0.99, axis=(1, 2)) for body in bodies])
        middles, mean = 0.5 * (edges[1:] + edges[:-1]), values.mean(axis=0)
        shown, color = mean > 0, style.SURFACES[side]
        axes.semilogx(mean[shown], middles[shown], ".-", color=color, label=f"surface {side}")
    axes.axhspan(3.0, 4.0, color=style.FAINT, alpha=0.5)
    axes.set(ylabel="depth [µm]", xlabel="D of a pass, 1 % of surface")
    axes.invert_yaxis()
    axes.legend(loc="upper right")
    axes.set_title("6. depth: published peak at 3 to 4 µm", fontsize="medium", loc="left")


def main(words: list[str] | None = None) -> None:
    """Compute, print, draw."""
    from mpi4py import MPI

    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("folder", type=Path, help="of the lives")
    parser.add_argument("scenes", nargs="*", metavar="SCENE", help=", ".join(SCENES))
    parser.add_argument(
        "--short", action="store_true", help="two seeds a scene, on a mesh too coarse for shares"
    )
    parser.add_argument("-o", "--output", type=Path, default=Path("seven_signs.png"), metavar="PICTURE")
    parser.add_argument("--store", action="store_true", help="shares as columns of the file")
    chosen = parser.parse_args(words)
    if unknown := [name for name in chosen.scenes if name not in SCENES]:
        parser.error(f"scene {unknown[0]}; allowed: {', '.join(SCENES)}")
    chosen.folder.mkdir(exist_ok=True, parents=True)
    ensembles = {name: compute(name, chosen.folder, chosen.short) for name in chosen.scenes or SCENES}
    if MPI.COMM_WORLD.rank:
        return
    print("\n".join(lines(ensembles)))
    if chosen.store:
        store(ensembles)
    if "first" in ensembles:
        style.save(draw(ensembles), chosen.output)
        print(chosen.output)


if __name__ == "__main__":
    main()
