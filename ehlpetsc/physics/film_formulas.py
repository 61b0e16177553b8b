"""Films of smooth contacts by the fits of :mod:`.geometry`: as expected, on a mesh, with a short inlet."""

from __future__ import annotations

import math

import numpy as np

from ehlpetsc.base.case import Case, Fluid
from ehlpetsc.physics.contact.films import rigid_factors
from ehlpetsc.physics.contact.geometry import Geometry
from ehlpetsc.physics.operation import Conditions
from ehlpetsc.physics.scales import Scales

MAX_FILM_ITERATIONS = 200
MAX_FILM_SLOPE = 0.25  # films by which the gap opens from node to node: the film is 5 % too thin
FAR_INLET, GRUBIN_POINTS = 100.0, 1000  # half-widths in place of infinity in Grubin's integral; its points
OIL_REACH, ROLLING_ANGLES = 1.0 / 3.0, 64  # radii along x to which oil reaches before a point contact


def load_outside(scales: Scales, film: float, inlet: float, half_width: float) -> float:
    r"""Load of the oil before and beside the mesh of a flooded point contact [N].

    .. math:: p=4\eta_0u\varphi\,\frac{2\mathcal L}{\pi}\,\frac{-x}{h^2},\qquad
       h=h_c+\frac{x^2}{2R_x}+\frac{y^2}{2R_y},\qquad x<0

    of rigid bodies and ambient viscosity (Kapitza 1955), to the load of
    :func:`.contact.films.brewe_rigid_film`, integrated outside :math:`x>-` `inlet`, :math:`|y|<`
    `half_width`. It falls as slowly as 1 over the distance.

    Parameters
    ----------
    film, inlet, half_width
        Central film, distances of the first node and of the edges from the middle [m].
    """
    side_leakage, load = rigid_factors(scales.extent)
    across = 2.0 * scales.R * scales.extent

    def inside(gap: float) -> float:
        return math.atan(half_width / math.sqrt(across * gap)) / math.sqrt(gap)

    integral = 0.5 * math.pi / math.sqrt(film) - inside(film) + inside(film + 0.5 * inlet**2 / scales.R)
    pressure = 8.0 / math.pi * scales.eta0 * abs(scales.u) * side_leakage * load
    return pressure * 2.0 * scales.R * math.sqrt(across) * integral


def film_on_mesh(case: Case, scales: Scales, inlet: float, half_width: float) -> tuple[float, float]:
    """Share of the load that a flooded point contact carries outside a mesh; film on it over the flooded one.

    On the mesh the contact carries that load too: its film is that of a flooded contact under the load and
    that outside, by :func:`load_outside`, which takes the same distances.
    """
    fluid, groups = case.fluid, (scales.R, scales.E, scales.extent)

    def flooded(load: float) -> float:
        return scales.geometry.smooth_films(
            fluid.viscosity, abs(scales.u), fluid.pressure_viscosity, load, *groups
        )[0]

    film = lower = flooded(scales.load)
    share = load_outside(scales, film, inlet, half_width) / scales.load
    for _ in range(MAX_FILM_ITERATIONS):
        before, lower = lower, flooded(scales.load + load_outside(scales, lower, inlet, half_width))
        if before - lower < 1e-3 * lower:
            break
    return share, lower / film


def smooth_films(scales: Scales, fluid: Fluid, conditions: Conditions) -> tuple[float, float]:
    r"""Expected central and minimum film of the smooth, flooded contact [m].

    .. math:: h_c=h_{c,0}\left(\frac{\rho_0}{\rho(p_0)}\right)^m,\qquad
       h_{min}=h_{min,0}\left(\frac{\rho_0}{\rho(p_0)}\right)^n

    of the films of an incompressible oil, :attr:`.geometry.Geometry.smooth_films`, and the exponents
    `compression` there. The inlet entrains the mass of an incompressible oil, which passes the contact with
    its density at p0; the pressure of the exit constriction is lower.

    Line contacts: within 4 % of computed films, compressible and incompressible, for M from 9 to 100 and L
    from 3 to 11 (`tests/unit/test_scales.py`); :math:`h_{c,0}` alone exceeds the central film by 22 to 27 %.
    Point contacts: see :func:`.contact.films.fitted_point_films`.
    """
    return contact_films(scales.geometry, scales.E, scales.extent, fluid, conditions)


def contact_films(
    geometry: Geometry, modulus: float, extent: float, fluid: Fluid, conditions: Conditions
) -> tuple[float, float]:
    """Films of :func:`smooth_films` of a kind of contact; E' [Pa] and extent of its formulas."""
    from ehlpetsc.physics.oil.laws import density

    load, radius, speed = conditions.load, conditions.radius, abs(conditions.entrainment)
    if speed == 0.0:
        return 0.0, 0.0
    groups = fluid.viscosity, speed, fluid.pressure_viscosity, load, radius, modulus
    *incompressible, p0 = geometry.smooth_films(*groups, extent)
    under_p0 = float(density(np.array([p0]), fluid)[0][0])
    pairs = zip(incompressible, geometry.compression, strict=True)
    central, minimum = (film * under_p0**-exponent for film, exponent in pairs)
    return central, min(central, minimum)


