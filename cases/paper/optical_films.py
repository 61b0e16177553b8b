"""Central films of a ball on glass beside optical measurements: table on two meshes and picture.

``ehlpetsc python cases/paper/optical_films.py [-o PICTURE]`` computes the point contact of `CASE` at the
measured speeds on a/16 and a/32, prints measured and computed films with their ratio, and draws them over the
speed.
"""

from __future__ import annotations

import argparse
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure

from ehlpetsc.case.loading import Case, load
from ehlpetsc.physics.film_formulas import hamrock_dowson_films
from ehlpetsc.physics.laws import density
from ehlpetsc.physics.scales import Scales
from ehlpetsc.pictures import style
from ehlpetsc.run.simulation import Simulation

CASE = {
    "title": "Ball on a glass disc",
    "contact": {
        "radius": [9.525e-3, 9.525e-3],
        "load": 20.0,
        "youngs_modulus": [207e9, 75e9],
        "poisson_ratio": [0.3, 0.22],
    },
    "motion": {"entrainment_speed": 1.0},
    "mesh": {"inlet": -4.5, "outlet": 1.5, "width": 6.0},
}
MESHES = (16, 32)  # nodes per half-width
RANGE = (0.06, 1.1)  # m/s, of the mean ratio: slower films scatter, faster ones jump by a fringe


class Oil(NamedTuple):
    """Oil of the films at a temperature [degrees C].

    `index`, `assumed_index`: refractive index at ambient pressure, and the one of the logged films.
    `changes`: keys of `[fluid]` that differ from the oil of this name.
    """

    name: str
    temperature: float
    index: float
    assumed_index: float
    changes: dict[str, float | None]
    speeds: tuple[float, ...]
    logged: tuple[float, ...]

    @property
    def films(self) -> np.ndarray:
        """Measured films [nm], by the refractive index at ambient pressure."""
        return np.array(self.logged) * self.assumed_index / self.index


FVA3 = Oil(
    "fva3",
    25.0,
    1.48,
    1.48,
    {},
    (
        *(0.0210, 0.02435, 0.02885, 0.03553, 0.04226, 0.05008, 0.06013, 0.07135, 0.08593, 0.1028, 0.1239),
        *(0.1486, 0.1777, 0.2122, 0.2549, 0.3064, 0.3664, 0.4408, 0.5289, 0.6353, 0.7624, 0.9149, 1.098),
        *(1.318, 1.584, 1.899),
    ),
    (
        *(49.7, 55.9, 66.5, 81.3, 94.3, 108.5, 132.5, 153.5, 167.5, 187.0, 220.0),
        *(249.8, 284.4, 321.2, 372.5, 412.7, 464.6, 524.6, 589.4, 652.7, 724.1, 800.9, 860.2),
        *(945.7, 992.8, 1199.0),
    ),
)
"""Steel ball of 19.05 mm driven by the disc, 20 N: logs of github.com/ngocminhdao88/dao_masterarbeit, 2018."""


OILS = (FVA3,)


def case_of(oil: Oil, speed: float, points: int) -> Case:
    """Case at a speed [m/s], on a mesh of so many nodes per half-width."""
    keys = {"motion.entrainment_speed": speed, "mesh.points_per_half_width": points}
    changes = {f"fluid.{key}": value for key, value in oil.changes.items()}
    return load(CASE, {"fluid.oil": oil.name, "fluid.temperature": 273.15 + oil.temperature} | keys | changes)


def film(oil: Oil, speed: float, points: int) -> float:
    """Computed film in the middle [nm]."""
    simulation = Simulation(case_of(oil, speed, points))
    (state,) = simulation
    return 1e9 * float(state.film_thickness[np.argmin(simulation.scales.grid.distance)])


def hamrock_dowson(oil: Oil) -> np.ndarray:
    """Central films of Hamrock and Dowson at the measured speeds [nm]."""
    case = case_of(oil, 1.0, MESHES[0])
    scales, fluid = Scales.of(case), case.fluid
    W = case.contact.load / (scales.E * scales.R**2)
    U = fluid.viscosity * np.array(oil.speeds) / (scales.E * scales.R)
    G = fluid.pressure_viscosity * scales.E
    return 1e9 * scales.R * np.array([hamrock_dowson_films(u, G, W, 1.0)[0] for u in U])


def index_under_pressure(oil: Oil) -> float:
    r"""Refractive index at p0, :math:`(n^2-1)/(n^2+2)` proportional to the density (Lorentz and Lorenz)."""
    case = case_of(oil, 1.0, MESHES[0])
    refraction = (oil.index**2 - 1.0) / (oil.index**2 + 2.0) * density(Scales.of(case).p0, case.fluid)[0]
    return float(np.sqrt((1.0 + 2.0 * refraction) / (1.0 - refraction)))


def draw(oil: Oil, computed: np.ndarray) -> Figure:
    """Measured and computed films over the speed [nm, m/s]."""
    figure, panel = style.new_figure(1, 1, (5.2, 4.2))
    panel.plot(oil.speeds, computed, color=style.SINGLE, lw=1.4, label="computed")
    panel.plot(oil.speeds, hamrock_dowson(oil), color=style.SECOND, lw=1.0, ls="--", label="Hamrock, Dowson")
    panel.plot(oil.speeds, oil.films, "o", ms=4, color=style.DARK, label="measured")
    panel.set(xscale="log", yscale="log", xlabel="mean speed [m/s]", ylabel="central film [nm]")
    panel.grid(lw=0.3, which="both")
    panel.legend(**style.SMALL)
    style.set_title(figure, f"Ball on glass, 20 N, {oil.name}, {oil.temperature:g} °C")
    return figure


def main(words: list[str] | None = None) -> None:
    """Print the table and write the picture."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("-o", "--output", default="optical_films.png", help="picture [optical_films.png]")
    chosen = parser.parse_args(words)
    oil, published = FVA3, hamrock_dowson(FVA3)
    print(
        "speed [m/s]: film measured, " + ", ".join(f"on a/{n}" for n in MESHES) + ", Hamrock and Dowson [nm]"
    )
    computed = np.empty((len(oil.speeds), len(MESHES)))
    for k, (speed, measured) in enumerate(zip(oil.speeds, oil.films, strict=True)):
        computed[k] = [film(oil, speed, points) for points in MESHES]
        figures = ", ".join(f"{value:.1f}" for value in (measured, *computed[k], published[k]))
        print(f"{speed:g}: {figures}; ratio {measured / computed[k, -1]:.3f}", flush=True)
    inside = (np.array(oil.speeds) > RANGE[0]) & (np.array(oil.speeds) < RANGE[1])
    mean = float((oil.films / computed[:, -1])[inside].mean())
    print(f"mean ratio of {inside.sum()} films from {RANGE[0]:g} to {RANGE[1]:g} m/s: {mean:.3f}")
    index = index_under_pressure(oil)
    print(f"with the refractive index {index:.3f} at p0: {mean * oil.index / index:.3f}")
    style.save(draw(oil, computed[:, -1]), chosen.output)
    print(chosen.output)


if __name__ == "__main__":
    main()
