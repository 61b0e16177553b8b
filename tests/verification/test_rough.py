"""Two measured surfaces in contact: the bound, its multiplier, load and mass at every step."""

import itertools

import numpy as np
import pytest
from support.driving import Scene

from ehlpetsc.nonlinear.two_fields import ZERO_TOLERANCE

pytestmark = pytest.mark.slow
# the inlet near the contact, thin oil: the asperities touch within few steps
SHORT = ("mesh.inlet=-1.3", "mesh.points_per_half_width=100", "time.travel=1.5", "fluid.viscosity=0.001")
TOLERANCE = 1e-7  # of the residual


@pytest.fixture(scope="module")
def states():
    scene = Scene("table1_rough.toml", *SHORT, snes_atol=TOLERANCE).start()
    levels = [scene.state, *(state.dimensionless for state in scene.simulation)]
    found = list(itertools.pairwise(levels))
    return scene, found


def test_film_flow_pressure_and_load_at_every_step(states):
    """F >= 0 where h = 0, F = 0 elsewhere; no film or pressure is negative, and few steps are halved."""
    scene, found = states
    assert sum((state.h == 0.0).sum() for _, state in found) > 50
    assert min(state.h.min() for _, state in found) == 0.0
    for _, state in found:
        touching = state.h <= ZERO_TOLERANCE  # as SNES has it
        assert state.reynolds_residual[touching].min(initial=0.0) >= -TOLERANCE
        assert np.linalg.norm(state.reynolds_residual[~touching]) <= TOLERANCE
        assert state.p.min() >= 0.0
        assert scene.problem.dx * state.p.sum() == pytest.approx(np.pi / 2, rel=1e-10)
    assert sum(state.retries for _, state in found) <= 0.05 * len(found)


def test_error_of_the_default_tolerance(states):
    """Pressures to 1e-5 p0, films to 1e-5 of the expected one, at every node and step; the same contacts."""
    tight, found = states
    for (_, state), looser in zip(found, Scene("table1_rough.toml", *SHORT).start().simulation, strict=True):
        state_by_default = looser.dimensionless
        np.testing.assert_array_equal(state_by_default.h == 0.0, state.h == 0.0)
        np.testing.assert_allclose(state_by_default.p, state.p, rtol=0, atol=1e-5)
        np.testing.assert_allclose(state_by_default.h, state.h, rtol=0, atol=1e-5 * tight.problem.film_scale)
