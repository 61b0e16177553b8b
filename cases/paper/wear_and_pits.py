"""Wear against micropits over film and rate of wear: the table and the picture of `cases/micropitting.md`.

``ehlpetsc python cases/paper/wear_and_pits.py FOLDER [--strip] [--seeds 1,2] [-o PICTURE]`` computes a life
without break-outs of each seed and film of `cases/wear_and_pits.toml`, or of the strip of
`cases/micropitting.toml`, continues those that are in the folder, and prints for each the rate of wear that
keeps both surfaces from failing, passes to the first failed cell at other rates, and the smoothing. Wear and
damage are proportional to the passes, so that one life serves every rate k: D(N; k) = F(kN)/k. Under mpirun
ranks share the lives.
"""

from __future__ import annotations

import argparse
import tomllib
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ehlpetsc.life.body import LifeBody
from ehlpetsc.life.ensemble import read_lives
from ehlpetsc.life.history import LifeHistory
from ehlpetsc.pictures import style

CASES = Path(__file__).parent.parent
FLOODED = {"mesh.inlet": -3.7, "time.travel": 9.0, "life.max_solved": 12}  # little is worn under thick films
LINE: dict[str, dict[str, Any]] = {  # lambda: settings
    "0.34": {"motion.entrainment_speed": 0.49},
    "0.97": {},
    "3": {"motion.entrainment_speed": 11.0} | FLOODED,
}
STRIP: dict[str, dict[str, Any]] = {
    "0.33": {"motion.entrainment_speed": 0.71},
    "0.97": {},
}
OF_STRIP = {  # a life that serves every rate of wear
    "wear.coefficient": 1e-15,
    "life.passes": 1e7,
    "life.max_solved": 48,
    "life.damage_jump": 1.0,
    "life.break_out": "none",
}
SHORT = {"mesh.points_per_half_width": 10, "life.max_solved": 4, "life.partners": 2}
SEEDS = (1, 2, 3)
BODIES = "rough surface 1", "smooth surface 2", "smooth surface 2, mean of its columns"
RISES = 0.2  # change of D in the last round, over D, from which on a limiting rate is a lower bound
RATES = 1e-18, 1e-17, 1e-16  # of the printed passes [m^2/N]
Lives = dict[str, list[LifeHistory]]


class Curve(NamedTuple):
    """Largest damage over the wear, both at a rate of 1 m^2/N, of the `BODIES`.

    `worn`: k N [m^2/N], shape (n,). `damage`: k D, largest one so far [m^2/N], shape (3, n).
    """

    worn: np.ndarray
    damage: np.ndarray

    @classmethod
    def of(cls, life: LifeHistory) -> Curve:
        """Curve of a life without break-outs, from no passes on."""
        k = tomllib.loads(life.case)["wear"]["coefficient"]
        even = [mean_damage(body) for _, body in life.bodies]
        damage = np.maximum.accumulate([life("damage_1"), life("damage_2"), even], axis=1)
        return cls(*(np.pad(k * of, [(0, 0)] * (of.ndim - 1) + [(1, 0)]) for of in (life("passes"), damage)))

    def passes(self, rate: float) -> np.ndarray:
        """Passes to the first failed cell of the `BODIES` at a rate [m^2/N], shape (3,); inf: none."""
        found = [np.inf if of[-1] < rate else np.interp(rate, of, self.worn) / rate for of in self.damage]
        return np.array(found)

    @property
    def limits(self) -> np.ndarray:
        """Rates of wear from which on no cell of the `BODIES` fails [m^2/N], shape (3,)."""
        return self.damage[:, -1]

    @property
    def rise(self) -> np.ndarray:
        """Change of the largest damage in the last row, over the damage, shape (3,)."""
        return 1.0 - self.damage[:, -2] / self.damage[:, -1]


def mean_damage(body: LifeBody) -> float:
    """Largest mean over the columns of the damage of cells that are there, of all depths.

    All columns of a smooth body are alike. If its partner drifts through all positions, each of them
    therefore gets the mean, where few positions leave some of them more.
    """
    cells = np.where(body.is_there, body.damage, 0.0)
    return float(cells.reshape(len(cells), -1).mean(axis=1).max())


def compute(
    folder: Path, is_strip: bool, seeds: tuple[int, ...] = SEEDS, changes: dict[str, Any] | None = None
) -> Lives:
    """Lives of each film, continued if they are there; of every rank."""
    from mpi4py import MPI

    from ehlpetsc.case.loading import load
    from ehlpetsc.life.ensemble import run_lives

    file, begin, common = ("micropitting", "strip", OF_STRIP) if is_strip else ("wear_and_pits", "line", {})
    series = {"key": "surface.1.synthetic.seed", "values": list(seeds)}
    lives = {}
    for film, settings in (STRIP if is_strip else LINE).items():
        case = load(CASES / f"{file}.toml", common | settings | {"series": series} | (changes or {}))
        output = folder / f"{begin}_{film}.life.h5"
        index = run_lives(case, output, MPI.COMM_WORLD, unresolved=True, show=print)
        lives[film] = next(iter(read_lives(index).values()))
    return lives


