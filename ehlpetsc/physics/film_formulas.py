r"""Film thickness formulas of smooth line contacts, and what is left of waviness.

Dimensionless groups of a line contact: :math:`U=\eta_0u/(E'R)`, :math:`G=\alpha E'`, :math:`W=w'/(E'R)`,
u the mean speed; Moes' :math:`M=W(2U)^{-1/2}`, :math:`L=G(2U)^{1/4}`, :math:`H=(h/R)(2U)^{-1/2}`.
"""

import numpy as np

FAR, STEPS = 100.0, 1000  # half widths that stand for infinity in Grubin's integral, its nodes


def dowson_higginson(U, G, W):
    r"""Least film over radius, :math:`h_{min}/R=2.65\,U^{0.7}G^{0.54}W^{-0.13}` (Dowson & Higginson 1966)."""
    return 2.65 * U**0.7 * G**0.54 * W**-0.13


def moes_central_film(M, L):
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


def waviness_ratio(r):
    r"""Amplitude left over initial amplitude of waviness in pure rolling, :math:`1/(1+0.17r+0.03r^2)`.

    :math:`r=(\lambda/b)M^{3/4}L^{-1/2}`; Venner, Couhier, Lubrecht & Greenwood 1997, their fit.
    """
    return 1.0 / (1.0 + 0.17 * r + 0.03 * r**2)


def inlet_opening(film, points):
    r"""How many films Hertz' gap opens beside the contact from one node to the next.

    :math:`\frac{2\sqrt2}{3}(\Delta x/a)^{3/2}` in :math:`a^2/R` over the film there. At 0.25 the film
    of a second-order scheme is some 5 % too thin, at 1 some 40 %; from about 5 on none is left.

    Parameters
    ----------
    film : float
        Central film in a^2/R.
    points : float
        Nodes a half width.
    """
    return 2.0 * np.sqrt(2.0) / 3.0 * points**-1.5 / film


def points_for_opening(film, opening):
    """Nodes a half width at which :func:`inlet_opening` is as given."""
    return (inlet_opening(film, 1.0) / opening) ** (2.0 / 3.0)


def film_left_by_inlet(film, inlet):
    r"""Film under an inlet that begins at a distance, over that of a flooded one.

    Grubin's integral :math:`\int(g/(h_c+g)^3)dX` over Hertz' gap g, taken from the inlet instead of from
    infinity, has the same value for the thinner film: what the pressure-viscosity coefficient asks for.

    Parameters
    ----------
    film : float
        Central film of the flooded contact in a^2/R.
    inlet : float
        Distance of the first node from the middle in half widths, above 1.
    """
    asked = _grubin(film, FAR)
    low, high = np.log(film) - 20.0, np.log(film)
    while high - low > 1e-3:  # the integral falls as the film grows
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _grubin(np.exp(middle), inlet) > asked else (low, middle)
    return float(np.exp(0.5 * (low + high)) / film)


def _grubin(film, inlet):
    r"""Integral of g/(h_c+g)^3 over 1 < X < `inlet`; X = 1 + (inlet - 1) s^3 has nodes where g is small."""
    s = (np.arange(STEPS) + 0.5) / STEPS
    x = 1.0 + (inlet - 1.0) * s**3
    gap = 0.5 * (x * np.sqrt(x * x - 1.0) - np.log(x + np.sqrt(x * x - 1.0)))
    return float((gap / (film + gap) ** 3 * s * s).sum() * 3.0 * (inlet - 1.0) / STEPS)


def expected_film(case, scales):
    """Central film by Moes' fit over all regimes, in a^2/R: divides the Reynolds rows and sets the start."""
    if case.fluid is None:
        return 1.0
    return max(moes_central_film(scales.moes_m, scales.moes_l) * np.pi / (8.0 * scales.moes_m), 1e-6)
