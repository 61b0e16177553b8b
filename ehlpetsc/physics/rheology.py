r"""Flow of a film: Eyring's factors, the mobility of the pressure flow and the shear stress at the walls."""

from __future__ import annotations

from typing import Any

import numpy as np

from ehlpetsc.base.compiled import compiled

SERIES_LIMIT = 0.1  # |Sigma| below which the series of the Eyring factors are exact to 1e-14


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
        :math:`\tau_0` [Pa], infinite for a Newtonian fluid, S = 1; :math:`|u_1-u_2|/\tau_0` [m/(Pa s)].

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


def wall_shear(
    h: Any, gradient: Any, ln_eta: np.ndarray, fluid: Any, sliding: float, p: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    r"""Shear stress at the lower and the upper wall, :math:`\tau(\mp h/2)=\tau_m\mp hp_x/2`.

    :math:`\tau_m=\tau_0\,\mathrm{asinh}(\zeta\Sigma/\sinh\Sigma)`, :math:`\zeta=\eta(u_1-u_2)/(\tau_0h)`
    (Conry, Wang & Cusano 1987); Newtonian: :math:`\tau_m=\eta(u_1-u_2)/h`. With a limiting shear stress
    :math:`\tau_m` is limited to :math:`\Lambda p`, see :func:`limited_shear`.

    Returns
    -------
    lower, upper : ndarray
        Shear stress [Pa] in the film at the walls of surface 2 (lower) and 1 (upper), at h > 0.
    """
    rate = sliding / h
    half = h * gradient / 2.0
    if fluid.eyring_stress is None:
        mean = fluid.viscosity * np.exp(ln_eta) * rate
        mean = _limited_mean(mean, fluid, p)
        return mean - half, mean + half
    tau0 = fluid.eyring_stress
    sigma = np.abs(half) / tau0
    # ln(sinh(s)/s), so that neither a huge viscosity nor a steep gradient overflows
    small = sigma < SERIES_LIMIT
    s, square = np.where(small, 1.0, sigma), sigma * sigma
    series = square * (1 / 6 - square * (1 / 180 - square / 2835))
    log_sinh_ratio = np.where(small, series, s + np.log1p(-np.exp(-2 * s)) - np.log(2 * s))
    with np.errstate(divide="ignore"):
        ln_argument = np.log(np.abs(rate) * fluid.viscosity / tau0) + ln_eta - log_sinh_ratio
    large = ln_argument > 20.0
    asinh = np.where(large, ln_argument + np.log(2.0), np.arcsinh(np.exp(np.minimum(ln_argument, 20.0))))
    mean = _limited_mean(tau0 * np.sign(sliding) * asinh, fluid, p)
    return mean - half, mean + half


def _limited_mean(mean: np.ndarray, fluid: Any, p: np.ndarray | None) -> np.ndarray:
    """Mean shear stress, limited if the fluid has a limiting shear stress."""
    if getattr(fluid, "limiting_shear", None) is None:
        return mean
    size, limit = np.abs(mean), fluid.limiting_shear * p
    smaller, ratio = np.minimum(size, limit), np.ones_like(mean)
    np.divide(smaller, np.maximum(size, limit), out=ratio, where=np.maximum(size, limit) > 0.0)
    return np.sign(mean) * smaller * (1.0 + ratio**4) ** -0.25


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
