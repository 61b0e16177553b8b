"""A strip whose roughness does not depend on y is the line contact: same nodes, same pressures and films.

Found, largest difference of pressures over all steps: 4e-11 p0, of films 3e-12 a^2/R.
"""

import numpy as np
import pytest
from support import CASES

from ehlpetsc.case.loading import load
from ehlpetsc.run.simulation import Simulation

MESH = {"mesh.points_per_half_width": 50, "mesh.outlet": 1.3, "contact.yield_pressure": None}
LAYER = {"contact.boundary_film": None, "contact.asperity_height": 20e-9}


def marched(name, changes, steps):
    """Steady start and time steps of a case; tolerance near rounding."""
    simulation = Simulation(load(CASES / name, MESH | changes), options={"snes_atol": 1e-11})
    return simulation, [simulation.advance() for _ in range(steps + 1)]


@pytest.mark.slow
@pytest.mark.parametrize(
    "name, changes",
    [
        pytest.param("resolved_mixed.toml", {"mesh.inlet": -1.4}, id="rigid"),
        pytest.param("resolved_mixed.toml", LAYER | {"mesh.inlet": -1.5, "time.courant": 1.5}, id="layer"),
        pytest.param("table1_rough.toml", {"mesh.inlet": -1.4}, id="direct"),
        pytest.param("compliant_mixed.toml", {"mesh.inlet": -1.4}, id="rough layer"),
    ],
)
def test_strip_of_profiles_equals_the_line(name, changes):
    """Both surfaces rough, sliding, until solids touch; the strip takes the time steps of the line."""
    steps = 40
    changes = {"time.courant": 1.0} | changes
    _, line = marched(name, changes, steps)
    simulation, strip = marched(name, changes | {"mesh.width": 0.08}, steps)
    shape = simulation.scales.grid.shape
    assert shape[0] == 4 and max(state.in_contact.sum() for state in line) >= 1
    for one, other in zip(line, strip, strict=True):
        assert other.retries == one.retries == 0 and other.time == one.time
        for field, tolerance in (("p", 1e-9), ("h", 1e-10)):
            expected, found = getattr(one.dimensionless, field), getattr(other.dimensionless, field)
            np.testing.assert_allclose(
                found.reshape(shape), np.broadcast_to(expected, shape), rtol=0, atol=tolerance
            )
        assert other.in_contact.sum() == shape[0] * one.in_contact.sum()
        assert other.friction == pytest.approx(one.friction, rel=1e-9)
