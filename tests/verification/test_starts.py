"""Starts: of rough bodies at rest, of the same contact seen in a mirror, of next to no load."""

import resource
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import petsc4py
import pytest
from support import CASES, roelands_oil
from support.points import point

petsc4py.init([])

from ehlpetsc.base.errors import NoSteadyStart, NotConverged, SolveFailed
from ehlpetsc.case.loading import load
from ehlpetsc.discretisation.unknowns import Unknowns
from ehlpetsc.nonlinear.two_fields import TwoFields
from ehlpetsc.run import simulation
from ehlpetsc.run.simulation import Simulation
from ehlpetsc.stepping import steady_start, time_stepping
from ehlpetsc.stepping.first_guess import MAX_DIRECT_REACH, smoothed

GROUND = {"kind": "ground", "ra": 0.1e-6, "correlation": 25e-6, "skewness": -1.0, "seed": 1}
MESH = {"mesh.inlet": -1.5, "mesh.outlet": 1.3, "mesh.points_per_half_width": 40}


def rough(side, xi, travel, **more):
    """Table 1 with one rough surface."""
    changed = {f"surface.{side}": {"synthetic": GROUND}, "motion.slide_roll_ratio": xi, "time.travel": travel}
    return load(CASES / "table1_smooth.toml", MESH | {"time": {"travel": travel}} | changed | more)


def test_iterations_include_failed_attempts(monkeypatch):
    def solve(solver, *_):
        raise SolveFailed("SNES", "diverged", 7)

    monkeypatch.setattr(steady_start, "solve_checked", solve)
    attempt = steady_start.SolveAttempts(SimpleNamespace(start_iterations=lambda max_it: 30))
    assert attempt((0.0, 0.0, 0.0), None) is attempt((0.0, 0.0, 0.0), None) is None
    assert (attempt.made, attempt.spent, str(attempt.failure)) == (2, 14, "SNES diverged after 7 iterations")


def test_continuation_ends_at_the_case_itself():
    """By steps of less than 0.3, as longer ones fail; the state is the share of the roughness here."""
    continuation = steady_start.Continuation(SimpleNamespace(start_iterations=lambda max_it: 30), None)
    continuation._try = lambda state, _, share: share if share - state < 0.3 else None
    assert continuation._ramp(0.0, 0.0, lambda share: (1.0, share)) == 1.0


@pytest.mark.parametrize("xi", [2.0, -8.0])
def test_results_are_independent_of_surface_names(xi):
    """The rough fast surface at xi is the rough slow one at -xi, to the last digit of Newton's method."""
    one, other = (list(Simulation(rough(side, ratio, 1.0))) for side, ratio in (("1", xi), ("2", -xi)))
    assert len(one) == len(other) > 20
    assert [s.newton for s in one] == [s.newton for s in other]
    for a, b in zip(one, other, strict=True):
        np.testing.assert_allclose(a.pressure, b.pressure, rtol=0, atol=1e-9 * a.p_max)
        np.testing.assert_allclose(a.film_thickness, b.film_thickness, rtol=1e-9)


@pytest.mark.slow
def test_stationary_roughness_is_reached_by_time_stepping(monkeypatch):
    """After the oil has passed the domain it is the steady film that continuation finds."""
    known = next(iter(Simulation(rough("1", -2.0, 1.0))))
    found = time_stepping.steady

    def only_smooth(solver, film, inputs, watch=None, guess=None):
        if inputs.phi.any():
            raise NoSteadyStart("none")
        return found(solver, film, inputs)

    monkeypatch.setattr(time_stepping, "steady", only_smooth)
    # a node a step, where the steady balance and that of a step are the same
    first, *_, last = Simulation(rough("1", -2.0, 8.0, **{"time.courant": 1.0}))
    assert first.time == 0.0 and first.step == 0 and first.newton > 50
    scale = known.film_thickness[np.abs(known.film_thickness) < 1e-6].max()
    for state, tolerance in ((first, 0.05), (last, 1e-3)):
        difference = np.abs(state.film_thickness - known.film_thickness).max()
        assert difference < tolerance * scale, tolerance


