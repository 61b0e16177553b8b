"""Rolling friction of smooth lines, balls and discs beside multigrid fits and measurements.

``ehlpetsc python cases/paper/rolling_friction.py`` prints friction of a surface over the fits of Biboulet and
Houpert (2010): of `LINES` with the inlet that `explain` asks for, on two meshes; of `BALLS` on two sizes of
the mesh, alone and with the oil outside it to a third of the radius. Then friction of Aihara's discs
over his formula, isothermal, and its exponent of the load.
"""

from __future__ import annotations

from typing import Any

import measured_data
import numpy as np

from ehlpetsc.case.loading import Case, load
from ehlpetsc.physics.film_formulas import (
    expected_film,
    point_rolling_friction,
    rolling_left_by_inlet,
    rolling_outside,
)
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.simulation import Simulation

RADIUS, MODULUS, ALPHA = 0.01, 207e9 / 0.91, 20e-9  # m, E' [Pa], 1/Pa
LEFT = 0.97  # of the rolling friction, by the inlet of a line
LINES = tuple((M, L) for M in (2.0, 5.0, 15.0, 50.0) for L in (8.0, 12.0, 16.0))  # Moes' M, L
LINE_MESHES = (60, 120)  # nodes per half-width
BALLS = {(5.0, 8.0): 8, (20.0, 8.0): 8, (60.0, 8.0): 16}  # Moes' M, L: nodes along x
SIZES = (14.0, 28.0)  # half-widths before the middle and beside it
DISC_RADIUS, DENSITY = 0.025, 870.0  # m, kg/m^3
DISC_MESH = {"inlet": -30.0, "outlet": 1.5, "points_per_half_width": 60}


def rolling_case(
    contact: dict[str, Any], viscosity: float, speed: float, mesh: dict[str, Any], **fluid: Any
) -> Case:
    """Steel in pure rolling, as the fits with the laws of Barus and of Dowson and Higginson."""
    oil = {"viscosity": viscosity, "law": "barus", "pressure_viscosity": ALPHA, "density": "dowson-higginson"}
    return load(
        {
            "title": "Rolling",
            "contact": {"youngs_modulus": 207e9, "poisson_ratio": 0.3} | contact,
            "fluid": oil | fluid,
            "motion": {"entrainment_speed": speed, "slide_roll_ratio": 0.0},
            "mesh": mesh,
        }
    )


def speed_parameter(material: float) -> float:
    """Dimensionless speed U = 2 eta u/(E' R) of Moes' L."""
    return (material / (ALPHA * MODULUS)) ** 4


def line(load_number: float, material: float, mesh: dict[str, Any]) -> Case:
    """Line contact of Moes' M and L at 1 m/s."""
    U = speed_parameter(material)
    contact = {"radius": RADIUS, "load": load_number * U**0.5 * MODULUS * RADIUS}
    return rolling_case(contact, 0.5 * U * MODULUS * RADIUS, 1.0, mesh)


def ball(load_number: float, material: float, size: float, points: int) -> Case:
    """Circular contact of Moes' M and L at 1 m/s, `size` half-widths of the mesh before and beside it."""
    U = speed_parameter(material)
    contact = {"radius": [RADIUS, RADIUS], "load": load_number * U**0.75 * MODULUS * RADIUS**2}
    mesh = {"inlet": -size, "outlet": 2.0, "width": 2.0 * size, "points_per_half_width": [points, 4]}
    return rolling_case(contact, 0.5 * U * MODULUS * RADIUS, 1.0, mesh)


def friction(case: Case) -> float:
    """Computed rolling friction of a surface [N/m], of a ball [N]."""
    (state,) = Simulation(case)
    return abs(float(state.scalars["friction"]))


