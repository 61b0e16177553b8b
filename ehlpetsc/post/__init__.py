"""Stresses, fatigue damage and its statistics from result files or arrays; needs no PETSc and no MPI."""

from ehlpetsc.post.fatigue.accumulate import Damage, damage
from ehlpetsc.post.fatigue.cycles import rainflow
from ehlpetsc.post.fatigue.statistics import WeibullFit, weibull_fit
from ehlpetsc.post.fatigue.strain_life import Material, cycles_to_failure, equivalent_range, strain_range
from ehlpetsc.post.stresses.half_plane import out_of_plane, stress, von_mises

__all__ = [
    "Damage",
    "Material",
    "WeibullFit",
    "cycles_to_failure",
    "damage",
    "equivalent_range",
    "out_of_plane",
    "rainflow",
    "strain_range",
    "stress",
    "von_mises",
    "weibull_fit",
]