def test_wide_and_narrow_smoothing_kernels_agree():
    x = np.linspace(-1.5, 1.5, 12_001)
    p = np.sqrt(np.maximum(1.0 - x**2, 0.0))
    wide = 1.2 * MAX_DIRECT_REACH / 4.0
    reach = int(4.0 * wide + 0.5)
    weights = np.exp(-0.5 * (np.arange(-reach, reach + 1) / wide) ** 2)
    direct = np.convolve(p, weights / weights.sum())[reach : reach + len(p)]
    np.testing.assert_allclose(smoothed(p, wide), direct, rtol=0, atol=1e-13)
    assert smoothed(p, 1e9).shape == p.shape


def test_memory_at_small_load_is_bounded():
    code = (
        "import ehlpetsc\n"
        f"case = ehlpetsc.load({str(CASES / 'table1_smooth.toml')!r}, {{'contact.load': 0.3}})\n"
        "try: ehlpetsc.solve(case)\n"
        "except ehlpetsc.NotConverged as error: print(error)\n"
    )
    most = 2 * 2**30

    def bounded():
        resource.setrlimit(resource.RLIMIT_DATA, (most, most))

    done = subprocess.run(
        [sys.executable, "-c", code], preexec_fn=bounded, capture_output=True, text=True, timeout=300
    )
    assert done.returncode == 0, done.stderr


def test_failed_start_stops_after_its_attempts(monkeypatch):
    monkeypatch.setattr(steady_start, "MAX_ATTEMPTS", 3)
    simulation = Simulation(load(CASES / "table1_smooth.toml", MESH), options={"snes_max_it": 1})
    with pytest.raises(NotConverged, match="3 attempts and 3 Newton iterations"):
        simulation.advance()


@pytest.mark.parametrize("share", [1.25, 2.0, 4.0])
def test_fully_plastic_start_converges(share):
    """Hertz' pressure above the yield pressure: few iterations, from the dry contact."""
    mesh = {"mesh.points_per_half_width": 50, "mesh.inlet": -6.0, "mesh.outlet": 4.0}
    hertz = Simulation(load(CASES / "table1_smooth.toml")).scales.p0
    keys = {"contact.model": "mixed", "contact.yield_pressure": hertz / share}
    state = Simulation(load(CASES / "table1_smooth.toml", mesh | keys)).advance()
    assert state.newton < 60 and state.load_error < 1e-10
    assert state.p_max == pytest.approx(hertz / share, rel=1e-15) and state.yielding > 30


MIXED = {"poisson_ratio": 0.3, "model": "mixed"}
FROM_REST = {
    "title": "from rest",
    "contact": {"radius": 0.0024, "load": 47e3, "youngs_modulus": 70e9} | MIXED,
    "fluid": roelands_oil(0.004, 16e-9),
    "mesh": {"inlet": -2.0, "outlet": 2.0, "points_per_half_width": 24},
    "time": {"courant": 0.5},
    "operation": {"time": [0.0, 3.8e-5], "speed_1": [0.0, 0.77], "speed_2": [0.0, 0.77]},
    "motion": {"entrainment_speed": 1.54, "slide_roll_ratio": 0.0},
    "heat": {"bulk_temperature": 349.2, "inlet_temperature": 383.1, "viscosity_temperature": 0.0138},
}


RESTING_SOLIDS = [
    {"contact.boundary_film": 9.7e-9},
    {"contact.boundary_film": 9.7e-9, "contact.yield_pressure": 827e6},
    {"contact.boundary_film": 9.7e-9, "contact.yield_pressure": 470e6},
    {"contact.asperity_height": 9e-9, "contact.yield_pressure": 827e6},
]


