"""Cases of point contacts by Moes' numbers, their films."""

import numpy as np

E_REDUCED, R, ALPHA, ETA0 = 2.2e11, 0.0125, 22e-9, 0.04


def point(M, L, points, changes=None, width=4.0):
    """Tables of a smooth circular contact in pure rolling; `changes` by dotted keys, None removes one."""
    two_u = (L / (ALPHA * E_REDUCED)) ** 4
    speed, load = 0.5 * two_u * E_REDUCED * R / ETA0, M * E_REDUCED * R * R * two_u**0.75
    tables = {
        "title": f"M = {M:g}, L = {L:g}",
        "contact": {
            "radius": [R, R],
            "load": load,
            "youngs_modulus": E_REDUCED * 0.91,
            "poisson_ratio": 0.3,
            "model": "mixed",
            "boundary_film": 1e-10,
        },
        "fluid": {
            "viscosity": ETA0,
            "law": "roelands",
            "roelands_z": 0.68,
            "pressure_viscosity": ALPHA,
            "density": "dowson-higginson",
            "gamma": 2.3e-9,
            "lambda": 1.7e-9,
        },
        "motion": {"entrainment_speed": speed},
        "mesh": {"inlet": -2.5, "outlet": 1.5, "points_per_half_width": points, "width": width},
    }
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
