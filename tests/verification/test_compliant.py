"""Mixed contact through a compliant layer: convergence, balance, limits, and the range of speeds."""

from pathlib import Path

import numpy as np
import petsc4py
import pytest

petsc4py.init([])

import ehlpetsc
from ehlpetsc.case.loading import load
from ehlpetsc.physics.asperities import GAMMA

CASES = Path(__file__).parents[2] / "cases"
SIGMA = 20e-9
RESOLVED = ["mesh.inlet=-1.5", "mesh.outlet=1.3", "time.travel=5.0"]


def case(*overrides, sigma=SIGMA, file="resolved_mixed.toml", yield_pressure=None):
    """A case of mixed contact with a compliant layer."""
    loaded = load(CASES / file, list(overrides))
    layer = {"model": "mixed", "boundary_film": None, "asperity_height": sigma}
    layer |= {"asperity_stiffness": 1.0, "asperity_slope": 0.1, "boundary_friction": 0.1}
    if yield_pressure is not None:
        layer["yield_pressure"] = (yield_pressure, yield_pressure)
    return loaded.copy(update={"contact": loaded.contact.copy(update=layer), "series": None})


def layer_pressure(state, solids, sigma=SIGMA):
    """The law at the films of a state [Pa]."""
    modulus = 0.5 * solids.scales.E
    return modulus * np.exp(-state.film_thickness / (GAMMA * sigma))


@pytest.mark.parametrize("speed", [20.0, 5.0, 1.0, 0.2, 0.05, 0.01, 1e-3, 1e-4])
def test_steady_contacts_converge_at_every_speed(speed):
    simulation = ehlpetsc.Simulation(case(f"motion.entrainment_speed={speed}"))
    state = simulation.advance()
    carried = state.contact_pressure
    np.testing.assert_allclose(carried, layer_pressure(state, simulation), rtol=1e-9, atol=1e-3)
    assert state.load_error < 1e-10 and state.mass_error < 1e-6
    if speed <= 1e-3:
        assert state.contact_share > 0.9998
        assert state.friction_coefficient == pytest.approx(0.1, abs=1e-4)
    if speed >= 20.0:
        assert state.contact_share < 1e-4