@pytest.mark.parametrize("solids", RESTING_SOLIDS)
def test_start_from_rest_is_the_dry_contact_in_oil_whatever_the_rounding(monkeypatch, solids):
    """Seeds of rounding errors in the guesses take as many iterations, and few."""
    set_guess, random = TwoFields.set_initial_guess, np.random.default_rng(1)

    def disturbed(system, guess, inputs):
        q, w = (values * (1.0 + 1e-15 * random.uniform(-1.0, 1.0, len(values))) for values in guess[:2])
        set_guess(system, Unknowns(q, w, guess.border), inputs)

    monkeypatch.setattr(TwoFields, "set_initial_guess", disturbed)
    states = [Simulation(load(FROM_REST, solids)).advance() for _ in range(2)]
    taken = [state.newton for state in states]
    assert max(taken) <= 8 and max(taken) - min(taken) <= 1
    for state in states:
        assert state.contact_share == pytest.approx(1.0, abs=1e-9) and state.load_error < 1e-7
        assert state.heat_error < 1e-6  # next to no heat is no measure of it


WAVE = {"kind": "sine", "amplitude": 56e-9, "wavelength": 1.25e-4}
STRIP_FROM_REST = {
    "title": "strip from rest",
    "contact": {"radius": 0.03768, "load": 84290, "youngs_modulus": 206e9, "boundary_film": 16.57e-9} | MIXED,
    "fluid": roelands_oil(0.001224, 12.67e-9, eyring_stress=9.088e6),
    "mesh": {"inlet": -2.0, "outlet": 1.7, "points_per_half_width": 6, "width": 1.07},
    "surface": {"1": {"synthetic": WAVE | {"wavelength_across": 0.00020224807411789976}}},  # the width
    "time": {"courant": 2.0},
    "operation": {"time": [0.0, 1.4e-4], "speed_1": [0.0, 1.17], "speed_2": [0.0, 1.8]},
    "motion": {"entrainment_speed": 1.483, "slide_roll_ratio": -0.427},
}


@pytest.mark.parametrize("film", [2e-6, 0.3e-6])
@pytest.mark.parametrize(
    "case, solids", [(STRIP_FROM_REST, {}), (FROM_REST, RESTING_SOLIDS[0]), (FROM_REST, RESTING_SOLIDS[3])]
)
def test_start_from_rest_with_an_oil_film(case, solids, film):
    """The oil film of the inlet is everywhere where the gap is wider, and steps can begin from there."""
    simulation = Simulation(load(case, solids | {"fluid.inlet_film": film}))
    state = simulation.advance()
    assert state.contact_share == pytest.approx(1.0, abs=1e-9) and state.load_error < 1e-7
    oil = state.film_thickness * (1.0 - state.void_fraction)
    np.testing.assert_allclose(oil, np.minimum(state.film_thickness, film), rtol=1e-12)
    later = [simulation.advance() for _ in range(3)]
    assert max(s.newton for s in later) < 12 and sum(s.retries for s in later) == 0


LIGHT_AND_FAST = {
    "title": "light and fast",
    "contact": {"radius": 9.78e-3, "load": 61.3e3, "material": "100Cr6"},
    "fluid": {"oil": "fva3"},
    "heat": {"bulk_temperature": 323.15},
    "motion": {"entrainment_speed": 11.104},
    "mesh": {"inlet": -30.0, "outlet": 2.0, "points_per_half_width": 60},
}


@pytest.mark.parametrize("speed, points", [(11.1, 60), (11.104, 60), (11.104, 120), (22.0, 60)])
def test_light_fast_line_with_heat_starts_in_few_iterations(speed, points):
    keys = {"motion.entrainment_speed": speed, "mesh.points_per_half_width": points}
    state = Simulation(load(LIGHT_AND_FAST, keys)).advance()
    assert state.newton <= 12 and state.load_error < 1e-8 and state.heat_error < 1e-10


@pytest.mark.parametrize("speed, load_, ratio, points", [(21.5, 95.9e3, 1.0, 30), (20.1, 285.7e3, 0.0, 60)])
def test_fast_warm_line_starts(speed, load_, ratio, points):
    """In turn, film and temperatures oscillate by 20 K, or do not settle in 60 solves."""
    keys = {"motion.entrainment_speed": speed, "motion.slide_roll_ratio": ratio, "contact.load": load_}
    state = Simulation(load(LIGHT_AND_FAST, keys | {"mesh.points_per_half_width": points})).advance()
    assert state.newton <= 30 and state.load_error < 1e-8 and state.heat_error < 1e-10


