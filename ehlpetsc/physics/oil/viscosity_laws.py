r"""Viscosity of the oil by pressure and temperature: laws as pure functions, and data sheets.

A law is a function of p [Pa] and T [K], numbers or arrays, complex ones too, and of its constants. It
returns :math:`\ln(\eta/\eta_0)` and the derivatives by p and T. Its keys of `[fluid]` are beside it. The
table of laws is in :mod:`ehlpetsc.physics.oil.laws`.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ehlpetsc.base.compiled import compiled
from ehlpetsc.base.declarations import Key
from ehlpetsc.physics.oil.law import STANDARD_TEMPERATURE, Derivatives, Numbers

KELVIN = 273.15  # K at 0 degrees Celsius
GLASSY = -0.5  # x/(C2 + x) of Yasutomi's law below which the logarithm continues linearly, towards a solid
# temperature dependence of a power law
ISOTHERMAL, EXPONENTIAL, ROELANDS, WALTHER, ROELANDS_WALTHER = 0.0, 1.0, 2.0, 3.0, 4.0
ROELANDS_ZERO = 138.0  # K
MIN_ABOVE_POLE = 10.0  # K of T + D in the modulus law, below which the logarithm continues linearly
MIN_MODULUS = 1e7  # Pa: lower bound of its modulus, below that of any fit in its range
GOLD_PRESSURE = 2e8  # Pa: that of the secant of Gold's coefficients
WALTHER_SHIFT = 0.7  # mm^2/s


def power_law(
    p: Numbers,
    T: Numbers,
    factor: float,
    reference: float,
    z: float,
    thermal: float = ISOTHERMAL,
    first: float = 0.0,
    second: float = 0.0,
    t0: float = STANDARD_TEMPERATURE,
) -> Derivatives:
    r""":math:`\ln(\eta/\eta_0)` of Barus, z = 1, and Roelands, :math:`c\,[P-1]`, :math:`P=(1+p/p_r)^z`.

    With temperature, by `thermal`,

    * exponential: :math:`c[P-1]-\beta(T-T_0)`;
    * Roelands (1966): :math:`c\,[P\,\vartheta-1]`, :math:`\vartheta=((T-138)/(T_0-138))^{-S_0}`, T in K;
    * Walther: :math:`c[P-1]+\ln\nu(T)-\ln\nu(T_0)`, see :func:`walther`;
    * both: :math:`c[P-1]+P\,(\ln\nu(T)-\ln\nu(T_0))`, Walther's at ambient pressure, as Roelands' under it.
    """
    base = 1.0 + p / reference
    power = base**z  # in no branch, so that a compiler can share it between temperatures
    by_p = z * power / (base * reference)
    rise = p / reference if z == 1.0 else power - 1.0  # which would lose digits
    if thermal == ROELANDS:
        theta = ((T - ROELANDS_ZERO) / (t0 - ROELANDS_ZERO)) ** (-first)
        ln_eta = factor * (rise * theta + (theta - 1.0))
        return ln_eta, factor * by_p * theta, -factor * power * theta * first / (T - ROELANDS_ZERO)
    if thermal == ROELANDS_WALTHER:
        nu, slope = walther(T, first, second)
        change = np.log(nu) - np.log(walther(t0, first, second)[0])
        return factor * rise + power * change, by_p * (factor + change), power * slope
    ln_eta, by_p, by_t = factor * rise, factor * by_p, 0.0 * T
    if thermal == EXPONENTIAL:
        return ln_eta - first * (T - t0), by_p, by_t - first
    if thermal == WALTHER:
        nu, slope = walther(T, first, second)
        return ln_eta + np.log(nu) - np.log(walther(t0, first, second)[0]), by_p, slope
    return ln_eta, by_p, by_t


@compiled
def walther(temperature: Numbers, a: float, b: float) -> Derivatives:
    r"""Kinematic viscosity [mm^2/s], :math:`\lg\lg(\nu+0.7)=A-B\lg T` (ASTM D341), T in K; d ln(nu)/dT."""
    exponent = 10.0 ** (a - b * np.log(temperature) / 2.302585092994046)
    shifted = 10.0**exponent
    nu = shifted - WALTHER_SHIFT
    return nu, -shifted / nu * 2.302585092994046 * exponent * b / temperature


def walther_constants(v40: float, v100: float) -> tuple[float, float]:
    """A and B of :func:`walther` from the kinematic viscosities at 40 and 100 degrees Celsius [m^2/s]."""
    low, high = (np.log10(np.log10(1e6 * v + WALTHER_SHIFT)) for v in (v40, v100))
    cold, hot = np.log10(40.0 + KELVIN), np.log10(100.0 + KELVIN)
    b = (low - high) / (hot - cold)
    return low + b * cold, b


def gold_pressure_viscosity(nu: float) -> float:
    r"""Pressure-viscosity coefficient [1/Pa], :math:`\alpha=9.904\,\nu^{0.139}` /GPa, nu in mm^2/s.

    Gold, Schmidt, Dicke, Loos & Assmann, J. Synth. Lubr. 18 (2001) 51, their constants for mineral oils, as
    in the public program github.com/PedroTayer/contact_mechanics. That they are a secant of ln(eta) over
    2000 bar, usual in German data sheets, is from memory.
    """
    return 9.904e-9 * nu**0.139


def roelands_slope_of_secant(secant: float, decades: float, pressure: float, z: float | None = None) -> float:
    r"""Initial slope :math:`\alpha` [1/Pa] of Roelands' law by the secant of :math:`\ln\eta` over 2000 bar.

    :math:`D[(1+P/p_r)^z-1]=\alpha_sP`, :math:`\alpha=zD/p_r`; the secant as slope makes films 5 to
    10 % too thin.

    Parameters
    ----------
    decades, pressure
        :math:`D=\ln(\eta_0/\eta_r)`; :math:`p_r` [Pa].
    z
        Where it is given, D follows from the secant.
    """
    base = 1.0 + GOLD_PRESSURE / pressure
    if z is None:
        z = math.log(1.0 + secant * GOLD_PRESSURE / decades) / math.log(base)
        return z * decades / pressure
    return z * secant * GOLD_PRESSURE / ((base**z - 1.0) * pressure)


def doolittle(
    p: Numbers,
    T: Numbers,
    b: float,
    occupied: float,
    occupied_rise: float,
    k_slope: float,
    k_zero: float,
    k_decay: float,
    expansion: float,
    reference: float,
    offset: float,
) -> Derivatives:
    r"""Doolittle's free volume, :math:`B[v_\infty/(v-v_\infty)-\ldots_0]`, v by Tait, over that at T_R.

    :math:`v_\infty=R_0(1+\varepsilon(T-T_R))`, :math:`v=(1+a_V(T-T_R))[1-\ln(1+X)/(1+K_0')]`,
    :math:`X=p(1+K_0')/K_0`, :math:`K_0=K_{00}e^{-\beta_KT}`, T in K (Bair 2007, High-Pressure Rheology).
    """
    rise, one = T - reference, 1.0 + k_slope
    ratio = p * one * np.exp(k_decay * T) / k_zero
    ambient, shrinkage = 1.0 + expansion * rise, 1.0 - np.log(1.0 + ratio) / one
    v, full = ambient * shrinkage, occupied * (1.0 + occupied_rise * rise)
    v_p = -ambient * np.exp(k_decay * T) / (k_zero * (1.0 + ratio))
    v_t = expansion * shrinkage - ambient * k_decay * ratio / (one * (1.0 + ratio))
    over_free = 1.0 / (v - full)
    scale = b * over_free * over_free
    ln_eta = b * (full * over_free - offset)
    return ln_eta, -scale * full * v_p, scale * (occupied * occupied_rise * v - full * v_t)


DOOLITTLE = {
    "doolittle_b": Key("`B` of Doolittle's law", gt=0, le=20),
    "doolittle_occupied": Key("`R0`, occupied volume at doolittle_temperature", gt=0, lt=1),
    "doolittle_occupied_rise": Key("its relative rise with temperature", unit="1/K", ge=-0.01, le=0.01),
    "tait_slope": Key("`K0'`, of the bulk modulus with pressure", gt=0, le=50),
    "tait_modulus": Key("`K00`, bulk modulus `K00 exp(-beta_K T)`", unit="Pa", gt=0, le=1e12),
    "tait_decay": Key("`beta_K` of the bulk modulus, T in K", unit="1/K", ge=0, le=0.1),
    "tait_expansion": Key("`a_V` of the volume at ambient pressure", unit="1/K", ge=0, le=0.01),
    "doolittle_temperature": Key("`T_R` at which `R0` holds", unit="K", ge=150, le=700),
}


def yasutomi(
    p: np.ndarray,
    T: np.ndarray,
    c1: float,
    c2: float,
    tg0: float,
    a1: float,
    a2: float,
    b1: float,
    b2: float,
    offset: float,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    r"""Improved Yasutomi law: :math:`\ln(\eta/\eta_0)` and its derivatives by p [1/Pa] and T [1/K].

    .. math::
       \lg\frac\eta{\eta_g}=-\frac{C_1x}{C_2+x},\qquad x=(T-T_g)(1+b_1p)^{b_2},\qquad
       T_g=T_{g0}+A_1\ln(1+A_2p):

    Bair, Mary, Bouscharain & Vergne, Proc. IMechE J 227 (2013) 1056.
    :math:`\eta_g` is the viscosity at the glass transition :math:`T_g`. Temperatures are in K.

    Parameters
    ----------
    offset
        :math:`x/(C_2+x)` where :math:`\eta=\eta_0`; 0: :math:`\ln(\eta/\eta_g)`.
    """
    slope = 2.302585092994046 * c1
    growth, shift = 1.0 + b1 * p, 1.0 + a2 * p
    factor = growth**b2
    above = T - tg0 - a1 * np.log(shift)
    x = above * factor
    x_p = -a1 * a2 / shift * factor + x * b1 * b2 / growth
    bounded = np.maximum(x, c2 * GLASSY / (1.0 - GLASSY))
    over = 1.0 / (c2 + bounded)
    by_x = -slope * c2 * over * over
    value = -slope * (bounded * over - offset) + by_x * (x - bounded)
    return value, by_x * x_p, by_x * factor


YASUTOMI = {
    "yasutomi_c1": Key("`C1` of Yasutomi's law", gt=0, le=100),
    "yasutomi_c2": Key("`C2`", unit="K", gt=0, le=1000, is_difference=True),
    "yasutomi_glass": Key("`T_g0`, glass transition at ambient pressure", unit="K", ge=50, le=700),
    "yasutomi_a1": Key(
        "`A1` of the glass transition `T_g0 + A1 ln(1 + A2 p)`", unit="K", ge=0, le=2000, is_difference=True
    ),
    "yasutomi_a2": Key("`A2`", unit="1/Pa", ge=0, le=1e-6),
    "yasutomi_b1": Key("`b1` of the factor `(1 + b1 p)^b2`", unit="1/Pa", ge=0, le=1e-6),
    "yasutomi_b2": Key("`b2`", ge=-5, le=0),
}


def modulus(
    p: Any,
    T: Any,
    factor: float,
    c: float,
    d: float,
    a1: float,
    a2: float,
    b1: float,
    b2: float,
    offset: float,
) -> Derivatives:
    r"""Modulus law :math:`\ln(\eta/\eta_0)=f\,[C/(D+T)+p/m-\ldots_0]` with a modulus linear in p and T.

    :math:`m=a_1+a_2T+(b_1+b_2T)p`, T in K (Bode 1989; Dicke; Gold et al. 2001; as printed by Wingertszahn et
    al., Lubricants 11 (2023) 369, and Arana et al., Proc. IMechE J 233 (2019) 303). Constants of sources with
    T in degrees Celsius: :math:`D-273.15`, :math:`a_1-273.15\,a_2`, :math:`b_1-273.15\,b_2`.

    Parameters
    ----------
    factor, offset
        f = 1, less during a continuation; :math:`C/(D+T)` where :math:`\eta=\eta_0`.
    """
    above = np.maximum(T + d, MIN_ABOVE_POLE)
    rise = b1 + b2 * T
    full = a1 + a2 * T + rise * p
    m = np.maximum(full, MIN_MODULUS)
    by_t, by_m = -c / (above * above), -p / (m * m) * (full.real >= MIN_MODULUS)
    ln_eta = c / above + by_t * (T + d - above) + p / m - offset
    return factor * ln_eta, factor * (1.0 / m + by_m * rise), factor * (by_t + by_m * (a2 + b2 * p))


MODULUS = {
    "modulus_c": Key("`C` of the modulus law", unit="K", gt=0, le=1e4, is_difference=True),
    "modulus_d": Key(
        "`D`, T in K: of sources with T in degrees C less 273.15",
        unit="K",
        ge=-300,
        le=300,
        is_difference=True,
    ),
    "modulus_a1": Key("`a1`, T in K: of T in degrees C less `273.15 a2`", unit="Pa", ge=-1e10, le=1e10),
    "modulus_a2": Key("`a2`", unit="Pa/K", ge=0, le=1e8),
    "modulus_b1": Key("`b1`, T in K: of T in degrees C less `273.15 b2`", ge=-10, le=10),
    "modulus_b2": Key("`b2`", unit="1/K", ge=-0.1, le=0.1),
}
