r"""Kinds of contact: dry smooth contact, nodes and dimensionless groups of each.

A line contact is of infinite length; a strip is a line contact whose roughness varies along its length,
periodic over the width of the mesh; a point contact is an ellipse.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ehlpetsc.physics.film_formulas import (
    MIN_OVER_CENTRAL_FILM,
    brewe_rigid_film,
    hamrock_dowson_films,
    moes_central_film,
    nijenbanning_central_film,
)
from ehlpetsc.physics.grid import Grid
from ehlpetsc.physics.hertz import hertz_ellipse, hertz_line

if TYPE_CHECKING:
    from ehlpetsc.base.declarations import Values
    from ehlpetsc.physics.scales import Scales

POINT_WIDTH = 4.0  # half-widths b: of the mesh of a point contact across, unless given


class Dry(NamedTuple):
    """Dry smooth contact: half-widths along and across, infinite in a line [m]; maximum pressure [Pa]."""

    a: float
    b: float
    p0: float


class Geometry(NamedTuple):
    """Quantities in which the kinds of contact differ.

    `dry`: of [contact] and E' [Pa].
    `half_width`: along x [m], of load, radius along x, E' and the ratio of the radii; also of arrays.
    `rows`: rows of nodes across, of [mesh] and the dry contact.
    `grid`: of [contact], [mesh] and the dry contact.
    `moes`: Moes' M and L of viscosity, mean speed, alpha, load, radius along x and E'.
    `smooth_films`: of viscosity, mean speed, alpha, load, radius along x, E' and the ratio of the radii:
        central film of an incompressible oil [m], minimum over central film, maximum dry pressure [Pa].
    `expected_film`: central film of the smooth flooded contact in a^2/R.
    """

    dry: Callable[[Values, float], Dry]
    half_width: Callable[..., np.ndarray]
    rows: Callable[[Values, Dry], int]
    grid: Callable[[Values, Values, Dry], Grid]
    moes: Callable[..., tuple[float, float]]
    smooth_films: Callable[..., tuple[float, float, float]]
    expected_film: Callable[[Scales], float]


def along(mesh: Values) -> np.ndarray:
    """Nodes along the direction of motion in half-widths."""
    return mesh.inlet + np.arange(mesh.nodes) / mesh.points_per_half_width


def line(contact: Values, modulus: float) -> Dry:
    """Dry line contact of a load per length."""
    a, p0 = hertz_line(contact.load, contact.radius, modulus)
    return Dry(a, math.inf, p0)


def ellipse(contact: Values, modulus: float) -> Dry:
    """Dry point contact."""
    return Dry(*hertz_ellipse(contact.load, contact.radius, contact.radius_across, modulus)[:3])


def line_half_width(load: np.ndarray, radius: np.ndarray, modulus: float, ratio: float) -> np.ndarray:
    """Half-width of dry line contacts [m]."""
    return np.sqrt(8.0 * load * radius / (np.pi * modulus))


def point_half_width(load: np.ndarray, radius: np.ndarray, modulus: float, ratio: float) -> np.ndarray:
    """Semi-axis along x of dry ellipses of one shape [m]."""
    return hertz_ellipse(1.0, 1.0, ratio, modulus).a * np.cbrt(load * radius)


def line_grid(contact: Values, mesh: Values, dry: Dry) -> Grid:
    """Nodes of a line contact."""
    return Grid((along(mesh),), (dry.a / mesh.points_per_half_width,), (1.0,), (1.0,), 0.5 * np.pi)


def one_row(mesh: Values, dry: Dry) -> int:
    """The row of a line contact."""
    return 1


def strip_rows(mesh: Values, dry: Dry) -> int:
    """Rows of a strip, over its period."""
    return max(round(mesh.width * (mesh.points_across or mesh.points_per_half_width)), 2)


def point_rows(mesh: Values, dry: Dry) -> int:
    """Rows of a point contact, an odd number."""
    points = mesh.points_across or mesh.points_per_half_width * dry.b / dry.a
    return 2 * max(round(0.5 * (mesh.width or POINT_WIDTH) * points), 2) + 1


def strip_grid(contact: Values, mesh: Values, dry: Dry) -> Grid:
    """Nodes of a strip: cells of equal width over the period, about the middle."""
    n_y = strip_rows(mesh, dry)
    step = mesh.width / n_y
    y = (np.arange(n_y) - 0.5 * (n_y - 1)) * step
    spacings = step * dry.a, dry.a / mesh.points_per_half_width
    load = 0.5 * np.pi * mesh.width
    return Grid(
        (y, along(mesh)), spacings, (math.inf, 1.0), (0.0, 1.0), load, breadth=mesh.width, periodic=True
    )


def point_grid(contact: Values, mesh: Values, dry: Dry) -> Grid:
    """Nodes of a point contact, symmetric about the direction of motion."""
    ratio = dry.b / dry.a
    points = mesh.points_across / ratio if mesh.points_across else mesh.points_per_half_width
    half = point_rows(mesh, dry) // 2
    y = np.arange(-half, half + 1) / points
    spacings = dry.a / points, dry.a / mesh.points_per_half_width
    curvature = contact.radius / contact.radius_across
    return Grid(
        (y, along(mesh)),
        spacings,
        (ratio, 1.0),
        (curvature, 1.0),
        2.0 * np.pi / 3.0 * ratio,
        growth=2.0 / 3.0,
        breadth=2.0 * ratio,
    )


def line_groups(
    viscosity: float, speed: float, alpha: float, load: float, radius: float, modulus: float
) -> tuple[float, float]:
    r"""Moes' load and lubricant numbers of a line contact.

    :math:`U=\eta_0u/(E'R)`, :math:`M=w'/(E'R)\,(2U)^{-1/2}`, :math:`L=\alpha E'(2U)^{1/4}`, u the mean speed.
    """
    two_u = 2.0 * viscosity * speed / (modulus * radius)
    return load / (modulus * radius * math.sqrt(two_u)), alpha * modulus * two_u**0.25


def point_groups(
    viscosity: float, speed: float, alpha: float, load: float, radius: float, modulus: float
) -> tuple[float, float]:
    r"""Moes' numbers of a point contact, :math:`M=F/(E'R^2)\,(2U)^{-3/4}`; L as in a line."""
    two_u = 2.0 * viscosity * speed / (modulus * radius)
    return load / (modulus * radius**2 * two_u**0.75), alpha * modulus * two_u**0.25


def line_films(
    viscosity: float, speed: float, alpha: float, load: float, radius: float, modulus: float, ratio: float
) -> tuple[float, float, float]:
    """Films by Moes' fit, see :class:`Geometry`."""
    M, L = line_groups(viscosity, speed, alpha, load, radius, modulus)
    unit = radius * math.sqrt(2.0 * viscosity * speed / (modulus * radius))
    return unit * moes_central_film(M, L), MIN_OVER_CENTRAL_FILM, hertz_line(load, radius, modulus)[1]


def point_films(
    viscosity: float, speed: float, alpha: float, load: float, radius: float, modulus: float, ratio: float
) -> tuple[float, float, float]:
    """Films by the fit of Nijenbanning, Venner and Moes, rigid limit computed, see :class:`Geometry`."""
    M, L = point_groups(viscosity, speed, alpha, load, radius, modulus)
    two_u = 2.0 * viscosity * speed / (modulus * radius)
    film = nijenbanning_central_film(M, L, ratio, brewe_rigid_film(M, ratio))
    central = radius * math.sqrt(two_u) * film
    of_hamrock = hamrock_dowson_films(0.5 * two_u, alpha * modulus, load / (modulus * radius**2), ratio)
    return central, of_hamrock[1] / of_hamrock[0], hertz_ellipse(load, radius, radius * ratio, modulus).p0


def line_film(scales: Scales) -> float:
    """Central film by Moes' fit in a^2/R."""
    return moes_central_film(scales.moes_m, scales.moes_l) * np.pi / (8.0 * scales.moes_m)


def point_film(scales: Scales) -> float:
    """Central film by the fit of Nijenbanning, Venner and Moes in a^2/R."""
    two_u = 2.0 * scales.eta0 * abs(scales.u) / (scales.E * scales.R)
    film = nijenbanning_central_film(scales.moes_m, scales.moes_l, scales.radius_ratio)
    return film * math.sqrt(two_u) * (scales.R / scales.a) ** 2


GEOMETRIES = {
    "line": Geometry(line, line_half_width, one_row, line_grid, line_groups, line_films, line_film),
    "strip": Geometry(line, line_half_width, strip_rows, strip_grid, line_groups, line_films, line_film),
    "point": Geometry(
        ellipse, point_half_width, point_rows, point_grid, point_groups, point_films, point_film
    ),
}
"""Kinds of contact by name, :attr:`ehlpetsc.case.tables.Case.kind`."""
