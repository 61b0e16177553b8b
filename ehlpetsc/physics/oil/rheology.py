r"""Shear laws of the oil: stress by rate, mobility of the pressure flow.

A law is an entry of `SHEAR_LAWS`: a function of :math:`x=\ln(\eta\dot\gamma/\tau_s)` and of its constants,
the first of which is its stress :math:`\tau_s`, a factor of the result. The pressure flow of Newton's and of
Eyring's law has a closed form; that of any other is a table, see :mod:`ehlpetsc.physics.oil.tabulated_flow`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ehlpetsc.base.case import Fluid
from ehlpetsc.base.compiled import address_of, call_at, compiled, inlined
from ehlpetsc.base.declarations import Key, Refused
from ehlpetsc.physics.oil.law import Derivatives, FluidValues, Law, n_constants, switched

MAX_SERIES_STRESS = 0.1  # |Sigma| below which the series of the Eyring factors are exact to 1e-14
NEWTON, EYRING, CARREAU = range(3)  # positions in `SHEAR_LAWS`
MAX_LN_SINH = 20.0  # above it asinh(exp(x)) is x + ln 2 to 1e-17, below its negative exp(x) to 1e-17
MAX_EXPONENT = 600.0
SHARPNESS = 20  # power of the smooth minimum of stress and limit


class FlowLaw(NamedTuple):
    r"""Shear stress by shear rate of an oil at one pressure and temperature.

    * `NEWTON`: :math:`\tau=\eta\dot\gamma`;
    * `EYRING`: :math:`\tau=\tau_0\,\mathrm{asinh}(\eta\dot\gamma/\tau_0)`;
    * `CARREAU`: :math:`\tau=\eta\dot\gamma[1+(\eta\dot\gamma/G)^a]^{(n-1)/a}` (Carreau 1972: a = 2; Yasuda
      1979), by the relaxation time :math:`\eta/G`.

    Attributes
    ----------
    kind
        One of the above, or the address of a user's law.
    stress
        :math:`\tau_0` or G [Pa]; 1 Pa for `NEWTON`.
    n, a
        Of `CARREAU`; second and third constant of a user's law.
    """

    kind: int
    stress: float = 1.0
    n: float = 1.0
    a: float = 2.0


def newton(x: float, stress: float) -> Derivatives:
    """Shear stress of Newton's law and its derivative by x."""
    tau = stress * (np.exp(x) if x.real < MAX_EXPONENT else np.exp(MAX_EXPONENT + 0.0 * x))
    return tau, tau


def eyring(x: float, stress: float) -> Derivatives:
    """Shear stress of Eyring's law and its derivative by x."""
    if x.real < -MAX_LN_SINH:
        tau = stress * np.exp(x)
        return tau, tau
    if x.real > MAX_LN_SINH:
        return stress * (x + 0.6931471805599453), stress + 0.0 * x
    e = np.exp(x)
    root = np.sqrt(1.0 + e * e)  # the logarithm takes a third of the time of arcsinh
    return stress * (np.log(e + root) if x.real > -2.0 else np.arcsinh(e)), stress * e / root


def carreau(x: float, stress: float, n: float, a: float) -> Derivatives:
    """Shear stress of Carreau's law and its derivative by x."""
    if x.real < -MAX_LN_SINH:
        tau = stress * np.exp(x)
        return tau, tau
    thinned, ln_sum = 1.0 + 0.0 * x, a * x
    if ln_sum.real < 2.0 * MAX_LN_SINH:
        e = np.exp(ln_sum)
        thinned, ln_sum = e / (1.0 + e), np.log(1.0 + e)
    tau = stress * np.exp(x + (n - 1.0) / a * ln_sum)
    return tau, tau * (1.0 + (n - 1.0) * thinned)


def _complete_carreau(fluid: FluidValues) -> dict[str, float]:
    if fluid.carreau_exponent is None:
        raise Refused("", "carreau_exponent")
    return {}


