"""Smooth circular contacts by Moes' numbers: computed films on three meshes beside film formulas.

``python cases/paper/point_films.py`` prints, for each M and L, the central and minimum film H computed on
a/16, a/32 and a/64, their limit by Richardson's extrapolation from the two finest meshes (order 2), and the
formulas of Nijenbanning, Venner and Moes (1994) and of Hamrock and Dowson (1977).
"""

from __future__ import annotations

import numpy as np

from ehlpetsc.case.loading import load
from ehlpetsc.physics.contact.geometry import hamrock_dowson_films, nijenbanning_central_film
from ehlpetsc.run.simulation import Simulation

GROUPS = ((20.0, 10.0), (50.0, 5.0), (100.0, 10.0), (200.0, 5.0), (200.0, 10.0))  # M, L
MESHES = (16, 32, 64)  # nodes per half-width
MODULUS, RADIUS = 231e9, 0.0127  # E' [Pa], m
ALPHA, VISCOSITY = 22e-9, 0.04  # 1/Pa, Pa s


def tables(M: float, L: float, points: int, modulus: float = MODULUS, radius: float = RADIUS) -> dict:
    """Case of a ball of Moes' numbers M and L on -2.5 to 1.5 a."""
    two_u = (L / (ALPHA * modulus)) ** 4
    return {
        "title": f"M = {M:g}, L = {L:g}",
        "contact": {
            "radius": [radius, radius],
            "load": M * modulus * radius * radius * two_u**0.75,
            "youngs_modulus": 0.91 * modulus,  # two bodies of Poisson's ratio 0.3
            "poisson_ratio": 0.3,
        },
        "fluid": {
            "viscosity": VISCOSITY,
            "law": "roelands",
            "roelands_z": 0.68,
            "pressure_viscosity": ALPHA,
            "density": "dowson-higginson",
            "gamma": 2.3e-9,
            "lambda": 1.7e-9,
        },
        "motion": {"entrainment_speed": 0.5 * two_u * modulus * radius / VISCOSITY},
        "mesh": {"inlet": -2.5, "outlet": 1.5, "width": 4.0, "points_per_half_width": points},
    }


def films(M: float, L: float, points: int) -> np.ndarray:
    """Computed central and minimum film H."""
    simulation = Simulation(load(tables(M, L, points)))
    (state,) = simulation
    grid, unit = simulation.scales.grid, RADIUS * (L / (ALPHA * MODULUS)) ** 2
    return np.array([state.film_thickness.flat[np.argmin(grid.distance)], state.h_min]) / unit


def formulas(M: float, L: float) -> tuple[float, float, float]:
    """Central film H of Nijenbanning, Venner and Moes; central and minimum film of Hamrock and Dowson."""
    G, two_u = ALPHA * MODULUS, (L / (ALPHA * MODULUS)) ** 4
    central, minimum = hamrock_dowson_films(0.5 * two_u, G, M * two_u**0.75, 1.0)
    return nijenbanning_central_film(M, L, 1.0), central / two_u**0.5, minimum / two_u**0.5


def main() -> None:
    """Print the table."""
    print("M, L: Hc on a/16, a/32, a/64, limit; two formulas: Hm on the same; formula")
    for M, L in GROUPS:
        found = np.array([films(M, L, points) for points in MESHES])
        limit = found[-1] + (found[-1] - found[-2]) / 3.0
        nijenbanning, central, minimum = formulas(M, L)
        rows = [", ".join(f"{value:.3f}" for value in (*h, x)) for h, x in zip(found.T, limit, strict=True)]
        of_formulas = f"{nijenbanning:.3f}, {central:.3f}: {rows[1]}; {minimum:.3f}"
        print(f"{M:g}, {L:g}: {rows[0]}; {of_formulas}", flush=True)


if __name__ == "__main__":
    main()
