r"""Shear stress of a film with the temperature resolved across it, and its exchange of heat with both walls.

The shear stress is constant across a sheared film. Where its shear rate is :math:`g(\tau)\,e^{\beta(T-T_0)}`,
g that of the flow law at the temperature :math:`T_0`, conduction across the film has a closed form (Crook,
Phil. Trans. R. Soc. A 254 (1961) 237, for a Newtonian oil between equal walls; here for any flow law and two
walls). With :math:`T_0=(T_1+T_2)/2`, the mean of the walls,

.. math::
   \frac{|u_1-u_2|}h=g\,\frac{\sinh y}y,\qquad \cosh y=\cosh d+2\rho,\qquad
   \rho=\frac{\beta\tau(u_1-u_2)^2}{8k_fg},\qquad d=\frac{\beta(T_1-T_2)}2.

Between equal walls :math:`\rho=r^2=\sinh^2(y/2)` and :math:`\sinh y/y=r\sqrt{1+r^2}/\mathrm{asinh}\,r`.
A flow law is a stress by the logarithm x of the viscous stress :math:`\eta\dot\gamma` over a constant of the
law, which leaves one monotone equation for y,

.. math:: \frac{y(\cosh y-\cosh d)}{2\sinh y}=B\,\tau\big(x-\ln(\sinh y/y)\big),\qquad
   B=\frac{\beta h|u_1-u_2|}{8k_f},

x at :math:`\eta(T_0)` and :math:`|u_1-u_2|/h`. Without heating y = \|d\| and the stress is
the isothermal one.

In compiled loops over nodes: `resolved_stress` for the stress and its derivatives, `mean_rise` and
`wall_exchange` at its y for the mean temperature and the heat fluxes. Numbers may be complex, for derivatives
by complex step.

Heat H [W/m^2] of another source (pressure flow, compression, less the heat that the oil stores and carries)
makes a parabola of temperature: :math:`Hh/(12k_f)` in the mean, H/2 in both fluxes, and for the stress a rise
:math:`c\,Hh/k_f` of :math:`T_0`, c between 1/12 without heating by shear and 1/8 with much of it. A pressure
flow subtracts :math:`\ln(\sinh\Sigma/\Sigma)` from x, as in :func:`.traction.wall_shear`, and its heat, which
arises near the walls, has c = 1/12: 1 % at :math:`\Sigma=1`, where ignoring both costs 1 to 18 %.

Of a law of temperature other than the exponential, :math:`\beta` is the secant of :math:`\ln\eta` between
:math:`T_0` and the middle of the film, :math:`T_0+(2/\beta)\ln[\cosh(y/2)/\cosh(d/2)]`. Roelands' law at 0.5
to 1 GPa then has the stress to 1 % (Eyring) or 3 % (Newtonian) up to 200 K in the middle. The slope at the
wall costs 4 % at 30 K, 16 % at 70 K and 30 % at 120 K.

The heat fluxes into the walls are those of a parabola, see :mod:`.film_law`, but for oil that enters cold
between surfaces far apart in temperature: a parabola would cool the colder surface by oil that is warmer than
it. Where it does, the sum of both fluxes stays and the colder surface has none; where the oil is colder than
both surfaces, each gives heat by its own difference, :math:`q_i=6(T_e-T_i)/r`, with the same sum. All three
agree where they meet. The sum is :math:`(T_e-\alpha)/\kappa`, for the parabola with

.. math:: \kappa=\frac r{12}+\frac14\Big[R_1+R_2-\frac{(R_1-R_2)^2}{r/X+R_1+R_2}\Big],\qquad
   \alpha=\frac{W_1+W_2}2-\frac{(R_1-R_2)(W_1-W_2)}{2(r/X+R_1+R_2)},

regular at r = 0.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ehlpetsc.base.compiled import inlined
from ehlpetsc.physics.oil.rheology import FlowLaw, flow_stress

MIN_SHEAR_HEATING = 1e-280
MAX_SERIES_Y = 0.2  # y below which the series of :func:`across` are exact to 1e-12
MEAN_SERIES_LIMIT = 0.2  # y/2 below which the series of the mean rise is exact to 1e-14
EXCHANGE_KINDS = PARABOLA, INSULATED, APART = 0, 1, 2  # in the order in which the oil gets colder
MAX_SPLIT = 30.0  # of d, walls thousands of kelvins apart: beyond, in first iterations, its sinh may overflow
NO_FLUX = 1e-9  # K: difference of temperature whose heat flux is rounding
Y_ITERATIONS = 200
Y_ACCURACY = 1e-7  # relative change of y in an iteration of Newton's method, after which it is exact to 1e-14


@inlined
def across(y: float, d: float) -> tuple[float, float, float, float, float]:
    r"""Shear rate and heating by y.

    Returns
    -------
    ln_rate, rate_by_y
        :math:`\ln(\sinh y/y)` and its derivative.
    heating, heating_by_y, heating_by_d
        :math:`y(\cosh y-\cosh d)/(2\sinh y)` and its derivatives.
    """
    if y.real < MAX_SERIES_Y:
        less = -np.expm1(-y)  # 1 - exp(-y)
        e, t = 1.0 - less, y * y
        ln_rate = t * (1 / 6 - t * (1 / 180 - t * (1 / 2835 - t * (1 / 37800 - t / 467775))))
        rate_by_y = y * (1 / 3 - t * (1 / 45 - t * (2 / 945 - t * (1 / 4725 - t * 2 / 93555))))
        over = 1.0 / (less * (1.0 + e))  # 1/(1 - exp(-2 y))
        coth = (1.0 + e * e) * over
    else:
        e = np.exp(-y)
        less = 1.0 - e
        over = 1.0 / (less * (1.0 + e))
        coth, over_y = (1.0 + e * e) * over, 1.0 / y
        ln_rate, rate_by_y = y + np.log(0.5 * less * (1.0 + e) * over_y), coth - over_y
    up = np.expm1(d)
    below = -up / (1.0 + up)  # exp(-d) - 1
    ratio = (less - e * below) * (less - e * up) * over  # (cosh(y) - cosh(d))/sinh(y)
    return (
        ln_rate,
        rate_by_y,
        0.5 * y * ratio,
        0.5 * (ratio + y * (1.0 - ratio * coth)),
        -0.5 * y * e * (up - below) * over,
    )


@inlined
def resolved_stress(
    start: float, x: float, heating: float, d: float, flow: FlowLaw, limit: float
) -> tuple[float, float, float, float, float, float]:
    r"""Shear stress [Pa] of a film whose temperature is resolved across it.

    Newton's method for y, with :math:`b=B\tau` of the isothermal stress between the bounds
    :math:`\sinh^2(y/2)\ge b+\sinh^2(d/2)` and :math:`y\le|d|+2\sqrt{b(1+b)}`, which hold for every law with
    :math:`0\le d\ln\tau/dx\le1`; for a Newtonian oil the first is the solution.

    Parameters
    ----------
    start
        y to start from, such as of the last call for this node; 0: none.
    x
        :math:`\ln(\eta|u_1-u_2|/(h\tau_s))`, :math:`\eta` at :math:`T_0`; finite.
    heating
        B [1/Pa].
    d
        :math:`\beta(T_1-T_2)/2`, 0 between equal walls.
    limit
        Limiting shear stress [Pa]; infinite: none.

    Returns
    -------
    y, stress, by_x, by_heating, by_d, by_limit
        Derivatives of the stress, each at constant others.
    """
    isothermal, slope, _ = flow_stress(x, flow, limit)
    b = (heating * isothermal).real
    half = np.sinh(0.5 * d.real)
    low = 2.0 * np.arcsinh(np.sqrt(b + half * half + MIN_SHEAR_HEATING))
    high = abs(d.real) + 2.0 * np.sqrt(b * (1.0 + b)) + low * 1e-12
    guess = start.real if start.real > 0.0 else high / (1.0 + 2.0 * (heating * slope).real)
    y = min(max(guess, low), high) + 0.0 * (x + heating + d)
    low *= 1.0 - 1e-12
    last = False
    tau, by_x, by_limit = flow_stress(x, flow, limit)
    rate_by_y, by_y, by_d = y, y, y
    for _ in range(Y_ITERATIONS):
        ln_rate, rate_by_y, value, by_y, by_d = across(y, d)
        tau, by_x, by_limit = flow_stress(x - ln_rate, flow, limit)
        if last:
            break
        residual = value - heating * tau
        if residual.real > 0.0:
            high = min(high, y.real)
        else:
            low = max(low, y.real)
        new = y - residual / (by_y + heating * by_x * rate_by_y)
        if low <= new.real <= high:
            last = abs(new.real - y.real) <= Y_ACCURACY * y.real
        else:
            new = np.sqrt(low) * np.sqrt(high) + 0.0 * new
            last = high - low <= 1e-14 * high
        y = new
    lowered = by_x * rate_by_y / (by_y + heating * by_x * rate_by_y)
    kept = 1.0 - lowered * heating
    return y, tau, by_x * kept, -lowered * tau, lowered * by_d, by_limit * kept


@inlined
def _mean_between_equal_walls(y: float) -> tuple[float, float]:
    r""":math:`2\ln\cosh s-(2/s)\int_0^s\ln\cosh x\,dx`, s = y/2, by the dilogarithm; derivative by y."""
    s = 0.5 * y
    if s.real < MEAN_SERIES_LIMIT:
        t = s * s
        tail = t * (34 / 2835 - t * (124 / 31185 - t * (2764 / 2027025 - t * (43688 / 91216125))))
        value = t * (2 / 3 - t * (2 / 15 - t * (4 / 105 - tail)))
    else:
        e = np.exp(-y)
        w = np.log(1.0 + e)
        t = w * w
        tail = t * (1 / 3600 - t * (1 / 211680 - t * (1 / 10886400 - t / 526901760)))
        dilogarithm = -w * (1.0 + w * (1 / 4 + w * (1 / 36 - tail)))  # Li2(-exp(-y))
        value = s + 2.0 * w - (0.8224670334241132 + dilogarithm) / s  # pi^2/12
        return value, (1.0 - e) / (1.0 + e) - value / y
    return value, np.tanh(s) - value / y


@inlined
def mean_rise(y: float, d: float) -> tuple[float, float]:
    r"""Mean of :math:`\beta(T-T_0)` across the film, and its derivative by y.

    Exact between equal walls; between others the value for y less that for \|d\|, times :math:`1+d^2/30`, is
    the mean to 0.3 % for \|d\| up to 1 (50 K between the walls at :math:`\beta` = 0.04/K).
    """
    value, by_y = _mean_between_equal_walls(y)
    if d != 0.0:
        factor = 1.0 + d * d / 30.0
        unheated, _ = _mean_between_equal_walls(d if d.real > 0.0 else -d)
        value, by_y = factor * (value - unheated), factor * by_y
    return value, by_y


@inlined
def wall_exchange(y: float, d: float) -> float:
    r"""Heat flux from wall 1 to wall 2 over that of conduction, :math:`\frac{y\sinh d}{d\sinh y}`.

    The fluxes into the walls are :math:`q_{1,2}=\tau|u_1-u_2|/2\mp(k_f/h)(T_1-T_2)` times it.
    """
    t = d * d
    factor = 1.0 + t * (1 / 6 + t / 120) if abs(d.real) < 1e-2 else np.sinh(d) / d
    return -2.0 * factor * y * np.exp(-y) / np.expm1(-2.0 * y)


class Exchange(NamedTuple):
    """Exchange of a film of thermal resistance r with both walls.

    `kind`: `PARABOLA`, `INSULATED` or `APART`.
    `r`: :math:`h/k_f` [m^2 K/W].
    `walls`: W1, W2 [K], R1, R2 [m^2 K/W], 1/X of :mod:`.film_law`.
    `conductance`: flux into both walls per temperature [W/(m^2 K)].
    `balanced`: temperature without flux [K].
    """

    kind: int
    r: float
    walls: tuple[float, float, float, float, float]
    conductance: float
    balanced: float


@inlined
def exchange_of(kind: int, r: float, walls: tuple) -> Exchange:
    """Exchange by one of the three laws."""
    w1, w2, r1, r2, between = walls
    if kind == PARABOLA:
        skew = (r1 - r2) / (r * between + r1 + r2)
        resistance = r * (1.0 / 12.0) + 0.25 * (r1 + r2 - (r1 - r2) * skew)
        return Exchange(kind, r, walls, 1.0 / resistance, 0.5 * (w1 + w2) - 0.5 * skew * (w1 - w2))
    if kind == INSULATED:
        conductance = 1.0 / (r * (1.0 / 12.0) + 0.5 * (r2 if w1 < w2 else r1))
        return Exchange(kind, r, walls, conductance, 0.5 * (w1 + w2))
    g1, g2 = 1.0 / (r / 6.0 + r1), 1.0 / (r / 6.0 + r2)
    return Exchange(kind, r, walls, g1 + g2, (g1 * w1 + g2 * w2) / (g1 + g2))


@inlined
def fluxes(t: float, exchange: Exchange) -> tuple[float, float, float]:
    """Heat fluxes into both surfaces from a film at t [K], and the derivative of their sum by r."""
    r, (w1, w2, r1, r2, between) = exchange.r, exchange.walls
    flow = (t - exchange.balanced) * exchange.conductance
    if exchange.kind == PARABOLA:
        over_total = 1.0 / (r * between + r1 + r2)
        skew = (r1 - r2) * over_total
        more = -2.0 * (w1 - w2) * over_total - skew * flow
        by_r = 0.5 * between * skew * (w1 - w2) * over_total
        by_r = -(by_r + flow * (1.0 / 12.0 + 0.25 * between * skew * skew)) * exchange.conductance
        return 0.5 * (flow + more), 0.5 * (flow - more), by_r
    if exchange.kind == INSULATED:
        first = 0.0 if w1 < w2 else flow
        return first, flow - first, -flow * exchange.conductance / 12.0
    g1, g2 = 1.0 / (r / 6.0 + r1), 1.0 / (r / 6.0 + r2)
    q1, q2 = g1 * (t - w1), g2 * (t - w2)
    return q1, q2, -(g1 * q1 + g2 * q2) / 6.0


@inlined
def split(t: float, beta: float, exchange: Exchange) -> float:
    """Half the difference of the walls' temperatures, times beta."""
    walls, (q1, q2, _) = exchange.walls, fluxes(t, exchange)
    d = 0.5 * beta * (walls[0] + walls[2] * q1 - walls[1] - walls[3] * q2)
    return min(max(d, -MAX_SPLIT), MAX_SPLIT)


@inlined
def holds(q1: float, q2: float, t: float, exchange: Exchange) -> bool:
    """Whether the law is that of the film: the next one is for oil that is colder still."""
    w1, w2 = exchange.walls[0], exchange.walls[1]
    if exchange.kind == PARABOLA:
        return (q1 if w1 < w2 else q2) >= -NO_FLUX * exchange.conductance
    return exchange.kind == APART or t >= min(w1, w2)
