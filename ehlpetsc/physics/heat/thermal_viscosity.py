r"""Temperature dependence of viscosity, with derivatives, and oils as data sheets describe them.

Laws are functions of numbers or arrays in SI units and carry complex arguments through.
"""

import numpy as np

from ehlpetsc.compiled import compiled

ISOTHERMAL, EXPONENTIAL, ROELANDS, WALTHER = 0, 1, 2, 3
KELVIN = 273.15  # K at 0 degrees Celsius
ROELANDS_ZERO = 138.0  # K
WALTHER_SHIFT = 0.7  # mm^2/s


def log_viscosity(p, temperature, pressure_law, thermal_law):
    r"""Logarithm of the viscosity over the one at ambient pressure and reference temperature.

    With the pressure law :math:`c\,[P-1]`, :math:`P=(1+p/p_r)^z`,

    * exponential: :math:`c[P-1]-\beta(T-T_0)`;
    * Roelands (1966): :math:`c\,[P\,\vartheta-1]`, :math:`\vartheta=((T-138)/(T_0-138))^{-S_0}`, T in K;
    * Walther: :math:`c[P-1]+\ln\nu(T)-\ln\nu(T_0)`, see :func:`walther`.

    Parameters
    ----------
    p : float
        [Pa]
    temperature : float
        [K]
    pressure_law : tuple of 3 floats
        Factor, reference pressure [Pa] and exponent, of :func:`.rheology.viscosity_constants`.
    thermal_law : tuple of 4 floats
        Kind of the law, its two constants (beta; S0; A and B) and T0 [K].

    Returns
    -------
    ln_eta, by_p, by_temperature : float
    """
    factor, reference, z = pressure_law
    kind, first, second, t0 = thermal_law
    if z == 1.0:
        power, by_p, rise = 1.0 + p / reference, 1.0 / reference + 0.0 * p, p / reference
    else:
        base = 1.0 + p / reference
        power = base**z
        by_p, rise = z * power / (base * reference), power - 1.0
    if kind == ROELANDS:
        theta = ((temperature - ROELANDS_ZERO) / (t0 - ROELANDS_ZERO)) ** (-first)
        ln_eta = factor * (rise * theta + (theta - 1.0))
        return ln_eta, factor * by_p * theta, -factor * power * theta * first / (temperature - ROELANDS_ZERO)
    ln_eta, by_p, by_t = factor * rise, factor * by_p, 0.0 * temperature
    if kind == EXPONENTIAL:
        return ln_eta - first * (temperature - t0), by_p, by_t - first
    if kind == WALTHER:
        nu, slope = _walther(temperature, first, second)
        return ln_eta + np.log(nu) - np.log(_walther(t0, first, second)[0]), by_p, slope
    return ln_eta, by_p, by_t


@compiled
def _walther(temperature, a, b):
    """Kinematic viscosity [mm^2/s] and the derivative of its logarithm by T [1/K]."""
    exponent = 10.0 ** (a - b * np.log(temperature) / 2.302585092994046)
    shifted = 10.0**exponent
    nu = shifted - 0.7
    return nu, -shifted / nu * 2.302585092994046 * exponent * b / temperature


def walther(temperature, a, b):
    r"""Kinematic viscosity [mm^2/s], :math:`\lg\lg(\nu+0.7)=A-B\lg T` (ASTM D341), T in K.

    Returns
    -------
    nu, dln_nu_dt : ndarray
        Viscosity and the derivative of its logarithm [1/K].
    """
    return _walther(temperature, a, b)


def walther_constants(v40, v100):
    """Constants A and B of :func:`walther` of an oil.

    Parameters
    ----------
    v40, v100 : float
        Kinematic viscosities at 40 and 100 degrees Celsius [m^2/s].
    """
    low, high = (np.log10(np.log10(1e6 * v + WALTHER_SHIFT)) for v in (v40, v100))
    cold, hot = np.log10(40.0 + KELVIN), np.log10(100.0 + KELVIN)
    b = (low - high) / (hot - cold)
    return low + b * cold, b


def gold_pressure_viscosity(nu):
    r"""Pressure-viscosity coefficient of a mineral oil [1/Pa], :math:`\alpha=9.904\,\nu^{0.139}` /GPa.

    Gold, Schmidt, Dicke, Loos & Assmann, J. Synth. Lubr. 18 (2001) 51, their constants for mineral oils.

    Parameters
    ----------
    nu : float
        Kinematic viscosity at the temperature in question [mm^2/s].
    """
    return 9.904e-9 * nu**0.139


def limited_shear(stress, limit):
    r"""Shear stress of a film that bears `limit` at most, :math:`(\tau^{-4}+\tau_L^{-4})^{-1/4}`.

    Smooth, within 1.5 % of the smaller one where they differ by a factor of two. (Bair & Winer 1979
    introduced :math:`\tau_L=\Lambda p`; the power 4 is a choice.)

    Parameters
    ----------
    stress, limit : float
        [Pa], not negative.

    Returns
    -------
    value, by_stress, by_limit : float
    """
    if stress == 0.0 or limit == 0.0:
        return 0.0, 0.0, 0.0
    ratio = stress / limit
    if ratio.real > 1.0:
        down = 1.0 / ratio**4
        value = limit * (1.0 + down) ** -0.25
    else:
        value = stress * (1.0 + ratio**4) ** -0.25
    return value, (value / stress) ** 5, (value / limit) ** 5
