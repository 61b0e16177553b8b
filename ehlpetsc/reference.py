r"""Exact solutions and published values that the solver is held against.

Dimensionless groups of a line contact: :math:`U=\eta_0u/(E'R)`, :math:`G=\alpha E'`, :math:`W=w'/(E'R)`,
u the mean speed; Moes' :math:`M=W(2U)^{-1/2}`, :math:`L=G(2U)^{1/4}`, :math:`H=(h/R)(2U)^{-1/2}`.
"""
from typing import NamedTuple

import numpy as np


def hertz_pressure(x, a, p0):
    r"""Pressure of a dry smooth cylinder, :math:`p_0\sqrt{1-(x/a)^2}`, 0 outside (Johnson 1985, eq. 4.44).

    Parameters
    ----------
    x : ndarray
        Distance from the centre [m].
    a, p0 : float
        Half width [m] and maximum pressure [Pa].
    """
    return p0 * np.sqrt(np.maximum(1.0 - (np.asarray(x) / a) ** 2, 0.0))


def hertz_gap(x, a, radius):
    r"""Gap beside a dry smooth cylinder [m], 0 inside.

    :math:`\frac{a^2}{2R}\left[X\sqrt{X^2-1}-\ln(X+\sqrt{X^2-1})\right]`, :math:`X=|x|/a`: the parabola
    and the deflection by the pressure of `hertz_pressure` (Johnson 1985, section 4.2).
    """
    ratio = np.maximum(np.abs(x) / a, 1.0)
    root = np.sqrt(ratio**2 - 1.0)
    return a**2 / (2.0 * radius) * (ratio * root - np.log(ratio + root))


def westergaard_full_pressure(amplitude, wavelength, modulus):
    r"""Mean pressure [Pa] that closes the gap :math:`\Delta(1-\cos 2\pi x/l)`, :math:`p^*=\pi E'\Delta/(2l)`.

    Johnson 1985, section 13.2, after Westergaard 1939; E' as in `ehlpetsc.scales.reduced_modulus`.
    """
    return np.pi * modulus * amplitude / (2.0 * wavelength)


def westergaard_half_width(mean_pressure, amplitude, wavelength, modulus):
    r"""Half width c [m] of each contact of a wavy surface, :math:`\bar p/p^*=\sin^2(\pi c/l)`."""
    full = westergaard_full_pressure(amplitude, wavelength, modulus)
    return wavelength / np.pi * np.arcsin(np.sqrt(np.minimum(mean_pressure / full, 1.0)))


def westergaard_pressure(x, mean_pressure, amplitude, wavelength, modulus):
    r"""Pressure [Pa] of a wavy surface with a crest at x = 0, for :math:`\bar p\le p^*`.

    :math:`p=2\bar p\,\frac{\cos\psi}{\sin^2\psi_c}\sqrt{\sin^2\psi_c-\sin^2\psi}`, :math:`\psi=\pi x/l`,
    :math:`\psi_c=\pi c/l` (Johnson 1985, section 13.2).
    """
    c = westergaard_half_width(mean_pressure, amplitude, wavelength, modulus)
    edge = np.sin(np.pi * c / wavelength) ** 2
    psi = np.pi * np.asarray(x) / wavelength
    root = np.sqrt(np.maximum(edge - np.sin(psi) ** 2, 0.0))
    return 2.0 * mean_pressure * np.abs(np.cos(psi)) / edge * root


def quartic_pressure(x, a, radius, modulus, quartic):
    r"""Pressure [Pa] of the dry profile :math:`x^2/(2R)+Bx^4` in contact over half width a.

    :math:`p=\left[E'/(4R)+E'B(x^2+a^2/2)\right]\sqrt{a^2-x^2}`: the two powers of the Steuermann profiles
    (Johnson 1985, section 5.3) added.

    Parameters
    ----------
    quartic : float
        B [1/m^3].
    """
    x = np.asarray(x)
    slope = modulus / (4.0 * radius) + modulus * quartic * (x**2 + a**2 / 2.0)
    return slope * np.sqrt(np.maximum(a**2 - x**2, 0.0))


def quartic_load(a, radius, modulus, quartic):
    r"""Load of `quartic_pressure` [N/m], :math:`\pi E'a^2/(8R)+3\pi E'Ba^4/8`."""
    return np.pi * modulus * a**2 / 8.0 * (1.0 / radius + 3.0 * quartic * a**2)


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


class Film(NamedTuple):
    """A smooth steady film: conditions, and least and central film thickness [um]."""

    viscosity: float
    speed: float
    slide_roll_ratio: float
    points_per_half_width: int | None
    h_min: float
    h_central: float


SMOOTH_FILMS = (
    Film(0.010, 5.0, 0.25, None, 0.22747, 0.26211),
    Film(0.005, 5.0, 0.25, None, 0.14216, 0.16314),
    Film(0.002, 5.0, 0.25, None, 0.07672, 0.08751),
    Film(0.005, 25.0, 0.10, None, 0.43387, 0.50144),
)
"""Table 1 contact and Eyring stress on [-4, 1.5] a: dense solutions extrapolated to zero mesh size, 0.2 %."""

SMOOTH_FILMS_BY_MESH = (
    Film(0.005, 5.0, 0.25, 100, 0.141250, 0.161532),
    Film(0.005, 5.0, 0.25, 200, 0.141722, 0.162430),
    Film(0.005, 5.0, 0.25, 400, 0.141839, 0.162654),
)
"""The second of `SMOOTH_FILMS` on [-2.5, 1.5] a and on finite meshes."""


class MoesPoint(NamedTuple):
    """Dimensionless films of a Newtonian, incompressible Barus fluid."""

    M: float
    L: float
    h_min: float
    h_central: float


MOES_POINTS = (MoesPoint(20.0, 10.0, 3.966, 5.262), MoesPoint(100.0, 11.0, 3.488, 4.656))
"""Computed by a dense solver."""

WAVINESS = {4.0: 0.030, 2.0: 0.073, 1.0: 0.183, 0.5: 0.394, 0.25: 0.660, 0.125: 0.839}
"""Wavelength/b -> amplitude ratio at M=100, L=11, Ai/Hc=0.1, pure rolling; Venner et al. 1997, table 1."""

WAVINESS_LINEAR = {4.0: 0.0298, 2.0: 0.0708, 1.0: 0.179, 0.5: 0.391, 0.25: 0.677, 0.125: 0.887}
"""The same by a linearised dense solution with their fluid; the shortest is mesh-sensitive."""


class Bounds(NamedTuple):
    """A value and its uncertainty."""

    value: float
    uncertainty: float


RIDGE = {
    "film at the centre": Bounds(0.148e-6, 0.001e-6),
    "h_min": Bounds(0.1253e-6, 0.0005e-6),
    "p_max": Bounds(1.179e9, 0.002e9),
}
"""Gaussian ridge 0.1 um exp(-((X-Xc)/0.1)^2) at Xc = 0, Table 1, eta0 = 0.005, u = 5, xi = 0.25 [m, m, Pa].

It travels at 0.875 u from Xc = -2 with the load held; computed by a dense solver."""

CONTACT_PROPORTIONS = {100: 1.0, 200: 1.26, 300: 1.48, 400: 1.76}
"""Points per half width -> mean contact rate over the coarsest mesh's; Holmes et al. 2005, section 3.1."""
