r"""Shear laws of the oil: stress by rate, mobility of the pressure flow.

A law is a branch of :func:`flow_stress` and a line in `SHEAR_LAWS`. The pressure flow of Newton's and of
Eyring's law has a closed form; that of any other is a table, see :mod:`ehlpetsc.physics.tabulated_flow`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ehlpetsc.base.compiled import compiled, inlined

if TYPE_CHECKING:
    from ehlpetsc.case.tables.contact import Fluid

SERIES_LIMIT = 0.1  # |Sigma| below which the series of the Eyring factors are exact to 1e-14
NEWTON, EYRING, CARREAU = 0, 1, 2
SHEAR_LAWS = {"eyring_stress": EYRING, "carreau_stress": CARREAU}  # by the key of its stress; none: Newton
MAX_LN_SINH = 20.0  # above it asinh(exp(x)) is x + ln 2 to 1e-17, below its negative exp(x) to 1e-17
MAX_EXPONENT = 600.0


class FlowLaw(NamedTuple):
    r"""Shear stress by shear rate of an oil at one pressure and temperature.

    * `NEWTON`: :math:`\tau=\eta\dot\gamma`;
    * `EYRING`: :math:`\tau=\tau_0\,\mathrm{asinh}(\eta\dot\gamma/\tau_0)`;
    * `CARREAU`: :math:`\tau=\eta\dot\gamma[1+(\eta\dot\gamma/G)^a]^{(n-1)/a}` (Carreau 1972: a = 2; Yasuda
      1979), by the relaxation time :math:`\eta/G`.

    Attributes
    ----------
    kind
        One of the above.
    stress
        :math:`\tau_0` or G [Pa]; 1 Pa for `NEWTON`.
    n, a
        Of `CARREAU`.
    """

    kind: int
    stress: float = 1.0
    n: float = 1.0
    a: float = 2.0


@inlined
def limited_shear(stress: float, limit: float) -> tuple[float, float, float]:
    r"""Shear stress of a film that bears `limit` at most, :math:`(\tau^{-4}+\tau_L^{-4})^{-1/4}`.

    Smooth, within 1.5 % of the smaller one where they differ by a factor of two. (Bair & Winer 1979
    introduced :math:`\tau_L=\Lambda p`; the power 4 is a choice.)

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
        down = 1.0 / ratio**4
        value = limit * (1.0 + down) ** -0.25
    else:
        value = stress * (1.0 + ratio**4) ** -0.25
    return value, (value / stress) ** 5, (value / limit) ** 5


@inlined
def flow_stress(x: float, flow: FlowLaw, limit: float) -> tuple[float, float, float]:
    r"""Shear stress [Pa] by :math:`x=\ln(\eta\dot\gamma/\tau_s)`, :math:`\tau_s` the constant of the law.

    Limited by :func:`limited_shear` to `limit` [Pa]; infinite: not limited.

    Returns
    -------
    stress, by_x, by_limit
    """
    if flow.kind == NEWTON or x.real < -MAX_LN_SINH:
        tau = flow.stress * (np.exp(x) if x.real < MAX_EXPONENT else np.exp(MAX_EXPONENT + 0.0 * x))
        by_x = tau
    elif flow.kind == EYRING:
        if x.real > MAX_LN_SINH:
            tau, by_x = flow.stress * (x + 0.6931471805599453), flow.stress + 0.0 * x
        else:
            e = np.exp(x)
            root = np.sqrt(1.0 + e * e)  # the logarithm takes a third of the time of arcsinh
            tau = flow.stress * (np.log(e + root) if x.real > -2.0 else np.arcsinh(e))
            by_x = flow.stress * e / root
    else:
        thinned, ln_sum = 1.0 + 0.0 * x, flow.a * x
        if ln_sum.real < 2.0 * MAX_LN_SINH:
            e = np.exp(ln_sum)
            thinned, ln_sum = e / (1.0 + e), np.log(1.0 + e)
        tau = flow.stress * np.exp(x + (flow.n - 1.0) / flow.a * ln_sum)
        by_x = tau * (1.0 + (flow.n - 1.0) * thinned)
    if limit == np.inf:
        return tau, by_x, 0.0 * by_x
    value, by_tau, by_limit = limited_shear(tau, limit)
    return value, by_x * by_tau, by_limit + 0.0 * by_x


def flow_law(fluid: Fluid) -> FlowLaw:
    """Shear law of a case."""
    for key, kind in SHEAR_LAWS.items():
        if getattr(fluid, key, None) is not None:
            stress = float(getattr(fluid, key))
            if kind == EYRING:
                return FlowLaw(kind, stress)
            return FlowLaw(kind, stress, float(fluid.carreau_exponent), float(fluid.carreau_width))
    return FlowLaw(NEWTON)


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
    if abs(s.real) < SERIES_LIMIT:
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
    h: float,
    gradient: float,
    fluidity_l: float,
    fluidity_r: float,
    eyring: float,
    slip: float,
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
