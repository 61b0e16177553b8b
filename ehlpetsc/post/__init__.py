"""Stresses, fatigue damage and its statistics from result files or arrays; needs no PETSc and no MPI."""

# ruff: noqa: F401 - the interface

from ehlpetsc.post.criteria.critical_plane import PlaneDamage, critical_plane
from ehlpetsc.post.criteria.dang_van import dang_van
from ehlpetsc.post.criteria.planes import Criteria
from ehlpetsc.post.fatigue.accumulate import Damage, damage
from ehlpetsc.post.fatigue.cycles import rainflow
from ehlpetsc.post.fatigue.statistics import WeibullFit, WeibullLikelihood, weibull_fit, weibull_likelihood
from ehlpetsc.post.fatigue.strain_life import Material, cycles_to_failure
from ehlpetsc.post.stresses.half_plane import stress, von_mises
from ehlpetsc.post.stresses.half_space import StressTensor, stress_plane
