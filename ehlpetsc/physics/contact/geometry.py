"""Kinds of contact: dry smooth contact, nodes, dimensionless groups and film formulas of each.

A line contact is of infinite length; a strip is a line contact whose roughness varies along its length,
periodic over the width of the mesh; a point contact is an ellipse.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ehlpetsc.base.counts import whole_near
from ehlpetsc.base.declarations import Values
from ehlpetsc.physics.contact.films import (
    LINE_COMPRESSION,
    POINT_COMPRESSION,
    line_film,
    line_films,
    line_groups,
    point_film,
    point_films,
    point_groups,
)
from ehlpetsc.physics.contact.grid import Grid
from ehlpetsc.physics.contact.hertz import hertz_ellipse, hertz_line
from ehlpetsc.physics.contact.profiles import gap_along
from ehlpetsc.physics.contact.shape import CYLINDER, STRAIGHT, Shape

POINT_WIDTH = 4.0  # half-widths b: of the mesh of a point contact across, unless given


class Dry(NamedTuple):
    """Dry smooth contact: half-widths along and across, infinite in a line [m]; maximum pressure [Pa]."""

    a: float
    b: float
    p0: float


class Geometry(NamedTuple):
    """Quantities in which the kinds of contact differ.

    `extent`: of the contact across in the formulas, of [contact]: the ratio of the radii of a point contact,
        1 m of a line contact, the length of a roller [m].
    `dry`: of [contact] and E' [Pa].
    `half_width`: along x [m], of load, radius along x, E' and extent; also of arrays.
    `rows`: rows of nodes across, of [contact], [mesh] and the dry contact.
    `grid`: of [contact], [mesh] and the dry contact.
    `moes`: Moes' M and L of viscosity, mean speed, alpha, load, radius along x, E' and extent.
    `smooth_films`: of viscosity, mean speed, alpha, load, radius along x, E' and extent: central and minimum
        film of an incompressible oil [m], maximum dry pressure [Pa].
    `expected_film`: central film of the smooth flooded contact in a^2/R, of M, L, extent, 2U and R/a.
    `compression`: exponents of the density under the maximum dry pressure by which central and minimum film
        are thinner.
    `is_elliptic`: whether the dry contact is an ellipse; otherwise that of a line contact, in its middle.
    """

    extent: Callable[[Values], float]
    dry: Callable[[Values, float], Dry]
    half_width: Callable[..., np.ndarray]
    rows: Callable[[Values, Values, Dry], int]
    grid: Callable[[Values, Values, Dry], Grid]
    moes: Callable[..., tuple[float, float]]
    smooth_films: Callable[..., tuple[float, float, float]]
    expected_film: Callable[[float, float, float, float, float], float]
    compression: tuple[float, float]
    is_elliptic: bool = False


def along(mesh: Values) -> np.ndarray:
    """Nodes along the direction of motion in half-widths."""
    return mesh.inlet + np.arange(mesh.nodes) / mesh.points_per_half_width


def shape_along(contact: Values, dry: Dry) -> Shape:
    """Shape along the direction of motion: the parabola of the radius, and the profile beside it."""
    profile, unit = contact.profile_along, dry.a**2 / contact.radius
    if profile is None:
        return CYLINDER
    return CYLINDER._replace(profile=lambda x: gap_along(x * dry.a, profile) / unit)


def unit_length(contact: Values) -> float:
    """Extent of a line contact, of a load per length: 1 m."""
    return 1.0


def ratio_of_radii(contact: Values) -> float:
    """Extent of a point contact."""
    return contact.radius_across / contact.radius


def line(contact: Values, modulus: float) -> Dry:
    """Dry line contact of a load per length."""
    a, p0 = hertz_line(contact.load, contact.radius, modulus)
    return Dry(a, math.inf, p0)


def ellipse(contact: Values, modulus: float) -> Dry:
    """Dry point contact."""
    return Dry(*hertz_ellipse(contact.load, contact.radius, contact.radius_across, modulus)[:3])


def line_half_width(load: np.ndarray, radius: np.ndarray, modulus: float, extent: float) -> np.ndarray:
    """Half-width of dry line contacts of a length [m]."""
    return np.sqrt(8.0 * (load / extent) * radius / (np.pi * modulus))


def point_half_width(load: np.ndarray, radius: np.ndarray, modulus: float, extent: float) -> np.ndarray:
    """Semi-axis along x of dry ellipses of one shape [m]."""
    return hertz_ellipse(1.0, 1.0, extent, modulus).a * np.cbrt(load * radius)


def line_grid(contact: Values, mesh: Values, dry: Dry) -> Grid:
    """Nodes of a line contact."""
    return Grid(
        (along(mesh),),
        (dry.a / mesh.points_per_half_width,),
        (1.0,),
        (shape_along(contact, dry),),
        0.5 * np.pi,
    )


def one_row(contact: Values, mesh: Values, dry: Dry) -> int:
    """The row of a line contact."""
    return 1


def strip_rows(contact: Values, mesh: Values, dry: Dry) -> int:
    """Rows of a strip, over its period."""
    return max(whole_near(mesh.width * (mesh.points_across or mesh.points_per_half_width)), 2)


def point_rows(contact: Values, mesh: Values, dry: Dry) -> int:
    """Rows of a point contact, an odd number."""
    points = mesh.points_across or mesh.points_per_half_width * dry.b / dry.a
    return 2 * max(whole_near(0.5 * (mesh.width or POINT_WIDTH) * points), 2) + 1


def strip_grid(contact: Values, mesh: Values, dry: Dry) -> Grid:
    """Nodes of a strip: cells of equal width over the period, about the middle."""
    n_y = strip_rows(contact, mesh, dry)
    step = mesh.width / n_y
    y = (np.arange(n_y) - 0.5 * (n_y - 1)) * step
    spacings = step * dry.a, dry.a / mesh.points_per_half_width
    load = 0.5 * np.pi * mesh.width
    return Grid(
        (y, along(mesh)),
        spacings,
        (math.inf, 1.0),
        (STRAIGHT, shape_along(contact, dry)),
        load,
        breadth=mesh.width,
        periodic=True,
    )


def point_grid(contact: Values, mesh: Values, dry: Dry) -> Grid:
    """Nodes of a point contact, symmetric about y = 0."""
    ratio = dry.b / dry.a
    points = mesh.points_across / ratio if mesh.points_across else mesh.points_per_half_width
    half = point_rows(contact, mesh, dry) // 2
    y = np.arange(-half, half + 1) / points
    spacings = dry.a / points, dry.a / mesh.points_per_half_width
    across = Shape(contact.radius / contact.radius_across)
    return Grid(
        (y, along(mesh)),
        spacings,
        (ratio, 1.0),
        (across, shape_along(contact, dry)),
        2.0 * np.pi / 3.0 * ratio,
        growth=2.0 / 3.0,
        breadth=2.0 * ratio,
        middle=-(contact.tilt or 0.0) * contact.radius_across / dry.a,
    )


LINE = Geometry(
    unit_length,
    line,
    line_half_width,
    one_row,
    line_grid,
    line_groups,
    line_films,
    line_film,
    LINE_COMPRESSION,
)
STRIP = LINE._replace(rows=strip_rows, grid=strip_grid)
POINT = Geometry(
    ratio_of_radii,
    ellipse,
    point_half_width,
    point_rows,
    point_grid,
    point_groups,
    point_films,
    point_film,
    POINT_COMPRESSION,
    True,
)
