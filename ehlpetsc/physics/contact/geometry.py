r"""Kinds of contact: dry smooth contact, nodes, dimensionless groups and film formulas of each.

A line contact is of infinite length; a strip is a line contact whose roughness varies along its length,
periodic over the width of the mesh; a point contact is an ellipse.

Groups of a line contact: :math:`U=\eta_0u/(E'R)`, :math:`G=\alpha E'`, :math:`W=w'/(E'R)`, u the mean speed;
Moes' :math:`M=W(2U)^{-1/2}`, :math:`L=G(2U)^{1/4}`, :math:`H=(h/R)(2U)^{-1/2}`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ehlpetsc.base.counts import whole_near
from ehlpetsc.base.declarations import Values
from ehlpetsc.physics.contact.grid import Grid
from ehlpetsc.physics.contact.hertz import hertz_ellipse, hertz_line
from ehlpetsc.physics.contact.shape import CYLINDER, STRAIGHT, Shape

MIN_OVER_CENTRAL_FILM = 0.75  # of an incompressible oil
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
    `smooth_films`: of viscosity, mean speed, alpha, load, radius along x, E' and extent: central film of an
        incompressible oil [m], minimum over central film, maximum dry pressure [Pa].
    `expected_film`: central film of the smooth flooded contact in a^2/R, of M, L, extent, 2U and R/a.
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
    is_elliptic: bool = False


def along(mesh: Values) -> np.ndarray:
    """Nodes along the direction of motion in half-widths."""
    return mesh.inlet + np.arange(mesh.nodes) / mesh.points_per_half_width


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
    return Grid((along(mesh),), (dry.a / mesh.points_per_half_width,), (1.0,), (CYLINDER,), 0.5 * np.pi)


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
        (STRAIGHT, CYLINDER),
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
        (across, CYLINDER),
        2.0 * np.pi / 3.0 * ratio,
        growth=2.0 / 3.0,
        breadth=2.0 * ratio,
        middle=-(contact.tilt or 0.0) * contact.radius_across / dry.a,
    )


def line_groups(
    viscosity: float, speed: float, alpha: float, load: float, radius: float, modulus: float, extent: float
) -> tuple[float, float]:
    r"""Moes' load and lubricant numbers of a line contact of a length [m].

    :math:`U=\eta_0u/(E'R)`, :math:`M=w'/(E'R)\,(2U)^{-1/2}`, :math:`L=\alpha E'(2U)^{1/4}`, u the mean speed.
    """
    two_u = 2.0 * viscosity * speed / (modulus * radius)
    return load / extent / (modulus * radius * math.sqrt(two_u)), alpha * modulus * two_u**0.25


def point_groups(
    viscosity: float, speed: float, alpha: float, load: float, radius: float, modulus: float, extent: float
) -> tuple[float, float]:
    r"""Moes' numbers of a point contact, :math:`M=F/(E'R^2)\,(2U)^{-3/4}`; L as in a line."""
    two_u = 2.0 * viscosity * speed / (modulus * radius)
    return load / (modulus * radius**2 * two_u**0.75), alpha * modulus * two_u**0.25


def moes_central_film(M: float, L: float) -> float:
    r"""Central film H of a line contact by Moes' fit over all regimes (Moes 1992).

    :math:`H=\left[(H_{RI}^{7/3}+H_{EI}^{7/3})^{3s/7}+(H_{RP}^{-7/2}+H_{EP}^{-7/2})^{-2s/7}\right]^{1/s}`,
    :math:`s=\frac15(7+8e^{-2H_{EI}/H_{RI}})`, with the rigid/elastic, isoviscous/piezoviscous asymptotes
    :math:`H_{RI}=3/M`, :math:`H_{EI}=2.621M^{-1/5}`, :math:`H_{RP}=1.287L^{2/3}`,
    :math:`H_{EP}=1.311M^{-1/8}L^{3/4}`.
    """
    rigid, elastic = 3.0 / M, 2.621 * M**-0.2
    rigid_piezo, elastic_piezo = 1.287 * L ** (2.0 / 3.0), 1.311 * M**-0.125 * L**0.75
    s = (7.0 + 8.0 * np.exp(-2.0 * elastic / rigid)) / 5.0
    isoviscous = (rigid ** (7.0 / 3.0) + elastic ** (7.0 / 3.0)) ** (3.0 * s / 7.0)
    piezoviscous = (rigid_piezo**-3.5 + elastic_piezo**-3.5) ** (-2.0 * s / 7.0)
    return (isoviscous + piezoviscous) ** (1.0 / s)


def nijenbanning_central_film(M: float, L: float, ratio: float, rigid: float | None = None) -> float:
    r"""Central film H of an elliptic contact by the fit over all regimes of Nijenbanning, Venner and Moes
    (1994).

    .. math:: H=\left\{\left[H_{RI}^{3/2}+(H_{EI}^{-4}+H_{00}^{-4})^{-3/8}\right]^{2s/3}+
       (H_{RP}^{-8}+H_{EP}^{-8})^{-s/8}\right\}^{1/s},\qquad s=1.5\,(1+e^{-1.2H_{EI}/H_{EP}})

    with :math:`\lambda=R_x/R_y`, :math:`H_{RI}=145(1+0.796\lambda^{14/15})^{-15/7}\lambda^{-1}M^{-2}`,
    :math:`H_{EI}=3.18(1+0.006\ln\lambda+0.63\lambda^{4/7})^{-14/25}\lambda^{-1/15}M^{-2/15}`,
    :math:`H_{RP}=1.29(1+0.691\lambda)^{-2/3}L^{2/3}`,
    :math:`H_{EP}=1.48(1+0.006\ln\lambda+0.63\lambda^{4/7})^{-7/20}\lambda^{-1/24}M^{-1/12}L^{3/4}`,
    :math:`H_{00}=1.8\lambda^{-1}`.

    `ratio`: :math:`R_y/R_x`. `rigid`: another :math:`H_{RI}`.
    """
    lam = 1.0 / ratio
    shape = 1.0 + 0.006 * math.log(lam) + 0.63 * lam ** (4.0 / 7.0)
    rigid = rigid or 145.0 * (1.0 + 0.796 * lam ** (14.0 / 15.0)) ** (-15.0 / 7.0) / (lam * M**2)
    elastic = 3.18 * shape ** (-14.0 / 25.0) * lam ** (-1.0 / 15.0) * M ** (-2.0 / 15.0)
    rigid_piezo = 1.29 * (1.0 + 0.691 * lam) ** (-2.0 / 3.0) * L ** (2.0 / 3.0)
    elastic_piezo = 1.48 * shape ** (-7.0 / 20.0) * lam ** (-1.0 / 24.0) * M ** (-1.0 / 12.0) * L**0.75
    s = 1.5 * (1.0 + math.exp(-1.2 * elastic / elastic_piezo))
    isoviscous = (rigid**1.5 + (elastic**-4 + (1.8 / lam) ** -4) ** -0.375) ** (2.0 * s / 3.0)
    return (isoviscous + (rigid_piezo**-8 + elastic_piezo**-8) ** (-s / 8.0)) ** (1.0 / s)


def brewe_rigid_film(M: float, ratio: float) -> float:
    r"""Central film H of a rigid, isoviscous elliptic contact (Brewe, Hamrock and Taylor 1979).

    .. math:: H=32\,\alpha\varphi^2\mathcal L^2/M^2,\qquad\varphi=\frac{1}{1+2/(3\alpha)},\qquad
       \mathcal L=0.131\arctan(\alpha/2)+1.683,\qquad\alpha=R_y/R_x=\texttt{ratio}

    of a computed load that exceeds that of half of Kapitza's pressure by :math:`2\mathcal L/\pi`. For a ball
    :math:`H_{RI}` of Nijenbanning, Venner and Moes is 18 % higher.
    """
    side_leakage, load = rigid_factors(ratio)
    return 32.0 * ratio * (side_leakage * load / M) ** 2


def rigid_factors(ratio: float) -> tuple[float, float]:
    r""":math:`\varphi` and :math:`\mathcal L` of :func:`brewe_rigid_film`."""
    return 1.0 / (1.0 + 2.0 / (3.0 * ratio)), 0.131 * math.atan(0.5 * ratio) + 1.683


def hamrock_dowson_films(U: float, G: float, W: float, ratio: float) -> tuple[float, float]:
    r"""Central and minimum film of an elliptic contact over :math:`R_x` (Hamrock and Dowson 1977).

    :math:`H_c=2.69U^{0.67}G^{0.53}W^{-0.067}(1-0.61e^{-0.73k})`,
    :math:`H_{min}=3.63U^{0.68}G^{0.49}W^{-0.073}(1-e^{-0.68k})`, :math:`k=1.03(R_y/R_x)^{0.64}`,
    :math:`W=F/(E'R_x^2)`.

    `ratio`: :math:`R_y/R_x`.
    """
    k = 1.03 * ratio**0.64
    central = 2.69 * U**0.67 * G**0.53 * W**-0.067 * (1.0 - 0.61 * math.exp(-0.73 * k))
    return central, 3.63 * U**0.68 * G**0.49 * W**-0.073 * (1.0 - math.exp(-0.68 * k))


def line_films(
    viscosity: float, speed: float, alpha: float, load: float, radius: float, modulus: float, extent: float
) -> tuple[float, float, float]:
    """Films by Moes' fit, see :class:`Geometry`."""
    M, L = line_groups(viscosity, speed, alpha, load, radius, modulus, extent)
    unit = radius * math.sqrt(2.0 * viscosity * speed / (modulus * radius))
    return (
        unit * moes_central_film(M, L),
        MIN_OVER_CENTRAL_FILM,
        hertz_line(load / extent, radius, modulus)[1],
    )


def point_films(
    viscosity: float, speed: float, alpha: float, load: float, radius: float, modulus: float, extent: float
) -> tuple[float, float, float]:
    """Films by the fit of Nijenbanning, Venner and Moes, rigid limit computed, see :class:`Geometry`."""
    M, L = point_groups(viscosity, speed, alpha, load, radius, modulus, extent)
    two_u = 2.0 * viscosity * speed / (modulus * radius)
    film = nijenbanning_central_film(M, L, extent, brewe_rigid_film(M, extent))
    central = radius * math.sqrt(two_u) * film
    of_hamrock = hamrock_dowson_films(0.5 * two_u, alpha * modulus, load / (modulus * radius**2), extent)
    return central, of_hamrock[1] / of_hamrock[0], hertz_ellipse(load, radius, radius * extent, modulus).p0


def line_film(M: float, L: float, extent: float, two_u: float, slope: float) -> float:
    """Central film by Moes' fit in a^2/R, see :class:`Geometry`."""
    return moes_central_film(M, L) * np.pi / (8.0 * M)


def point_film(M: float, L: float, extent: float, two_u: float, slope: float) -> float:
    """Central film by the fit of Nijenbanning, Venner and Moes in a^2/R, see :class:`Geometry`."""
    return nijenbanning_central_film(M, L, extent) * math.sqrt(two_u) * slope**2


LINE = Geometry(unit_length, line, line_half_width, one_row, line_grid, line_groups, line_films, line_film)
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
    True,
)
