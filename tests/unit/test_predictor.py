"""The first guess of a time step."""

from pathlib import Path

import numpy as np
import pytest

from ehlpetsc.case.loading import load
from ehlpetsc.nonlinear.line.system import line_problem
from ehlpetsc.physics.film_formulas import expected_film
from ehlpetsc.physics.scales import Scales
from ehlpetsc.stepping.state import TimeLevel, advected, predict

CASE = Path(__file__).parents[2] / "cases" / "table1_smooth.toml"


def problem_of(model="direct"):
    case = load(CASE, ["mesh.points_per_half_width=40", f"contact.model='{model}'"])
    scales = Scales.of(case)
    return line_problem(case, scales, expected_film(case, scales), 0, scales.nx)


def smooth_and_rough(problem, seed=0):
    """A uniform smooth film under a pressure with a cavity behind it, and the same with a ripple in both."""
    rng, film = np.random.default_rng(seed), problem.film_scale
    smooth = TimeLevel(
        0.0, np.full(problem.n, 0.5), problem.model.w_from_film(np.full(problem.n, 2.0 * film))
    )
    rough = TimeLevel(
        1e-6, 0.5 + 0.3 * rng.uniform(-1, 1, problem.n), smooth.w * rng.uniform(0.5, 1.5, problem.n)
    )
    return smooth, rough


@pytest.mark.parametrize("model", ["direct", "mixed"])
def test_ripple_on_a_uniform_film_is_advected_by_whole_nodes(model):
    problem = problem_of(model)
    smooth, rough = smooth_and_rough(problem)
    q, w = predict(problem, smooth, [rough], [3.0])
    np.testing.assert_allclose(q[3:], rough.q[:-3], rtol=1e-12)
    np.testing.assert_allclose(w[3:], rough.w[:-3], rtol=1e-9)


def test_cavity_is_not_advected_into_oil():
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


def test_prediction_uses_the_level_nearest_to_whole_nodes():
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


def test_advected_values_lie_between_their_neighbours():
    v = np.zeros(30)
    v[12] = 1.0
    for nodes in (0.25, 0.5, 3.75):
        moved = advected(v[None], nodes)[0]
        assert moved.min() >= 0.0 and moved.max() <= 1.0
        assert set(np.flatnonzero(moved)) <= {12 + int(nodes), 13 + int(nodes)}
    line = np.arange(60.0)
    np.testing.assert_allclose(advected(line[None], 0.25)[0, 20:-20], line[20:-20] - 0.25, rtol=1e-9)
