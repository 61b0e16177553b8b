"""The solution does not depend on the number of ranks: a rough run with contact, on all ranks and on one."""

from pathlib import Path

import numpy as np
import petsc4py
import pytest

petsc4py.init([])

from mpi4py import MPI
from support.work_shares import shared_out

from ehlpetsc.case.loading import load
from ehlpetsc.run.simulation import Simulation

CASE = Path(__file__).parents[2] / "cases" / "table1_rough.toml"
# the inlet near the contact, thin oil: the asperities touch within few steps
SHORT = [
    "mesh.inlet=-1.2",
    "mesh.outlet=1.3",
    "mesh.points_per_half_width=40",
    "time.travel=0.7",
    "time.courant=1.0",
    "fluid.viscosity=0.001",
]


MODELS = {
    "direct": ["contact.model=direct"],
    "direct, touching all over": ["contact.model=direct", "time.start=rough", "time.travel=0.1"],
    "mixed": ["contact.model=mixed"],
    "compliant": ["contact.model=mixed", "contact.asperity_height=20e-9"],
    "compliant, yielding": [
        "contact.model=mixed",
        "contact.asperity_height=20e-9",
        "contact.yield_pressure=1.5e9",
    ],
    "yielding": ["contact.model=mixed", "contact.yield_pressure=1.5e9"],
    "heat": ["contact.model=mixed", "heat.bulk_temperature=363.0"],
    "reversing": [
        "contact.model=mixed",
        "mesh.outlet=1.2",
        "operation.time=[0.0, 1e-5, 2e-5]",
        "operation.load=[527e3, 500e3, 450e3]",
        "operation.speed_1=[5.5, 0.0, -5.5]",
        "operation.speed_2=[4.5, 0.0, -4.5]",
    ],
}


@pytest.fixture(scope="module")
def alone():
    """Steps of one rank, by model."""
    return shared_out(lambda model: marched(MPI.COMM_SELF, model), MODELS)


def marched(comm, model):
    """Pressures, films and contacts of all steps; Newton iterations in all."""
    simulation = Simulation(load(CASE, [*SHORT, *MODELS[model]]), comm)
    states, scales = list(simulation), simulation.scales
    return (
        np.array([s.pressure for s in states]) / scales.p0,
        np.array([s.film_thickness for s in states]) / scales.h,
        np.array([s.in_contact for s in states]),
        np.array([s.newton for s in states]),
        states[-1].scalars.get("set_volume"),
    )


@pytest.mark.several_ranks
@pytest.mark.parametrize("model", MODELS)
def test_rough_run_is_independent_of_the_number_of_ranks(model, alone):
    pressure, film, touching, newton, volume = marched(MPI.COMM_WORLD, model)
    expected = alone[model]
    assert touching.any()
    np.testing.assert_array_equal(touching, expected[2])
    np.testing.assert_allclose(pressure, expected[0], rtol=0, atol=1e-9)  # p0
    np.testing.assert_allclose(film, expected[1], rtol=0, atol=1e-9)  # a^2/R
    if "yielding" in model:
        assert volume == pytest.approx(expected[4], rel=1e-6) and volume > 0.0
    assert newton.sum() == pytest.approx(expected[3].sum(), rel=0.02)  # last digits may tip a residual over
