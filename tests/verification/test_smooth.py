"""Smooth steady films against published and independently computed values, and Hertz, through the solver."""

import numpy as np
import petsc4py
import pytest
from support import CASES

petsc4py.init([])

from support.published_values import SMOOTH_FILMS, SMOOTH_FILMS_BY_MESH

from ehlpetsc.case.loading import load
from ehlpetsc.run.simulation import Simulation


def steady(name, *overrides):
    simulation = Simulation(load(CASES / name, overrides))
    state = simulation.advance().dimensionless
    return simulation.scales, simulation.stepper.problem, state


def table_1(film, *more):
    """The case of one of the published films."""
    keys = f"fluid.viscosity={film.viscosity}", f"motion.entrainment_speed={film.speed}"
    return steady("table1_smooth.toml", *keys, f"motion.slide_roll_ratio={film.slide_roll_ratio}", *more)


@pytest.mark.parametrize("published", SMOOTH_FILMS)
def test_table_1_film_within_0_3_percent(published):
    """The table's values are extrapolated: a/400."""
    s, _, state = table_1(published, "mesh.points_per_half_width=400")
    film = state.h * s.h * 1e6
    assert film.min() == pytest.approx(published.h_min, rel=3e-3)
    assert film[np.argmin(np.abs(s.x))] == pytest.approx(published.h_central, rel=3e-3)


@pytest.mark.parametrize("published", SMOOTH_FILMS)
def test_default_start_converges_in_10_iterations(published):
    *_, state = table_1(published)
    assert state.newton <= 10


@pytest.mark.parametrize("points, error", [(100, 5e-3), (200, 1.3e-3), (400, 4e-4)])
def test_film_on_short_domain_nears_the_limit_of_a_dense_solver(points, error):
    """Limits of its films at a/200 and a/400, extrapolated; its own errors there are twice as large."""
    _, coarse, fine = SMOOTH_FILMS_BY_MESH
    s, problem, state = steady(
        "table1_smooth.toml", "mesh.inlet=-2.5", f"mesh.points_per_half_width={points}"
    )
    film = state.h * s.h * 1e6
    for found, name in ((film.min(), "h_min"), (film[np.argmin(np.abs(s.x))], "h_central")):
        value = getattr(fine, name)
        limit = value + (value - getattr(coarse, name)) / 3.0
        assert found == pytest.approx(limit, rel=error)
    assert abs(problem.dx * state.p.sum() / (np.pi / 2) - 1) < 1e-8


def test_dry_contact_is_hertz():
    s, problem, state = steady("dry_hertz.toml")
    inside = np.abs(s.x) < 0.99
    assert np.all(state.h >= 0.0)
    assert np.all(state.p >= -1e-12)
    np.testing.assert_allclose(state.q[inside], np.sqrt(1 - s.x[inside] ** 2), atol=5e-3)
    beyond = s.x < -1.2
    x = np.abs(s.x[beyond])
    gap = 0.5 * (x * np.sqrt(x**2 - 1) - np.log(x + np.sqrt(x**2 - 1)))
    np.testing.assert_allclose(state.h[beyond], gap, rtol=2e-3)
