"""Torque of a flooded tapered roller bearing 32008 beside measurements, at two supply temperatures.

``./run_mpi.sh python cases/paper/bearing_torque.py [-o PICTURE]`` computes the rolling friction of both
raceways as smooth line contacts with heat, at the speeds of `data/bearing_32008.csv`, prints measured and
computed torque with the effect of each of `CHANGES`, and draws them over the speed. Nothing is fitted.

Not in it: the rib and the roller ends (see :func:`rib`), the cage, the churned oil, the crowns of the
rollers, microslip, rings hotter than the supply. Speeds in proportion to the diameter of a roller, 11 % from
end to end, change rolling friction by next to nothing (:func:`cone_friction`).
"""

from __future__ import annotations

from typing import Any, NamedTuple

import measured_data
import numpy as np
from matplotlib.figure import Figure

from ehlpetsc.case.loading import Case, load
from ehlpetsc.physics.oil.viscosity_laws import KELVIN, walther, walther_constants
from ehlpetsc.pictures import style
from ehlpetsc.run.simulation import Simulation

AXIAL_LOAD, ROLLERS, LENGTH = 12.85e3, 23, 13.66e-3  # N, of a roller [m]
DIAMETERS = 6.131e-3, 6.846e-3  # of a roller at both ends [m]
CUP, CONE = np.radians(14.17), np.radians(11.17)  # half angles of the raceways
PITCH_RADIUS = 27e-3  # m
OIL, V40, V100, DENSITY = "fva3", 90.02e-6, 10.41e-6, 884.0  # m^2/s, kg/m^3 of FVA 3A
ROLLER = 0.25 * sum(DIAMETERS)  # mean radius [m]
TILT = 0.5 * (CUP + CONE)  # of a roller's axis
RIB_HEIGHT = 1e-3  # m of the contact of roller end and rib above the raceway, assumed
MESH = {"inlet": -16.0, "outlet": 1.5, "points_per_half_width": 60}
CHANGES: dict[str, dict[str, Any]] = {
    "a/120": {"mesh.points_per_half_width": 120},
    "inlet at 8 a": {"mesh.inlet": -8.0},
    "46 W/(m K) of soft steel": {"heat.conductivity": 46.0},
    "isothermal": {"heat": None},
}
"""Changed keys of the assumptions that the torque depends on, by their label."""


class Raceway(NamedTuple):
    """Raceway: its radius and that of the contact [m], load of a roller on it [N]."""

    radius: float
    reduced: float
    load: float


def raceways() -> tuple[Raceway, Raceway]:
    """Cup and cone: radii normal to the surface, loads of a roller in balance with its rib along its axis."""
    offset, load = ROLLER * np.cos(TILT), AXIAL_LOAD / (ROLLERS * np.sin(CUP))
    outer, inner = (PITCH_RADIUS + offset) / np.cos(CUP), (PITCH_RADIUS - offset) / np.cos(CONE)
    of_outer, of_inner = 1.0 / (1.0 / ROLLER - 1.0 / outer), 1.0 / (1.0 / ROLLER + 1.0 / inner)
    return Raceway(outer, of_outer, load), Raceway(inner, of_inner, load)


def rolling_speed(rotation: float) -> float:
    """Speed of both surfaces through a contact [m/s], inner ring at `rotation` [1/min] and pure rolling."""
    gamma = ROLLER * np.cos(TILT) / PITCH_RADIUS
    return float(np.pi / 60.0 * rotation * PITCH_RADIUS * (1.0 - gamma**2))


def viscosity(temperature: float) -> float:
    """Viscosity of FVA 3A [Pa s], by Walther's law, at a temperature [K]."""
    nu, _ = walther(temperature, *walther_constants(V40, V100))
    return float(1e-6 * nu) * DENSITY


def case_of(raceway: Raceway, rotation: float, celsius: float, changes: dict[str, Any]) -> Case:
    """Line contact of a roller and a raceway at a supply temperature; `changes`: keys of the case."""
    temperature = celsius + KELVIN
    case = {
        "title": "Tapered roller bearing 32008",
        "contact": {
            "radius": raceway.reduced,
            "load": raceway.load / LENGTH,
            "material": "100Cr6",
        },
        "fluid": {
            "oil": OIL,
            "temperature": temperature,
            "viscosity": viscosity(temperature),
        },
        "heat": {"bulk_temperature": temperature, "conductivity": 21.0},
        "motion": {"entrainment_speed": rolling_speed(rotation), "slide_roll_ratio": 0.0},
        "mesh": MESH,
    }
    return load(case, changes)


def rolling_moment(case: Case) -> float:
    """Moment of the pressure about the middle of a contact per length [N], against the motion."""
    simulation = Simulation(case)
    (state,) = simulation
    x = simulation.scales.a * simulation.scales.grid.x
    return -float((state.pressure * x).sum() * (x[1] - x[0]))