def test_start_with_heat_from_a_coarser_mesh_ends_as_the_one_from_hertz(monkeypatch):
    """Within the accuracy of the steady temperatures; the one from Hertz takes more than 50 iterations."""
    case = load(LIGHT_AND_FAST, {"mesh.points_per_half_width": 40})
    nested = Simulation(case).advance()
    monkeypatch.setattr(simulation, "MIN_HEATED_POINTS", 1000)
    direct = Simulation(case).advance()
    rise = direct.film_temperature_max - 323.15
    assert nested.newton < 0.3 * direct.newton
    assert np.abs(nested.film_temperature - direct.film_temperature).max() < 1e-4 * rise
    np.testing.assert_allclose(nested.film_thickness, direct.film_thickness, rtol=1e-5)


def test_start_that_fails_on_a_fine_mesh_begins_from_a_coarser_one(monkeypatch):
    keys = {"mesh.inlet": -2.0, "mesh.points_per_half_width": 200, "fluid.pressure_viscosity": 20e-9}
    expected = Simulation(load(CASES / "table1_smooth.toml", keys)).advance()
    found = time_stepping.steady

    def only_coarse(solver, film, inputs, watch=None, guess=None):
        if guess is None and solver.problem.n > 400:
            raise NoSteadyStart("too fine")
        return found(solver, film, inputs, watch, guess)

    monkeypatch.setattr(time_stepping, "steady", only_coarse)
    state = Simulation(load(CASES / "table1_smooth.toml", keys)).advance()
    np.testing.assert_allclose(state.film_thickness, expected.film_thickness, rtol=1e-6)
    monkeypatch.setattr(time_stepping, "steady", lambda *_: only_coarse(*_[:3]))
    with pytest.raises(NotConverged, match="^steady start: too fine. Try a finer mesh or contact.model"):
        Simulation(load(CASES / "table1_smooth.toml", keys)).advance()


@pytest.mark.parametrize("start", ["smooth", "rough"])
def test_many_nodes_start_from_a_coarser_mesh_and_end_in_the_same_state(monkeypatch, start):
    waves = {"kind": "sine", "amplitude": 20e-9, "wavelength": 1e-4, "wavelength_across": 1e-4}
    rough = {"surface": {"1": {"synthetic": waves}}, "time": {"travel": 0.1, "start": "rough"}}
    case = load(point(200.0, 10.0, 16) | (rough if start == "rough" else {}))
    direct, nodes, interpolated = Simulation(case).advance(), [], simulation.guess_of
    monkeypatch.setattr(simulation, "MANY_NODES", 1000)

    def guess_of(state, by, problem):
        nodes.append((by.n, problem.n))
        return interpolated(state, by, problem)

    monkeypatch.setattr(simulation, "guess_of", guess_of)
    nested = Simulation(case).advance()
    assert np.abs(nested.pressure - direct.pressure).max() < 1e-6 * direct.p_max
    assert nodes == [(17**2, 33**2), (33**2, 65**2)]


@pytest.mark.parametrize("speed", [3e-4, 1e-5])
def test_a_strip_starts_with_a_film_far_thinner_than_its_layer_as_a_line_does(speed):
    """Films of 0.16 and 0.02 nm in a layer of 10 nm; a strip of four equal rows is the line."""
    contact = {"radius": 0.0191, "load": 527e3, "material": "SAE4340", "model": "mixed"}
    contact |= {"asperity_height": 10e-9, "asperity_stiffness": 3.74e-4}
    case = {
        "title": "oil locked in",
        "contact": contact,
        "fluid": roelands_oil(0.002, 11.1e-9) | {"eyring_stress": 10e6},
        "motion": {"entrainment_speed": speed, "slide_roll_ratio": 0.25},
        "mesh": {"inlet": -1.5, "outlet": 1.3, "points_per_half_width": 16},
    }
    line = Simulation(load(case)).advance()
    strip = Simulation(load(case, {"mesh.width": 0.25})).advance()
    np.testing.assert_allclose(strip.film_thickness, np.tile(line.film_thickness, (4, 1)), rtol=1e-6)
    assert strip.contact_share == pytest.approx(line.contact_share, rel=1e-6) and strip.newton < 120
