"""Misaligned point contacts: a given tilt against Hertz, a free one against a wedge, in mixed contact."""

import re

import numpy as np
import pytest
from support import one_fault, self_affine
from support.points import point

import ehlpetsc
from ehlpetsc.case.loading import load
from ehlpetsc.physics.contact.hertz import hertz_ellipse
from ehlpetsc.run.recorder import Recorder
from ehlpetsc.run.simulation import Simulation

RY = 0.05
ROLLER = {
    "title": "A crowned roller on a plane",
    "contact": {"radius": [0.01, RY], "load": 100.0, "material": "16MnCr5"},
    "mesh": {"inlet": -1.3, "outlet": 1.3, "width": 3.0, "points_per_half_width": 16},
}


def test_given_tilt_moves_the_dry_ellipse():
    shift = 0.2  # half-widths b
    hertz = hertz_ellipse(100.0, 0.01, RY, Simulation(load(ROLLER)).scales.E)
    tilt = -shift * hertz.b / RY
    simulation = Simulation(load(ROLLER, {"contact.tilt": tilt}))
    state, grid = simulation.advance(), simulation.scales.grid
    y, x = (axis.reshape(grid.shape) for axis in grid.coordinates)
    p, y = state.pressure, y * hertz.a / hertz.b
    inside = (distance := np.hypot(x, y - shift)) < 0.9
    expected = hertz.p0 * np.sqrt(1.0 - distance[inside] ** 2)
    np.testing.assert_allclose(p[inside], expected, rtol=0.0, atol=5e-3 * hertz.p0)
    assert (p * y).sum() / p.sum() == pytest.approx(shift, abs=1e-4)
    raised = 0.5 * tilt**2 * RY  # of the middle over the nearest points of the undeformed bodies
    assert state.scalars["approach"] == pytest.approx(raised - hertz.approach, rel=2e-3)
    assert state.scalars["tilt"] == pytest.approx(tilt, rel=1e-12)


def test_restart_continues_a_tilted_contact_whose_film_is_that_of_the_moved_one(tmp_path):
    tables = point(50.0, 5.0, 8) | {"time": {"travel": 0.4, "courant": 1.0}}
    straight = Simulation(load(tables))
    tilt = -0.25 * straight.scales.b / straight.case.contact.radius_across  # by two nodes
    states = list(Simulation(case := load(tables, {"contact.tilt": tilt})))
    assert states[0].film_central == pytest.approx(straight.advance().film_central, rel=1e-3)
    with Recorder(simulation := Simulation(case), tmp_path / "run.h5") as recorder:
        for _ in range(2):
            recorder.write(simulation.advance())
        recorder.checkpoint()
    rest = ehlpetsc.solve(case, tmp_path / "run.h5", restart=tmp_path / "run.restart.h5")
    np.testing.assert_allclose(rest.steps.film_central, [s.film_central for s in states], rtol=1e-9)
    np.testing.assert_allclose(rest.steps("tilt"), tilt, rtol=1e-12)


def test_free_tilt_evens_out_a_wedge():
    tight, slope = {"snes_atol": "1e-10"}, 2e-3
    simulation = Simulation(load(ROLLER, {"contact.self_aligning": True}), options=tight)
    state, solver = simulation.advance().dimensionless, simulation.stepper.solver
    problem, s = solver.problem, simulation.scales
    assert problem.balance.tilt(state.unknowns.border) == pytest.approx(0.0, abs=1e-9)
    wedge = slope * s.grid.coordinates[0] * s.a / s.h
    solution, _ = solver.solve(state.unknowns, problem.inputs(phi=wedge), max_it=60)
    assert problem.balance.tilt(solution.border) == pytest.approx(-slope, rel=1e-9)
    pressure = problem.model.state(solution.q, solution.w).pressure
    np.testing.assert_allclose(pressure, state.p, rtol=0.0, atol=1e-8)


def test_moment_vanishes_in_mixed_contact():
    changes = {"contact.self_aligning": True, "contact.boundary_film": 10e-9, "motion.slide_roll_ratio": 0.3}
    changes |= {"surface": {"1": {"synthetic": self_affine(40e-9, 40e-6, 20e-6)}}}
    changes |= {"fluid.viscosity": 0.01, "time": {"travel": 0.1, "start": "rough", "courant": 1.0}}
    simulation = Simulation(load(point(50.0, 5.0, 8), changes))
    y = simulation.scales.grid.coordinates[0]
    states = list(simulation)
    for state in states:
        pressure = state.pressure.ravel()
        assert abs(pressure @ y) < 1e-6 * pressure.sum()
        assert state.load_error < 1e-6
    assert states[-1].scalars["contact_share"] > 0.02
    assert abs(states[-1].scalars["tilt"]) > 1e-7


@pytest.mark.parametrize(
    "changes, message",
    [
        ({"contact.radius": 0.01, "mesh.width": None}, "contact.tilt"),
        ({"contact.approach": 1e-6, "contact.load": None}, "contact.tilt.*approach"),
        ({"contact.self_aligning": True}, "contact.self_aligning.*tilt"),
        ({"contact.tilt": 0.2}, "contact.tilt = 0.2: allowed: "),
    ],
)
def test_refused_tilts_are_one_sentence(changes, message):
    assert re.search(message, fault := one_fault(load, ROLLER, {"contact.tilt": 1e-3} | changes)), fault
