"""First guesses: of a time step, and of a rough start whose ramp is left to a coarser mesh."""

import numpy as np
import petsc4py
import pytest

petsc4py.init([])

from pathlib import Path

from support.points import point

from ehlpetsc.base.errors import CaseError, NotConverged
from ehlpetsc.case.loading import load
from ehlpetsc.nonlinear.line.system import line_problem
from ehlpetsc.physics.film_formulas import expected_film
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.simulation import Simulation
from ehlpetsc.stepping.state import TimeLevel, advected, predict
from ehlpetsc.stepping.steady_start import coarser
from ehlpetsc.stepping.time_stepping import TimeStepping


def tables(ramp):
    """Wavy surface that slides through a thick film, with the whole film renewed at the end."""
    case = point(50.0, 5.0, 12, {"motion.slide_roll_ratio": 0.3, "mesh.inlet": -1.6, "mesh.outlet": 1.3}, 3.0)
    a = Scales.of(load(case)).a
    wave = {"kind": "sine", "amplitude": 5e-9, "wavelength": a, "wavelength_across": a}
    time = {"travel": 3.5, "start": "rough", "ramp": ramp}
    return case | {"surface": {"1": {"synthetic": wave}}, "time": time}


def test_film_of_a_coarse_ramp_ends_as_that_of_a_fine_one_and_takes_a_few_of_its_steps():
    ends, counts = [], []
    for ramp in ("fine", "coarse"):
        simulation, shares = Simulation(load(tables(ramp))), []
        simulation.stepper.show_ramp(shares.append)
        films = [state.film_thickness for state in simulation]
        ends.append((films[0], films[-1]))
        counts.append(len(shares))
        assert shares[-1] == pytest.approx(1.0)
    assert counts == [12, 2]  # the coarse mesh takes 5 of 6
    (begin, end), (coarse_begin, coarse_end) = ends
    contact = end < 1.5 * np.median(end[end < 2.0 * end.min()])
    at_begin, at_end = (
        (abs(b / a - 1.0))[contact].max() for a, b in ((begin, coarse_begin), (end, coarse_end))
    )
    assert at_begin > 0.05  # it falls by ten in each 1.3 half-widths
    assert at_end < 1e-3


def test_first_step_after_a_coarse_ramp_has_the_iterations_of_a_start(monkeypatch):
    """Where asperities of the coarse mesh overlap on the fine one, the residual begins at 1e9."""
    given, advance = {}, TimeStepping.advance

    def noted(stepping, state, dt=None, watch=None, max_it=None):
        given.setdefault(stepping.problem.n, []).append(max_it)
        return advance(stepping, state, dt, watch, max_it)

    monkeypatch.setattr(TimeStepping, "advance", noted)
    Simulation(load(tables("coarse"))).advance()
    coarse, fine = (given[nodes] for nodes in sorted(given))
    assert fine == [210, None] and coarse == [None] * len(coarse)


def test_coarser_mesh_has_half_of_the_nodes_along_and_across():
    for given, halved in ((12, (6, None)), ([12, 10], (6, 5)), ([20, 7], (10, 3))):
        mesh = coarser(load(tables("fine"), {"mesh.points_per_half_width": given})).mesh
        assert (mesh.points_per_half_width, mesh.points_across) == halved


def test_mesh_does_the_ramp_itself_where_the_coarser_one_has_no_solution(monkeypatch):
    def fail_on_coarse(stepping, records, watch, guess, begun, left=0.0):
        if left:
            raise NotConverged("steady start")
        return ramped(stepping, records, watch, guess, begun, left)

    states, ramped = [], TimeStepping.ramped
    monkeypatch.setattr(TimeStepping, "ramped", fail_on_coarse)
    for ramp in ("fine", "coarse"):
        states.append(Simulation(load(tables(ramp))).advance())
    np.testing.assert_array_equal(states[1].pressure, states[0].pressure)


@pytest.mark.parametrize(
    "change", [{"time": {"travel": 1.0, "ramp": "coarse"}}, {"wear": {"coefficient": 1e-18}}]
)
def test_ramp_that_a_coarser_mesh_cannot_do_is_refused(change):
    case = load(tables("coarse") | change)
    with pytest.raises(CaseError, match='time.ramp = "coarse": allowed: in steps of a point contact'):
        Simulation(case)


CASE = Path(__file__).parents[2] / "cases" / "table1_smooth.toml"


def problem_of(model="direct"):
    case = load(CASE, ["mesh.points_per_half_width=40", f"contact.model='{model}'"])
    scales = Scales.of(case)
    return line_problem(case, scales, expected_film(case, scales), 0, scales.nx)


def smooth_and_rough(problem, seed=0):
    """A uniform smooth film under a pressure with a cavity behind it, and the same with a ripple in both."""
    rng, film = np.random.default_rng(seed), problem.film_scale
    level = np.full(problem.n, 2.0 * film)
    smooth = TimeLevel(0.0, np.full(problem.n, 0.5), problem.model.w_from_film(level))
    q = 0.5 + 0.3 * rng.uniform(-1, 1, problem.n)
    rough = TimeLevel(1e-6, q, smooth.w * rng.uniform(0.5, 1.5, problem.n))
    return smooth, rough


