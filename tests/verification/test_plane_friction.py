"""Friction of a point in mixed contact over the slide/roll ratio, against the integral over its area."""

import numpy as np
import pytest
from support import roelands_oil

from ehlpetsc.case.loading import load, members
from ehlpetsc.physics.oil.laws import viscosity
from ehlpetsc.run.simulation import Simulation

EYRING, FRICTION, LOAD = 6e6, 0.1, 20.0
POINT = {
    "title": "traction of a ball",
    "contact": {
        "radius": [0.0125, 0.02],
        "load": LOAD,
        "material": "100Cr6",
        "model": "mixed",
        "asperity_height": 60e-9,
        "boundary_friction": FRICTION,
    },
    "fluid": roelands_oil(0.01, 20e-9, eyring_stress=EYRING),
    "motion": {"entrainment_speed": 0.5},
    "mesh": {"inlet": -2.0, "outlet": 1.5, "points_per_half_width": 12, "width": 3.5},
    "series": {"key": "motion.slide_roll_ratio", "values": [0.0, 0.02, 0.5, -0.5]},
}


def test_friction_is_the_integral_over_the_area():
    found = []
    for _, case in members(load(POINT)):
        simulation = Simulation(case)
        [state] = simulation
        s, oil = simulation.scales, state.pressure - state.contact_pressure
        cell, sliding = s.grid.spacings[0] * s.grid.spacings[1], s.u1 - s.u2
        eta = case.fluid.viscosity * np.exp(viscosity(oil, case.fluid)[0])
        stress = EYRING * np.arcsinh(eta * sliding / state.film_thickness / EYRING)
        stress = stress * (1.0 - state.void_fraction) + FRICTION * np.sign(sliding) * state.contact_pressure
        force = cell * stress.sum()
        assert state.load == pytest.approx(LOAD, rel=1e-6)
        assert 0.05 < state.contact_share < 0.5
        # the mean of both walls; the pressure flow lowers the stress of the film by less than this
        assert 0.5 * (state.friction - state.friction_1) == pytest.approx(force, rel=1e-3, abs=1e-9)
        assert state.friction_coefficient == pytest.approx(abs(force) / LOAD, rel=1e-3, abs=1e-9)
        found.append(0.5 * (state.friction - state.friction_1))
    rolling, slow, fast, back = found
    assert abs(rolling) < 1e-9 < slow < fast
    assert back == pytest.approx(-fast, rel=1e-6)
