r"""Shear stress of a film with the temperature resolved across it.

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
`wall_exchange` at its y for the mean temperature and the heat fluxes; `film_stress` is the same for arrays of
physical quantities. Numbers may be complex, for derivatives by complex step.

Heat H [W/m^2] of another source (pressure flow, compression, less the heat that the oil stores and carries)
makes a parabola of temperature: add :math:`c\,Hh/k_f` with :func:`other_heat` to :math:`T_0`,
:math:`Hh/(12k_f)` to the mean temperature, H/2 to both fluxes. The stress is then that of the boundary value
problem across the film to 0.05 % for H of 10 % of the heat of shear, to 0.4 % for 30 % (without it, 4 and
12 %). A pressure flow subtracts :math:`\ln(\sinh\Sigma/\Sigma)` from x, as in :func:`.traction.wall_shear`,
and its heat, which arises near the walls, has c = 1/12: 1 % at :math:`\Sigma=1`, where ignoring both costs 1
to 18 %.

Of a law of temperature other than the exponential, :math:`\beta` is the secant of :math:`\ln\eta` between
:math:`T_0` and the middle of the film, :math:`T_0+(2/\beta)\ln[\cosh(y/2)/\cosh(d/2)]`. Roelands' law at 0.5
to 1 GPa then has the stress to 1 % (Eyring) or 3 % (Newtonian) up to 200 K in the middle. The slope at the
wall costs 4 % at 30 K, 16 % at 70 K and 30 % at 120 K.
"""

from typing import NamedTuple

import numpy as np

from ehlpetsc.base.compiled import compiled, inlined
from ehlpetsc.physics.rheology import FlowLaw, flow_stress

MIN_HEATING = 1e-280
SERIES_LIMIT = 0.2  # y below which the series of :func:`across` are exact to 1e-12
MEAN_SERIES_LIMIT = 0.2  # y/2 below which the series of the mean rise is exact to 1e-14
ITERATIONS = 200
ACCURACY = 1e-7  # relative change of y in an iteration of Newton's method, after which it is exact to 1e-14


class FilmStress(NamedTuple):
    """Results of :func:`film_stress`; temperatures are above the mean of the walls [K].

    Attributes
    ----------
    stress, q1, q2
        Shear stress [Pa]; heat fluxes into both walls [W/m^2].
    by_ln_eta, by_ln_h, by_beta, by_t1, by_t2
        Derivatives of the stress, those by the walls' temperatures with the viscosity that they change.
    mean, middle, maximum
        Temperature averaged across the film, in the middle, and maximum with the walls.
    y
        Of :func:`resolved_stress`.
    """

    stress: np.ndarray
    by_ln_eta: np.ndarray
    by_ln_h: np.ndarray
    by_beta: np.ndarray
    by_t1: np.ndarray
    by_t2: np.ndarray
    q1: np.ndarray
    q2: np.ndarray
    mean: np.ndarray
    middle: np.ndarray
    maximum: np.ndarray
    y: np.ndarray


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
    if y.real < SERIES_LIMIT:
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
    low = 2.0 * np.arcsinh(np.sqrt(b + half * half + MIN_HEATING))
    high = abs(d.real) + 2.0 * np.sqrt(b * (1.0 + b)) + low * 1e-12
    guess = start.real if start.real > 0.0 else high / (1.0 + 2.0 * (heating * slope).real)
    y = min(max(guess, low), high) + 0.0 * (x + heating + d)
    low *= 1.0 - 1e-12
    last = False
    tau, by_x, by_limit = flow_stress(x, flow, limit)
    rate_by_y, by_y, by_d = y, y, y
    for _ in range(ITERATIONS):
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
            last = abs(new.real - y.real) <= ACCURACY * y.real
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
def other_heat(y: float) -> float:
    r"""Weight c of heat uniform across the film: :math:`c\,Hh/k_f` acts like a rise of :math:`T_0`.

    First order in H, for every flow law: from 1/12, the mean of the parabola, without heating to 1/8, its
    maximum, as the shear concentrates in the middle; :math:`(2s\tanh s-m)/[8s(\tanh s+s/\cosh^2s)]`, s = y/2,
    m the mean rise. Between equal walls.
    """
    s = 0.5 * y
    if s.real < 1e-3:
        return 1.0 / 12.0 + s * s / 45.0
    tanh = np.tanh(s)
    mean, _ = _mean_between_equal_walls(y)
    return (2.0 * s * tanh - mean) / (8.0 * s * (tanh + s * (1.0 - tanh * tanh)))


