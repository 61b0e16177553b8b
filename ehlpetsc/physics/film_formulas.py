r"""Film thickness formulas of smooth line and point contacts.

Dimensionless groups of a line contact: :math:`U=\eta_0u/(E'R)`, :math:`G=\alpha E'`, :math:`W=w'/(E'R)`,
u the mean speed; Moes' :math:`M=W(2U)^{-1/2}`, :math:`L=G(2U)^{1/4}`, :math:`H=(h/R)(2U)^{-1/2}`.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ehlpetsc.case.tables import Case
    from ehlpetsc.case.tables.contact import Fluid
    from ehlpetsc.physics.geometry import Geometry
    from ehlpetsc.physics.operation import Conditions
    from ehlpetsc.physics.scales import Scales


MIN_OVER_CENTRAL_FILM = 0.75  # of an incompressible oil
MAX_FILM_ITERATIONS = 200
FAR_INLET, GRUBIN_POINTS = 100.0, 1000  # half-widths in place of infinity in Grubin's integral; its points


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
    side_leakage, load = _rigid_factors(ratio)
    return 32.0 * ratio * (side_leakage * load / M) ** 2


def _rigid_factors(ratio: float) -> tuple[float, float]:
    r""":math:`\varphi` and :math:`\mathcal L` of :func:`brewe_rigid_film`."""
    return 1.0 / (1.0 + 2.0 / (3.0 * ratio)), 0.131 * math.atan(0.5 * ratio) + 1.683


def load_outside(scales: Scales, film: float, inlet: float, half_width: float) -> float:
    r"""Load of the oil before and beside the mesh of a flooded point contact [N].

    .. math:: p=4\eta_0u\varphi\,\frac{2\mathcal L}{\pi}\,\frac{-x}{h^2},\qquad
       h=h_c+\frac{x^2}{2R_x}+\frac{y^2}{2R_y},\qquad x<0

    of rigid bodies and ambient viscosity (Kapitza 1955), to the load of :func:`brewe_rigid_film`, integrated
    outside :math:`x>-` `inlet`, :math:`|y|<` `half_width`. It falls as slowly as 1 over the distance.

    Parameters
    ----------
    film, inlet, half_width
        Central film, distances of the first node and of the edges from the middle [m].
    """
    side_leakage, load = _rigid_factors(scales.radius_ratio)
    across = 2.0 * scales.R * scales.radius_ratio

    def inside(gap: float) -> float:
        return math.atan(half_width / math.sqrt(across * gap)) / math.sqrt(gap)

    integral = 0.5 * math.pi / math.sqrt(film) - inside(film) + inside(film + 0.5 * inlet**2 / scales.R)
    pressure = 8.0 / math.pi * scales.eta0 * abs(scales.u) * side_leakage * load
    return pressure * 2.0 * scales.R * math.sqrt(across) * integral


def film_on_mesh(case: Case, scales: Scales, inlet: float, half_width: float) -> tuple[float, float]:
    """Share of the load that a flooded point contact carries outside a mesh; film on it over the flooded one.

    On the mesh the contact carries that load too: its film is that of a flooded contact under the load and
    that outside, by :func:`load_outside`, parameters as there.
    """
    fluid, groups = case.fluid, (scales.R, scales.E, scales.radius_ratio)

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


def smooth_films(scales: Scales, fluid: Fluid, conditions: Conditions) -> tuple[float, float]:
    r"""Expected central and minimum film of the smooth, flooded contact [m].

    .. math:: h_c=h_{Moes}\,\frac{\rho_0}{\rho(p_0)},\qquad
       h_{min}=0.75\,h_{Moes}\left(\frac{\rho_0}{\rho(p_0)}\right)^{1/4}.

    The inlet entrains the mass of an incompressible oil, which passes the contact with its density at p0;
    the pressure of the exit constriction is lower. Both are within 4 % of computed films, compressible
    and incompressible, for M from 9 to 100 and L from 3 to 11 (`tests/unit/test_scales.py`), where
    :math:`h_{Moes}` alone exceeds the central film by 22 to 27 %.

    In a point contact the minimum over the central film is that of Hamrock and Dowson (1977).
    """
    return contact_films(scales.geometry, scales.E, scales.radius_ratio, fluid, conditions)


def contact_films(
    geometry: Geometry, modulus: float, radius_ratio: float, fluid: Fluid, conditions: Conditions
) -> tuple[float, float]:
    """Films of :func:`smooth_films` of a kind of contact; E' [Pa] and the ratio of its radii."""
    from ehlpetsc.physics.laws import density

    load, radius, speed = conditions.load, conditions.radius, abs(conditions.entrainment)
    if speed == 0.0:
        return 0.0, 0.0
    groups = fluid.viscosity, speed, fluid.pressure_viscosity, load, radius, modulus
    incompressible, lowest, p0 = geometry.smooth_films(*groups, radius_ratio)
    ratio = 1.0 / float(density(np.array([p0]), fluid)[0][0])
    return incompressible * ratio, lowest * incompressible * ratio**0.25


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
    return max(scales.geometry.expected_film(scales), 1e-6)
