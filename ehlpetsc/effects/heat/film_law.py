r"""Temperature and shear stress of the film at a node, with both surfaces, as a law of pressure and film.

With both surfaces' response :math:`R_i` to the present flux, a film of mean temperature T has

.. math:: aT-b=\Phi+G-q_1-q_2,\qquad T_i=W_i+R_iq_i,\qquad \Phi=\tau_m|u_1-u_2|.

The shear stress is that of :mod:`.film_shear`, resolved across the film: the heat of shear
concentrates in its middle. Its base temperature is that of the walls and of all other heat,
:math:`T_s=(T_1+T_2)/2+Hr/12`, :math:`H=q_1+q_2-\Phi`, :math:`r=h/k_f`. The fluxes are those of a parabola
with the mean temperature :math:`T_e=(T_1+T_2)/2+(q_1+q_2)r/12`,

.. math:: q_{1,2}=\frac1r\Big[6(T_e-T_w)\pm X(T_2-T_1)\Big],\qquad T_w=(T_1+T_2)/2,

X the factor of :func:`.film_shear.wall_exchange` at the last level: the oil is most fluid
near the hotter wall, which gets more of the heat of shear than conduction alone leaves it. (X = 1 gives 8 %
more friction at slide/roll 1.9, 2 % at 1.5.) The mean of the profile is :math:`T=T_s+m/\beta`. What is left
are two equations, for :math:`T_s` and y, with one solution. (Heat in the middle of the film would need
the weight c of :mod:`.film_shear`, up to 1/8, in place of 1/12: 1 % of the stress where H is
10 % of :math:`\Phi`, 4 % where it is 30 %; but with it there need not be a solution.)

The walls may get heat otherwise where oil enters cold: :mod:`.film_shear`.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ehlpetsc.base.compiled import inlined
from ehlpetsc.effects.heat.film_oil import FilmLaw, NodeOil, oil_at
from ehlpetsc.effects.heat.film_shear import (
    EXCHANGE_KINDS,
    Exchange,
    across,
    exchange_of,
    fluxes,
    holds,
    mean_rise,
    resolved_stress,
    split,
)
from ehlpetsc.physics.oil.rheology import flow_stress
from ehlpetsc.physics.oil.viscosity_laws import ROELANDS_ZERO

NEWTON_ITERATIONS = 30  # of Newton's method, before bisection
BISECTIONS = 200
MAX_TEMPERATURE_CHANGE = 60.0  # K in an iteration
QUADRATIC = 1e-3  # K: change in an iteration of Newton's method, after which it is accurate to 1e-7 K
QUADRATIC_Y = 1e-4  # the same of y
MAX_SPLIT_CHANGE = 1e-6  # of d
MIN_HEATING = 1e-12  # of b: less does not heat the film
UNIFORM = 1.0 / 12.0  # mean temperature by uniform heat, over heat times thickness over conductivity

A, B, G, SPREAD, W1, W2, R1, R2, BETWEEN, MIDDLE, REFERENCE, SLIDING = range(12)  # of FilmHeat.of_nodes
T_BASE, T_SHAPE, T_MEAN = range(3)  # rows of a film's state: base temperature, y, mean temperature


class FilmTemperature(NamedTuple):
    r"""Temperature of the film at a node.

    `mean`, `by_p`, `by_h`: mean across the film [K] and its derivatives [K/Pa], [K/m].
    `q1`, `q2`, `shear_heat`: heat fluxes into both surfaces and Phi [W/m^2].
    `stress`: mean shear stress by the flow law [Pa]; where nothing slides, Phi over the speed is rounding.
    `base`, `profile`: :math:`T_s` [K] and y.
    `energy`: :math:`T_e` [K].
    """

    mean: float
    by_p: float
    by_h: float
    q1: float
    q2: float
    shear_heat: float
    stress: float
    base: float
    profile: float
    energy: float


class Shear(NamedTuple):
    r"""Equation of the shear stress at :math:`T_s` and y.

    `y`: as it is taken: \|d\| where the film is not heated, and more than that where it is.
    `stress`, `by_x`, `by_limit`: shear stress [Pa], its derivatives as of :func:`.rheology.flow_stress`.
    `f`, `f_t`, `f_y`: residual of the heating, and its derivatives by :math:`T_s` and y.
    `rate_y`: derivative of :math:`\ln(\sinh y/y)`.
    `mean`, `mean_y`: of :func:`.film_shear.mean_rise`.
    """

    y: float
    is_heated: bool
    stress: float
    by_x: float
    by_limit: float
    f: float
    f_t: float
    f_y: float
    rate_y: float
    mean: float
    mean_y: float


class Heat(NamedTuple):
    """Equation of the heat at the same state.

    `energy`: :math:`T_e` [K].
    `phi`, `phi_t`, `phi_y`: heat of shear [W/m^2], and its derivatives.
    `mean_phi`: derivative of the mean temperature by it.
    `f`, `f_t`, `f_y`: residual [W/m^2], and its derivatives.
    """

    energy: float
    phi: float
    phi_t: float
    phi_y: float
    mean_phi: float
    f: float
    f_t: float
    f_y: float


@inlined
def fixed_at(i: int, of_nodes: np.ndarray) -> tuple:
    """Arguments `last` and `walls` of :func:`film_temperature` at node i, by :class:`.film.FilmHeat`."""
    walls = of_nodes[W1, i], of_nodes[W2, i], of_nodes[R1, i], of_nodes[R2, i], of_nodes[BETWEEN, i]
    return (of_nodes[SPREAD, i], of_nodes[MIDDLE, i], of_nodes[REFERENCE, i]), walls


@inlined
def film_temperature(
    start: tuple[float, float],
    node: tuple[float, float, float, float],
    balance: tuple[float, float, float],
    last: tuple[float, float, float],
    walls: tuple[float, float, float, float, float],
    law: FilmLaw,
) -> tuple[FilmTemperature, NodeOil]:
    r"""Temperature of the film at one node, and its oil.

    Parameters
    ----------
    start
        Of the iteration: :math:`T_s` [K] and y.
    node
        Pressure [Pa], film [m], fraction of the gap full of oil, |u1 - u2| [m/s].
    balance
        a, storage and transport per temperature [W/(m^2 K)]; b, their known part [W/m^2]; G, heat that does
        not depend on the temperature [W/m^2].
    last
        Spread and temperatures of the last level, as of :func:`.film_oil.oil_at`.
    walls
        W1, W2 [K], R1, R2 [m^2 K/W], and the resistance of the film between the walls over r, 1/X.
    """
    oil = oil_at(*node, last, law)
    t, y = start
    found = FilmTemperature(t, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, t, y, t)
    for kind in EXCHANGE_KINDS:
        exchange = exchange_of(kind, oil.r, walls)
        if oil.speed == 0.0:
            found = _unsheared(balance, oil, exchange)
        else:
            found = _sheared(found.base, found.profile, balance, oil, exchange)
        if holds(found.q1, found.q2, found.energy, exchange):
            break
    return found, oil


@inlined
def _unsheared(balance: tuple, oil: NodeOil, exchange: Exchange) -> FilmTemperature:
    """Film without heat of shear: one linear equation."""
    a, b, g = balance
    t = (b + g + exchange.balanced * exchange.conductance) / (a + exchange.conductance)
    q1, q2, by_r = fluxes(t, exchange)
    t_r = -by_r / (a + exchange.conductance)
    return FilmTemperature(t, -t_r * oil.r * oil.k_p, t_r * oil.r_h, q1, q2, 0.0, 0.0, t, 0.0, t)


@inlined
def _sheared(t: float, y: float, balance: tuple, oil: NodeOil, exchange: Exchange) -> FilmTemperature:
    """Film with heat of shear, by Newton's method for both equations."""
    energy, low, high, change, change_y = t, ROELANDS_ZERO + 1.0, 1e5, 0.0, 0.0
    is_heated = np.bool_(False)  # numba would compile `_shear_equation` again for a literal
    for k in range(NEWTON_ITERATIONS + BISECTIONS):
        d, x = split(energy, oil.beta, exchange), oil.ln_rate + oil.ln_eta - oil.beta * (t - oil.reference)
        if k >= NEWTON_ITERATIONS:  # the stress by itself, and the temperature between bounds
            y = resolved_stress(y, x, oil.heating, d, oil.flow, oil.limit)[0]
        shear = _shear_equation(x, y, d, is_heated, oil)
        heat = _heat_equation(t, shear, balance, oil, exchange)
        y, is_heated, energy = shear.y, shear.is_heated, heat.energy
        over_det = _over_determinant(shear, heat)
        change = (shear.f * heat.f_y - shear.f_y * heat.f) * over_det
        change_y = (shear.f_t * heat.f - heat.f_t * shear.f) * over_det
        change = min(max(change, -MAX_TEMPERATURE_CHANGE, 0.5 * (ROELANDS_ZERO - t)), MAX_TEMPERATURE_CHANGE)
        if k >= NEWTON_ITERATIONS:
            low, high = (low, min(high, t)) if heat.f > 0.0 else (max(low, t), high)
            if not low <= t + change <= high:
                change = 0.5 * (low + high) - t
        new_y = min(max(y + change_y, abs(d) + 0.2 * (y - abs(d))), 3.0 * y + 1.0)
        t, change_y = t + change, new_y - y
        y = new_y
        if abs(change) < QUADRATIC and abs(change_y) <= QUADRATIC_Y * y:
            if abs(d - split(energy, oil.beta, exchange)) < MAX_SPLIT_CHANGE:
                break
    stress = shear.stress - shear.by_x * (oil.beta * change + shear.rate_y * change_y)
    phi = heat.phi + (heat.phi_t * change + heat.phi_y * change_y)
    energy = t + phi * (oil.r * UNIFORM)
    mean = t + heat.mean_phi * phi + (shear.mean + shear.mean_y * change_y) / oil.beta
    q1, q2, by_r = fluxes(energy, exchange)
    a, b, g = balance
    phi = a * mean - b - g + q1 + q2  # so that the balance of heat closes
    t_p, t_h = _derivatives(t, phi, a, by_r, shear, heat, oil, exchange.conductance)
    return FilmTemperature(mean, t_p, t_h, q1, q2, phi, stress, t, y, energy)