SHEAR_LAWS = {  # a law is that of the case whose first key, its stress, is given
    "newton": Law(newton, lambda fluid, heat: (1.0,), "`tau = eta g`"),
    "eyring": Law(
        eyring,
        lambda fluid, heat: (fluid.eyring_stress,),
        "`tau = tau0 asinh(eta g/tau0)`",
        {
            "eyring_stress": Key(
                "`tau0`, `du/dz = (tau0/eta) sinh(tau/tau0)`; left out: Newtonian", "Pa", 1e3, 1e12
            ),
            "eyring_stress_pressure": Key(
                "`b` of `tau0 (1 + b p) (1 + c (T - T0))`", "1/Pa", 0, 1e-7, needs=("fluid.eyring_stress",)
            ),
            "eyring_stress_temperature": Key(
                "`c` of it, `1/T0` by Eyring's theory; the pressure flow has `tau0` at `T0`",
                *("1/K", -0.02, 0.02),
                needs=("fluid.eyring_stress",),
            ),
        },
    ),
    "carreau": Law(
        carreau,
        lambda fluid, heat: (fluid.carreau_stress, fluid.carreau_exponent, fluid.carreau_width),
        "`tau = eta g (1 + (eta g/G)^a)^((n - 1)/a)`",
        {
            "carreau_stress": Key(
                "`G` of Carreau's law; left out: Eyring's or Newtonian",
                *("Pa", 1e3, 1e12),
                needs=("fluid.eyring_stress left out",),
                equation="`tau = eta g (1 + (eta g/G)^a)^((n - 1)/a)`, `g` the shear rate",
            ),
            "carreau_exponent": Key("`n` of Carreau's law", gt=0.2, lt=1, needs=("fluid.carreau_stress",)),
            "carreau_width": Key("`a` of it; Carreau: 2, otherwise Yasuda's", ge=0.5, le=10, default=2.0),
        },
        _complete_carreau,
    ),
}
KNOWN_SHEAR = tuple(SHEAR_LAWS.values())
N_SHEAR_LAWS = len(KNOWN_SHEAR)  # positions; larger numbers are addresses
_shear_stress = switched(SHEAR_LAWS, 1)


def shear_law(fluid: FluidValues) -> str:
    """Name of the shear law of a case."""
    keys = {name: next(iter(law.keys)) for name, law in SHEAR_LAWS.items() if law.keys}
    return next((name for name, key in keys.items() if getattr(fluid, key, None) is not None), "newton")


@inlined
def limited_shear(stress: float, limit: float) -> tuple[float, float, float]:
    r"""Shear stress of a film that bears `limit` at most, :math:`(\tau^{-n}+\tau_L^{-n})^{-1/n}`, n = 20.

    A smooth form of the minimum that fits to traction are made with (Bair & Winer 1979: :math:`\tau_L=\Lambda
    p`): 3.4 % below it where both are equal, 0.1 % where they differ by a fifth. Newton's method needs as
    many iterations as with n = 4, which takes 16 % off.

    Parameters
    ----------
    stress, limit
        [Pa], not negative.

    Returns
    -------
    value, by_stress, by_limit : float
    """
    if stress == 0.0 or limit == 0.0:
        return 0.0, 0.0, 0.0
    ratio = stress / limit
    if ratio.real > 1.0:
        value = limit * (1.0 + ratio**-SHARPNESS) ** (-1.0 / SHARPNESS)
    else:
        value = stress * (1.0 + ratio**SHARPNESS) ** (-1.0 / SHARPNESS)
    return value, (value / stress) ** (SHARPNESS + 1), (value / limit) ** (SHARPNESS + 1)


@inlined
def flow_stress(x: float, flow: FlowLaw, limit: float) -> tuple[float, float, float]:
    r"""Shear stress [Pa] by :math:`x=\ln(\eta\dot\gamma/\tau_s)`, :math:`\tau_s` the constant of the law.

    Limited by :func:`limited_shear` to `limit` [Pa]; infinite: not limited.

    Returns
    -------
    stress, by_x, by_limit
    """
    constants = (flow.stress, flow.n, flow.a)
    if flow.kind >= N_SHEAR_LAWS:
        tau, by_x, _ = call_at(flow.kind, x, 0.0, constants)
    else:
        tau, by_x = _shear_stress(flow.kind, (x,), constants)
    if limit == np.inf:
        return tau, by_x, 0.0 * by_x
    value, by_tau, by_limit = limited_shear(tau, limit)
    return value, by_x * by_tau, by_limit + 0.0 * by_x


def flow_law(fluid: Fluid) -> FlowLaw:
    """Shear law of a case with its constants."""
    law = SHEAR_LAWS[shear_law(fluid)]
    constants = map(float, law.constants(fluid, None))
    built_in = law in KNOWN_SHEAR
    kind = KNOWN_SHEAR.index(law) if built_in else address_of(law.function, n_constants(law.function, 1), 1)
    return FlowLaw(kind, *constants)


def stress_pressure(fluid: Fluid) -> float:
    """Relative rise of the Eyring stress with pressure [1/Pa]."""
    return getattr(fluid, "eyring_stress_pressure", None) or 0.0


# ---- pressure flow ----