def smoothing(life: LifeHistory) -> tuple[float, float, float]:
    """Root mean square height of surface 1 as made and at the end, and wear of its highest column [m]."""
    body = life.bodies[-1][0]
    crest = np.unravel_index(body.height.argmax(), body.height.shape)
    return float(body.height.std()), float(body.profile.std()), float(body.wear[crest])


def lines(lives: Lives) -> list[str]:
    """Lines on each life: limiting rates, first failures, smoothing; then the order of the films."""
    found = []
    for film, of_seeds in lives.items():
        for number, life in enumerate(of_seeds, 1):
            curve, (before, after, crest) = Curve.of(life), smoothing(life)
            found.append(
                f"lambda {film}, life {number}, {life.solved} passes to kN = {curve.worn[-1]:.2g} m^2/N: "
                f"Sq {1e9 * before:.0f} -> {1e9 * after:.0f} nm, highest crest {1e9 * crest:.0f} nm less"
            )
            passes = np.array([curve.passes(rate) for rate in RATES]).T
            for name, limit, rise, of_rates in zip(BODIES, curve.limits, curve.rise, passes, strict=True):
                first = ", ".join(f"{number:.3g}" for number in of_rates)
                found.append(
                    f"  {name}: no failure from k = {limit:.2g} m^2/N on (last round {rise:+.1%}); first "
                    f"failure at k = {', '.join(f'{rate:g}' for rate in RATES)}: {first} passes"
                )
    row = next(iter(lives.values()))[0].rows[-1]
    return [*found, f"smooth contact: {row['smooth_life_2']:.3g} passes at {row['smooth_pressure']:.3g} Pa"]


def smooth_life(lives: Lives) -> float:
    """Passes after which the smooth contact fails."""
    return next(iter(lives.values()))[0].rows[-1]["smooth_life_2"]


def over_rate(axes: Axes, lives: Lives, body: int) -> None:
    """Passes to the first failed cell of one of the `BODIES` over the rate of wear, a curve for each life."""
    curves = {film: [Curve.of(life) for life in of_seeds] for film, of_seeds in lives.items()}
    limits = [curve.limits[body] for of_film in curves.values() for curve in of_film]
    rates = np.geomspace(1e-3 * max(limits), 1.2 * max(limits), 400)
    for colour, (film, of_film) in zip(style.shades(len(lives)), curves.items(), strict=True):
        for number, curve in enumerate(of_film):
            passes = np.array([curve.passes(rate)[body] for rate in rates])
            fails = np.isfinite(passes)
            label = None if number else f"lambda {film}"
            axes.loglog(rates[fails], passes[fails], color=colour, label=label)
            still_rises = curve.rise[body] > RISES
            marker = {"mfc": "w"} if still_rises else {}
            axes.plot(rates[fails][-1:], passes[fails][-1:], "o", ms=5, color=colour, **marker)
    axes.axhline(smooth_life(lives), ls="--", color=style.DARK, label="smooth contact")
    axes.set_xlabel("rate of wear k [m²/N]")
    axes.set_title(BODIES[body], fontsize="medium", loc="left")


def draw(lives: Lives) -> Figure:
    """Passes to the first failed cell of the `BODIES` over the rate of wear, a curve for each life."""
    figure, panels = style.new_figure(1, len(BODIES), (12.0, 4.2), sharey=True)
    for body, axes in enumerate(np.ravel(panels)):
        over_rate(axes, lives, body)
    np.ravel(panels)[0].set_ylabel("passes to the first failed cell")
    np.ravel(panels)[0].set_ylim(top=30.0 * smooth_life(lives))
    np.ravel(panels)[-1].legend(**style.SMALL)
    style.set_title(
        figure, "Wear against micropits: beyond a dot no cell fails; at an open one the life ends"
    )
    return figure


def main(words: list[str] | None = None) -> None:
    """Compute, print, draw."""
    from mpi4py import MPI

    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("folder", type=Path, help="of the lives")
    parser.add_argument("--strip", action="store_true", help="that of micropitting.toml for the line")
    parser.add_argument("--seeds", default=SEEDS, type=lambda word: tuple(map(int, word.split(","))))
    parser.add_argument("--short", action="store_true", help="a coarse mesh and few passes")
    parser.add_argument("-o", "--output", type=Path, default=Path("wear_and_pits.png"), metavar="PICTURE")
    chosen = parser.parse_args(words)
    chosen.folder.mkdir(exist_ok=True, parents=True)
    lives = compute(chosen.folder, chosen.strip, chosen.seeds, SHORT if chosen.short else None)
    if MPI.COMM_WORLD.rank:
        return
    print("\n".join(lines(lives)))
    style.save(draw(lives), chosen.output)
    print(chosen.output)


if __name__ == "__main__":
    main()
