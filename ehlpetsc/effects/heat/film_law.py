r"""Temperature of the film at a node, with both surfaces, as a law of pressure and film.

With one temperature T of the film and both surfaces' response :math:`R_i` to the present flux,

.. math:: aT-b=\Phi(T)+G-q_1-q_2,\qquad T_i=W_i+R_iq_i,

:math:`\Phi=\tau_m|u_1-u_2|`, the fluxes by :mod:`.exchange`, linear in T. What is left is one equation for T,
monotone because the shear stress falls with T; the derivatives follow from the implicit function theorem.

Heat fluxes from the film into both surfaces, by the film's mean temperature T.

A parabola across the film gives

.. math:: q_{1,2}=\frac{k_f}{h}\Big[6(T-T_w)\pm(T_2-T_1)\Big],\qquad T_w=(T_1+T_2)/2.

Oil that enters cold between surfaces far apart in temperature has no parabola: the law would cool the colder
surface by oil that is warmer than it. Where it does, the sum of both fluxes stays and the colder surface has
none; where the oil is colder than both surfaces, each gives heat by its own difference,
:math:`q_i=6(k_f/h)(T-T_i)`, with the same sum. All three agree where they meet.

With the responses :math:`T_i=W_i+R_iq_i` and :math:`r=h/k_f` the sum is :math:`(T-\alpha)/\kappa`, for the
parabola with

.. math:: \kappa=\frac r{12}+\frac14\Big[R_1+R_2-\frac{(R_1-R_2)^2}{r+R_1+R_2}\Big],\qquad
   \alpha=\frac{W_1+W_2}2-\frac{(R_1-R_2)(W_1-W_2)}{2(r+R_1+R_2)},

regular at r = 0.
"""

from typing import NamedTuple

import numpy as np

from ehlpetsc.compiled import inlined
from ehlpetsc.physics.laws import SLOTS, is_linear_in_temperature, ln_viscosity, viscosity_law
from ehlpetsc.physics.rheology import limited_shear

MIN_CONDUCTING_FRACTION = 1e-6  # fraction of the gap: less conducts as this
ITERATIONS = 200
ACCURACY = 1e-10  # K: change in an iteration that ends it
QUADRATIC = 1e-4  # K: the same of an iteration of Newton's method, after which it is accurate to 1e-9 K
ERROR = 1e-8  # K: estimated error of an iteration of Chebyshev's method that ends it,
SMALL = 0.3  # change of ln(eta) up to which that estimate holds

A, B, G, SPREAD, W1, W2, R1, R2 = range(8)  # rows of FilmHeat.of_nodes
PARABOLA, INSULATED, APART = 0, 1, 2  # the three cases, in the order in which the oil gets colder
NO_FLUX = 1e-9  # K: difference of temperature whose heat flux is rounding
MAX_LN_SINH = 20.0  # above it the stress is linear in ln(eta) to 1e-17

_limited = inlined(limited_shear)


class FilmLaw(NamedTuple):
    """Constants of the oil in a step.

    Attributes
    ----------
    viscosity : tuple
        :class:`ehlpetsc.physics.laws.OilLaw` as a tuple.
    is_linear : bool
        Whether the logarithm of the viscosity is linear in temperature.
    eta0 : float
        Viscosity at ambient pressure and reference temperature [Pa s].
    eyring : float
        Eyring stress [Pa]; infinite: Newtonian.
    limit : float
        Limiting shear stress over pressure; infinite: none.
    conductivity : float
        k_f at ambient pressure [W/(m K)].
    conductivity_pressure : float
        Its relative increase with pressure [1/Pa].
    sliding : float
        |u1 - u2| [m/s].
    thinnest : float
        Film [m] below which the shear stress is that of this film; 0: films of no thickness are not sheared.
    """

    viscosity: tuple
    is_linear: bool
    eta0: float
    eyring: float
    limit: float
    conductivity: float
    conductivity_pressure: float
    sliding: float
    thinnest: float = 0.0


def film_law(fluid, heat, sliding, thinnest=0.0):
    """Constants of the oil in a step, :class:`.film.FilmLaw`.

    Parameters
    ----------
    fluid : case.tables.fluid.Fluid or None
        None: dry.
    heat : case.tables.heat.Heat
    sliding : float
        u1 - u2 [m/s].
    thinnest : float
        See :class:`.film.FilmLaw`.
    """
    conduction = float(heat.oil_conductivity), float(heat.oil_conductivity_pressure)
    if fluid is None:
        return FilmLaw((0, (0.0,) * SLOTS, 300.0), True, 1.0, np.inf, np.inf, *conduction, 0.0)
    eyring = np.inf if fluid.eyring_stress is None else float(fluid.eyring_stress)
    law = viscosity_law(fluid, heat)
    limiting = getattr(fluid, "limiting_shear", None)
    return FilmLaw(
        tuple(law),
        is_linear_in_temperature(law),
        float(fluid.viscosity),
        eyring,
        np.inf if limiting is None else float(limiting),
        *conduction,
        abs(float(sliding)),
        thinnest,
    )


