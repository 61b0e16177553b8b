"""Thermal properties of a body, and the heat in it between time steps.

Apart from the compiled loops of :mod:`.half_space_conduction`, for readers of results that need none of them.
"""

from typing import NamedTuple

import numpy as np


class Solid(NamedTuple):
    """Thermal properties of a body.

    Attributes
    ----------
    conductivity : float
        k [W/(m K)].
    density : float
        rho [kg/m^3].
    heat_capacity : float
        c [J/(kg K)].
    """

    conductivity: float
    density: float
    heat_capacity: float

    @property
    def diffusivity(self):
        """Thermal diffusivity k/(rho c) [m^2/s]."""
        return self.conductivity / (self.density * self.heat_capacity)

    @property
    def effusivity(self):
        """Thermal effusivity sqrt(k rho c) [W s^(1/2)/(m^2 K)]."""
        return (self.conductivity * self.density * self.heat_capacity) ** 0.5


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
