"""Damage of asperities by ensembles of rough strips: the tables and the picture of `cases/micropitting.md`.

``ehlpetsc python cases/paper/micropits.py FOLDER [SCENE ...] [--store] [-o PICTURE]`` computes one pass of
each seed of the scenes, by default of all, skips lives that are in the folder, and prints shares of the
surface that asperities damage and passes to the first failures, which ``--store`` writes to
`data/micropits.csv`. With the scene `first` it draws the signs, of scenes that are not chosen by the file.
Under mpirun ranks share the lives.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import measured_data
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from micropit_scenes import COMMON, PASSES, RING_PASSES, SCENES, SEEDS, Scene

from ehlpetsc.life.body import LifeBody
from ehlpetsc.life.ensemble import read_lives
from ehlpetsc.life.history import LifeHistory
from ehlpetsc.life.laws import below, regions
from ehlpetsc.pictures import style
from ehlpetsc.results.means import bootstrap_bounds
from ehlpetsc.results.post_result import DAMAGED, is_damaged

CASE = Path(__file__).parent.parent / "micropitting.toml"
FILE = "micropits.csv"
SHARES = tuple(f"{name}_{side}" for side in "12" for name in ("share", "low", "high"))
COLUMNS = ("scene", "seeds", *SHARES, "life_1", "life_2", "smooth_life", "smooth_depth")
SCENE = "scene"  # the first seeds of the scene, of as many as are compared with them
SHORT = {"mesh.points_per_half_width": 10, "time.travel": 6.0}  # in which points of all scenes pass
SIGNS = {  # title of a panel, with the published sign: its scenes; sign 6 is drawn over depth
    "1. the smooth body (2) is damaged more, the more the contact slides": ("mirror", SCENE, "reversed"),
    "2. slide/roll ratio": ("rolling", SCENE),
    "3. lambda: worst near 1, nothing at 3": ("thin", SCENE, "thick"),
    "4. Rq of rings NU 209: 0.05 on 1.0 µm alone pits": tuple(f"pair_{k}_line" for k in (1, 2, 3, 4)),
    "5. temperature of NU 211: worst at 73 °C": ("cold_line", "warm_line", "hot_line"),
    "7. lay: changes the area": ("transverse", SCENE, "along"),
}
SCENE_LABELS = {"1": "0.25", "2": "0.25", "3": "0.97", "7": "isotropic"}  # of a sign's number
TEN = "first", "second", "third"  # whose seeds are the scene "ten"
ALL = SCENES | {"ten": Scene("ten seeds")}
COMPARED = "second", "third", "ten", "smoother", "fine", "wide", "long", "drift", "mises", "full"
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


def share(body: LifeBody, passes: float, deepest: float = np.inf) -> float:
    """Share of the columns that asperities damage in cells down to a depth [m], after passes without wear."""
    cells = body.edges[1:] <= deepest
    damage, smooth = passes * body.damage_rate[cells], passes * below(body.smooth_rate[cells], body.height)
    return float(is_damaged(damage, smooth).any(axis=0).mean())


def shares(lives: list[LifeHistory], passes: float, deepest: float = np.inf) -> np.ndarray:
    """Shares of both surfaces of each life, shape (2, lives)."""
    return np.array([[share(body, passes, deepest) for body in life.bodies[-1]] for life in lives]).T


def first_failures(lives: list[LifeHistory]) -> np.ndarray:
    """Passes to D = 1 at the worst point of both surfaces, geometric means over the lives, shape (2,)."""
    worst = np.array([[body.damage_rate.max() for body in life.bodies[-1]] for life in lives])
    with np.errstate(divide="ignore"):
        return 1.0 / np.exp(np.log(worst).mean(axis=0))


def percentages(values: np.ndarray) -> str:
    """Mean of shares with its bounds."""
    form = "{:.1f} % ({:.1f} to {:.1f})" if len(values) > 1 else "{:.1f} %"
    return form.format(*100 * statistics(values))


def spot_widths(lives: list[LifeHistory], passes: float) -> np.ndarray:
    """Diameters of circles of the area of damaged spots of both surfaces [m]."""
    found = []
    for body in (body for life in lives for body in life.bodies[-1]):
        damage, smooth = passes * body.damage_rate, passes * body.smooth_rate[:, None, None]
        numbers, count = regions(is_damaged(damage, smooth).any(axis=0), True)
        cells = np.bincount(numbers.ravel(), minlength=count + 1)[1:]
        found.append(np.sqrt(4.0 / np.pi * cells * np.prod(body.widths)))
    return np.concatenate(found)


def lines(ensembles: Ensembles) -> list[str]:
    """Shares with their bounds (90 %), first failures, and ratios to the same seeds of the scene."""
    found = []
    for name, lives in ensembles.items():
        scene, last = ALL[name], [life.rows[-1] for life in lives]
        values, failures = shares(lives, scene.passes), first_failures(lives)
        text = [f"surface {k}: {percentages(one)}" for k, one in enumerate(values, 1)]
        friction, pressure = (np.mean([row[key] for row in last]) for key in ("friction", "p_max"))
        line = f"{name}, {scene.label}, {len(lives)} seeds: {', '.join(text)}"
        line += "; first failure after {:.3g} and {:.3g} passes".format(*failures)
        line += f", smooth contact {last[0]['smooth_life_1']:.3g}"
        line += f"; friction {friction:.4f}, {pressure / 1e9:.2f} GPa"
        if name in COMPARED and "first" in ensembles:
            reference = ensembles["first"][: None if name in (*TEN, "ten") else len(lives)]
            before = shares(reference, PASSES).mean(axis=1), first_failures(reference)
            line += "; over the first {:.2f} and {:.2f}, failures {:.2f} and {:.2f}".format(
                *values.mean(axis=1) / before[0], *failures / before[1]
            )
        found.append(line)
    return found + (of_limits(ensembles["first"]) if "first" in ensembles else [])


def of_limits(lives: list[LifeHistory]) -> list[str]:
    """Shares of the scene by other depths, and after other passes, or by other thresholds of D."""
    found = []
    for text, passes, deepest in (
        (f"D above {2 * DAMAGED:g}, or half the passes", 0.5 * PASSES, np.inf),
        (f"D above {0.5 * DAMAGED:g}, or twice the passes", 2.0 * PASSES, np.inf),
        ("down to 6 µm", PASSES, 6e-6),
        ("down to 4 µm", PASSES, 4e-6),
        ("down to 2 µm", PASSES, 2e-6),
    ):
        values = shares(lives, passes, deepest)
        found.append(f"first, {text}: surface 1 {percentages(values[0])}, surface 2 {percentages(values[1])}")
    widths = 1e6 * np.quantile(spot_widths(lives, 0.3 * PASSES), (0.1, 0.5, 0.9))
    spots = "first, damaged spots after {:.0e} passes: {:.0f} to {:.0f} µm wide, half of them below {:.0f}"
    even = ", ".join(f"{damage:.3g}" for damage in even_damage(lives, PASSES))
    text = f"first, D of surface 2 if its partner drifts through all positions: {even}"
    return [*found, spots.format(0.3 * PASSES, widths[0], widths[2], widths[1]), text]


def even_damage(lives: list[LifeHistory], passes: float) -> list[float]:
    """Largest mean over the columns of D of the smooth body, of all depths, of each life.

    Its columns are alike. If partners drift through all positions, each of them gets the mean.
    """
    rates = [life.bodies[-1][1].damage_rate for life in lives]
    return [passes * rate.reshape(len(rate), -1).mean(axis=1).max() for rate in rates]


def rows_of(ensembles: Ensembles) -> dict[str, tuple[str, ...]]:
    """Rows of `FILE` by scene, those of the ensembles anew: shares as percentages, passes to failures."""
    columns = measured_data.read(FILE).columns
    rows = {row[0]: row for row in zip(*(map(_text, columns[name]) for name in COLUMNS), strict=True)}
    for name, lives in ensembles.items():
        values = [100 * statistics(one) for one in shares(lives, ALL[name].passes)]
        row = lives[0].rows[-1]
        ends = [*first_failures(lives), row["smooth_life_1"], row["smooth_depth_1"]]
        texts = [*(f"{value:.1f}" for value in np.ravel(values)), *(f"{value:.3g}" for value in ends)]
        rows[name] = (name, str(len(lives)), *texts)
    return {name: rows[name] for name in ALL if name in rows}


def _text(value: str | float) -> str:
    return value if isinstance(value, str) else f"{value:.3g}"


def store(ensembles: Ensembles) -> None:
    """Write the rows of the ensembles to `FILE`; the others stay."""
    columns = zip(*rows_of(ensembles).values(), strict=True)
    measured_data.store(FILE, **dict(zip(COLUMNS, columns, strict=True)))


def stored_shares(rows: dict[str, tuple[str, ...]], name: str) -> np.ndarray | None:
    """Mean shares of both surfaces and their bounds [%], shape (2, 3), of a scene; None: not there."""
    return np.array(rows[name][2:8], float).reshape(2, 3) if name in rows else None


def statistics(values: np.ndarray) -> np.ndarray:
    """Mean and its bounds."""
    return np.array([values.mean(), *bootstrap_bounds(values)])


def bars(axes: Axes, labels: list[str], values: list[np.ndarray], limited: list[np.ndarray | None]) -> None:
    """Shares of both surfaces with bounds, one below the other; diamonds with a limiting shear stress."""
    for k, side in enumerate("12"):
        mean, low, high = np.array([one[k] for one in values]).T
        at = np.arange(len(labels)) + 0.4 * k - 0.2
        axes.barh(at, mean, 0.38, color=style.SURFACES[side])
        axes.errorbar(mean, at, xerr=(mean - low, high - mean), fmt="none", color=style.DARK, lw=1, capsize=2)
        for place, one in zip(at, limited, strict=True):
            if one is not None:
                axes.plot(one[k, 0], place, "D", ms=5, mfc="w", mec=style.DARK)
    axes.set_yticks(range(len(labels)), labels, fontsize="small")
    axes.set_ylim(len(labels) - 0.5, -0.5)


def draw(ensembles: Ensembles) -> Figure:
    """Row of each sign over one axis of shares, of the ensembles or as stored; damage over depth."""
    rows = rows_of(ensembles)
    signs = {title: [name for name in names if _of(name) in rows] for title, names in SIGNS.items()}
    signs = {title: names for title, names in signs.items() if len(names) > 1}
    figure = Figure(figsize=(10.0, 1.5 + 1.3 * len(signs)), layout="constrained")
    heights = [1 + len(names) for names in signs.values()]
    grid = figure.add_gridspec(len(signs), 2, width_ratios=(2, 1), height_ratios=heights)
    first = None
    for row, (title, names) in enumerate(signs.items()):
        axes = figure.add_subplot(grid[row, 0], sharex=first)
        first = first or axes
        labels = [SCENE_LABELS[title[0]] if name == SCENE else SCENES[name].label for name in names]
        values = [np.asarray(stored_shares(rows, _of(name))) for name in names]
        bars(axes, labels, values, [stored_shares(rows, f"{_of(name)}_limited") for name in names])
        axes.set_title(title, fontsize="medium", loc="left")
        axes.tick_params(labelbottom=row == len(signs) - 1)
    axes.set_xlabel(f"share with D > {DAMAGED:g}, of which the smooth contact has less than a tenth [%]")
    over_depth(figure.add_subplot(grid[:, 1]), ensembles["first"])
    title = f"Surface damaged by asperities after {PASSES:,.0f} passes (4: {RING_PASSES:,.0f})"
    style.set_title(figure, f"{title}; diamonds: shear stress to 0.054 p")
    return figure


def _of(name: str) -> str:
    """Scene of an ensemble: that of the case has the first seeds."""
    return "first" if name == SCENE else name


def over_depth(axes: Axes, lives: list[LifeHistory]) -> None:
    """Damage that 1 % of the surface exceeds in a pass at each depth, and that of the smooth contact."""
    for k, side in enumerate("12"):
        bodies = [life.bodies[-1][k] for life in lives]
        edges = 1e6 * bodies[0].edges
        values = np.array([np.quantile(body.damage_rate, 0.99, axis=(1, 2)) for body in bodies])
        middles, mean = 0.5 * (edges[1:] + edges[:-1]), values.mean(axis=0)
        shown, color = mean > 0, style.SURFACES[side]
        axes.semilogx(mean[shown], middles[shown], ".-", color=color, label=f"surface {side}")
    axes.semilogx(bodies[0].smooth_rate, middles, "--", color=style.SINGLE, label="smooth contact")
    axes.axhspan(3.0, 4.0, color=style.FAINT, alpha=0.5)
    axes.set(ylabel="depth [µm]", xlabel="D of a pass, 1 % of surface", xlim=(1e-10, None))
    axes.invert_yaxis()
    axes.legend(loc=(0.03, 0.7), fontsize="small")
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
    if ensembles.keys() >= {*TEN}:
        ensembles["ten"] = [life for name in TEN for life in ensembles[name]]
    print("\n".join(lines(ensembles)))
    if chosen.store:
        store(ensembles)
    if "first" in ensembles:
        style.save(draw(ensembles), chosen.output)
        print(chosen.output)


if __name__ == "__main__":
    main()
