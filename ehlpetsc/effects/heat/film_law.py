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

Oil that enters cold between surfaces far apart in temperature has no parabola: the law would cool the colder
surface by oil that is warmer than it. Where it does, the sum of both fluxes stays and the colder surface has
none; where the oil is colder than both surfaces, each gives heat by its own difference,
:math:`q_i=6(T_e-T_i)/r`, with the same sum. All three agree where they meet. The sum is
:math:`(T_e-\alpha)/\kappa`, for the parabola with

.. math:: \kappa=\frac r{12}+\frac14\Big[R_1+R_2-\frac{(R_1-R_2)^2}{r/X+R_1+R_2}\Big],\qquad
   \alpha=\frac{W_1+W_2}2-\frac{(R_1-R_2)(W_1-W_2)}{2(r/X+R_1+R_2)},

regular at r = 0.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ehlpetsc.base.compiled import inlined
from ehlpetsc.effects.heat.film_shear import across, mean_rise, resolved_stress
from ehlpetsc.physics.laws import (
    SLOTS,
    conductivity,
    is_linear_in_temperature,
    ln_viscosities,
    ln_viscosity,
    viscosity_law,
)
from ehlpetsc.physics.rheology import NEWTON, FlowLaw, flow_law, flow_stress, stress_pressure
from ehlpetsc.physics.viscosity_laws import ROELANDS_ZERO

if TYPE_CHECKING:
    from ehlpetsc.base.declarations import Values
    from ehlpetsc.case.tables.contact import Fluid

MIN_CONDUCTING_FRACTION = 1e-6  # fraction of the gap: less conducts as this
ITERATIONS = 30  # of Newton's method, before bisection
BISECTIONS = 200
MAX_CHANGE = 60.0  # K in an iteration
QUADRATIC = 1e-3  # K: change in an iteration of Newton's method, after which it is accurate to 1e-7 K
QUADRATIC_Y = 1e-4  # the same of y
MAX_SPLIT_CHANGE = 1e-6  # of d
MIN_SLOPE = 1e-12  # 1/K
MIN_RISE = 0.1  # K of the secant
MIN_HEATING = 1e-12  # of b: less does not heat the film
MIN_STRESS = 0.1  # of the shear law's and the limiting stress, over those at the reference temperature
UNIFORM = 1.0 / 12.0  # mean temperature by uniform heat, over heat times thickness over conductivity

A, B, G, SPREAD, W1, W2, R1, R2, BETWEEN, MIDDLE, REFERENCE = range(11)  # rows of FilmHeat.of_nodes
BASE, PROFILE, MEAN = range(3)  # rows of a film's state: base temperature, y, mean temperature
PARABOLA, INSULATED, APART = 0, 1, 2  # the three cases, in the order in which the oil gets colder
NO_FLUX = 1e-9  # K: difference of temperature whose heat flux is rounding


class FilmLaw(NamedTuple):
    """Constants of the oil in a step.

    Attributes
    ----------
    viscosity
        :class:`ehlpetsc.physics.laws.OilLaw` as a tuple.
    is_linear
        Whether the logarithm of the viscosity is linear in temperature.
    eta0
        Viscosity at ambient pressure and reference temperature [Pa s].
    flow
        :class:`ehlpetsc.physics.rheology.FlowLaw` as a tuple.
    limit
        Limiting shear stress over pressure; infinite: none.
    conductivity, conductivity_pressure, conductivity_saturation
        k_f at ambient pressure [W/(m K)], its relative increase with pressure, and the
        decrease of that [1/Pa].
    sliding
        |u1 - u2| [m/s].
    thinnest
        Film [m] below which the shear stress is that of this film; 0: films of no thickness are not sheared.
    stress_pressure, stress_temperature
        Relative rise of the stress of the shear law with pressure [1/Pa] and, from the temperature at which
        the viscosity is eta0, with temperature [1/K].
    limit_temperature
        Relative rise of the limiting shear stress with temperature [1/K], likewise.
    """

    viscosity: tuple
    is_linear: bool
    eta0: float
    flow: tuple
    limit: float
    conductivity: float
    conductivity_pressure: float
    conductivity_saturation: float
    sliding: float
    thinnest: float = 0.0
    stress_pressure: float = 0.0
    stress_temperature: float = 0.0
    limit_temperature: float = 0.0


