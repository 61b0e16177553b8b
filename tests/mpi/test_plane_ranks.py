"""Points and strips do not depend on the number of ranks, which own rows along x: all ranks against one."""

from pathlib import Path

import numpy as np
import petsc4py
import pytest
from support import self_affine

petsc4py.init([])

from mpi4py import MPI
from support.points import point
from support.work_shares import shared_out

from ehlpetsc.case.loading import load
from ehlpetsc.run.simulation import Simulation

CASE = Path(__file__).parents[2] / "cases" / "resolved_mixed.toml"
STRIP = {
    "mesh.inlet": -1.3,
    "mesh.outlet": 1.3,
    "mesh.points_per_half_width": 24,
    "mesh.width": 0.6,
    "time.travel": 0.7,
    "time.courant": 1.0,
    "fluid.viscosity": 0.003,
}
LAYER = {"contact.boundary_film": None, "contact.asperity_height": 30e-9}
MIXED = {
    "surface.1.synthetic": self_affine(40e-9, 40e-6, 20e-6),
    "fluid.viscosity": 0.01,
    "motion.slide_roll_ratio": 0.3,
    "time": {"travel": 0.3, "start": "rough", "courant": 1.0},
}
REVERSED = {"mesh.inlet": -2.0, "mesh.outlet": 2.0, "motion": None, "operation.time": [0.0, 1e-1]}
REVERSED |= {"operation.load": [1.5, 1.9], "operation.speed_1": [-0.05] * 2, "operation.speed_2": [-0.03] * 2}
APPROACH = {"contact.load": None, "contact.approach": 2e-6}
SPINNING = {"contact.groove_radius": 0.02, "motion.spin": [30.0, -10.0], "fluid.eyring_stress": 5e6}
SPINNING |= {"time": {"travel": 0.3}, "motion.slide_roll_ratio": 0.02}
COATED = {"contact.coating": {"thickness": 2e-6, "youngs_modulus": 1e11, "poisson_ratio": 0.2}}
ROLLER = {
    "title": "a roller with free ends",
    "contact": {"radius": 6e-3, "length": 4e-3, "load": 800.0, "material": "100Cr6", "tilt": 1e-3},
    "fluid": {
        "viscosity": 0.02,
        "law": "roelands",
        "pressure_viscosity": 2e-8,
        "density": "dowson-higginson",
    },
    "motion": {"entrainment_speed": 3.0, "slide_roll_ratio": 0.1},
    "mesh": {"inlet": -2.4, "outlet": 2.0, "points_per_half_width": [10, 20]},
    "surface": {"1": {"synthetic": {"kind": "sine", "amplitude": 5e-8, "wavelength": 1e-4}}},
    "time": {"travel": 0.5},
}
ROLLER["contact"]["profile"] = {"kind": "iso", "diameter": 12e-3}
WINDOW = {"mesh.window": {"from": -2e-3, "to": -0.8e-3}}
TIGHT = {"snes_atol": "1e-10"}
CASES = {
    "point": (lambda: load(point(50.0, 5.0, 10)), 1),
    "direct point": (
        lambda: load(point(50.0, 5.0, 10, {"contact.boundary_film": None, "contact.model": "direct"})),
        1,
    ),
    "point at an approach": (lambda: load(point(50.0, 5.0, 8, APPROACH), MIXED), 2),
    "coated point": (lambda: load(point(50.0, 5.0, 8), COATED), 1),
    "rough point": (lambda: load(point(50.0, 5.0, 8), MIXED), 1),
    "rough point, reversed": (lambda: load(point(50.0, 5.0, 8), MIXED | REVERSED), 1),
    "spinning ball": (lambda: load(point(50.0, 5.0, 8), SPINNING), 2),
    "roller": (lambda: load(ROLLER), 3),
    "window of a roller": (lambda: load(ROLLER, WINDOW), 3),
    "strip": (lambda: load(CASE, STRIP), 12),
    "strip with a layer": (lambda: load(CASE, STRIP | LAYER), 12),
}


def pressures(comm, name):
    """Pressures over p0 and iterations of all steps."""
    case, steps = CASES[name]
    simulation = Simulation(case(), comm, TIGHT)
    states = [simulation.advance() for _ in range(steps)]
    return np.array([s.pressure for s in states]) / simulation.scales.p0, sum(s.newton for s in states)


@pytest.fixture(scope="module")
def alone():
    """Pressures and iterations of one rank, by case."""
    return shared_out(lambda name: pressures(MPI.COMM_SELF, name), CASES)


@pytest.mark.several_ranks
@pytest.mark.parametrize("name", CASES)
def test_contact_in_the_plane_is_independent_of_the_number_of_ranks(name, alone):
    found, newton = pressures(MPI.COMM_WORLD, name)
    expected, newton_alone = alone[name]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9)
    assert newton == pytest.approx(newton_alone, rel=0.1)
