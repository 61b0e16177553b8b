r"""Film thickness formulas of smooth line contacts, and what is left of waviness.

Dimensionless groups of a line contact: :math:`U=\eta_0u/(E'R)`, :math:`G=\alpha E'`, :math:`W=w'/(E'R)`,
u the mean speed; Moes' :math:`M=W(2U)^{-1/2}`, :math:`L=G(2U)^{1/4}`, :math:`H=(h/R)(2U)^{-1/2}`.
"""

import numpy as np


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


def expected_film(case, scales):
    """Central film by Moes' fit over all regimes, in a^2/R: divides the Reynolds rows and sets the start."""
    if case.fluid is None:
        return 1.0
    return max(moes_central_film(scales.moes_m, scales.moes_l) * np.pi / (8.0 * scales.moes_m), 1e-6)
