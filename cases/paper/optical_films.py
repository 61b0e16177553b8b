"""Central films of a ball on glass beside optical measurements: table on two meshes and picture.

``ehlpetsc python cases/paper/optical_films.py [--store] [-o PICTURE]`` computes cases/optical.toml at the
measured speeds on a/16 and a/32, prints measured and computed films with their ratio and the effect of
each of `CHANGES`, and draws them over the speed.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import measured_data
import numpy as np
from matplotlib.figure import Figure

from ehlpetsc.case.loading import Case, load
from ehlpetsc.physics.contact.films import hamrock_dowson_films
from ehlpetsc.physics.oil.laws import density
from ehlpetsc.physics.scales import Scales
from ehlpetsc.pictures import style
from ehlpetsc.run.simulation import Simulation

CASE = Path(__file__).parents[1] / "optical.toml"
INDEX = 1.48  # refractive index of the oils at ambient pressure, about
MESHES = (16, 32)  # nodes per half-width
RANGE = (0.06, 1.1)  # m/s, of the mean ratio: slower films scatter, faster ones jump by a fringe

SPEED_OF_CHANGES = 0.2122  # m/s
CHANGES = {"26 degrees C": {"temperature": 26.0}, "oil m100": {"name": "m100"}}
"""Changed fields of :class:`Oil` that a film of FVA 3 depends on, by their label."""


class Oil(NamedTuple):
    """Oil by name, title and temperature [degrees C] of its films, `changes`: keys of `[fluid]` beside it.

    `logged_index`: refractive index with which the films were logged.
    """

    name: str
    title: str
    temperature: float
    logged_index: float
    changes: dict[str, float | None] = {}

    @property
    def speeds(self) -> np.ndarray:
        """Measured speeds [m/s]."""
        return DATA.where(oil=self.name)["entrainment_speed"]

    @property
    def films(self) -> np.ndarray:
        """Measured films [nm], by the refractive index of the oil at ambient pressure."""
        return DATA.where(oil=self.name)["film"] * self.logged_index / INDEX


DATA = measured_data.read("optical_films.csv")
FVA3 = Oil("fva3", "FVA 3", 25.0, 1.48)
SHC320 = Oil("shc320", "SHC 320", 38.8, 1.40)
THINNING = SHC320._replace(
    title="SHC 320, Carreau",
    changes={"fluid.carreau_stress": 0.5e6, "fluid.carreau_exponent": 0.3, "fluid.eyring_stress": None},
)  # fitted to these films
OILS = (FVA3, SHC320, THINNING)


def case_of(oil: Oil, speed: float, points: int) -> Case:
    """Case at a speed [m/s], on a mesh of so many nodes per half-width."""
    keys = {"motion.entrainment_speed": speed, "mesh.points_per_half_width": points}
    of_oil = {"fluid.oil": oil.name, "fluid.temperature": 273.15 + oil.temperature}
    return load(CASE, of_oil | keys | oil.changes)


def film(oil: Oil, speed: float, points: int) -> float:
    """Computed film in the middle [nm]."""
    simulation = Simulation(case_of(oil, speed, points))
    (state,) = simulation
    return 1e9 * float(state.film_thickness.flat[np.argmin(simulation.scales.grid.distance)])


def hamrock_dowson(oil: Oil) -> np.ndarray:
    """Central films of Hamrock and Dowson at the measured speeds [nm]."""
    case = case_of(oil, 1.0, MESHES[0])
    scales, fluid = Scales.of(case), case.fluid
    W = case.contact.load / (scales.E * scales.R**2)
    U = fluid.viscosity * oil.speeds / (scales.E * scales.R)
    G = fluid.pressure_viscosity * scales.E
    return 1e9 * scales.R * np.array([hamrock_dowson_films(u, G, W, 1.0)[0] for u in U])


def index_under_pressure(oil: Oil) -> float:
    r"""Refractive index at p0, :math:`(n^2-1)/(n^2+2)` proportional to the density (Lorentz and Lorenz)."""
    case = case_of(oil, 1.0, MESHES[0])
    refraction = (INDEX**2 - 1.0) / (INDEX**2 + 2.0) * density(Scales.of(case).p0, case.fluid)[0]
    return float(np.sqrt((1.0 + 2.0 * refraction) / (1.0 - refraction)))


def draw(computed: dict[str, np.ndarray]) -> Figure:
    """Films over the speed; `computed` by the title of the oil [nm]."""
    figure, panels = style.new_figure(1, len(OILS), (9.0, 4.2), sharey=True)
    for panel, oil in zip(panels, OILS, strict=True):
        panel.plot(oil.speeds, computed[oil.title], color=style.SINGLE, lw=1.4, label="computed")
        published = dict(color=style.SECOND, lw=1.0, ls="--", label="Hamrock, Dowson")
        panel.plot(oil.speeds, hamrock_dowson(oil), **published)
        panel.plot(oil.speeds, oil.films, "o", ms=4, color=style.DARK, label="measured")
        panel.set(xscale="log", yscale="log", xlabel="mean speed [m/s]")
        panel.set_title(f"{oil.title}, {oil.temperature:g} °C", fontsize="medium")
        panel.xaxis.set_major_formatter("{x:g}")
        panel.yaxis.set_major_formatter("{x:g}")
        panel.grid(lw=0.3, which="both")
        panel.legend(**style.SMALL)
    panels[0].set_ylabel("central film [nm]")
    style.set_title(figure, "Steel ball of 19 mm on glass, 20 N, rolling")
    return figure


def table(oil: Oil) -> np.ndarray:
    """Print the films of an oil; returns those on the fine mesh [nm]."""
    computed, published = np.empty((len(oil.speeds), len(MESHES))), hamrock_dowson(oil)
    for k, (speed, measured) in enumerate(zip(oil.speeds, oil.films, strict=True)):
        computed[k] = [film(oil, speed, points) for points in MESHES]
        figures = ", ".join(f"{value:.1f}" for value in (measured, *computed[k], published[k]))
        print(f"{oil.title}, {speed:g}: {figures}; ratio {measured / computed[k, -1]:.3f}", flush=True)
    inside = (oil.speeds > RANGE[0]) & (oil.speeds < RANGE[1])
    mean, index = float((oil.films / computed[:, -1])[inside].mean()), index_under_pressure(oil)
    print(f"mean ratio of {inside.sum()} films from {RANGE[0]:g} to {RANGE[1]:g} m/s: {mean:.3f}; ", end="")
    print(f"with the refractive index {index:.3f} at p0: {mean * INDEX / index:.3f}")
    return computed[:, -1]


def main(words: list[str] | None = None) -> None:
    """Print the tables and write the picture."""
    parser = measured_data.parser(__doc__, "optical_films.png")
    parser.add_argument("--store", action="store_true", help="computed films as a column of the file")
    chosen = parser.parse_args(words)
    meshes = ", ".join(f"on a/{points}" for points in MESHES)
    print(f"oil, speed [m/s]: film measured, {meshes}, Hamrock and Dowson [nm]")
    computed = {oil.title: table(oil) for oil in OILS}
    (unchanged,) = computed[FVA3.title][FVA3.speeds == SPEED_OF_CHANGES]
    for name, fields in CHANGES.items():
        changed = film(FVA3._replace(**fields), SPEED_OF_CHANGES, MESHES[-1])
        print(f"FVA 3 at {SPEED_OF_CHANGES} m/s, {name}: {100.0 * (changed / unchanged - 1.0):+.1f} %")
    if chosen.store:
        films = (computed[oil.title] for oil in (FVA3, SHC320))
        measured_data.store("optical_films.csv", computed=[f"{film:.1f}" for of in films for film in of])
    style.save(draw(computed), chosen.output)
    print(chosen.output)


if __name__ == "__main__":
    main()
