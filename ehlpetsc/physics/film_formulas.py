r"""Film thickness formulas of smooth line contacts.

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
    from ehlpetsc.physics.operation import Conditions
    from ehlpetsc.physics.scales import Scales


MIN_OVER_CENTRAL_FILM = 0.75  # of an incompressible oil
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


def smooth_films(fluid: Fluid, modulus: float, conditions: Conditions) -> tuple[float, float]:
    r"""Expected central and minimum film of the smooth, flooded contact [m].

    .. math:: h_c=h_{Moes}\,\frac{\rho_0}{\rho(p_0)},\qquad
       h_{min}=0.75\,h_{Moes}\left(\frac{\rho_0}{\rho(p_0)}\right)^{1/4}.

    The inlet entrains the mass of an incompressible oil, which passes the contact with its density at p0;
    the pressure of the exit constriction is lower. Both are within 4 % of computed films, compressible
    and incompressible, for M from 9 to 100 and L from 3 to 11 (`tests/unit/test_exact_solutions.py`), where
    :math:`h_{Moes}` alone exceeds the central film by 22 to 27 %.

    Parameters
    ----------
    modulus
        E' [Pa].
    """
    from ehlpetsc.physics.laws import density
    from ehlpetsc.physics.scales import hertz_line, moes_groups

    load, radius, speed = conditions.load, conditions.radius, abs(conditions.entrainment)
    if speed == 0.0:
        return 0.0, 0.0
    alpha = fluid.pressure_viscosity
    M, L = moes_groups(fluid.viscosity, speed, alpha, load, radius, modulus)
    unit = radius * math.sqrt(2.0 * fluid.viscosity * speed / (modulus * radius))
    incompressible = unit * moes_central_film(M, L)
    ratio = 1.0 / float(density(np.array([hertz_line(load, radius, modulus)[1]]), fluid)[0][0])
    return incompressible * ratio, MIN_OVER_CENTRAL_FILM * incompressible * ratio**0.25


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
    prescribed = _grubin(film, FAR_INLET)
    low, high = np.log(film) - 20.0, np.log(film)
    while high - low > 1e-3:  # the integral falls as the film grows
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _grubin(np.exp(middle), inlet) > prescribed else (low, middle)
    return float(np.exp(0.5 * (low + high)) / film)


def _grubin(film: float, inlet: float) -> float:
    r"""Integral of g/(h_c+g)^3 over 1 < X < `inlet`; X = 1 + (inlet - 1) s^3 has nodes where g is small."""
    s = (np.arange(GRUBIN_POINTS) + 0.5) / GRUBIN_POINTS
    x = 1.0 + (inlet - 1.0) * s**3
    gap = 0.5 * (x * np.sqrt(x * x - 1.0) - np.log(x + np.sqrt(x * x - 1.0)))
    return float((gap / (film + gap) ** 3 * s * s).sum() * 3.0 * (inlet - 1.0) / GRUBIN_POINTS)


def expected_film(case: Case, scales: Scales) -> float:
    """Central film by Moes' fit in a^2/R, scale of the Reynolds rows and film of the initial guess."""
    if case.fluid is None:
        return 1.0
    return max(moes_central_film(scales.moes_m, scales.moes_l) * np.pi / (8.0 * scales.moes_m), 1e-6)