def film_law(fluid: Fluid, heat: Values | None, sliding: float, thinnest: float = 0.0) -> FilmLaw:
    """Constants of the oil in a step with u1 - u2 [m/s]; `fluid` None: dry."""
    conduction = (
        float(heat.oil_conductivity),
        float(heat.oil_conductivity_pressure),
        float(heat.oil_conductivity_saturation),
    )
    if fluid is None:
        return FilmLaw(
            (0, (0.0,) * SLOTS, 300.0), True, 1.0, tuple(FlowLaw(NEWTON)), np.inf, *conduction, 0.0
        )
    law = viscosity_law(fluid, heat)
    return FilmLaw(
        tuple(law),
        is_linear_in_temperature(law, fluid.law),
        float(fluid.viscosity),
        tuple(flow_law(fluid)),
        np.inf if fluid.limiting_shear is None else float(fluid.limiting_shear),
        *conduction,
        abs(float(sliding)),
        thinnest,
        stress_pressure(fluid),
        getattr(fluid, "eyring_stress_temperature", None) or 0.0,
        getattr(fluid, "limiting_shear_temperature", None) or 0.0,
    )


@inlined
def exchange_law(kind: int, r: float, walls: tuple) -> tuple[float, float]:
    """Flux into both surfaces per temperature [W/(m^2 K)], and the temperature without flux [K]."""
    w1, w2, r1, r2, between = walls
    if kind == PARABOLA:
        skew = (r1 - r2) / (r * between + r1 + r2)
        resistance = r * (1.0 / 12.0) + 0.25 * (r1 + r2 - (r1 - r2) * skew)
        return 1.0 / resistance, 0.5 * (w1 + w2) - 0.5 * skew * (w1 - w2)
    if kind == INSULATED:
        return 1.0 / (r * (1.0 / 12.0) + 0.5 * (r2 if w1 < w2 else r1)), 0.5 * (w1 + w2)
    g1, g2 = 1.0 / (r / 6.0 + r1), 1.0 / (r / 6.0 + r2)
    return g1 + g2, (g1 * w1 + g2 * w2) / (g1 + g2)


@inlined
def fluxes(
    kind: int, t: float, r: float, walls: tuple, exchange: float, alpha: float
) -> tuple[float, float, float]:
    """Heat fluxes into both surfaces, and the derivative of their sum with respect to r."""
    w1, w2, r1, r2, between = walls
    flow = (t - alpha) * exchange
    if kind == PARABOLA:
        over_total = 1.0 / (r * between + r1 + r2)
        skew = (r1 - r2) * over_total
        more = -2.0 * (w1 - w2) * over_total - skew * flow
        by_r = 0.5 * between * skew * (w1 - w2) * over_total
        by_r = -(by_r + flow * (1.0 / 12.0 + 0.25 * between * skew * skew)) * exchange
        return 0.5 * (flow + more), 0.5 * (flow - more), by_r
    if kind == INSULATED:
        first = 0.0 if w1 < w2 else flow
        return first, flow - first, -flow * exchange / 12.0
    g1, g2 = 1.0 / (r / 6.0 + r1), 1.0 / (r / 6.0 + r2)
    q1, q2 = g1 * (t - w1), g2 * (t - w2)
    return q1, q2, -(g1 * q1 + g2 * q2) / 6.0


@inlined
def _resistivity(p: float, left: float, law: FilmLaw) -> tuple[float, float]:
    """1/k_f [m K/W] of a film with a fraction of oil, and d ln(k_f)/dp [1/Pa]."""
    k, by_p = conductivity(p, law.conductivity, law.conductivity_pressure, law.conductivity_saturation)
    return 1.0 / (k * max(left, MIN_CONDUCTING_FRACTION)), by_p / k


@inlined
def fixed_at(i: int, of_nodes: np.ndarray, law: FilmLaw) -> tuple:
    """Arguments of :func:`film_temperature` at node i from `g` on, by :class:`.film.FilmHeat`."""
    walls = of_nodes[W1, i], of_nodes[W2, i], of_nodes[R1, i], of_nodes[R2, i], of_nodes[BETWEEN, i]
    return of_nodes[G, i], of_nodes[SPREAD, i], of_nodes[MIDDLE, i], of_nodes[REFERENCE, i], walls, law


@inlined
def _split(kind: int, t: float, r: float, walls: tuple, exchange: float, alpha: float, beta: float) -> float:
    """Half the difference of the walls' temperatures, times beta."""
    q1, q2, _ = fluxes(kind, t, r, walls, exchange, alpha)
    return 0.5 * beta * (walls[0] + walls[2] * q1 - walls[1] - walls[3] * q2)


