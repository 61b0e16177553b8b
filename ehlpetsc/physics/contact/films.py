r"""Films of smooth, steady, flooded contacts by formulas.

Groups of a line contact: :math:`U=\eta_0u/(E'R)`, :math:`G=\alpha E'`, :math:`W=w'/(E'R)`, u the mean speed;
Moes' :math:`M=W(2U)^{-1/2}`, :math:`L=G(2U)^{1/4}`, :math:`H=(h/R)(2U)^{-1/2}`.
"""

from __future__ import annotations

import math

import numpy as np

from ehlpetsc.physics.contact.hertz import hertz_ellipse, hertz_line

MIN_OVER_CENTRAL_FILM = 0.75  # of a line contact and an incompressible oil
# exponents of the density at p0: of central films, computed ones of a point, and of minimum films
LINE_COMPRESSION, POINT_COMPRESSION = (1.0, 0.25), (0.8, 0.1)
FITTED_M, FITTED_L, FITTED_RATIO = (
    (20.0, 8e3),
    (2.0, 15.0),
    (0.2, 10.0),
)  # ranges of the fit of point contacts
# coefficients of the fit, by cases/paper/point_films.py --compute
CENTRAL = (0.138, -0.028, -0.058, -0.056, -0.009, -0.007, 0.005, -0.038, 0.026, -0.87)
MINIMUM = (-0.815, -0.222, -0.052, 0.427, -0.01, 0.093, 0.009, 0.053, -0.07, -0.903)


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


def fit_terms(M: float, L: float, ratio: float) -> tuple[float, np.ndarray]:
    """Film H of Nijenbanning, Venner and Moes, and the terms of :func:`fitted_point_films`, shape (10,)."""
    rigid = brewe_rigid_film(M, ratio)
    base = nijenbanning_central_film(M, L, ratio, rigid)
    limits = FITTED_M, FITTED_L, FITTED_RATIO
    near = (min(max(value, low), high) for value, (low, high) in zip((M, L, ratio), limits, strict=True))
    x, y, z = (math.log(value / middle) for value, middle in zip(near, (200.0, 7.0, 1.0), strict=True))
    g = rigid / base
    return base, (1.0 - g) * np.array([1.0, x, y, z, x * y, x * z, y * z, y * y, z * z, g])


def fitted_point_films(M: float, L: float, ratio: float) -> tuple[float, float]:
    r"""Central and minimum film H of an elliptic contact and an incompressible oil, fitted to computed films.

    .. math:: \ln\frac H{H_N}=(1-g)(c_0+c_1x+c_2y+c_3z+c_4xy+c_5xz+c_6yz+c_7y^2+c_8z^2+c_9g),\qquad
       x=\ln\frac M{200},\quad y=\ln\frac L7,\quad z=\ln\frac{R_y}{R_x},\quad g=\frac{H_{RI}}{H_N}

    with :math:`H_N` of :func:`nijenbanning_central_film` with the rigid limit :math:`H_{RI}` of
    :func:`brewe_rigid_film`. A fit of this program's own films (`cases/paper/data/point_films.csv`; M from 20
    to 8,000, L from 2 to 15, :math:`R_y/R_x` from 0.2 to 10, up to 4 GPa; at 0.2 M up to 700, for L = 2 up to
    2,500, at 0.5 up to 2,500 and 8,000; Roelands' law, Dowson and Higginson's density), within 8 and 10 % of
    each; 97 films of an oil of 18e-9/Pa and z = 0.61 in place of 22e-9/Pa and 0.68 within 11 and 13 %, in the
    mean 5 and 4 %. Two films between, M = 2,500 at 0.2 and 8,000 at 0.5 with L = 5, are known to some 5 % and
    met within 9 %; at 0.2 and M = 8,000 no mesh of a million nodes resolves the minimum film. Beyond, x, y
    and z keep the values of the nearest M, L and ratio of this range. The minimum lies beside the contact, or
    behind that of a wide ellipse, and falls to a tenth of the central film, where that of
    :func:`hamrock_dowson_films` is half of it.

    `ratio`: :math:`R_y/R_x`.
    """
    base, terms = fit_terms(M, L, ratio)
    return base * math.exp(terms @ CENTRAL), base * math.exp(terms @ MINIMUM)


def line_films(
    viscosity: float, speed: float, alpha: float, load: float, radius: float, modulus: float, extent: float
) -> tuple[float, float, float]:
    """Films by Moes' fit, see :class:`.geometry.Geometry`."""
    M, L = line_groups(viscosity, speed, alpha, load, radius, modulus, extent)
    unit = radius * math.sqrt(2.0 * viscosity * speed / (modulus * radius))
    film = unit * moes_central_film(M, L)
    return film, MIN_OVER_CENTRAL_FILM * film, hertz_line(load / extent, radius, modulus)[1]


def point_films(
    viscosity: float, speed: float, alpha: float, load: float, radius: float, modulus: float, extent: float
) -> tuple[float, float, float]:
    """Films by :func:`fitted_point_films`, see :class:`.geometry.Geometry`."""
    M, L = point_groups(viscosity, speed, alpha, load, radius, modulus, extent)
    unit = radius * math.sqrt(2.0 * viscosity * speed / (modulus * radius))
    central, minimum = fitted_point_films(M, L, extent)
    return unit * central, unit * minimum, hertz_ellipse(load, radius, radius * extent, modulus).p0


def line_film(M: float, L: float, extent: float, two_u: float, slope: float) -> float:
    """Central film by Moes' fit in a^2/R, see :class:`.geometry.Geometry`."""
    return moes_central_film(M, L) * np.pi / (8.0 * M)


def point_film(M: float, L: float, extent: float, two_u: float, slope: float) -> float:
    """Central film by the fit of Nijenbanning, Venner and Moes in a^2/R, see :class:`.geometry.Geometry`."""
    return nijenbanning_central_film(M, L, extent) * math.sqrt(two_u) * slope**2
