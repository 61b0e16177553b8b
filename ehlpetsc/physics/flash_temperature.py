"""Flash temperature of a contact by Blok's formula, and the friction expected of a case."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ehlpetsc.base.case import Fluid
from ehlpetsc.physics.oil.laws import viscosity
from ehlpetsc.physics.scales import Scales
from ehlpetsc.physics.traction import wall_shear


class Solid(NamedTuple):
    """Thermal properties of a body.

    Attributes
    ----------
    conductivity
        k [W/(m K)].
    density
        rho [kg/m^3].
    heat_capacity
        c [J/(kg K)].
    """

    conductivity: float
    density: float
    heat_capacity: float

    @property
    def diffusivity(self) -> float:
        """Thermal diffusivity k/(rho c) [m^2/s]."""
        return self.conductivity / (self.density * self.heat_capacity)

    @property
    def effusivity(self) -> float:
        """Thermal effusivity sqrt(k rho c) [W s^(1/2)/(m^2 K)]."""
        return (self.conductivity * self.density * self.heat_capacity) ** 0.5


STEEL = Solid(46.0, 7850.0, 470.0)
OIL_CONDUCTIVITY = 0.25  # W/(m K), of a mineral oil at about 0.6 GPa
MAX_ISOTHERMAL_RISE = 20.0  # K, of the film over the bodies: above it a case should not be isothermal
MIN_SLIDING = 1e-300  # surfaces at rest do not slide
MAX_FRICTION = 0.1  # coefficient: isothermal Newtonian estimates have no bound


def blok_flash_temperature(
    friction: float | np.ndarray,
    load: float | np.ndarray,
    sliding: float | np.ndarray,
    u1: float | np.ndarray,
    u2: float | np.ndarray,
    a: float | np.ndarray,
    effusivities: Sequence[float],
) -> float | np.ndarray:
    r"""Maximum flash temperature of a line contact [K] by Blok's formula.

    :math:`T=1.11\,\frac{\mu w'|u_1-u_2|}{(e_1\sqrt{|u_1|}+e_2\sqrt{|u_2|})\sqrt{2a}}` (Blok 1937, as in
    ISO/TS 6336-20), e the thermal effusivities :math:`\sqrt{k\rho c}`.

    Parameters
    ----------
    friction
        Coefficient of friction mu.
    load
        w' [N/m].
    sliding, u1, u2
        [m/s]
    a
        Hertz half-width [m].
    effusivities
        [W s^(1/2)/(m^2 K)]
    """
    carried = sum(e * abs(u) ** 0.5 for e, u in zip(effusivities, (u1, u2), strict=True))
    return 1.11 * friction * load * abs(sliding) / (np.maximum(carried, MIN_SLIDING) * (2.0 * a) ** 0.5)


def expected_friction(fluid: Fluid, load: float, a: float, sliding: float, film: float) -> float:
    """Coefficient of friction of a smooth, flooded contact at its mean Hertz pressure.

    Parameters
    ----------
    load, a, sliding
        w' [N/m], Hertz half-width [m], u1 - u2 [m/s].
    film
        Expected film [m].
    """
    p = np.array([load / (2.0 * a)])
    with np.errstate(over="ignore"):
        stress, _ = wall_shear(np.array([film]), 0.0, viscosity(p, fluid)[0], fluid, sliding, p)
    return float(min(abs(stress[0]) / p[0], MAX_FRICTION))


def flash_temperature(friction: float, scales: Scales) -> float:
    """Flash temperature [K] of the middle row of a contact of steels, by its coefficient of friction."""
    conditions = scales.load_per_length, scales.u1 - scales.u2, scales.u1, scales.u2, scales.a
    return blok_flash_temperature(friction, *conditions, (STEEL.effusivity, STEEL.effusivity))


def film_rise(friction: float, scales: Scales, film: float) -> float:
    r"""Mean temperature across the film over that of its walls [K], :math:`\tau|u_1-u_2|h/(12k)`.

    Of heat generated evenly across, by the mean Hertz pressure of the middle row.

    Parameters
    ----------
    friction
        Coefficient of friction, :math:`\tau/p`.
    film
        h [m], 0 of a dry contact.
    """
    stress = friction * scales.load_per_length / (2.0 * scales.a)
    return stress * abs(scales.u1 - scales.u2) * film / (12.0 * OIL_CONDUCTIVITY)
