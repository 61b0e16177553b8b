"""Constants of the film's temperature law from the tables of a case."""

import numpy as np

from ehlpetsc.effects.heat.film_law import FilmLaw
from ehlpetsc.physics.laws import SLOTS, is_linear_in_temperature, viscosity_law


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
