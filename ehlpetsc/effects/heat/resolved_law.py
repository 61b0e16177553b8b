r"""Temperature of the film at a node with its profile across the film, as a law of pressure and film.

The unknowns are the temperature :math:`T_0` without the heat of shear, that of the walls and of all other
heat, and the rise :math:`\theta` from it to the middle of the film. With the factors :math:`\varphi`, w and
:math:`\ln F` of :func:`.film_shear.profile` by the drop of :math:`\ln\eta` over :math:`\theta`,

.. math::
   \theta\varphi=\frac{rs\tau}8,\qquad \tau=\tau(\ln\eta(T_0)-\ln F),\qquad
   aT-b=s\tau+G-q_1-q_2,\qquad T=T_0+w\theta,

s the sliding speed times the fraction of oil, :math:`r=h/k_f`. The fluxes are those of a parabola of the same
heat, :mod:`.film_law`, whose mean is :math:`T_0+\tfrac23\varphi\theta`. The walls' difference of temperature
changes the fluxes, not the profile: 0.3 % of friction where one surface is 16 K hotter.
"""

import numpy as np

from ehlpetsc.compiled import inlined
from ehlpetsc.effects.heat.film_law import (
    APART,
    INSULATED,
    MIN_CONDUCTING_FRACTION,
    NO_FLUX,
    PARABOLA,
    FilmLaw,
    _balanced,
    _log_rate,
    exchange_law,
    fluxes,
    shear_stress,
)
from ehlpetsc.physics.film_shear import profile
from ehlpetsc.physics.laws import ln_viscosity

ITERATIONS = 100
ACCURACY = 1e-6  # change of ln(theta), and of T_0 in 10 K, of an iteration after which it is exact to 1e-10
MAX_STEP, MAX_STEP_KELVIN = 1.5, 30.0  # of ln(theta) and T_0 in an iteration
FAR = 0.7  # error of ln(theta) above which T_0 stays
MIN_RISE = 1e-12  # K


@inlined
def _viscosity(p: float, t: float, start: tuple[float, tuple[float, float, float]], law: FilmLaw) -> tuple:
    """Of :func:`.laws.ln_viscosity`; linear in T by temperature and viscosity of `start`, without a power."""
    if law.is_linear:
        ln_eta, by_p, by_t = start[1]
        return ln_eta + by_t * (t - start[0]), by_p, by_t
    return ln_viscosity(law.viscosity, p, t)


@inlined
def _state(p: float, t0: float, rise: float, ln_rate: float, start: tuple, law: FilmLaw) -> tuple:
    """Viscosity at T_0 and in the middle, profile and shear stress."""
    cold, hot = _viscosity(p, t0, start, law), _viscosity(p, t0 + rise, start, law)
    shape = profile(cold[0] - hot[0])
    return cold, hot, shape, shear_stress(ln_rate - shape[0], cold[0], p, law.eyring, law.limit)


@inlined
def resolved_temperature(
    guess: float,
    p: float,
    h: float,
    left: float,
    a: float,
    b: float,
    g: float,
    spread: float,
    walls: tuple[float, float, float, float],
    law: FilmLaw,
) -> tuple:
    """Temperature of the film at one node: arguments and results of :func:`.film_law.film_temperature`.

    Returns
    -------
    temperature, by_p, by_h, q1, q2, shear_heat, viscosity
        Of :func:`.film_law.film_temperature`, the temperature averaged across the film.
    middle, shear_ln_eta
        Temperature in the middle of the film [K]; ln(eta/eta0) with which the flow law has the stress of this
        film at :math:`|u_1-u_2|/h`.
    """
    pressure_factor = 1.0 + law.conductivity_pressure * p
    over_conductivity = 1.0 / (law.conductivity * pressure_factor * max(left, MIN_CONDUCTING_FRACTION))
    r = h * over_conductivity
    sheared = max(h, law.thinnest)
    heat = left * law.sliding if sheared > 0.0 else 0.0
    ln_rate = _log_rate(sheared, spread, law) if heat > 0.0 else -np.inf
    start = guess, ln_viscosity(law.viscosity, p, guess)
    for kind in (PARABOLA, INSULATED, APART):
        exchange, alpha = exchange_law(kind, r, walls)
        slope, intercept = a + exchange, b + g + alpha * exchange
        t0, rise = _resolved(slope, intercept, a, heat, r, ln_rate, p, start, law)
        cold, hot, shape, shear = _state(p, t0, rise, ln_rate, start, law)
        q1, q2, by_r = fluxes(kind, t0 + rise * shape[2] / 1.5, r, walls, exchange, alpha)
        if kind == PARABOLA and (q1 if walls[0] < walls[1] else q2) >= -NO_FLUX * exchange:
            break
        if kind == INSULATED and t0 + rise * shape[4] >= min(walls[0], walls[1]):
            break
    j = _jacobian(rise, slope, a, heat, cold, hot, shape, shear)
    t, shear_ln_eta = t0 + rise * shape[4], cold[0] - shape[0]
    fixed = j[5], j[6]  # of both equations by the drop, at constant T_0 and rise
    drop_p = cold[1] - hot[1]
    tau_p = shear[1] * (cold[1] - shape[1] * drop_p) + shear[3]
    r_p = -law.conductivity_pressure / pressure_factor  # of ln(r)
    over_tau = 1.0 / shear[0] if shear[0] > 0.0 else 0.0
    f1, f2 = by_r * r * r_p + fixed[0] * drop_p - heat * tau_p, fixed[1] * drop_p - r_p - tau_p * over_tau
    by_p = _mean_change(f1, f2, j, rise, shape, cold, hot, drop_p)
    tau_h = -shear[1] / h if heat > 0.0 and h == sheared else 0.0
    ln_r_h = 1.0 / h if h > 0.0 else 0.0
    f1, f2 = by_r * over_conductivity - heat * tau_h, -ln_r_h - tau_h * over_tau
    by_h = _mean_change(f1, f2, j, rise, shape, cold, hot, 0.0)
    return t, by_p, by_h, q1, q2, heat * shear[0], _viscosity(p, t, start, law), t0 + rise, shear_ln_eta


