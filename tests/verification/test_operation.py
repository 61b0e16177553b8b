"""Conditions that change with time: load, radius and speeds, reversal, squeeze."""

import numpy as np
import pytest
from driving import CASES

from ehlpetsc.case.loading import load
from ehlpetsc.run.simulation import Simulation

COARSE = {"mesh.points_per_half_width": 50, "mesh.inlet": -2.5, "mesh.outlet": 1.5}


def states(name, overrides):
    """All accepted solutions of a case."""
    simulation = Simulation(load(CASES / name, overrides))
    return simulation, [state.solution for state in simulation]


def scaled(simulation, name, solution):
    return getattr(solution, name) * {"h": simulation.scales.h, "p": simulation.scales.p0}[name]


@pytest.mark.parametrize("name", ["table1_smooth.toml", "table1_mixed.toml"])
def test_constant_conditions_in_a_table_are_the_plain_case(name):
    plain = COARSE | {"time.travel": 0.4, "time.courant": 0.5}
    if name == "table1_smooth.toml":
        plain["surface.slow.synthetic"] = {"kind": "sine", "amplitude": 5e-8, "wavelength": 1e-4}
    simulation, expected = states(name, plain)
    s = simulation.scales
    table = {
        "operation.time": [0.0, s.duration],
        "operation.load": [s.load] * 2,
        "operation.radius": [s.R] * 2,
        "operation.speed_1": [s.u1] * 2,
        "operation.speed_2": [s.u2] * 2,
    }
    _, found = states(name, plain | table)
    assert len(found) == len(expected) > 20
    for one, other in zip(found, expected, strict=True):
        assert one.time == pytest.approx(other.time, rel=1e-12)
        np.testing.assert_allclose(one.p, other.p, atol=1e-9)
        np.testing.assert_allclose(one.h, other.h, atol=1e-9 * other.h.min())