@inlined
def exchange_law(kind, r, walls):
    """Flux into both surfaces per temperature [W/(m^2 K)], and the temperature without flux [K]."""
    w1, w2, r1, r2 = walls
    if kind == PARABOLA:
        skew = (r1 - r2) / (r + r1 + r2)
        resistance = r * (1.0 / 12.0) + 0.25 * (r1 + r2 - (r1 - r2) * skew)
        return 1.0 / resistance, 0.5 * (w1 + w2) - 0.5 * skew * (w1 - w2)
    if kind == INSULATED:
        return 1.0 / (r * (1.0 / 12.0) + 0.5 * (r2 if w1 < w2 else r1)), 0.5 * (w1 + w2)
    g1, g2 = 1.0 / (r / 6.0 + r1), 1.0 / (r / 6.0 + r2)
    return g1 + g2, (g1 * w1 + g2 * w2) / (g1 + g2)


@inlined
def fluxes(kind, t, r, walls, exchange, alpha):
    """Heat fluxes into both surfaces, and the derivative of their sum with respect to r."""
    w1, w2, r1, r2 = walls
    flow = (t - alpha) * exchange
    if kind == PARABOLA:
        over_total = 1.0 / (r + r1 + r2)
        skew = (r1 - r2) * over_total
        between = -2.0 * (w1 - w2) * over_total - skew * flow
        by_r = -(0.5 * skew * (w1 - w2) * over_total + flow * (1.0 / 12.0 + 0.25 * skew * skew)) * exchange
        return 0.5 * (flow + between), 0.5 * (flow - between), by_r
    if kind == INSULATED:
        first = 0.0 if w1 < w2 else flow
        return first, flow - first, -flow * exchange / 12.0
    g1, g2 = 1.0 / (r / 6.0 + r1), 1.0 / (r / 6.0 + r2)
    q1, q2 = g1 * (t - w1), g2 * (t - w2)
    return q1, q2, -(g1 * q1 + g2 * q2) / 6.0


@inlined
def shear_stress(ln_rate, ln_eta, p, eyring, limit):
    r"""Mean shear stress of the film :math:`\tau_m` [Pa].

    :math:`\tau_0\,\mathrm{asinh}(\eta|u_1-u_2|/(\tau_0h)\,e^{-s})`, :math:`s=\ln(\sinh\Sigma/\Sigma)` (Conry,
    Wang & Cusano 1987), limited by :func:`.rheology.limited_shear`.

    Parameters
    ----------
    ln_rate : float
        :math:`\ln(\eta_0|u_1-u_2|/(\tau_0h))-s`; Newtonian: :math:`\ln(\eta_0|u_1-u_2|/h)`.
    ln_eta, p : float
        ln(eta/eta0), pressure [Pa].
    eyring, limit : float
        Eyring stress [Pa], limiting shear stress over pressure; infinite: none.

    Returns
    -------
    tau, by_ln_eta, by_ln_eta_twice, by_p : float
        `by_p` at constant viscosity.
    """
    argument = ln_rate + ln_eta
    if eyring == np.inf:
        tau = by_ln_eta = twice = np.exp(min(argument, 600.0))
    elif argument > MAX_LN_SINH:
        tau, by_ln_eta, twice = eyring * (argument + 0.6931471805599453), eyring, 0.0
    else:
        x = np.exp(argument)
        root = np.sqrt(1.0 + x * x)
        over_root = 1.0 / root
        by_ln_eta = eyring * x * over_root
        tau = eyring * np.log(x + root) if x > 1e-4 else eyring * x
        twice = by_ln_eta * over_root * over_root
    if limit == np.inf:
        return tau, by_ln_eta, twice, 0.0
    value, by_tau, by_limit = _limited(tau, limit * p)
    if tau > 0.0:
        twice = by_tau * twice - 5.0 * by_tau * by_ln_eta * by_ln_eta / tau * (1.0 - (value / tau) ** 4)
    return value, by_ln_eta * by_tau, twice, by_limit * limit


@inlined
def _log_rate(h, spread, law):
    """`ln_rate` of :func:`.shear.shear_stress`."""
    if law.eyring == np.inf:
        return np.log(law.sliding * law.eta0 / h)
    return np.log(law.sliding * law.eta0 / (law.eyring * h)) - spread


