"""The solution does not depend on the number of ranks: a rough run with contact, on all ranks and on one."""

from pathlib import Path

import numpy as np
import petsc4py
import pytest

petsc4py.init([])

from petsc4py import PETSc

from ehlpetsc.case.loading import load
from ehlpetsc.nonlinear.newton import NewtonSolver, set_defaults
from ehlpetsc.physics.film_formulas import expected_film
from ehlpetsc.physics.scales import Scales
from ehlpetsc.stepping.time_stepping import TimeStepping
from ehlpetsc.surfaces.roughness import Roughness

CASE = Path(__file__).parents[2] / "cases" / "table1_rough.toml"
# the inlet near the contact, thin oil: the asperities touch within few steps
SHORT = [
    "mesh.inlet=-1.2",
    "mesh.outlet=1.3",
    "mesh.points_per_half_width=40",
    "time.travel=0.7",
    "fluid.viscosity=0.001",
]


def marched(comm):
    """Pressures, films and contacts of all steps; Newton iterations in all."""
    set_defaults(PETSc.Options())
    case = load(CASE, SHORT)
    scales = Scales.of(case)
    film = expected_film(case, scales)
    march = TimeStepping(NewtonSolver(case, scales, film, comm), scales, Roughness.of(case, scales), film)
    states = [march.start()]
    while states[-1].time < scales.duration:
        states.append(march.advance(states[-1]))
    return (
        np.array([s.p for s in states]),
        np.array([s.h for s in states]),
        np.array([s.h <= 0.0 for s in states]),
        np.array([s.newton for s in states]),
    )


def test_a_rough_run_is_the_same_on_every_number_of_ranks():
    pressure, film, touching, newton = marched(PETSc.COMM_WORLD)
    alone = marched(PETSc.COMM_SELF)
    assert touching.any()
    np.testing.assert_array_equal(touching, alone[2])
    np.testing.assert_allclose(pressure, alone[0], rtol=0, atol=1e-9)  # p0
    np.testing.assert_allclose(film, alone[1], rtol=0, atol=1e-9)  # a^2/R
    assert newton.sum() == pytest.approx(alone[3].sum(), rel=0.02)  # last digits may tip a residual over