def torque(rotation: float, celsius: float, changes: dict[str, Any] | None = None) -> float:
    """Torque of both raceways [N m]."""
    cup, cone = raceways()
    outer, inner = (rolling_moment(case_of(of, rotation, celsius, changes or {})) for of in (cup, cone))
    return ROLLERS / (2.0 * ROLLER) * (cup.radius * inner + cone.radius * outer) * LENGTH


def rib(friction: float) -> float:
    """Torque of the rib [N m] by a friction coefficient of the roller ends, at `RIB_HEIGHT`.

    A rib carries the difference of both raceways' normals, 2 Q sin((CUP - CONE)/2), at the speed of spin.
    """
    force = 2.0 * raceways()[0].load * np.sin(0.5 * (CUP - CONE))
    spin = 0.5 * PITCH_RADIUS / ROLLER  # of a roller over the speed of the inner ring, about
    return float(ROLLERS * friction * force * RIB_HEIGHT * spin)


def cone_friction(rotation: float, has_own_speeds: bool = False) -> float:
    """Rolling friction of a crowned roller on the cone [N], isothermal at 55 degrees C.

    `has_own_speeds`: whether its rows have their own speeds, in proportion to the diameter of the roller.
    """
    _, cone = raceways()
    small, large = DIAMETERS
    speed, temperature = rolling_speed(rotation), 55.0 + KELVIN
    spin = speed * (large - small) / (large + small) / (0.5 * LENGTH) if has_own_speeds else 0.0
    profile = {"kind": "iso", "diameter": 2.0 * ROLLER}
    contact = {"radius": cone.reduced, "length": LENGTH, "load": cone.load, "material": "100Cr6"}
    case = {
        "title": "Roller of a tapered roller bearing 32008",
        "contact": contact | {"profile": profile},
        "fluid": {"oil": OIL, "temperature": temperature, "viscosity": viscosity(temperature)},
        "motion": {"entrainment_speed": speed, "spin": [spin, spin]},
        "mesh": {"inlet": -6.0, "outlet": 2.4, "points_per_half_width": [10, 40]},
    }
    (state,) = Simulation(load(case))
    return -0.5 * float(state.friction + state.friction_1)


def draw(data: measured_data.Measured, computed: dict[float, np.ndarray]) -> Figure:
    """Torque over the speed, a colour for each supply temperature."""
    figure, panel = style.new_figure(1, 1, (6.0, 4.2))
    for (celsius, values), colour in zip(computed.items(), style.shades(len(computed)), strict=True):
        rows = data.where(temperature=celsius)
        bars = dict(fmt="o", ms=4, lw=0.8, capsize=2, color=colour)
        panel.errorbar(rows["rotation"], rows["torque"], yerr=0.08 * rows["torque"], **bars)
        panel.plot(rows["rotation"], values, color=colour, label=f"supply at {celsius:g} °C")
    panel.set(xlabel="speed of the inner ring [1/min]", ylabel="torque [N m]")
    panel.set_ylim(bottom=0.0)
    panel.grid(lw=0.3)
    panel.legend(**style.SMALL)
    style.set_title(figure, "Bearing 32008, 12.85 kN: raceways (lines), measured (points, 8 %)")
    return figure


def main(words: list[str] | None = None) -> None:
    """Print the tables and write the picture."""
    parser = measured_data.parser(__doc__, "bearing_torque.png")
    chosen = parser.parse_args(words)
    data, computed = measured_data.read("bearing_32008.csv"), {}
    print("supply [degrees C], speed [1/min]: torque [N m] measured; computed; ratio")
    for celsius in map(float, np.unique(data.columns["temperature"])):
        rows = data.where(temperature=celsius)
        computed[celsius] = np.array([torque(rotation, celsius) for rotation in rows["rotation"]])
        for rotation, value, found in zip(rows["rotation"], rows["torque"], computed[celsius], strict=True):
            print(f"{celsius:g}, {rotation:g}: {value:.2f}; {found:.3f}; {found / value:.2f}", flush=True)
    at = np.array([400.0, 2200.0])
    first = np.array([torque(rotation, 55.0) for rotation in at])
    hotter = np.array([torque(at[1], 75.0)])
    print(f"rings and oil at 75 degrees C, 2,200 1/min: {hotter[0]:.3f} N m")
    for name, changes in CHANGES.items():
        change = 100.0 * (np.array([torque(rotation, 55.0, changes) for rotation in at]) / first - 1.0)
        print(f"55, 400 and 2,200 1/min, {name}: {change[0]:+.1f}, {change[1]:+.1f} %", flush=True)
    change = 100.0 * (cone_friction(at[0], has_own_speeds=True) / cone_friction(at[0]) - 1.0)
    print(f"rows at their own speeds, 400 1/min: {change:+.3f} %")
    print(
        f"rib: {rib(0.01):.2f} N m for each 0.01 of friction of the roller ends, {1e3 * RIB_HEIGHT:g} mm high"
    )
    style.save(draw(data, computed), chosen.output)
    print(chosen.output)


if __name__ == "__main__":
    main()
