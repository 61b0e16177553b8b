"""State of the heat at a time level: temperatures of the film and of both bodies."""

from typing import NamedTuple

import numpy as np


class BodyHeat(NamedTuple):
    """Heat of one body.

    Attributes
    ----------
    first : int
        Position of the first cell in the body, in cells.
    terms : ndarray, shape (cells, terms)
        :math:`A_m` [J/m^2].
    flux : ndarray, shape (cells,)
        Heat flux at the time level [W/m^2].
    rates, weights : ndarray, shape (terms,)
        Of the sum of exponentials.
    """

    first: int
    terms: np.ndarray
    flux: np.ndarray
    rates: np.ndarray
    weights: np.ndarray


class HeatRecord(NamedTuple):
    """Temperatures and heat at a time level; arrays of shape (nx,) but for `flow`, (nx + 1,).

    Attributes
    ----------
    film, wall_1, wall_2
        Temperatures [K].
    flux_1, flux_2
        Heat fluxes into both bodies [W/m^2].
    source
        Heat that does not depend on the film's temperature in a step [W/m^2].
    spread
        Of :func:`ehlpetsc.effects.heat.film_law.shear_stress`.
    flow
        Heat capacity that the surfaces' mean speed moves through the faces, per cell [W/(m^2 K)].
    response_1, response_2
        Of the surfaces to their flux, in a steady solve [m^2 K/W].
    pressure
        Of the oil [Pa].
    rate
        Change of the film's temperature over the last step [K/s]; 0: steady.
    extrapolated
        Heat of the film beyond that at its temperature, see :mod:`.effects.heat.transport` [J/m^2].
    body_1, body_2 : BodyHeat
    heat : float
        Dissipated [W/m].
    error : float
        Its imbalance over it.
    solved : int
        Number of solutions before this level; 0: none yet.
    """

    film: np.ndarray
    wall_1: np.ndarray
    wall_2: np.ndarray
    flux_1: np.ndarray
    flux_2: np.ndarray
    source: np.ndarray
    spread: np.ndarray
    flow: np.ndarray
    response_1: np.ndarray
    response_2: np.ndarray
    pressure: np.ndarray
    rate: np.ndarray
    extrapolated: np.ndarray
    body_1: BodyHeat
    body_2: BodyHeat
    heat: float
    error: float
    solved: int