@compiled
def flow_factors(sigma: float) -> tuple[float, float, float, float]:
    r"""Eyring factors of rolling and sliding, of one number.

    :math:`S_0=3(\Sigma\cosh\Sigma-\sinh\Sigma)/\Sigma^3` and :math:`L=3(\Sigma\coth\Sigma-1)/\Sigma^2`
    (Conry, Wang & Cusano 1987); near zero by their series, :math:`S_0=3\sum 2n\,\Sigma^{2n-2}/(2n+1)!`.

    Returns
    -------
    s0, ds0, el, del_ : float
        :math:`S_0`, L and their derivatives.
    """
    s = sigma
    if abs(s.real) < MAX_SERIES_STRESS:
        t = s * s
        return (
            1.0 + t * (1 / 10 + t * (1 / 280 + t * (1 / 15120 + t / 1330560))),
            s * (1 / 5 + t * (1 / 70 + t * (1 / 2520 + t / 166320))),
            1.0 + t * (-1 / 15 + t * (2 / 315 + t * (-1 / 1575 + t * 2 / 31185))),
            s * (-2 / 15 + t * (8 / 315 + t * (-6 / 1575 + t * 16 / 31185))),
        )
    over, grown = 1.0 / s, np.exp(s)  # one exponential for sinh, cosh and coth
    shrunk = 1.0 / grown
    sinh, cosh = 0.5 * (grown - shrunk), 0.5 * (grown + shrunk)
    coth = 1.0 + 2.0 / (grown * grown - 1.0)
    square = 3.0 * over * over
    s0 = square * (cosh - sinh * over)
    ds0 = square * sinh - 3.0 * s0 * over
    el = square * (s * coth - 1.0)
    return s0, ds0, el, square * (coth - s * (coth * coth - 1.0)) - 2.0 * el * over


@compiled
def mobilities(
    h: float, gradient: float, fluidity_l: float, fluidity_r: float, eyring: float, slip: float
) -> tuple[tuple, tuple]:
    r"""Pressure-driven flow per pressure gradient, :math:`M = h^3 S/(12\eta)`, of two oils in one gap.

    :math:`12M=\sqrt{(h^3S_0/\eta)^2+(h^2(u_1-u_2)L/\tau_0)^2}` with
    :math:`\Sigma=h\,p_x/(2\tau_0)` (Conry, Wang & Cusano 1987). M is finite both for
    :math:`\eta\to\infty`, where a sliding Eyring film still flows, and for :math:`h\to0`. Gap and gradient
    belong to a face, the viscosities to the nodes on both sides; numbers, not arrays.

    Parameters
    ----------
    h, gradient
        Film [m] and pressure gradient [Pa/m] of the face.
    fluidity_l, fluidity_r
        :math:`1/\eta` [1/(Pa s)] on both sides.
    eyring, slip
        Stress of the shear law [Pa], infinite: Newtonian, S = 1; :math:`|u_1-u_2|/\tau_0` [m/(Pa s)].

    Returns
    -------
    left, right : tuple of 4 floats
        M [m^3/(Pa s)] and its derivatives with respect to h, gradient and :math:`\ln\eta`.
    """
    if eyring == np.inf:
        square = 0.25 * h * h
        cube = square * h / 3.0
        left, right = cube * fluidity_l, cube * fluidity_r
        return (left, square * fluidity_l, 0.0, -left), (right, square * fluidity_r, 0.0, -right)
    per_film = gradient * (0.5 / eyring)
    factors = flow_factors(h * per_film)
    return (
        _mobility(h, per_film, fluidity_l, eyring, slip, factors),
        _mobility(h, per_film, fluidity_r, eyring, slip, factors),
    )


@compiled
def _mobility(
    h: float,
    per_film: float,
    fluidity: float,
    eyring: float,
    slip: float,
    factors: tuple[float, float, float, float],
) -> tuple[float, float, float, float]:
    """One of :func:`mobilities`; `per_film` is Sigma/h."""
    s0, ds0, el, del_ = factors
    square = h * h
    cube = h * square * fluidity
    rolling, sliding = cube * s0, slip * square * el
    value = np.sqrt(rolling * rolling + sliding * sliding)
    safe = 1.0 / value if value != 0.0 else 1.0
    rolls, slides = rolling * safe, sliding * safe
    by_sigma = rolls * cube * ds0 + slides * slip * square * del_
    by_h = rolls * 3.0 * square * fluidity * s0 + 2.0 * slides * slip * h * el
    return (
        value / 12.0,
        (by_h + by_sigma * per_film) / 12.0,
        by_sigma * h * (0.5 / eyring) / 12.0,
        -rolls * rolling / 12.0,
    )
