"""Exact solutions and published formulas for tests: wavy profiles, films, heated bands."""

import numpy as np
from scipy.special import k0e


def westergaard_full_pressure(amplitude, wavelength, modulus):
    r"""Mean pressure [Pa] that closes the gap :math:`\Delta(1-\cos 2\pi x/l)`, :math:`p^*=\pi E'\Delta/(2l)`.

    Johnson 1985, section 13.2, after Westergaard 1939; E' as in `ehlpetsc.physics.scales.reduced_modulus`.
    """
    return np.pi * modulus * amplitude / (2.0 * wavelength)


def westergaard_half_width(mean_pressure, amplitude, wavelength, modulus):
    r"""Half-width c [m] of each contact of a wavy surface, :math:`\bar p/p^*=\sin^2(\pi c/l)`."""
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
    r"""Pressure [Pa] of the dry profile :math:`x^2/(2R)+Bx^4` in contact over half-width a.

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


def moving_band(x, flux, diffusivity, conductivity, speed):
    r"""Steady surface temperature [K] of a flux [W/m^2] at equally spaced x [m], constant in each cell.

    Jaeger 1942: :math:`T(x)=\frac1{\pi k}\int q(s)e^{U(x-s)}K_0(U|x-s|)\,ds`, :math:`U=u/(2\chi)`.
    """
    n, dx, u = len(x), x[1] - x[0], speed / (2.0 * diffusivity)
    points, weights = np.polynomial.legendre.leggauss(8)  # in each half cell
    s = 0.5 * (1.0 + points)  # s^3 clusters the points at the logarithm of K0
    offsets = 0.5 * dx * s**3
    lengths = 0.5 * dx * 0.5 * weights * 3.0 * s**2
    lag = np.arange(1 - n, n) * dx
    kernel = np.zeros(2 * n - 1)
    for sign in (1.0, -1.0):
        for offset, length in zip(offsets, lengths, strict=True):
            r = lag + sign * offset
            kernel += length * np.exp(u * r - abs(u) * np.abs(r)) * k0e(abs(u) * np.abs(r))
    return np.convolve(flux, kernel)[n - 1 : 2 * n - 1] / (np.pi * conductivity)


def hertz_gap(x: np.ndarray, a: float, radius: float) -> np.ndarray:
    r"""Gap outside the contact of a dry smooth cylinder [m], 0 inside.

    :math:`\frac{a^2}{2R}\left[X\sqrt{X^2-1}-\ln(X+\sqrt{X^2-1})\right]`, :math:`X=|x|/a`: the parabola
    and the deflection by the pressure of `hertz_pressure` (Johnson 1985, section 4.2).
    """
    ratio = np.maximum(np.abs(x) / a, 1.0)
    root = np.sqrt(ratio**2 - 1.0)
    return a**2 / (2.0 * radius) * (ratio * root - np.log(ratio + root))