@inlined
def _jacobian(
    rise: float,
    slope: float,
    a: float,
    heat: float,
    cold: tuple,
    hot: tuple,
    shape: tuple,
    shear: tuple,
) -> tuple:
    """Derivatives of the heat balance and of ln(theta) = ... by T_0 and ln(theta), and both by the drop."""
    _, rate_d, flux, flux_d, mean, mean_d = shape
    drop_t, drop_l = cold[2] - hot[2], -hot[2] * rise
    over_tau = shear[1] / shear[0] if shear[0] > 0.0 else 0.0
    by_drop = rise * (slope * flux_d / 1.5 + a * (mean_d - flux_d / 1.5))
    first_d, second_d = by_drop, flux_d / flux
    f1_t = slope + first_d * drop_t - heat * shear[1] * (cold[2] - rate_d * drop_t)
    f1_l = (
        rise * (slope * flux / 1.5 + a * (mean - flux / 1.5))
        + first_d * drop_l
        + heat * shear[1] * rate_d * drop_l
    )
    f2_t = second_d * drop_t - over_tau * (cold[2] - rate_d * drop_t)
    f2_l = 1.0 + second_d * drop_l + over_tau * rate_d * drop_l
    return f1_t, f1_l, f2_t, f2_l, 1.0 / (f1_t * f2_l - f1_l * f2_t), first_d, second_d


@inlined
def _mean_change(
    f1: float, f2: float, j: tuple, rise: float, shape: tuple, cold: tuple, hot: tuple, drop: float
) -> float:
    """Change of the mean temperature by the changes of both equations and of the drop."""
    t0 = -(j[3] * f1 - j[1] * f2) * j[4]
    ln_rise = -(j[0] * f2 - j[2] * f1) * j[4]
    drop += (cold[2] - hot[2]) * t0 - hot[2] * rise * ln_rise
    return t0 + rise * (shape[4] * ln_rise + shape[5] * drop)


@inlined
def _resolved(
    slope: float,
    intercept: float,
    a: float,
    heat: float,
    r: float,
    ln_rate: float,
    p: float,
    start: tuple,
    law: FilmLaw,
) -> tuple[float, float]:
    """T_0 and rise to the middle [K] of a node, by Newton's method in T_0 and ln(theta).

    The temperature is uniform without conduction, and where the oil stores so much heat that no profile is in
    balance.
    """
    guess, low = start[0], intercept / slope
    if heat == 0.0 or r == 0.0:
        return _balanced(guess, slope, intercept, heat, ln_rate, p, law)[0], MIN_RISE
    parabola = min(slope * r / 12.0, 1.0) * max(guess - low, 0.0)
    t0, rise = max(guess, low) - parabola, max(1.5 * parabola, 1e-3)
    for _ in range(ITERATIONS):
        cold, hot, shape, shear = _state(p, t0, rise, ln_rate, start, law)
        flux, mean = shape[2], shape[4]
        f1 = slope * (t0 + rise * flux / 1.5) + a * rise * (mean - flux / 1.5) - intercept - heat * shear[0]
        f2 = np.log(rise * flux / max(0.125 * r * heat * shear[0], MIN_RISE))
        j = _jacobian(rise, slope, a, heat, cold, hot, shape, shear)
        if abs(f2) > FAR:
            change, step = 0.0, -f2 / j[3]
        else:
            change, step = -(j[3] * f1 - j[1] * f2) * j[4], -(j[0] * f2 - j[2] * f1) * j[4]
        done = abs(step) < ACCURACY and abs(change) < 10.0 * ACCURACY
        damping = 1.0
        if not done:
            damping = min(1.0, MAX_STEP / max(abs(step), 1e-12), MAX_STEP_KELVIN / max(abs(change), 1e-12))
        t0 += damping * change
        rise = max(rise * np.exp(damping * step), MIN_RISE)
        if done:
            return t0, rise
    return _balanced(guess, slope, intercept, heat, ln_rate, p, law)[0], MIN_RISE
