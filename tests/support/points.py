"""Cases of point contacts by Moes' numbers, their films."""

import sys

import numpy as np

from support import CASES

sys.path.append(str(CASES / "paper"))
from point_films import tables as of_moes

E_REDUCED, R, ALPHA, ETA0 = 2.2e11, 0.0125, 22e-9, 0.04


def point(M, L, points, changes=None, width=4.0):
    """Tables of a smooth circular contact in pure rolling; `changes` by dotted keys, None removes one."""
    tables = of_moes(M, L, points, E_REDUCED, R)
    tables["contact"] |= {"model": "mixed", "boundary_film": 1e-10}
    tables["mesh"]["width"] = width
    for key, value in (changes or {}).items():
        table, name = key.split(".")
        tables.setdefault(table, {}).pop(name, None)
        if value is not None:
            tables[table][name] = value
    return tables


def lowest(film):
    """Minimum of a film (ny, nx) between the nodes: of the parabola through 3 x 3 about the lowest one."""
    j, i = np.unravel_index(np.argmin(film), film.shape)
    (a, b, c), (d, e, f), (g, h, k) = film[j - 1 : j + 2, i - 1 : i + 2]
    slope, mixed = 0.5 * np.array([h - b, f - d]), 0.25 * (k - g - c + a)
    curvature = np.array([[h - 2.0 * e + b, mixed], [mixed, f - 2.0 * e + d]])
    return e - 0.5 * slope @ np.linalg.solve(curvature, slope)


def moes_film(scales, film):
    """H = (h/R) (2U)^(-1/2) of a film [m]."""
    return film / scales.R / (2.0 * scales.eta0 * scales.u / (scales.E * scales.R)) ** 0.5
