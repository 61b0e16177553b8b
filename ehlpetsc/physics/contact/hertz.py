"""Dry smooth contact (Hertz): line contact and elliptic contact."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np


class Ellipse(NamedTuple):
    """Dry smooth point contact.

    `a`, `b`: semi-axes along and across the direction of motion [m]. `p0`: maximum pressure [Pa].
    `approach`: of distant points of both bodies [m].
    """

    a: float
    b: float
    p0: float
    approach: float


def hertz_line(load: float, radius: float, modulus: float) -> tuple[float, float]:
    r"""Half-width [m] and maximum pressure [Pa] of the dry smooth line contact.

    :math:`a=\sqrt{8w'R/(\pi E')}`, :math:`p_0=2w'/(\pi a)` (Johnson 1985, section 4.2).

    Parameters
    ----------
    load
        w' [N/m].
    radius
        R [m].
    modulus
        E' [Pa].
    """
    a = math.sqrt(8.0 * load * radius / (math.pi * modulus))
    return a, 2.0 * load / (math.pi * a)


def hertz_load(approach: float, radius_x: float, radius_y: float, modulus: float) -> float:
    r"""Load [N] of the dry smooth point contact of an approach [m], :math:`F\propto\delta^{3/2}`.

    Other parameters as of :func:`hertz_ellipse`.
    """
    return (approach / hertz_ellipse(1.0, radius_x, radius_y, modulus).approach) ** 1.5


def hertz_pressure(x: np.ndarray, a: float, p0: float) -> np.ndarray:
    r"""Pressure of a dry smooth cylinder, :math:`p_0\sqrt{1-(x/a)^2}`, 0 outside (Johnson 1985, eq. 4.44).

    Parameters
    ----------
    x
        Distance from the centre [m].
    a, p0
        Half-width [m] and maximum pressure [Pa].
    """
    return p0 * np.sqrt(np.maximum(1.0 - (np.asarray(x) / a) ** 2, 0.0))


def hertz_ellipse(load: float, radius_x: float, radius_y: float, modulus: float) -> Ellipse:
    r"""Semi-axes, maximum pressure and approach of the dry smooth point contact.

    With :math:`k=c_-/c_+` of the semi-axes, :math:`e^2=1-k^2` and the complete elliptic integrals K(e), E(e),

    .. math:: \frac{R_+}{R_-}=\frac{E/k^2-K}{K-E},\qquad
       \frac{1}{2R_+}=\frac{2p_0}{E'}\frac{k}{e^2c_+}(K-E),\qquad
       F=\frac{2\pi}{3}p_0c_+c_-,\qquad \delta=\frac{2p_0}{E'}c_-K

    (Johnson 1985, eqs. 4.24 to 4.32), plus and minus for the direction of the larger and the smaller
    semi-axis.

    Parameters
    ----------
    load
        F [N].
    radius_x, radius_y
        Radii of relative curvature along and across the direction of motion [m].
    modulus
        E' [Pa].
    """
    from scipy.optimize import brentq
    from scipy.special import ellipe, ellipkm1

    larger, smaller = max(radius_x, radius_y), min(radius_x, radius_y)
    if larger / smaller < 1.0 + 1e-9:  # e = 0, where the fractions are 0/0
        a = (1.5 * load * radius_x / modulus) ** (1.0 / 3.0)
        return Ellipse(a, a, 1.5 * load / (math.pi * a * a), a * a / radius_x)

    def misfit(log_k: float) -> float:
        k = math.exp(log_k)
        m = -math.expm1(2.0 * log_k)
        first, second = ellipkm1(k * k), ellipe(m)
        return math.log((second / k**2 - first) / (first - second)) - math.log(larger / smaller)

    log_k = brentq(misfit, -math.log(larger / smaller), -1e-10, xtol=1e-15, rtol=1e-14)
    k, m = math.exp(log_k), -math.expm1(2.0 * log_k)
    first, second = ellipkm1(k * k), ellipe(m)
    cubed = 6.0 * load * larger * (first - second) / (math.pi * modulus * m)  # of the larger semi-axis
    major = cubed ** (1.0 / 3.0)
    minor = k * major
    p0 = 1.5 * load / (math.pi * major * minor)
    axes = (major, minor) if radius_x >= radius_y else (minor, major)
    return Ellipse(*axes, p0, 2.0 * p0 * minor * first / modulus)
