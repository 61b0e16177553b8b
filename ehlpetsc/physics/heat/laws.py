"""Constants of the film's temperature law from the tables of a case."""

import numpy as np

from ehlpetsc.physics.heat import thermal_viscosity as thermal
from ehlpetsc.physics.heat.film import FilmLaw
from ehlpetsc.physics.rheology import viscosity_constants

BETA = 0.04  # 1/K, where a case gives no thermal viscosity: mineral oils have 0.03 to 0.05


def thermal_law(fluid, heat):
    """Kind, constants and reference temperature [K] for :func:`.thermal_viscosity.log_viscosity`."""
    reference_of_case = heat.reference_temperature or getattr(fluid, "temperature", None)
    reference = reference_of_case or heat.oil_inlet_temperature
    if heat.roelands_s0 is not None:
        return thermal.ROELANDS, heat.roelands_s0, 0.0, reference
    if heat.viscosity_temperature is None and getattr(fluid, "grade", None) is not None:
        return thermal.WALTHER, *thermal.walther_constants(fluid.grade.v40, fluid.grade.v100), reference
    beta = BETA if heat.viscosity_temperature is None else heat.viscosity_temperature
    return thermal.EXPONENTIAL, beta, 0.0, reference


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
        flat, isothermal = (0.0, 1.0, 1.0), (thermal.ISOTHERMAL, 0.0, 0.0, 300.0)
        return FilmLaw(flat, isothermal, 1.0, np.inf, np.inf, *conduction, 0.0)
    eyring = np.inf if fluid.eyring_stress is None else float(fluid.eyring_stress)
    limiting = getattr(fluid, "limiting_shear", None)
    return FilmLaw(
        tuple(map(float, viscosity_constants(fluid))),
        thermal_law(fluid, heat),
        float(fluid.viscosity),
        eyring,
        np.inf if limiting is None else float(limiting),
        *conduction,
        abs(float(sliding)),
        thinnest,
    )
