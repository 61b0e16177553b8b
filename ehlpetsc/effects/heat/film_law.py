r"""Temperature of the film at a node, with both surfaces, as a law of pressure and film.

With one temperature T of the film and both surfaces' response :math:`R_i` to the present flux,

.. math:: aT-b=\Phi(T)+G-q_1-q_2,\qquad T_i=W_i+R_iq_i,

:math:`\Phi=\tau_m|u_1-u_2|`, the fluxes by :mod:`.exchange`, linear in T. What is left is one equation for T,
monotone because the shear stress falls with T; the derivatives follow from the implicit function theorem.
"""

from typing import NamedTuple

import numpy as np

from ehlpetsc.compiled import inlined
from ehlpetsc.effects.heat.exchange import APART, INSULATED, NO_FLUX, PARABOLA, exchange_law, fluxes
from ehlpetsc.effects.heat.shear import shear_stress
from ehlpetsc.physics.laws import ln_viscosity

MIN_CONDUCTING_FRACTION = 1e-6  # fraction of the gap: less conducts as this
ITERATIONS = 200
ACCURACY = 1e-10  # K: change in an iteration that ends it
QUADRATIC = 1e-4  # K: the same of an iteration of Newton's method, after which it is accurate to 1e-9 K
ERROR = 1e-8  # K: estimated error of an iteration of Chebyshev's method that ends it,
SMALL = 0.3  # change of ln(eta) up to which that estimate holds

A, B, G, SPREAD, W1, W2, R1, R2 = range(8)  # rows of FilmHeat.of_nodes


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


class FilmHeat(NamedTuple):
    """Coefficients of the film's temperature that are fixed in a solve, and its last evaluation.

    Attributes
    ----------
    law : FilmLaw
    of_nodes : ndarray, shape (8, nx)
        Rows `A` to `R2`, as of :func:`film_temperature`. One array, as numba looks up the types of many in a
        tuple anew in some calls, slowly.
    guess : ndarray, shape (nx,)
        Temperature to start from [K]; that of the last evaluation.
    last_evaluation : ndarray, shape (4, nx)
        Unknown of the Reynolds equation and film, not a number before the first evaluation; fluidity and
        thermal factor of :func:`.effects.film.heated_nodal`.
    """

    law: FilmLaw
    of_nodes: np.ndarray
    guess: np.ndarray
    last_evaluation: np.ndarray

    @classmethod
    def begun(cls, law, of_nodes, guess):
        """Coefficients without any evaluation, from the rows of `of_nodes`."""
        return cls(law, np.array(of_nodes), guess, np.full((4, len(guess)), np.nan))

    def with_rows(self, rows, values):
        """Coefficients with other values in some rows of `of_nodes`."""
        of_nodes = self.of_nodes.copy()
        for row, row_values in zip(rows, values, strict=True):
            of_nodes[row] = row_values
        return self._replace(of_nodes=of_nodes)

    def mirrored(self):
        """Coefficients with the nodes in reverse order."""
        return self.at_nodes(slice(None, None, -1))

    def at_nodes(self, nodes):
        """Coefficients at a slice of the nodes."""
        if nodes == slice(0, len(self.guess)):
            return self
        return FilmHeat(self.law, *(np.ascontiguousarray(array[..., nodes]) for array in self[1:]))