@inlined
def _shear_equation(x: float, y: float, d: float, is_heated: bool, oil: NodeOil) -> Shear:
    r"""Heating of the film: :math:`y(\cosh y-\cosh d)/(2\sinh y)-B\tau=0`."""
    stress, by_x, by_limit = 0.0, 0.0, 0.0
    if not is_heated or y <= abs(d):  # otherwise the stress follows with the heating
        stress, by_x, by_limit = flow_stress(x, oil.flow, oil.limit)
        is_heated = oil.heating * stress > MIN_HEATING
    if not is_heated:
        y = abs(d)
        if y > 1e-6:
            stress, by_x, by_limit = flow_stress(x - across(y, 0.0)[0], oil.flow, oil.limit)
        return Shear(y, False, stress, by_x, by_limit, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)
    if y <= abs(d):
        half = np.sinh(0.5 * d)
        y = 2.0 * np.arcsinh(np.sqrt(oil.heating * stress + half * half))
    ln_rate, rate_y, f, f_y, _ = across(y, d)
    stress, by_x, by_limit = flow_stress(x - ln_rate, oil.flow, oil.limit)
    f_y += oil.heating * by_x * rate_y
    mean, mean_y = mean_rise(y, d)
    f, f_t = f - oil.heating * stress, oil.heating * by_x * oil.beta
    return Shear(y, True, stress, by_x, by_limit, f, f_t, f_y, rate_y, mean, mean_y)