def inlet_opening(film: float, points: float) -> float:
    r"""Opening of Hertz' gap over one node spacing outside the contact, over the film.

    :math:`\frac{2\sqrt2}{3}(\Delta x/a)^{3/2}` in :math:`a^2/R` over the film. At 0.25 the film
    of a second-order scheme is about 5 % too thin, at 1 about 40 %; from about 5 on there is no film.

    Parameters
    ----------
    film
        Central film in a^2/R.
    points
        Nodes per half-width.
    """
    return 2.0 * np.sqrt(2.0) / 3.0 * points**-1.5 / film


def points_for_opening(film: float, opening: float) -> int:
    """Nodes per half-width for a value of :func:`inlet_opening`."""
    return (inlet_opening(film, 1.0) / opening) ** (2.0 / 3.0)


def film_left_by_inlet(film: float, inlet: float) -> float:
    r"""Film with an inlet of finite length, over the film of the flooded contact.

    Grubin's integral :math:`\int(g/(h_c+g)^3)dX` over Hertz' gap g is prescribed by the pressure-viscosity
    coefficient; from a finite inlet instead of infinity it has the same value for a thinner film.

    Parameters
    ----------
    film
        Central film of the flooded contact in a^2/R.
    inlet
        Distance of the first node from the middle in half-widths, above 1.
    """
    prescribed = _inlet_integral(film, FAR_INLET, 3)
    low, high = np.log(film) - 20.0, np.log(film)
    while high - low > 1e-3:  # the integral falls as the film grows
        middle = 0.5 * (low + high)
        low, high = (
            (middle, high) if _inlet_integral(np.exp(middle), inlet, 3) > prescribed else (low, middle)
        )
    return float(np.exp(0.5 * (low + high)) / film)


def rolling_left_by_inlet(film: float, inlet: float) -> float:
    r"""Rolling friction before a light contact with an inlet of finite length, over that of a flooded one.

    Each wall carries :math:`\int\frac h2\frac{dp}{dx}dx=\int 6\eta u\frac{h-h_c}{h^2}dx`, with Hertz' gap
    before the contact and ambient viscosity; far out it falls as 1/x. Parameters: :func:`film_left_by_inlet`.
    """
    return _inlet_integral(film, inlet, 2) / _inlet_integral(film, FAR_INLET, 2)


def point_rolling_friction(scales: Scales) -> float:
    r"""Rolling friction of a surface of a flooded point contact [N] (Biboulet and Houpert 2010, part 2).

    .. math:: E'R_x^2\,\frac{2b}{R_x}U^{3/4}\left(\frac{0.77\kappa^{0.12}U^{-1/12}-1.8}{1+M/6.6}+1.8\right),
       \qquad U=\frac{2\eta_0u}{E'R_x},\quad M=\kappa\frac{F}{E'R_x^2}U^{-3/4},\quad\kappa=\frac ab\le1.
    """
    kappa = min(scales.a / scales.b, 1.0)
    U = 2.0 * scales.eta0 * abs(scales.u) / (scales.E * scales.R)
    M = kappa * scales.load / (scales.E * scales.R**2) * U**-0.75
    factor = (0.77 * kappa**0.12 * U ** (-1.0 / 12.0) - 1.8) / (1.0 + M / 6.6) + 1.8
    return scales.E * scales.R * 2.0 * scales.b * U**0.75 * factor


def rolling_outside(scales: Scales, inlet: float, half_width: float) -> float:
    r"""Rolling friction of a surface of a point contact before and beside its mesh [N].

    .. math:: \frac1{2R_x}\int(-x)\,p\,dA

    of the pressure of :func:`load_outside` without its central film, as far as an ellipse of half-width
    `OIL_REACH` :math:`R_x` along x. It grows with the logarithm of that reach and so has no flooded limit.

    Parameters
    ----------
    inlet, half_width
        Distances of the first node and of the edges from the middle [m].
    """
    side_leakage, load = rigid_factors(scales.extent)
    angle = np.pi * ((np.arange(ROLLING_ANGLES) + 0.5) / ROLLING_ANGLES - 0.5)
    stretch = math.sqrt(scales.extent)
    mesh = np.minimum(inlet / np.cos(angle), half_width / stretch / np.abs(np.sin(angle)))
    reach = np.log(np.maximum(OIL_REACH * scales.R / mesh, 1.0))
    integral = float((np.cos(angle) ** 2 * reach).mean()) * np.pi
    return 16.0 / np.pi * scales.eta0 * abs(scales.u) * side_leakage * load * scales.R * stretch * integral


def _inlet_integral(film: float, inlet: float, power: int) -> float:
    """Integral of g/(h_c+g)^power over 1 < X < `inlet`; X = 1 + (inlet - 1) s^3: nodes where g is small."""
    s = (np.arange(GRUBIN_POINTS) + 0.5) / GRUBIN_POINTS
    x = 1.0 + (inlet - 1.0) * s**3
    gap = 0.5 * (x * np.sqrt(x * x - 1.0) - np.log(x + np.sqrt(x * x - 1.0)))
    return float((gap / (film + gap) ** power * s * s).sum() * 3.0 * (inlet - 1.0) / GRUBIN_POINTS)


def expected_film(case: Case, scales: Scales) -> float:
    """Central film by Moes' fit in a^2/R, scale of the Reynolds rows and film of the initial guess."""
    if case.fluid is None:
        return 1.0
    two_u = 2.0 * scales.eta0 * abs(scales.u) / (scales.E * scales.R)
    groups = scales.moes_m, scales.moes_l, scales.extent, two_u, scales.R / scales.a
    return max(scales.geometry.expected_film(*groups), 1e-6)
