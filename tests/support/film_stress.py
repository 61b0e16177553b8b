"""Sheared films for arrays of physical quantities by the closed form of `ehlpetsc.effects.heat`."""

from typing import NamedTuple

import numpy as np

from ehlpetsc.effects.heat import film_shear
from ehlpetsc.physics.oil.rheology import FlowLaw


class FilmStress(NamedTuple):
    """Results of :func:`film_stress`; temperatures are above the mean of the walls [K].

    Attributes
    ----------
    stress, q1, q2
        Shear stress [Pa]; heat fluxes into both walls [W/m^2].
    by_ln_eta, by_ln_h, by_beta, by_t1, by_t2
        Derivatives of the stress, those by the walls' temperatures with the viscosity that they change.
    mean, middle
        Temperature averaged across the film and in the middle.
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
    y: np.ndarray


def _resolve(
    x: np.ndarray, heating: np.ndarray, d: np.ndarray, flow: FlowLaw, limit: np.ndarray
) -> np.ndarray:
    """Rows y, stress, its derivatives by x, B and d, mean rise and exchange of the walls."""
    out = np.empty((7, len(x)), x.dtype)
    for i in range(len(x)):
        given = x[i], heating[i], d[i], flow, limit[i]
        y, tau, by_x, by_heating, by_d, _ = film_shear.resolved_stress(0.0, *given)
        mean, exchange = film_shear.mean_rise(y, d[i])[0], film_shear.wall_exchange(y, d[i])
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
        y=y,
    )
    return FilmStress(*(np.reshape(value, shape) for value in results))