@inlined
def _line(p: float, middle: float, reference: float, law: FilmLaw) -> tuple[float, float, float, float]:
    """ln(eta/eta0) at `reference`, its secant to the temperature `middle`, -d/dT [1/K]; both by p."""
    if law.is_linear:
        value, by_p, slope = ln_viscosity(law.viscosity, p, reference)
        return value, max(-slope, MIN_SLOPE), by_p, 0.0
    rise = max(middle - reference, MIN_RISE)
    (value, by_p, _), (further, further_by_p, _) = ln_viscosities(
        law.viscosity, p, reference, reference + rise
    )
    return value, max((value - further) / rise, MIN_SLOPE), by_p, (by_p - further_by_p) / rise


@inlined
def film_temperature(
    base: float,
    profile: float,
    p: float,
    h: float,
    left: float,
    a: float,
    b: float,
    g: float,
    spread: float,
    middle: float,
    reference: float,
    walls: tuple[float, float, float, float, float],
    law: FilmLaw,
) -> tuple:
    r"""Temperature of the film at one node.

    Parameters
    ----------
    base, profile
        Start of the iteration: :math:`T_s` [K] and y.
    p, h, left
        Pressure [Pa], film [m], fraction of the gap full of oil.
    a, b
        Storage and transport per temperature [W/(m^2 K)], and their known part [W/m^2].
    g
        Heat that does not depend on the temperature [W/m^2].
    spread
        :math:`\ln(\sinh\Sigma/\Sigma)` of the Eyring stress.
    middle, reference
        Temperatures of the last level [K], in the middle of the film and :math:`T_s`: :math:`\beta` is the
        secant of ln(eta) between them. Around the second the law is exponential, which leaves one solution.
    walls
        W1, W2 [K], R1, R2 [m^2 K/W], and the resistance of the film between the walls over r, 1/X.

    Returns
    -------
    temperature, by_p, by_h
        Mean across the film [K] and its derivatives [K/Pa], [K/m].
    q1, q2, shear_heat
        Heat fluxes into both surfaces and Phi [W/m^2].
    line
        ln(eta/eta0) at `reference`, :math:`\beta` [1/K], derivative of the first by p [1/Pa].
    base, profile
        :math:`T_s` [K] and y.
    """
    w1, w2 = walls[0], walls[1]
    over_k, k_slope = _resistivity(p, left, law)
    r = h * over_k
    kind, stress, n, width = law.flow
    stress_p, warmer = 0.0, reference - law.viscosity[2]
    if law.stress_pressure != 0.0 or law.stress_temperature != 0.0:
        grown = 1.0 + law.stress_pressure * p
        stress *= grown * max(1.0 + law.stress_temperature * warmer, MIN_STRESS)
        stress_p = law.stress_pressure / grown
    limit_p = law.limit
    if law.limit_temperature != 0.0:
        limit_p *= max(1.0 + law.limit_temperature * warmer, MIN_STRESS)
    flow = FlowLaw(kind, stress, n, width)
    sheared = max(h, law.thinnest)
    heat = left * law.sliding if sheared > 0.0 else 0.0
    ln_rate, limit = 0.0, np.inf
    ln_eta, beta, eta_p, beta_p = _line(p, middle, reference, law)
    if heat > 0.0:
        ln_rate = np.log(law.sliding * law.eta0 / (flow.stress * sheared)) - spread
        limit = np.inf if law.limit == np.inf else limit_p * p
    heating = 0.125 * beta * law.sliding * r * max(left, MIN_CONDUCTING_FRACTION)
    t, y = base, profile
    temperature, energy_t, q1, q2, phi = base, base, 0.0, 0.0, 0.0
    t_p, t_h, change, low, high = 0.0, 0.0, 0.0, 0.0, 0.0
    tau, by_x, by_limit, is_heated = 0.0, 0.0, 0.0, False
    for case in (PARABOLA, INSULATED, APART):
        exchange, alpha = exchange_law(case, r, walls)
        if heat == 0.0:
            energy_t = (b + g + alpha * exchange) / (a + exchange)
            t, y, phi, temperature = energy_t, 0.0, 0.0, energy_t
            q1, q2, by_r = fluxes(case, energy_t, r, walls, exchange, alpha)
            t_r = -by_r / (a + exchange)
            t_p, t_h = -t_r * r * k_slope, t_r * over_k
        else:
            energy_t, low, high, is_heated = t, ROELANDS_ZERO + 1.0, 1e5, False
            for k in range(ITERATIONS + BISECTIONS):
                d = _split(case, energy_t, r, walls, exchange, alpha, beta)
                x = ln_rate + ln_eta - beta * (t - reference)
                if k >= ITERATIONS:  # the stress by itself, and the temperature between bounds
                    y = resolved_stress(y, x, heating, d, flow, limit)[0]
                if not is_heated or y <= abs(d):  # otherwise the stress follows with the heating
                    tau, by_x, by_limit = flow_stress(x, flow, limit)
                    is_heated = heating * tau > MIN_HEATING
                f_y, lr_y, f1, f1_t, mean, mean_y = 1.0, 0.0, 0.0, 0.0, 0.0, 0.0
                if not is_heated:
                    y = abs(d)
                    if y > 1e-6:
                        tau, by_x, by_limit = flow_stress(x - across(y, 0.0)[0], flow, limit)
                else:
                    if y <= abs(d):
                        half = np.sinh(0.5 * d)
                        y = 2.0 * np.arcsinh(np.sqrt(heating * tau + half * half))
                    lr, lr_y, f, f_y, _ = across(y, d)
                    tau, by_x, by_limit = flow_stress(x - lr, flow, limit)
                    f1, f1_t = f - heating * tau, heating * by_x * beta
                    f_y += heating * by_x * lr_y
                    mean, mean_y = mean_rise(y, d)
                phi, phi_t, phi_y = heat * tau, -heat * by_x * beta, -heat * by_x * lr_y
                uniform = r * UNIFORM
                energy_t = t + phi * uniform
                m_phi = 0.0 if is_heated else uniform  # without a profile the mean is that of a parabola
                temperature = t + m_phi * phi + mean / beta
                f2 = a * temperature - b - phi - g + (energy_t - alpha) * exchange
                loss = a * m_phi - 1.0 + uniform * exchange
                f2_t = a + exchange + loss * phi_t
                f2_y = a * mean_y / beta + loss * phi_y
                over_det = 1.0 / (f_y * f2_t - f1_t * f2_y)
                change, change_y = (f1 * f2_y - f_y * f2) * over_det, (f1_t * f2 - f2_t * f1) * over_det
                change = min(max(change, -MAX_CHANGE, 0.5 * (ROELANDS_ZERO - t)), MAX_CHANGE)
                if k >= ITERATIONS:
                    low, high = (low, min(high, t)) if f2 > 0.0 else (max(low, t), high)
                    if not low <= t + change <= high:
                        change = 0.5 * (low + high) - t
                new_y = min(max(y + change_y, abs(d) + 0.2 * (y - abs(d))), 3.0 * y + 1.0)
                t, change_y = t + change, new_y - y
                y = new_y
                if abs(change) < QUADRATIC and abs(change_y) <= QUADRATIC_Y * y:
                    if abs(d - _split(case, energy_t, r, walls, exchange, alpha, beta)) < MAX_SPLIT_CHANGE:
                        break
            phi += phi_t * change + phi_y * change_y
            energy_t = t + phi * uniform
            temperature = t + m_phi * phi + (mean + mean_y * change_y) / beta
            q1, q2, by_r = fluxes(case, energy_t, r, walls, exchange, alpha)
            phi = a * temperature - b - g + q1 + q2  # so that the balance of heat closes
            # derivatives of both equations by the pressure and by the film, at constant t and y
            tau_p, r_p = by_x * (eta_p - beta_p * (t - reference)), -r * k_slope
            if limit < np.inf:
                tau_p += by_limit * limit_p
            tau_p += stress_p * (tau - by_x - by_limit * limit if limit < np.inf else tau - by_x)
            heating_p = heating * (beta_p / beta - k_slope)
            tau_h = -by_x / h if h == sheared else 0.0
            heating_h = 0.125 * beta * law.sliding * over_k * max(left, MIN_CONDUCTING_FRACTION)
            for side in range(2):
                tau_s, r_s, heating_s = (tau_p, r_p, heating_p) if side == 0 else (tau_h, over_k, heating_h)
                phi_s = heat * tau_s
                e_s = UNIFORM * (phi * r_s + r * phi_s)
                m_s = -mean * beta_p / (beta * beta) if side == 0 else 0.0
                if not is_heated:
                    m_s += e_s
                f1_s = -heating_s * tau - heating * tau_s if is_heated else 0.0
                f2_s = a * m_s - phi_s + by_r * r_s + e_s * exchange
                base_s = (f1_s * f2_y - f_y * f2_s) * over_det
                y_s = (f1_t * f2_s - f2_t * f1_s) * over_det
                total = m_s + (1.0 + m_phi * phi_t) * base_s + (m_phi * phi_y + mean_y / beta) * y_s
                if side == 0:
                    t_p = total
                else:
                    t_h = total
        if case == PARABOLA and (q1 if w1 < w2 else q2) >= -NO_FLUX * exchange:
            break
        if case == INSULATED and energy_t >= min(w1, w2):
            break
    return temperature, t_p, t_h, q1, q2, phi, (ln_eta, beta, eta_p), t, y