@inlined
def _heat_equation(t: float, shear: Shear, balance: tuple, oil: NodeOil, exchange: Exchange) -> Heat:
    r"""Balance of heat: :math:`aT-b-\Phi-G+q_1+q_2=0`."""
    a, b, g = balance
    phi, phi_t = oil.speed * shear.stress, -oil.speed * shear.by_x * oil.beta
    phi_y, uniform = -oil.speed * shear.by_x * shear.rate_y, oil.r * UNIFORM
    energy = t + phi * uniform
    mean_phi = 0.0 if shear.is_heated else uniform  # without a profile the mean is that of a parabola
    mean = t + mean_phi * phi + shear.mean / oil.beta
    f = a * mean - b - phi - g + (energy - exchange.balanced) * exchange.conductance
    loss = a * mean_phi - 1.0 + uniform * exchange.conductance
    f_t, f_y = a + exchange.conductance + loss * phi_t, a * shear.mean_y / oil.beta + loss * phi_y
    return Heat(energy, phi, phi_t, phi_y, mean_phi, f, f_t, f_y)


@inlined
def _over_determinant(shear: Shear, heat: Heat) -> float:
    return 1.0 / (shear.f_y * heat.f_t - shear.f_t * heat.f_y)


@inlined
def _derivatives(
    t: float, phi: float, a: float, by_r: float, shear: Shear, heat: Heat, oil: NodeOil, conductance: float
) -> tuple[float, float]:
    """Derivatives of the mean temperature by the pressure and by the film, by those of both equations."""
    stress, by_x, beta, over_det = shear.stress, shear.by_x, oil.beta, _over_determinant(shear, heat)
    stress_p = by_x * (oil.eta_p - oil.beta_p * (t - oil.reference))
    if oil.limit < np.inf:
        stress_p += shear.by_limit * oil.limit_p
        stress_p += oil.stress_p * (stress - by_x - shear.by_limit * oil.limit)
    else:
        stress_p += oil.stress_p * (stress - by_x)
    stress_h = -by_x / oil.h if oil.h == oil.sheared else 0.0
    heating_p = oil.heating * (oil.beta_p / beta - oil.k_p)
    t_p = t_h = 0.0
    for side in range(2):  # at constant T_s and y
        stress_s, r_s, heating_s = (
            (stress_p, -oil.r * oil.k_p, heating_p) if side == 0 else (stress_h, oil.r_h, oil.heating_h)
        )
        phi_s = oil.speed * stress_s
        energy_s = UNIFORM * (phi * r_s + oil.r * phi_s)
        mean_s = -shear.mean * oil.beta_p / (beta * beta) if side == 0 else 0.0
        if not shear.is_heated:
            mean_s += energy_s
        f1_s = -heating_s * stress - oil.heating * stress_s if shear.is_heated else 0.0
        f2_s = a * mean_s - phi_s + by_r * r_s + energy_s * conductance
        t_s = (f1_s * heat.f_y - shear.f_y * f2_s) * over_det
        y_s = (shear.f_t * f2_s - heat.f_t * f1_s) * over_det
        total = mean_s + (1.0 + heat.mean_phi * heat.phi_t) * t_s
        total += (heat.mean_phi * heat.phi_y + shear.mean_y / beta) * y_s
        if side == 0:
            t_p = total
        else:
            t_h = total
    return t_p, t_h