def line_fit(case: Case) -> float:
    r"""Rolling friction of a surface [N/m] by the fit of Biboulet and Houpert (2010, part 1), equation 42.

    .. math:: 1.42\,E'R\sqrt{UW}\left(1+\left(\tfrac{1.4}{1.45}\sqrt M\right)^{10}\right)^{-1/10}
    """
    scales = Scales.of(case)
    U, W = 2.0 * scales.eta0 * scales.u / (scales.E * scales.R), scales.load / (scales.E * scales.R)
    elastic = (1.4 / 1.45 * np.sqrt(W / np.sqrt(U))) ** 10
    return float(1.42 * scales.E * scales.R * np.sqrt(U * W) / (1.0 + elastic) ** 0.1)


def sufficient_inlet(load_number: float, material: float) -> float:
    """Distance of the first node [half-widths] that leaves `LEFT` of the rolling friction of a line."""
    case, inlet = (
        line(load_number, material, {"inlet": -3.0, "outlet": 2.0, "points_per_half_width": 60}),
        3.0,
    )
    film = expected_film(case, Scales.of(case))
    while rolling_left_by_inlet(film, inlet) < LEFT:
        inlet *= 1.05
    return inlet


def line_ratio(load_number: float, material: float, points: int) -> float:
    """Computed friction of a line over the fit."""
    inlet = sufficient_inlet(load_number, material)
    case = line(load_number, material, {"inlet": -inlet, "outlet": 2.0, "points_per_half_width": points})
    return friction(case) / line_fit(case)


def ball_ratios(load_number: float, material: float, size: float, points: int) -> tuple[float, float]:
    """Computed friction of a ball over the fit, alone and with the oil outside the mesh."""
    case = ball(load_number, material, size, points)
    scales = Scales.of(case)
    found, outside = friction(case), rolling_outside(scales, size * scales.a, size * scales.b)
    return tuple(value / point_rolling_friction(scales) for value in (found, found + outside))


def disc_friction(viscosity: float, speed: float, per_length: float) -> float:
    """Computed rolling friction of Aihara's discs [N/m], isothermal.

    `viscosity` [m^2/s], `speed` [m/s], `per_length`: load [N/m].
    """
    contact = {"radius": DISC_RADIUS, "load": per_length}
    return friction(rolling_case(contact, DENSITY * viscosity, speed, DISC_MESH, law="roelands"))


def exponent(loads: np.ndarray, values: np.ndarray) -> float:
    """Exponent of the load in friction, by least squares."""
    return float(np.polyfit(np.log(loads), np.log(values), 1)[0])


def main(words: list[str] | None = None) -> None:
    """Print the tables."""
    print("line, M, L: friction over the fit on " + ", ".join(f"a/{points}" for points in LINE_MESHES))
    ratios = np.array([[line_ratio(*pair, points) for points in LINE_MESHES] for pair in LINES])
    for (M, L), row in zip(LINES, ratios, strict=True):
        print(f"{M:g}, {L:g}: " + ", ".join(f"{ratio:.3f}" for ratio in row))
    print(f"mean {ratios[:, -1].mean():.3f}, {ratios[:, -1].min():.3f} to {ratios[:, -1].max():.3f}")
    print(
        "ball, M, L: friction over the fit, alone and with the oil outside, on "
        + ", ".join(f"{s:g} a" for s in SIZES)
    )
    for (M, L), points in BALLS.items():
        both = [ball_ratios(M, L, size, points) for size in SIZES]
        print(f"{M:g}, {L:g}: " + "; ".join(f"{alone:.3f}, {total:.3f}" for alone, total in both), flush=True)
    print("discs, viscosity [m^2/s], speed [m/s]: friction over Aihara's at the loads; exponent of the load")
    data = measured_data.read("aihara_discs.csv")
    for viscosity in np.unique(data.columns["viscosity"]):
        for speed in np.unique(data.columns["speed"]):
            rows = data.where(viscosity=viscosity, speed=speed)
            values = np.array([disc_friction(viscosity, speed, load) for load in rows["load"]])
            text = ", ".join(f"{ratio:.2f}" for ratio in values / rows["friction"])
            print(f"{viscosity:g}, {speed:g}: {text}; {exponent(rows['load'], values):.2f}", flush=True)


if __name__ == "__main__":
    main()
