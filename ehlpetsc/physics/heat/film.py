r"""Temperature of the film at a node, with both surfaces, as a law of pressure and film.

With one temperature T of the film, a parabola across it, and both surfaces' response :math:`R_i` to the
present flux,

.. math:: aT-b=\Phi(T)+G-q_1-q_2,\qquad q_{1,2}=\frac{k_f}{h}\Big[6(T-T_w)\pm(T_2-T_1)\Big],\qquad
   T_i=W_i+R_iq_i,

:math:`T_w=(T_1+T_2)/2`, :math:`\Phi=\tau_m|u_1-u_2|`. The fluxes are linear in T: with
:math:`r=h/k_f`, :math:`T=\alpha+\kappa(q_1+q_2)`,

.. math:: \kappa=\frac r{12}+\frac14\Big[R_1+R_2-\frac{(R_1-R_2)^2}{r+R_1+R_2}\Big],\qquad
   \alpha=\frac{W_1+W_2}2-\frac{(R_1-R_2)(W_1-W_2)}{2(r+R_1+R_2)},

regular at r = 0. What is left is one equation for T, monotone because the shear stress falls with T; the
derivatives follow from the implicit function theorem.
"""

from typing import NamedTuple

import numpy as np

from ehlpetsc.compiled import compiled
from ehlpetsc.physics.heat import thermal_viscosity
from ehlpetsc.physics.heat.shear import shear_stress

LEAST_OIL = 1e-6  # fraction of the gap: less conducts as this
ITERATIONS = 200
ACCURACY = 1e-10  # K: change in an iteration that ends it
QUADRATIC = 1e-4  # K: the same of an iteration of Newton's method, after which it is accurate to 1e-9 K
ERROR = 1e-8  # K: estimated error of an iteration of Chebyshev's method that ends it,
SMALL = 0.3  # change of ln(eta) up to which that estimate holds

_log_viscosity = compiled(thermal_viscosity.log_viscosity)


class FilmLaw(NamedTuple):
    """Constants of the oil in a step.

    Attributes
    ----------
    pressure_law, thermal_law : tuple
        Of :func:`.thermal_viscosity.log_viscosity`.
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
    """

    pressure_law: tuple
    thermal_law: tuple
    eta0: float
    eyring: float
    limit: float
    conductivity: float
    conductivity_pressure: float
    sliding: float


@compiled
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
        Of :func:`.thermal_viscosity.log_viscosity` at that temperature.
    """
    pressure_law, thermal_law, eta0, eyring, limit = law[0], law[1], law[2], law[3], law[4]
    more = 1.0 + law[6] * p
    over_conductivity = 1.0 / (law[5] * more * max(left, LEAST_OIL))
    w1, w2, r1, r2 = walls
    r, difference = h * over_conductivity, r1 - r2
    over_total = 1.0 / (r + r1 + r2)
    share = difference * over_total
    exchange = 1.0 / (r * (1.0 / 12.0) + 0.25 * (r1 + r2 - difference * share))
    alpha = 0.5 * (w1 + w2) - 0.5 * share * (w1 - w2)
    slope, known = a + exchange, b + g + alpha * exchange
    heat = left * law[7] if h > 0.0 else 0.0
    over_h = 1.0 / h if h > 0.0 else 0.0
    low, high = known / slope, np.inf
    t = low if heat == 0.0 else max(guess, low)
    linear = thermal_law[0] < 2  # in T: the power of the pressure is taken once
    unit = eta0 if eyring == np.inf else eta0 / eyring
    ln_rate = np.log(law[7] * unit * over_h) - (0.0 if eyring == np.inf else spread) if heat > 0.0 else 0.0
    ln_eta, eta_p, eta_t = 0.0, 0.0, 0.0
    tau, by_ln_eta, twice, by_p = 0.0, 0.0, 0.0, 0.0
    change, last = 0.0, heat == 0.0
    for k in range(ITERATIONS):
        if k == 0 or not linear:
            ln_eta, eta_p, eta_t = _log_viscosity(p, t, pressure_law, thermal_law)
        else:
            ln_eta += eta_t * change
        if heat > 0.0:
            tau, by_ln_eta, twice, by_p = shear_stress(ln_rate, ln_eta, p, eyring, limit)
        if last:
            break
        f, over_f_t = slope * t - known - heat * tau, 1.0 / (slope - heat * by_ln_eta * eta_t)
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
    over_f_t = 1.0 / (slope - heat * by_ln_eta * eta_t)
    kappa_r = 1.0 / 12.0 + 0.25 * share * share
    alpha_r = 0.5 * share * (w1 - w2) * over_total
    flow = (t - alpha) * exchange
    f_r = -(alpha_r + flow * kappa_r) * exchange
    f_h = f_r * over_conductivity + heat * by_ln_eta * over_h
    f_p = -f_r * r * law[6] / more - heat * (by_ln_eta * eta_p + by_p)
    between = -2.0 * (w1 - w2) * over_total - share * flow
    q1, q2 = 0.5 * (flow + between), 0.5 * (flow - between)
    return t, -f_p * over_f_t, -f_h * over_f_t, q1, q2, heat * tau, (ln_eta, eta_p, eta_t)


class FilmHeat(NamedTuple):
    """Coefficients of the film's temperature that are fixed in a solve; arrays of shape (nx,).

    Attributes
    ----------
    law : FilmLaw
    a, b, g, spread
        As of :func:`film_temperature`.
    w1, w2, r1, r2
        Of both surfaces.
    guess
        Temperature to start from [K]; that of the last evaluation.
    """

    law: FilmLaw
    a: np.ndarray
    b: np.ndarray
    g: np.ndarray
    spread: np.ndarray
    w1: np.ndarray
    w2: np.ndarray
    r1: np.ndarray
    r2: np.ndarray
    guess: np.ndarray

    def mirrored(self):
        """Coefficients with the nodes in reverse order."""
        return self.part(slice(None, None, -1))

    def part(self, nodes):
        """Coefficients at a slice of the nodes."""
        return FilmHeat(self.law, *(np.ascontiguousarray(array[nodes]) for array in self[1:]))
