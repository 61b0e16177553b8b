"""Point contacts at a given approach or misaligned: dry, in mixed contact, restart, refusals."""

import copy
import re

import numpy as np
import pytest
from support import one_fault, self_affine
from support.points import R, point

import ehlpetsc
from ehlpetsc.case.loading import load
from ehlpetsc.physics.contact.hertz import hertz_ellipse, hertz_load
from ehlpetsc.run.forecast.explain import explain
from ehlpetsc.run.recorder import Recorder
from ehlpetsc.run.simulation import Simulation

APPROACH = 1.2e-6
DRY = {
    "title": "A ball pressed against a plane by a given approach",
    "contact": {"radius": [0.01, 0.02], "approach": APPROACH, "material": "16MnCr5"},
    "mesh": {"inlet": -1.25, "outlet": 1.25, "width": 2.5, "points_per_half_width": 32},
}
MIXED = {
    "contact": {"load": None, "approach": APPROACH, "boundary_film": 10e-9},
    "surface": {"1": {"synthetic": self_affine(40e-9, 40e-6, 20e-6)}},
    "motion": {"slide_roll_ratio": 0.3},
    "fluid": {"viscosity": 0.01},
    "time": {"travel": 0.15, "start": "rough", "courant": 1.0},
}


def mixed(changes=None):
    overrides = {f"{table}.{key}": value for table, keys in MIXED.items() for key, value in keys.items()}
    return load(point(50.0, 5.0, 8), overrides | (changes or {}))


def test_dry_load_grows_as_the_power_three_halves_of_the_approach():
    for approach in (0.4e-6, APPROACH, 4e-6):
        simulation = Simulation(load(DRY, {"contact.approach": approach}))
        state, modulus = simulation.advance(), simulation.scales.E
        of_hertz = hertz_ellipse(1.0, 0.01, 0.02, modulus).approach
        assert state.scalars["load"] == pytest.approx((approach / of_hertz) ** 1.5, rel=2e-4)
        assert state.scalars["approach"] == pytest.approx(-approach, rel=1e-9)
        assert state.load_error < 1e-9
    for radii in ((0.01, 0.01), (0.01, 0.08), (0.03, 0.004)):
        approach = hertz_ellipse(25.0, *radii, 2.2e11).approach
        assert hertz_load(approach, *radii, 2.2e11) == pytest.approx(25.0, rel=1e-12)


def test_approach_that_balances_a_load_gives_this_load():
    """A thick film keeps the bodies further apart than in Hertz contact; on the same domain [m]."""
    balanced = Simulation(load(point(20.0, 10.0, 13)))
    state, given, mesh = balanced.advance(), balanced.scales.load, balanced.case.mesh
    approach = -state.scalars["approach"]
    ratio = np.sqrt(approach / hertz_ellipse(given, R, R, balanced.scales.E).approach)
    assert ratio < 0.8
    changes = {f"mesh.{key}": getattr(mesh, key) / ratio for key in ("inlet", "outlet", "width")}
    changes |= {"contact.load": None, "contact.approach": approach}
    again = Simulation(load(point(20.0, 10.0, round(13 * ratio), changes)))
    assert again.advance().scalars["load"] == pytest.approx(given, rel=5e-3)
    assert again.scales.load < 0.6 * given


@pytest.fixture(scope="module")
def states():
    return list(Simulation(mixed()))


def test_mixed_contact_keeps_its_approach_while_the_load_varies(states):
    loads = np.array([state.scalars["load"] for state in states])
    for state in states:
        assert state.scalars["approach"] == pytest.approx(-APPROACH, rel=1e-9)
        assert state.mass_error < 1e-6
    assert states[-1].scalars["contact_share"] > 0.02
    assert np.ptp(loads) > 1e-3 * loads.mean()


def test_restart_at_an_approach_continues_the_run(states, tmp_path):
    case, file, begun = mixed(), tmp_path / "run.h5", tmp_path / "run.restart.h5"
    simulation = Simulation(case)
    with Recorder(simulation, file) as recorder:
        for _ in range(2):
            recorder.write(simulation.advance())
        recorder.checkpoint()
    rest = ehlpetsc.solve(case, file, restart=begun)
    np.testing.assert_allclose(rest.steps.load, [state.scalars["load"] for state in states], rtol=1e-9)
    with pytest.raises(ehlpetsc.OutputError, match="contact.approach"):
        ehlpetsc.solve(mixed({"contact.approach": 1.3e-6}), tmp_path / "other.h5", restart=begun)


@pytest.mark.parametrize(
    "changes, message",
    [
        ({"contact.load": 20.0}, "approach = 1.2e-06: in place of the load, which contact.load would"),
        ({"contact.radius": 0.01}, "contact.approach = 1.2e-06: of point contacts, and one radius"),
        ({"operation": {"time": [0, 1], "speed_1": [1, 2], "speed_2": [1, 2]}}, r"which \[operation\] would"),
        ({"gears": {"speed": 1}}, r"which \[gears\] would give; leave out one of both"),
        ({"contact.approach": 0.0}, "contact.approach = 0.0: allowed: a number >= 1e-09"),
        ({"contact.approach": 1e-9}, "contact.load is missing, and does not follow from approach; allowed: "),
        ({"contact.approach": "2 N"}, 'contact.approach = "2 N"'),
        ({"contact.approach": None}, "contact.load is missing; allowed: .*, or approach"),
    ],
)
def test_refused_approaches_are_one_sentence(changes, message):
    assert re.search(message, fault := one_fault(load, copy.deepcopy(DRY), changes)), fault


def test_approach_has_units_varies_over_a_series_and_is_explained():
    assert load(DRY, {"contact.approach": "1.2 um"}).contact.approach == pytest.approx(APPROACH)
    varied = {"key": "contact.approach", "values": [1e-6, 4e-6]}
    series = load(DRY, {"series": varied, "contact.approach": 1e-6})
    one, other = (member.contact.load for _, member in ehlpetsc.members(series))
    assert other / one == pytest.approx(8.0)
    assert "approach 1.2 um, dry load" in explain(load(DRY))


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