@pytest.mark.parametrize("model", ["direct", "mixed"])
def test_ripple_on_a_uniform_film_is_advected_by_whole_nodes(model):
    problem = problem_of(model)
    smooth, rough = smooth_and_rough(problem)
    q, w = predict(problem, smooth, [rough], [3.0])
    np.testing.assert_allclose(q[3:], rough.q[:-3], rtol=1e-12)
    np.testing.assert_allclose(w[3:], rough.w[:-3], rtol=1e-9)


def test_neither_cavities_nor_smooth_pressures_are_advected_into_others():
    """A cavity of the smooth film in which the layer keeps the gap full stays full; one of both stays one."""
    problem = problem_of("mixed")
    smooth, _ = smooth_and_rough(problem)
    x, q0 = problem.x, smooth.q
    smooth = smooth._replace(q=np.where(x > 0.0, -0.5, q0))
    level = smooth._replace(travelled=1e-6, q=np.where(x > 0.5, -0.5, 1e-6))
    q, _ = predict(problem, smooth, [level], [2.4])
    assert (q[x < 0.5] > 0.0).all()
    assert (q[x > 0.6] < 0.0).all() and q.min() >= -1.0
    problem = problem_of("mixed")
    smooth, _ = smooth_and_rough(problem)
    smooth = smooth._replace(q=np.where(problem.x > -1.0, 0.06, 0.0))
    valley = np.abs(problem.x + 1.0) < 0.2
    level = smooth._replace(travelled=1e-6, q=np.where(valley, 1e-6, smooth.q))
    q, _ = predict(problem, smooth, [level], [1.0])
    assert np.abs(q[np.abs(problem.x + 1.0) < 0.15]).max() <= 1e-6
    assert q[problem.x > 0.0] == pytest.approx(0.06)


def test_prediction_uses_the_nearest_level_and_bounded_values():
    problem = problem_of()
    smooth, _ = smooth_and_rough(problem)
    levels = [smooth_and_rough(problem, seed)[1] for seed in (1, 2, 3)]
    for nodes, taken in (([0.5, 1.0, 1.5], 1), ([1.0, 2.0, 3.0], 0), ([0.4, 0.8, 2.01], 2)):
        q, _ = predict(problem, smooth, levels, nodes)
        alone, _ = predict(problem, smooth, [levels[taken]], [nodes[taken]])
        np.testing.assert_array_equal(q, alone)
    problem = problem_of()
    film, x = problem.film_scale, problem.x
    q0 = np.where(x < 1.0, 0.7 / (1.0 + x**2), -0.5)
    smooth = TimeLevel(0.0, q0, film * (1.0 + np.maximum(x**2 - 1.0, 0.0)))
    q, w = predict(problem, smooth, [smooth._replace(travelled=1e-6)], [2.4])
    np.testing.assert_allclose(q, smooth.q, rtol=1e-12)
    np.testing.assert_allclose(w, smooth.w, rtol=1e-12)
    v = np.zeros(30)
    v[12] = 1.0
    for nodes in (0.25, 0.5, 3.75):
        moved = advected(v[None], nodes)[0]
        assert moved.min() >= 0.0 and moved.max() <= 1.0
        assert set(np.flatnonzero(moved)) <= {12 + int(nodes), 13 + int(nodes)}
    line = np.arange(60.0)
    np.testing.assert_allclose(advected(line[None], 0.25)[0, 20:-20], line[20:-20] - 0.25, rtol=1e-9)


@pytest.mark.parametrize("way", [0.3, 1.5, 2.9])
def test_predicted_films_and_voids_stay_within_bounds(way):
    problem = problem_of()
    smooth, rough = smooth_and_rough(problem)
    rough.q[40] = 5.0  # a spike beside which a cubic undershoots
    rough.q[100:110] = -0.9  # a cavity
    rough.w[60:62] = 0.0  # contact
    q, w = predict(problem, smooth, [rough], [way])
    assert w.min() >= problem.model.lower_bound and q.min() > -1.0
    came_from = np.arange(problem.n) - way
    both_oil = (came_from < 99) | (came_from > 110)
    assert (q[both_oil] > 0.0).all()
    assert (q[103:110] < 0.0).all()


@pytest.mark.parametrize("way, moved", [(2.0, 2), (1.6, 2), (2.4, 2)])
def test_contact_pressure_is_advected_unchanged(way, moved):
    problem = problem_of("mixed")
    smooth, rough = smooth_and_rough(problem)
    rough.w[50:53] = [-0.1, -0.3, -0.2]
    _, w = predict(problem, smooth, [rough], [way])
    np.testing.assert_array_equal(w[50 + moved : 53 + moved], rough.w[50:53])
    assert (np.delete(w, np.arange(50 + moved, 53 + moved)) >= 0.0).all()
