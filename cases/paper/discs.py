"""Friction of twin discs beside measurements: table, influences and picture.

``./run_mpi.sh python cases/paper/discs.py [--store] [-o PICTURE]`` computes `cases/discs.toml` with the oils
and speeds of `data/discs.csv` on a/60, prints measured and computed friction with their ratio, the effect of
each of `CHANGES`, and draws friction over the slide/roll ratio.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any, NamedTuple

import measured_data
import numpy as np
from matplotlib.figure import Figure

from ehlpetsc.case.loading import load
from ehlpetsc.pictures import style
from ehlpetsc.run.simulation import Simulation

CASE = Path(__file__).parents[1] / "discs.toml"
DENSE = np.geomspace(0.003, 0.4, 15)  # of the curves
SHIFTS = (0.95, 1.0, 1.05)  # of measured points, so that their bars do not overlap
POINTS = 60  # nodes per half-width
BAND = 0.005  # of the measured coefficients
SECOND_OIL = "m100"  # FVA 3, measured by Arana et al.
AS_SECOND_OIL = f"FVA 3 as oil {SECOND_OIL}"
PANELS = {"FVA 3": ("fva3",), "at 4 m/s": ("fva3", "n100", "pao100")}
NAMES = {"fva3": "FVA 3, mineral", "n100": "N100, naphthenic", "pao100": "PAO100"}
CHANGES: dict[str, dict[str, Any]] = {
    "a/30": {"mesh.points_per_half_width": 30},
    "46 W/(m K) of soft steel": {"heat.conductivity": 46.0},
    "isothermal": {"heat": None, "fluid.temperature": 333.15},
    "no limit of the shear stress": {"fluid.limiting_shear": 1.0},
    "Eyring stress constant over pressure": {"fluid.eyring_stress_pressure": 0.0},
    AS_SECOND_OIL: {"fluid.oil": SECOND_OIL},
}
"""Changed keys of the assumptions that friction depends on, by their label."""


class Curve(NamedTuple):
    """Friction coefficients of an oil at a mean speed [m/s] over slide/roll ratios."""

    oil: str
    speed: float
    ratios: np.ndarray
    friction: np.ndarray


def _curves() -> tuple[Curve, ...]:
    data = measured_data.read("discs.csv")
    keys = zip(data.columns["oil"], data.columns["entrainment_speed"], strict=True)
    rows = {key: data.where(oil=key[0], entrainment_speed=key[1]) for key in dict.fromkeys(keys)}
    return tuple(
        Curve(str(oil), float(speed), of["slide_roll_ratio"], of["friction"])
        for (oil, speed), of in rows.items()
    )


MEASURED = _curves()


def friction(oil: str, speed: float, ratio: float, changes: dict[str, Any] | None = None) -> float:
    """Computed friction coefficient at a slide/roll ratio; `changes`: keys of the case."""
    keys = {"fluid.oil": oil, "motion.entrainment_speed": speed, "motion.slide_roll_ratio": float(ratio)}
    case = load(CASE, keys | {"series": None, "mesh.points_per_half_width": POINTS} | (changes or {}))
    (state,) = Simulation(case)
    return float(state.scalars["friction_coefficient"])


def computed(changes: dict[str, Any] | None = None) -> np.ndarray:
    """Computed friction coefficients, a row for each of `MEASURED`; another oil replaces FVA 3 alone."""
    others = {key: value for key, value in (changes or {}).items() if key != "fluid.oil"}
    return np.array(
        [
            [friction(m.oil, m.speed, ratio, changes if m.oil == "fva3" else others) for ratio in m.ratios]
            for m in MEASURED
        ]
    )


def agreement(found: np.ndarray) -> str:
    """Points within 8 and 15 %, and mean ratio of FVA 3, as a line."""
    ratios = found / np.array([m.friction for m in MEASURED])
    error, mean = np.abs(ratios - 1.0), ratios[[m.oil == "fva3" for m in MEASURED]].mean()
    inside = " and ".join(str((error <= limit).sum()) for limit in (0.08, 0.15))
    return f"{inside} of {error.size} points within 8 and 15 %, mean ratio of FVA 3 {mean:.2f}"


def draw() -> Figure:
    """Friction over the slide/roll ratio, for the speeds of FVA 3 and for three oils at one speed."""
    figure, panels = style.new_figure(1, 2, (9.0, 4.2), sharey=True)
    curves = {
        of: [friction(*of, ratio, CHANGES["a/30"]) for ratio in DENSE]
        for of in {(m.oil, m.speed) for m in MEASURED}
    }
    for panel, (title, oils) in zip(panels, PANELS.items(), strict=True):
        shown = [m for m in MEASURED if m.oil in oils and (len(oils) == 1 or m.speed == 4.0)]
        for measured, colour, shift in zip(shown, style.shades(len(shown)), SHIFTS, strict=True):
            label = f"{measured.speed:g} m/s" if len(oils) == 1 else NAMES[measured.oil]
            panel.plot(DENSE, curves[measured.oil, measured.speed], color=colour, lw=1.4, label=label)
            bars = dict(fmt="o", ms=4, lw=0.8, capsize=2, color=colour)
            panel.errorbar(measured.ratios * shift, measured.friction, yerr=BAND, **bars)
        panel.set(xscale="log", xlabel=style.LABELS["motion.slide_roll_ratio"], ylim=(0.0, 0.06))
        panel.set_title(title, fontsize="medium")
        panel.xaxis.set_major_formatter("{x:g}")
        panel.grid(lw=0.3)
        panel.legend(loc="lower right", **style.SMALL)
    panels[0].set_ylabel("friction coefficient")
    style.set_title(figure, "Twin discs, 1 GPa, 60 °C: computed (lines) and measured (points, ± 0.005)")
    return figure


def main(words: list[str] | None = None) -> None:
    """Print the tables and write the picture."""
    parser = measured_data.parser(__doc__, "discs.png")
    parser.add_argument("--store", action="store_true", help="computed friction as columns of the file")
    chosen = parser.parse_args(words)
    print(f"oil, speed [m/s], slide/roll ratio: measured; computed on a/{POINTS}")
    published = computed()
    for measured, row in zip(MEASURED, published, strict=True):
        for ratio, value, found in zip(measured.ratios, measured.friction, row, strict=True):
            at = f"{measured.oil}, {measured.speed:g}, {ratio:g}: {value:.4f}"
            print(f"{at}; {found:.4f}; ratio {found / value:.3f}")
    print(agreement(published), flush=True)
    changed = {}
    for name, changes in CHANGES.items():
        found = changed[name] = computed(changes)
        change = 100.0 * (found / published - 1.0)
        print(f"{name}: {change.min():+.1f} to {change.max():+.1f} %; {agreement(found)}", flush=True)
    if chosen.store:
        of_oils = {"computed": published, SECOND_OIL: changed[AS_SECOND_OIL]}
        columns = {name: [f"{value:.4f}" for value in found.flat] for name, found in of_oils.items()}
        measured_data.store("discs.csv", **columns)
    style.save(draw(), chosen.output)
    print(chosen.output)


if __name__ == "__main__":
    main()
