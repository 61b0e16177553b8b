r"""Properties of measured oils under pressure: viscosity, conductivity, and oils with published constants.

Laws are functions of numbers or arrays in SI units, with their derivatives, as those of :mod:`.laws`; complex
arguments are carried through.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from ehlpetsc.base.compiled import compiled, inlined
from ehlpetsc.physics.film_shear import CARREAU, NEWTON, FlowLaw

KELVIN = 273.15  # K at 0 degrees Celsius
ROELANDS_ZERO = 138.0  # K
ROELANDS_EXPONENT = 9.67  # ln of 1 Pa s over Roelands' viscosity, 6.315e-5 Pa s
ROELANDS_PRESSURE = 1.96e8  # Pa
GOLD_PRESSURE = 2e8  # Pa: that of the secant of Gold's coefficients
GLASSY = -0.5  # x/(C2 + x) of Yasutomi's law below which the logarithm continues linearly, towards a solid


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
        :math:`x/(C_2+x)` where :math:`\eta=\eta_0`, by :func:`yasutomi_offset`; 0: :math:`\ln(\eta/\eta_g)`.
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


def yasutomi_offset(T: float, c1: float, c2: float, tg0: float) -> float:
    """Last constant of :func:`yasutomi`, where the viscosity at ambient pressure and T is the reference."""
    return (T - tg0) / (c2 + T - tg0)


@inlined
def conductivity(p: float, ambient: float, c1: float, c2: float) -> tuple[float, float]:
    r"""Conductivity of an oil [W/(m K)], :math:`k_0[1+c_1p/(1+c_2p)]`, and its derivative by p.

    Larsson & Andersson, Proc. IMechE J 214 (2000) 337, doi:10.1243/1350650001543223, measured to 1.1 GPa.
    """
    over = 1.0 / (1.0 + c2 * p)
    return ambient * (1.0 + c1 * p * over), ambient * c1 * over * over


CONDUCTIVITY = {  # k0 [W/(m K)], c1, c2 [1/Pa] of Larsson & Andersson
    "polyalphaolefin": (0.154, 1.40e-9, 0.34e-9),
    "paraffinic": (0.137, 1.72e-9, 0.54e-9),  # both mineral oils from memory, not checked against the article
    "naphthenic": (0.118, 1.54e-9, 0.33e-9),
}


def roelands_s0(eta: float, slope: float, T: float) -> float:
    r"""Exponent :math:`S_0` of Roelands' law with the slope :math:`-d\ln\eta/dT` [1/K] at ambient pressure.

    :math:`S_0=\beta(T-138)/(\ln\eta+9.67)` (Roelands 1966), :math:`\eta` [Pa s] at T [K]. At a pressure p the
    slope is then :math:`(1+p/p_r)^z` times that.
    """
    return slope * (T - ROELANDS_ZERO) / (math.log(eta) + ROELANDS_EXPONENT)


def roelands_s0_of_two(eta: tuple[float, float], T: tuple[float, float]) -> float:
    """The same by viscosities [Pa s] at two temperatures [K], such as those of a data sheet."""
    cold, hot = (math.log(value) + ROELANDS_EXPONENT for value in eta)
    return math.log(cold / hot) / math.log((T[1] - ROELANDS_ZERO) / (T[0] - ROELANDS_ZERO))


def roelands_of_secant(
    secant: float, eta: float, span: float = GOLD_PRESSURE, reference: float = ROELANDS_PRESSURE
) -> tuple[float, float]:
    r"""Exponent z and initial slope :math:`\alpha` [1/Pa] of Roelands' law by the secant of :math:`\ln\eta`.

    :math:`(\ln\eta_0+9.67)[(1+P/p_r)^z-1]=\alpha_sP`, :math:`\alpha=z(\ln\eta_0+9.67)/p_r`. The
    coefficients of Gold et al., J. Synth. Lubr. 18 (2001) 51, are such secants over 2000 bar, as is usual in
    German data sheets (from memory: the article was not checked). Used as slopes they make films 5 to 10 %
    too thin.
    """
    decades = math.log(eta) + ROELANDS_EXPONENT
    z = math.log(1.0 + secant * span / decades) / math.log(1.0 + span / reference)
    return z, z * decades / reference


# ---- pressure flow of Carreau's law ----

SHALLOW = 1e-3  # difference of stress across the film over the law's, below which M is that of this one
_Z, _WEIGHTS = (0.5 * half for half in np.polynomial.legendre.leggauss(8))  # across a film of thickness 1


@inlined
def carreau_rate(stress: float, flow: FlowLaw) -> tuple[float, float]:
    """Shear rate times viscosity [Pa] of `CARREAU` by stress [Pa], and its derivative."""
    t = abs(stress) / flow.stress
    if t < 1e-8:
        return stress, 1.0
    ln_t, power = np.log(t), (flow.n - 1.0) / flow.a
    x = ln_t if t < 1.0 else ln_t / flow.n
    slope = 1.0
    for _ in range(50):
        e = np.exp(-flow.a * abs(x))
        thinned = e / (1.0 + e) if x < 0.0 else 1.0 / (1.0 + e)
        slope = 1.0 + (flow.n - 1.0) * thinned
        change = (ln_t - x - power * (max(flow.a * x, 0.0) + np.log(1.0 + e))) / slope
        x += change
        if abs(change) < 1e-9:
            break
    rate = flow.stress * np.exp(x)
    return (rate if stress > 0.0 else -rate), rate / (t * flow.stress * slope)


@compiled
def carreau_flow(
    h: float, gradient: float, sliding: float, eta: float, flow: FlowLaw
) -> tuple[float, float, float, float, float]:
    r"""Mobility of the pressure flow in a sheared film of Carreau's law, isothermal across the film.

    :math:`M=\frac1{p_x}\int z\,\dot\gamma(\tau_m+zp_x)\,dz` by eight Gauss points, :math:`\tau_m` by
    :math:`\int\dot\gamma\,dz=u_1-u_2`; without a gradient :math:`M=\dot\gamma'(\tau_m)\,h^3/12`. Exact to
    1e-4. Of a face, as :func:`.rheology.mobilities` is for Eyring's law.

    Returns
    -------
    M, by_h, by_gradient, by_ln_eta
        [m^3/(Pa s)]
    stress
        :math:`\tau_m` [Pa].
    """
    target = abs(sliding) * eta / h
    least = SHALLOW * flow.stress / h
    steep = max(abs(gradient), least)  # M is even in the gradient
    stress = target
    if target > 0.0:
        x = min(flow.a * np.log(target / flow.stress), 600.0)
        stress = target * (1.0 + np.exp(x)) ** ((flow.n - 1.0) / flow.a)
    j0, j1, j2, i1 = 1.0, 0.0, 1.0, 0.0
    for _ in range(50):
        i0, j0, j1, j2, i1 = 0.0, 0.0, 0.0, 0.0, 0.0
        for k in range(len(_Z)):
            rate, slope = carreau_rate(stress + _Z[k] * h * steep, flow)
            i0 += _WEIGHTS[k] * rate
            i1 += _WEIGHTS[k] * rate * _Z[k]
            j0 += _WEIGHTS[k] * slope
            j1 += _WEIGHTS[k] * slope * _Z[k]
            j2 += _WEIGHTS[k] * slope * _Z[k] * _Z[k]
        change = (target - i0) / j0
        stress = max(stress + change, 0.0)
        if abs(change) <= 1e-10 * (stress + h * steep):
            break
    scale = h * h / (eta * steep)
    value, by_target, by_drop = scale * i1, scale * target * j1 / j0, scale * (j2 - j1 * j1 / j0)
    return (
        value,
        (2.0 * value + by_drop * h * steep - by_target) / h,
        (by_drop * h - value / steep) * gradient / steep,
        by_target - value,
        stress,
    )


# ---- oils ----


class Oil(NamedTuple):
    r"""A measured oil.

    Attributes
    ----------
    eta, temperature
        Viscosity at ambient pressure [Pa s] at the temperature [K].
    alpha, beta
        :math:`d\ln\eta/dp` [1/Pa] and :math:`-d\ln\eta/dT` [1/K] there.
    yasutomi
        Constants of the law from `c1` to `b2`; none: Roelands' law with alpha and beta.
    density, heat_capacity, conductivity
        [kg/m^3], [J/(kg K)], constants of :func:`conductivity`.
    flow, limit
        Shear stress by shear rate; limiting shear stress over pressure.
    """

    source: str
    eta: float
    temperature: float
    alpha: float
    beta: float
    density: float
    heat_capacity: float
    conductivity: tuple[float, float, float]
    yasutomi: tuple[float, ...] = ()
    flow: FlowLaw = FlowLaw(NEWTON)
    limit: float = math.inf


_PAO = (
    "data of github.com/DausdasKreuz/Thermoelastohydrodynamics_time_transient, which names no article; "
    "conductivity by Larsson & Andersson 2000"
)
_T9 = (
    "Bjoerling, Habchi, Bair, Larsson & Marklund, Tribol. Int. 66 (2013) 19, "
    "doi:10.1016/j.triboint.2013.04.008: constants from memory, not checked against the article"
)
_C1, _C2 = CONDUCTIVITY["polyalphaolefin"][1:]

OILS = {
    "pao4": Oil(_PAO, 13.62e-3, 313.15, 14.8e-9, 0.03, 815.8, 2049.0, (0.1407, _C1, _C2), limit=0.0395),
    "pao10": Oil(_PAO, 52.52e-3, 313.15, 17.1e-9, 0.03, 835.0, 2046.0, (0.16, _C1, _C2), limit=0.0395),
    "pao40": Oil(_PAO, 345.8e-3, 313.15, 23.89e-9, 0.03, 843.4, 2045.0, (0.1641, _C1, _C2), limit=0.0395),
    "t9": Oil(
        _T9,
        0.007946,
        313.15,
        21.7e-9,
        0.0326,
        872.0,
        1950.0,
        CONDUCTIVITY["naphthenic"],
        (16.09, 17.38, KELVIN - 83.2, 188.95, 0.719e-9, 8.2e-9, -0.5278),
        FlowLaw(CARREAU, 7e6, 0.35, 5.0),
        0.083,
    ),
}
