"""Thermal reduction of the central film of a ball and of a line contact in pure rolling.

``ehlpetsc python cases/paper/thermal_films.py`` prints, for three pairs of conditions, central film with heat
over the isothermal one: the line on a/50; the ball on a/12 and a/16 and, on a/12, on a wider mesh.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ehlpetsc.case.loading import load
from ehlpetsc.run.simulation import Simulation

RADIUS, MODULUS, ALPHA = 0.0191, 207e9 / 0.91, 18e-9  # m, E' [Pa], 1/Pa
BETA, CONDUCTIVITY = 0.04, 0.14  # of the oil, 1/K, W/(m K)
PAIRS = ((0.02, 7.1, 0.6e9), (0.02, 7.1, 1.2e9), (0.02, 14.0, 0.6e9))  # Pa s, m/s, Hertz pressure [Pa]
NEAR, WIDE = {"inlet": -6.0, "width": 8.0}, {"inlet": -10.0, "width": 14.0}  # half-widths
HEAT = {
    "bulk_temperature": 363.0,
    "viscosity_temperature": BETA,
    "oil_conductivity": CONDUCTIVITY,
    "oil_conductivity_pressure": 0.0,
}


def contact(kind: str, pressure: float) -> dict[str, Any]:
    """Table of the contact of a Hertz pressure [Pa]."""
    steel = {"youngs_modulus": 207e9, "poisson_ratio": 0.3}
    if kind == "line":
        half_width = 4.0 * pressure * RADIUS / MODULUS
        return steel | {"radius": RADIUS, "load": 0.5 * np.pi * half_width * pressure}
    half_width = np.pi * pressure * RADIUS / MODULUS
    return steel | {"radius": [RADIUS, RADIUS], "load": 2.0 / 3.0 * np.pi * half_width**2 * pressure}


def film(
    kind: str, pair: tuple[float, float, float], points: int, mesh: dict[str, float], heat: bool
) -> float:
    """Central film [m]."""
    viscosity, speed, pressure = pair
    extent = {key: value for key, value in mesh.items() if kind == "ball" or key != "width"}
    case = {
        "title": "Thermal reduction",
        "contact": contact(kind, pressure),
        "fluid": {
            "viscosity": viscosity,
            "law": "roelands",
            "pressure_viscosity": ALPHA,
            "density": "dowson-higginson",
        },
        "motion": {"entrainment_speed": speed, "slide_roll_ratio": 0.0},
        "mesh": {"outlet": 1.5, "points_per_half_width": points} | extent,
    }
    simulation = Simulation(load(case | ({"heat": HEAT} if heat else {})))
    (state,) = simulation
    grid = simulation.scales.grid
    distance = np.abs(grid.x) if kind == "line" else grid.distance
    return float(state.film_thickness.flat[np.argmin(distance)])


def reduction(
    kind: str, pair: tuple[float, float, float], points: int, mesh: dict[str, float] = NEAR
) -> float:
    """Central film with heat over the isothermal one."""
    return film(kind, pair, points, mesh, True) / film(kind, pair, points, mesh, False)


def moes(kind: str, pair: tuple[float, float, float]) -> tuple[float, float]:
    """Moes' load and material numbers M, L."""
    viscosity, speed, pressure = pair
    two_u = 2.0 * viscosity * speed / (MODULUS * RADIUS)
    load_number = contact(kind, pressure)["load"] / (MODULUS * RADIUS ** (1 if kind == "line" else 2))
    return load_number / two_u ** (0.5 if kind == "line" else 0.75), ALPHA * MODULUS * two_u**0.25


def main() -> None:
    """Print the table."""
    print("thermal load, Moes' L, M of the line, of the ball: line; ball on a/12, a/16, a/12 wide")
    for pair in PAIRS:
        heat_load = BETA * pair[0] * pair[1] ** 2 / CONDUCTIVITY
        (of_line, material), (of_ball, _) = moes("line", pair), moes("ball", pair)
        found = [
            reduction("line", pair, 50),
            *(reduction("ball", pair, points) for points in (12, 16)),
            reduction("ball", pair, 12, WIDE),
        ]
        figures = ", ".join(f"{value:.3f}" for value in found[1:])
        numbers = f"{heat_load:.2f}, {material:.1f}, {of_line:.0f}, {of_ball:.0f}"
        print(f"{numbers}: {found[0]:.3f}; {figures}", flush=True)


if __name__ == "__main__":
    main()
