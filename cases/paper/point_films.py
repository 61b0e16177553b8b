"""Smooth point contacts by Moes' numbers: computed films beside film formulas.

``python cases/paper/point_films.py`` prints, for M and L of `GROUPS`, the central and minimum film H of a
ball computed on a/16, a/32 and a/64, their limit by Richardson's extrapolation from the two finest meshes
(order 2), and the formulas of Nijenbanning, Venner and Moes (1994) and of Hamrock and Dowson (1977).

``--compute`` computes `FILE` again, films of ellipses over `RANGE` and their fit, the coefficients of
`ehlpetsc.physics.contact.films`, in eight minutes of processor time.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Iterator
from itertools import product
from typing import NamedTuple

import measured_data
import numpy as np

from ehlpetsc.base.errors import NotConverged
from ehlpetsc.case.loading import load
from ehlpetsc.physics.contact.films import (
    POINT_COMPRESSION,
    fit_terms,
    hamrock_dowson_films,
    nijenbanning_central_film,
)
from ehlpetsc.physics.film_formulas import expected_film, points_for_opening
from ehlpetsc.physics.oil.laws import density
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.simulation import Simulation

GROUPS = ((20.0, 10.0), (50.0, 5.0), (100.0, 10.0), (200.0, 5.0), (200.0, 10.0))  # M, L
MESHES = (16, 32, 64)  # nodes per half-width
MODULUS, RADIUS = 231e9, 0.0127  # E' [Pa], m
ALPHA, VISCOSITY = 22e-9, 0.04  # 1/Pa, Pa s

FILE = "point_films.csv"
RANGE = (0.2, 0.5, 1.0, 3.0, 10.0), (20.0, 60.0, 200.0, 700.0, 2500.0, 8000.0), (2.0, 5.0, 10.0, 15.0)
MAX_PRESSURE = 4e9  # Pa, Hertz': harder pressed films of `RANGE` are left out
COARSEST, OPENING = 24, 0.3  # nodes per half-width; films by which the gap opens on the coarsest mesh
MAX_NODES = 1_000_000  # of a mesh, 2.1 GB
SETTLED, USED = (
    1.05,
    1.1,
)  # limit over the minimum film on the finest mesh: no finer one; at most, of the file
LIGHT = 0.2  # a^2/R: films above it need a wide mesh


class Films(NamedTuple):
    """Central and minimum film H, and the density at p0 over that at ambient pressure."""

    central: float
    minimum: float
    density: float


def tables(
    M: float,
    L: float,
    points: int,
    modulus: float = MODULUS,
    radius: float = RADIUS,
    ratio: float = 1.0,
    sides: tuple[float, float] = (-2.5, 2.0),
) -> dict:
    """Case of a point contact of Moes' numbers M and L, its radius across `ratio` times that along.

    `sides`: inlet, and half the width of the mesh in half-widths.
    """
    two_u = (L / (ALPHA * modulus)) ** 4
    return {
        "title": f"M = {M:g}, L = {L:g}",
        "contact": {
            "radius": [radius, ratio * radius],
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
        "mesh": {
            "inlet": sides[0],
            "outlet": 1.5,
            "width": 2.0 * sides[1],
            "points_per_half_width": points if ratio == 1.0 else [points, points],
        },
    }


def films(given: dict) -> np.ndarray:
    """Computed central and minimum film H of a case."""
    simulation = Simulation(load(given))
    (state,) = simulation
    scales = simulation.scales
    unit = scales.R * math.sqrt(2.0 * scales.eta0 * scales.u / (scales.E * scales.R))
    return np.array([state.film_thickness.flat[np.argmin(scales.grid.distance)], state.h_min]) / unit


def formulas(M: float, L: float) -> tuple[float, float, float]:
    """Central film H of Nijenbanning, Venner and Moes; central and minimum film of Hamrock and Dowson."""
    G, two_u = ALPHA * MODULUS, (L / (ALPHA * MODULUS)) ** 4
    central, minimum = hamrock_dowson_films(0.5 * two_u, G, M * two_u**0.75, 1.0)
    return nijenbanning_central_film(M, L, 1.0), central / two_u**0.5, minimum / two_u**0.5


def limit(M: float, L: float, ratio: float) -> Films | None:
    """Limits of order 2 of the films of an ellipse; None where no mesh of `MAX_NODES` comes near them."""
    case = load(tables(M, L, 8, ratio=ratio))
    scales = Scales.of(case)
    film, pressure = expected_film(case, scales), scales.p0
    if pressure > MAX_PRESSURE:
        return None
    sides = (-12.0, 6.0) if film > LIGHT else _near_sides(film, scales.a / scales.b)
    points = max(COARSEST, math.ceil(points_for_opening(film, OPENING)))
    found, settled = [], math.inf
    while settled > SETTLED and points**2 * (1.5 - sides[0]) * 2.0 * sides[1] < MAX_NODES:
        try:
            found.append(films(tables(M, L, points, ratio=ratio, sides=sides)))
        except NotConverged:
            break
        if len(found) > 1 and found[-1][1] > 0.0:
            best = found[-1] + (found[-1] - found[-2]) / 3.0
            settled = best[1] / found[-1][1]
        points *= 2
    if settled > USED:
        return None
    return Films(*best, float(density(np.array([pressure]), case.fluid)[0][0]))


def _near_sides(film: float, slenderness: float) -> tuple[float, float]:
    """Inlet and half the width of a mesh beyond which a film [a^2/R] has little pressure; a over b."""
    root = math.sqrt(film)
    return -max(1.5, 1.25 + 5.0 * root), max(1.35, 1.25 + 2.0 * root * slenderness)


def computed() -> Iterator[tuple[tuple[float, float, float], Films]]:
    """Films of `RANGE`, with M, L and the ratio of the radii, as they come."""
    for ratio, M, L in product(*RANGE):
        found = limit(M, L, ratio)
        if found is not None:
            yield (M, L, ratio), found


def fit(groups: np.ndarray, films_of: np.ndarray) -> np.ndarray:
    """Coefficients of one film with the smallest largest error, by least squares of growing weights.

    `groups`: M, L, ratio, shape (n, 3). `films_of`: H of an incompressible oil, shape (n,).
    """
    bases, terms = zip(*(fit_terms(*group) for group in groups), strict=True)
    rows, wanted, weights = np.array(terms), np.log(films_of / np.array(bases)), np.ones(len(groups))
    for _ in range(300):
        root = np.sqrt(weights)
        found = np.linalg.lstsq(rows * root[:, None], wanted * root, rcond=None)[0]
        weights *= (1e-3 + np.abs(rows @ found - wanted)) ** 0.3
        weights /= weights.mean()
    return found


def compute() -> None:
    """Write `FILE` anew, and print the coefficients of the fit."""
    keys, found = map(np.array, zip(*computed(), strict=True))
    names = ("M", "L", "ratio", *Films._fields)
    columns = {
        name: [f"{value:.5g}" for value in column]
        for name, column in zip(names, [*keys.T, *found.T], strict=True)
    }
    measured_data.store(FILE, **columns)
    for name, values, exponent in zip(Films._fields, found.T, POINT_COMPRESSION, strict=False):
        print(f"{name}: {fit(keys, values * found[:, 2] ** exponent).round(4).tolist()}")


def main(words: list[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--compute", action="store_true", help="compute the films of ellipses again")
    if parser.parse_args(words).compute:
        return compute()
    print("M, L: Hc on a/16, a/32, a/64, limit; two formulas: Hm on the same; formula")
    for M, L in GROUPS:
        found = np.array([films(tables(M, L, points)) for points in MESHES])
        best = found[-1] + (found[-1] - found[-2]) / 3.0
        nijenbanning, central, minimum = formulas(M, L)
        rows = [", ".join(f"{value:.3f}" for value in (*h, x)) for h, x in zip(found.T, best, strict=True)]
        of_formulas = f"{nijenbanning:.3f}, {central:.3f}: {rows[1]}; {minimum:.3f}"
        print(f"{M:g}, {L:g}: {rows[0]}; {of_formulas}", flush=True)
    return None


if __name__ == "__main__":
    main()
