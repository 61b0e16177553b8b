"""A dimple that passes a ball on glass: centre lines of the film beside optical measurements.

``ehlpetsc python cases/paper/dimple.py [-o PICTURE]`` computes three dimples in pure rolling and with
sliding, prints the mean films behind and ahead of each on a/32, on a/64 and measured, and draws the film
along the direction of motion when the dimple is near the middle.
"""

from __future__ import annotations

from typing import NamedTuple

import measured_data
import numpy as np
from matplotlib.figure import Figure

from ehlpetsc.case.loading import load
from ehlpetsc.pictures import style
from ehlpetsc.run.simulation import Simulation

CASE = {  # Mourier, Mazuyer, Lubrecht and Donnet, Tribol. Int. 39 (2006) 1745
    "title": "Dimple on a ball",
    "contact": {
        "radius": [0.0125, 0.0125],
        "load": 15.0,
        "youngs_modulus": 100.1e9,  # E' 110 GPa
        "poisson_ratio": 0.3,
    },
    "fluid": {
        "viscosity": 0.25,
        "law": "roelands",
        "pressure_viscosity": 22e-9,
        "density": "dowson-higginson",
    },
    "motion": {"entrainment_speed": 0.09},
    "mesh": {"inlet": -2.5, "outlet": 1.5, "width": 3.5},
}
MESHES = (32, 64)  # nodes per half-width along the direction of motion, in which the film is advected
ACROSS = 32  # nodes per half-width across
RATIOS = (0.0, -1.0)  # slide/roll, 2 (u1 - u2)/(u1 + u2); the article's -0.5 is half of it
NEAR = 1.0  # widths from the middle of a dimple: nearer points belong to it
REACH = 100e-6  # m from the middle of the contact, of the means


class Dimple(NamedTuple):
    """Dimple of Gaussian shape on the ball: depth and full width at 1/e [m]."""

    depth: float
    width: float


class Line(NamedTuple):
    """Measured film along y = 0: position of the dimple, positions [um] and films [nm]."""

    at: float
    x: np.ndarray
    film: np.ndarray


DIMPLES = (Dimple(7e-6, 15e-6), Dimple(1.3e-6, 26e-6), Dimple(0.175e-6, 20e-6))
"""Dimples of radius 15.5, 21.5 and 15.5 um, as wide as where measured lines leave the range of the optics."""


def measured_line(dimple: Dimple, ratio: float) -> Line | None:
    """Measured line of a dimple at a slide/roll ratio."""
    data = measured_data.read("dimple.csv").where(depth=round(1e6 * dimple.depth, 3), slide_roll_ratio=ratio)
    return Line(data["position"][0], data["x"], data["film"]) if len(data["x"]) else None


def line(dimple: Dimple, ratio: float, at: float, points: int) -> tuple[np.ndarray, np.ndarray]:
    """Positions and films [m] along y = 0 when the dimple is at a position [um].

    The film is advected by the mean speed; with its Courant number of 1 the leading errors of space and time
    cancel.

    `points`: nodes per half-width along x.
    """
    faster = 1.0 + 0.5 * abs(ratio)
    synthetic = {"kind": "dent", "amplitude": dimple.depth, "wavelength": dimple.width}
    keys = {"motion.slide_roll_ratio": ratio, "mesh.points_per_half_width": [points, ACROSS]}
    scales = Simulation(load(CASE, keys)).scales
    distance = 2.0 * dimple.width + 1e-6 * at - scales.a * scales.grid.x[0]  # travelled by the dimple
    time = {"travel": distance / scales.a * faster / (1.0 + 0.5 * ratio), "courant": faster}
    *_, last = Simulation(load(CASE, keys | {"surface.1.synthetic": synthetic, "time": time}))
    films = last.film_thickness
    return scales.a * scales.grid.x, films[len(films) // 2]


def sides(dimple: Dimple, at: float, x: np.ndarray, film: np.ndarray) -> tuple[float, float]:
    """Mean films of the contact behind and ahead of a dimple.

    `at`: its position, as `x`; `dimple.width` in the same unit.
    """
    away, inside = (x - at) / dimple.width, np.abs(x) < REACH
    return tuple(float(film[inside & (side * away > NEAR)].mean()) for side in (-1.0, 1.0))


def draw(lines: dict[tuple[Dimple, float], tuple[np.ndarray, np.ndarray]]) -> Figure:
    """Film along y = 0: a row for each slide/roll ratio, a column for each dimple."""
    figure, panels = style.new_figure(len(RATIOS), len(DIMPLES), (9.0, 5.2), sharex=True, sharey=True)
    for (dimple, ratio), (x, film) in lines.items():
        panel = panels[RATIOS.index(ratio), DIMPLES.index(dimple)]
        panel.plot(1e6 * x, 1e9 * film, color=style.SINGLE, lw=1.4, label="computed")
        if measured := measured_line(dimple, ratio):
            panel.plot(measured.x, measured.film, "o", ms=3, color=style.DARK, label="measured")
            panel.legend(loc="lower center", **style.SMALL)
        panel.set_title(f"depth {dimple.depth * 1e6:g} µm, slide/roll {ratio:g}", fontsize="small")
        panel.set(xlim=(-160, 160), ylim=(0, 500))
        panel.grid(lw=0.3)
    for panel in panels[-1]:
        panel.set_xlabel("x [µm]")
    for panel in panels[:, 0]:
        panel.set_ylabel("film [nm]")
    style.set_title(figure, "A dimple on a ball, film along the direction of motion")
    return figure


def main(words: list[str] | None = None) -> None:
    """Print the table and write the picture."""
    parser = measured_data.parser(__doc__, "dimple.png")
    chosen = parser.parse_args(words)
    print("depth [um], slide/roll: mean film behind and ahead of the dimple [nm]")
    lines = {}
    for ratio in RATIOS:
        for dimple in DIMPLES:
            measured = measured_line(dimple, ratio)
            at, means = measured.at if measured else 0.0, []
            for points in MESHES:
                x, film = line(dimple, ratio, at, points)
                means.append(sides(dimple, 1e-6 * at, x, 1e9 * film))
            lines[dimple, ratio] = x, film
            if measured:
                means.append(sides(dimple, 1e-6 * at, 1e-6 * measured.x, measured.film))
            figures = "; ".join(f"{behind:.0f}, {ahead:.0f}" for behind, ahead in means)
            print(f"{dimple.depth * 1e6:g}, {ratio:g}: {figures}", flush=True)
    style.save(draw(lines), chosen.output)
    print(chosen.output)


if __name__ == "__main__":
    main()