@inlined
def _balanced(guess, slope, intercept, heat, ln_rate, p, law):
    """Temperature of `slope` T = `intercept` + `heat` times the shear stress, by safeguarded Halley steps.

    Returns
    -------
    temperature : float
    shear : tuple of 3 floats
        Stress [Pa] and its derivatives with respect to ln(eta) and p.
    viscosity : tuple of 3 floats
        Of :func:`.laws.ln_viscosity`.
    """
    eyring, limit = law.eyring, law.limit
    low, high = intercept / slope, np.inf
    t = low if heat == 0.0 else max(guess, low)
    linear = law.is_linear  # in T: the power of the pressure is taken once
    ln_eta, eta_p, eta_t = 0.0, 0.0, 0.0
    tau, by_ln_eta, twice, by_p = 0.0, 0.0, 0.0, 0.0
    change, last = 0.0, heat == 0.0
    for k in range(ITERATIONS):
        if k == 0 or not linear:
            ln_eta, eta_p, eta_t = ln_viscosity(law.viscosity, p, t)
        else:
            ln_eta += eta_t * change
        if heat > 0.0:
            tau, by_ln_eta, twice, by_p = shear_stress(ln_rate, ln_eta, p, eyring, limit)
        if last:
            break
        f, over_f_t = slope * t - intercept - heat * tau, 1.0 / (slope - heat * by_ln_eta * eta_t)
        low, high = (low, min(high, t)) if f > 0.0 else (max(low, t), high)
        change = -f * over_f_t
        bend = -0.5 * heat * twice * eta_t * eta_t * over_f_t * change  # of f over a step of Newton's
        if linear:
            change *= 1.0 + min(max(-bend, -0.5), 1.0)
        new = t + change
        newton = low <= new <= high
        if not newton:
            new = 0.5 * (low + high) if high < np.inf else max(new, low)
        change, t = new - t, new
        step = eta_t * change
        error = abs(bend * step * change) if linear and abs(step) < SMALL else np.inf
        if newton and (error < ERROR or abs(change) < QUADRATIC):
            ln_eta += step
            tau += (by_ln_eta + 0.5 * twice * step) * step
            by_ln_eta += twice * step
            break
        last = abs(change) < ACCURACY
    return t, (tau, by_ln_eta, by_p), (ln_eta, eta_p, eta_t)


@inlined
def fixed_at(i, of_nodes, law):
    """Last arguments of :func:`film_temperature` at node i, from `g` on, from those of :class:`FilmHeat`."""
    walls = of_nodes[W1, i], of_nodes[W2, i], of_nodes[R1, i], of_nodes[R2, i]
    return of_nodes[G, i], of_nodes[SPREAD, i], walls, law


@inlined
def film_temperature(guess, p, h, left, a, b, g, spread, walls, law):
    r"""Temperature of the film at one node.

    Parameters
    ----------
    guess : float
        Start of the iteration [K].
    p, h, left : float
        Pressure [Pa], film [m], fraction of the gap full of oil.
    a, b : float
        Storage and transport per temperature [W/(m^2 K)], and their known part [W/m^2].
    g : float
        Heat that does not depend on the temperature [W/m^2].
    spread : float
        :math:`\ln(\sinh\Sigma/\Sigma)` of the Eyring stress.
    walls : tuple of 4 floats
        W1, W2 [K], R1, R2 [m^2 K/W].
    law : FilmLaw

    Returns
    -------
    temperature : float
        [K]
    by_p, by_h : float
        Derivatives [K/Pa], [K/m].
    q1, q2 : float
        Heat fluxes into both surfaces [W/m^2].
    shear_heat : float
        Phi [W/m^2].
    viscosity : tuple of 3 floats
        Of :func:`.laws.ln_viscosity` at that temperature.
    """
    pressure_factor = 1.0 + law.conductivity_pressure * p
    over_conductivity = 1.0 / (law.conductivity * pressure_factor * max(left, MIN_CONDUCTING_FRACTION))
    r = h * over_conductivity
    sheared = max(h, law.thinnest)
    heat = left * law.sliding if sheared > 0.0 else 0.0
    ln_rate = _log_rate(sheared, spread, law) if heat > 0.0 else 0.0
    for kind in (PARABOLA, INSULATED, APART):
        exchange, alpha = exchange_law(kind, r, walls)
        slope = a + exchange
        t, shear, viscosity = _balanced(guess, slope, b + g + alpha * exchange, heat, ln_rate, p, law)
        q1, q2, by_r = fluxes(kind, t, r, walls, exchange, alpha)
        if kind == PARABOLA and (q1 if walls[0] < walls[1] else q2) >= -NO_FLUX * exchange:
            break
        if kind == INSULATED and t >= min(walls[0], walls[1]):
            break
    tau, by_ln_eta, by_p = shear
    over_f_t = 1.0 / (slope - heat * by_ln_eta * viscosity[2])
    f_h = by_r * over_conductivity
    if heat > 0.0 and h == sheared:
        f_h += heat * by_ln_eta / h
    f_p = -by_r * r * law.conductivity_pressure / pressure_factor - heat * (by_ln_eta * viscosity[1] + by_p)
    return t, -f_p * over_f_t, -f_h * over_f_t, q1, q2, heat * tau, viscosity
