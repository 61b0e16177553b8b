"""Share of the load on the solids over Lambda: line, strip and layer beside published laws.

``ehlpetsc python cases/paper/shares.py [--compute] [-o PICTURE]`` prints the shares of `data/shares.csv`
beside those of `LAWS` and draws them. ``--compute`` first computes that file again by ``anisotropy.py film``,
in six minutes of processor time, and prints the effect of each of `CHANGES` on line and strip.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import NamedTuple

import anisotropy
import measured_data
import numpy as np
from matplotlib.figure import Figure
from scipy.special import erf

from ehlpetsc.pictures import style

FILE = "shares.csv"


class Computed(NamedTuple):
    """Lay and nodes per half-width of :mod:`anisotropy`, symbol of the picture, outlet [half-widths]."""

    lay: float
    points: int
    symbol: str
    outlet: str = "1.5"


MODELS = {
    "line": Computed(0.01, 128, "s"),
    "strip": Computed(1.0, 64, "o", "2"),
    "layer": Computed(0.0, 64, "^"),
}


SPEED_OF_CHANGES = 3.3  # m/s, Lambda 0.73
CHANGES: dict[str, Callable[[Computed], list[str]]] = {
    "mesh twice as coarse": lambda of: ["--points", str(of.points // 2)],
    "seeds 4, 5": lambda of: ["--seed", "2"],
    "seeds 6, 7": lambda of: ["--seed", "3"],
    "border 79.9 um": lambda of: ["--border", "79.9e-6"],
}
"""Changed arguments of :mod:`anisotropy` that the share depends on, by their label."""


def exponential(b: float, c: float) -> Callable[[np.ndarray], np.ndarray]:
    r""":math:`\exp(-B\Lambda^C)`."""
    return lambda ratio: np.exp(-b * ratio**c)


def doleschel(ratio: np.ndarray) -> np.ndarray:
    r""":math:`(1-\lambda/2)^2` up to :math:`\lambda=2`, of the film over the mean of both Ra.

    Here of two surfaces of equal, normally distributed heights: :math:`\lambda=\sqrt\pi\,\Lambda`.
    """
    return np.maximum(1.0 - 0.5 * np.sqrt(np.pi) * np.asarray(ratio), 0.0) ** 2


LAWS: dict[str, Callable[[np.ndarray], np.ndarray]] = {
    "Clarke: 1 - erf": lambda ratio: 1.0 - erf(ratio),
    "Zhou, Hoeprich, 0.10 µm": exponential(2.1, 0.85),
    "Zhou, Hoeprich, 0.16 µm": exponential(2.32, 0.97),
    "Zhou, Hoeprich, 0.24 µm": exponential(1.90, 0.99),
    "Aihara": exponential(1.8, 1.2),
    "Doleschel": doleschel,
}
"""Each author has his own Lambda.

- Clarke: chosen by Arana et al. (Proc. IMechE J 233 (2019) 303, equation 14) to meet the limits, 1 at 0 and
  0 at 2, of electric resistances of axially ground discs by Clarke, Weeks, Evans et al. (Tribol. Int. 93
  (2016) 709);
- Zhou, Hoeprich (J. Tribol. 113 (1991) 590, equation 29): computed dry contact of measured ground profiles
  after running in, longitudinal, elastic and ideally plastic. They print no constants, which come from their
  curves by Wingertszahn et al. (Lubricants 11 (2023) 369, tables 4 and A2), for three rms heights;
- Aihara (J. Tribol. 109 (1987) 471, equation 13): computed with the flow model of Patir and Cheng (1978),
  below 0.4 GPa, longitudinal roughness, central film;
- Doleschel, by Arana et al., table 1: of gears, tested by friction alone.
"""


def computed(of: Computed, speed: float, changes: Iterable[str] = ()) -> anisotropy.Film:
    """Film of a model at a speed [m/s]; `changes`: arguments of :mod:`anisotropy`."""
    words = ["film", "--width", "0.5", "--points", str(of.points), "--outlet", of.outlet, *changes]
    return anisotropy.lubricated(anisotropy.arguments().parse_args(words), of.lay, speed)


def influences() -> None:
    """Print the share with each of `CHANGES`."""
    for model in ("line", "strip"):
        of = MODELS[model]
        for change, words in CHANGES.items():
            share = computed(of, SPEED_OF_CHANGES, words(of)).share
            print(f"{model} at {SPEED_OF_CHANGES} m/s, {change}: share {share:.4f}", flush=True)


def compute() -> None:
    """Write `FILE` anew, at its speeds."""
    keys = (measured_data.read(FILE).columns[key] for key in ("model", "speed"))
    found = [computed(MODELS[model], float(speed)) for model, speed in zip(*keys, strict=True)]
    measured_data.store(
        FILE,
        lambda_ratio=[f"{film.lambda_ratio:.2f}" for film in found],
        friction=[f"{film.friction:.4f}" for film in found],
        share=[f"{film.share:.4f}" for film in found],
    )


def draw(data: measured_data.Measured) -> Figure:
    """Share over Lambda, points of the models and lines of the laws."""
    figure, panel = style.new_figure(1, 1, (6.4, 4.4))
    dense = np.geomspace(0.02, 3.0, 100)
    for (name, law), colour in zip(LAWS.items(), style.shades(len(LAWS)), strict=True):
        panel.plot(dense, law(dense), color=colour, lw=1.2, label=name)
    for model, of in MODELS.items():
        rows = data.where(model=model)
        label = f"computed: {model}"
        panel.plot(
            rows["lambda_ratio"], rows["share"], of.symbol + "--", color=style.DARK, lw=0.6, label=label
        )
    panel.set(xscale="log", xlabel="Lambda", ylabel="share of load on the solids", ylim=(0.0, 1.05))
    panel.xaxis.set_major_formatter("{x:g}")
    panel.grid(lw=0.3)
    panel.legend(**style.SMALL)
    style.set_title(figure, "Load on the solids: one spectrum and oil (points), published laws (lines)")
    return figure


def main(words: list[str] | None = None) -> None:
    """Print the table and write the picture."""
    parser = measured_data.parser(__doc__, "shares.png")
    parser.add_argument("--compute", action="store_true", help="compute the shares again")
    chosen = parser.parse_args(words)
    if chosen.compute:
        compute()
        influences()
    data = measured_data.read(FILE)
    print("Lambda: " + ", ".join([*MODELS, *LAWS]))
    for speed in dict.fromkeys(data.columns["speed"]):
        at_speed = [data.where(model=model, speed=speed) for model in MODELS]
        shares, ratio = [rows["share"][0] for rows in at_speed], at_speed[0]["lambda_ratio"][0]
        laws = [float(law(ratio)) for law in LAWS.values()]
        print(f"{ratio:g}: " + ", ".join(f"{share:.3f}" for share in (*shares, *laws)))
    style.save(draw(data), chosen.output)
    print(chosen.output)


if __name__ == "__main__":
    main()