@inlined
def wall_exchange(y: float, d: float) -> float:
    r"""Heat flux from wall 1 to wall 2 over that of conduction, :math:`\frac{y\sinh d}{d\sinh y}`.

    The fluxes into the walls are :math:`q_{1,2}=\tau|u_1-u_2|/2\mp(k_f/h)(T_1-T_2)` times it.
    """
    t = d * d
    factor = 1.0 + t * (1 / 6 + t / 120) if abs(d.real) < 1e-2 else np.sinh(d) / d
    return -2.0 * factor * y * np.exp(-y) / np.expm1(-2.0 * y)


@compiled
def _resolve(
    x: np.ndarray, heating: np.ndarray, d: np.ndarray, flow: FlowLaw, limit: np.ndarray
) -> np.ndarray:
    """Rows y, stress, its derivatives by x, B and d, mean rise and exchange of the walls."""
    out = np.empty((7, len(x)), x.dtype)
    for i in range(len(x)):
        y, tau, by_x, by_heating, by_d, _ = resolved_stress(0.0, x[i], heating[i], d[i], flow, limit[i])
        mean, exchange = mean_rise(y, d[i])[0], wall_exchange(y, d[i])
        out[:, i] = y, tau, by_x, by_heating, by_d, mean, exchange
    return out


def film_stress(
    h: np.ndarray,
    eta: np.ndarray,
    beta: np.ndarray,
    t1: np.ndarray,
    t2: np.ndarray,
    conductivity: np.ndarray,
    sliding: np.ndarray,
    flow: FlowLaw,
    limit: np.ndarray | float = np.inf,
) -> FilmStress:
    r"""Shear stress, temperatures and heat fluxes of sheared films; arrays or numbers of any common shape.

    Parameters
    ----------
    h, sliding
        Film [m] and :math:`|u_1-u_2|` [m/s], positive.
    eta, beta
        Viscosity [Pa s] and :math:`-d\ln\eta/dT` [1/K], positive, at the mean of the walls' temperatures.
    t1, t2
        Temperatures of the walls [K].
    conductivity
        Of the oil, :math:`k_f` [W/(m K)].
    limit
        Limiting shear stress [Pa].
    """
    given = np.broadcast_arrays(h, eta, beta, t1, t2, conductivity, sliding, limit)
    kind = complex if any(np.iscomplexobj(array) for array in given) else float
    shape = given[0].shape
    h, eta, beta, t1, t2, k, u, limit = (np.ravel(array).astype(kind) for array in given)
    x, heating, d = np.log(eta * u / (h * flow.stress)), beta * h * u / (8.0 * k), 0.5 * beta * (t1 - t2)
    y, tau, by_x, by_heating, by_d, mean, exchange = _resolve(x, heating, d, flow, limit)
    by_eta_and_t, by_split = -0.5 * beta * by_x, 0.5 * beta * by_d
    conducted = k / h * (t1 - t2) * exchange
    rho = heating * tau * np.sinh(y) / y
    with np.errstate(divide="ignore", invalid="ignore"):
        inner = np.log(np.sinh(y) ** 2 / (4.0 * rho)) / beta
        maximum = np.where(np.abs(np.sinh(d)) < np.abs(2.0 * rho), inner, 0.5 * np.abs((t1 - t2).real))
    results = FilmStress(
        stress=tau,
        by_ln_eta=by_x,
        by_ln_h=-by_x + by_heating * heating,
        by_beta=by_heating * heating / beta + by_d * d / beta,
        by_t1=by_eta_and_t + by_split,
        by_t2=by_eta_and_t - by_split,
        q1=0.5 * tau * u - conducted,
        q2=0.5 * tau * u + conducted,
        mean=mean / beta,
        middle=2.0 / beta * np.log(np.cosh(0.5 * y) / np.cosh(0.5 * d)),
        maximum=maximum,
        y=y,
    )
    return FilmStress(*(np.reshape(value, shape) for value in results))
