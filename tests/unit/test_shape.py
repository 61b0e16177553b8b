"""Shapes of the undeformed solids under varying radii; rows advected along x; films in the middle."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from support import CASES

from ehlpetsc.base.case import KINDS
from ehlpetsc.case.loading import load
from ehlpetsc.physics.contact.grid import Grid
from ehlpetsc.physics.contact.shape import CYLINDER, STRAIGHT, Shape
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.simulation import Simulation
from ehlpetsc.stepping.first_guess import undeformed_gap
from ehlpetsc.stepping.observables import mean_film
from ehlpetsc.stepping.state import advected

X, Y = np.linspace(-2.0, 1.5, 8), np.array([-3.0, 1.0, 4.0])


def test_gap_is_the_sum_over_the_axes_and_only_parabolas_follow_the_radius():
    crown = Shape(0.0, lambda y: 0.1 * np.abs(y))
    relief = Shape(1.0, lambda x: np.where(x > 1.0, 0.2, 0.0))
    grid = Grid((Y, X), (1.0, 1.0), (3.0, 1.0), (crown, relief), 1.0)
    y, x = grid.coordinates
    beside = 0.1 * np.abs(y) + 0.2 * (x > 1.0)
    np.testing.assert_allclose(grid.undeformed(), 0.5 * x**2 + beside, rtol=1e-15)
    np.testing.assert_allclose(grid.undeformed(0.25), 0.125 * x**2 + beside, rtol=1e-15)
    np.testing.assert_array_equal(grid.undeformed(0.25, slice(3, 9)), grid.undeformed(0.25)[3:9])


@pytest.mark.parametrize(("shapes", "y2"), [((STRAIGHT, CYLINDER), 0.0), ((Shape(0.5), CYLINDER), 0.25)])
def test_parabolas_of_both_axes_keep_the_ratio_of_the_radii(shapes, y2):
    grid = Grid((Y, X), (1.0, 1.0), (np.inf, 1.0), shapes, 1.0)
    y, x = grid.coordinates
    np.testing.assert_allclose(grid.undeformed(0.5), 0.5 * (0.5 * x**2 + y2 * y**2), rtol=1e-15)


def test_first_guess_under_half_the_radius_keeps_the_profile():
    grid = Grid((X,), (1.0,), (1.0,), (Shape(1.0, np.abs),), 1.0)
    problem = SimpleNamespace(grid=grid, scales=SimpleNamespace(R=2.0))
    inputs = SimpleNamespace(phi=np.zeros(len(X)), conditions=SimpleNamespace(radius=1.0))
    np.testing.assert_allclose(undeformed_gap(problem, inputs) + grid.undeformed(), X**2 + np.abs(X))


def test_profile_along_a_line_contact_deforms_like_the_radius_that_it_amounts_to(monkeypatch):
    """A parabola beside that of the radius R: Hertz' contact of the radius R/1.44."""
    kind = KINDS["line"].part("geometry")

    def with_relief(contact, mesh, dry):
        return replace(kind.grid(contact, mesh, dry), shapes=(Shape(1.0, lambda x: 0.22 * x**2),))

    monkeypatch.setattr("ehlpetsc.physics.contact.geometry.LINE", kind._replace(grid=with_relief))
    dry = {"fluid": None, "motion": None, "mesh.points_per_half_width": 40}
    case = load(CASES / "table1_smooth.toml", dry)
    state, scales = Simulation(case).advance(), Scales.of(case)
    hertz = 1.2 * np.sqrt(np.maximum(1.0 - (1.2 * scales.x) ** 2, 0.0))
    away = np.abs(np.abs(scales.x) - 1.0 / 1.2) > 0.05  # two nodes from the edge, which is between nodes
    np.testing.assert_allclose((state.pressure / scales.p0)[away], hertz[away], atol=0.01)
    assert state.p_max / scales.p0 == pytest.approx(1.2, rel=1e-3)


@pytest.mark.parametrize("nodes", (0.3, 2.7, -1.6, 4.0))
def test_advected_rows_follow_a_cubic_exactly(nodes):
    """That rises, so that no value is limited; the ends of the row are held."""
    i, inside = np.arange(40.0), slice(8, 32)
    moved = advected(np.stack([i**3, i**3 + 20.0 * i]), nodes)
    at = i[inside] - nodes
    np.testing.assert_allclose(moved[:, inside], [at**3, at**3 + 20.0 * at], rtol=1e-12)
    assert moved[0].min() >= 0.0 and moved[0].max() <= 39.0**3


def test_mean_film_is_that_of_the_middle_half_of_the_contact_of_the_instant():
    x = np.linspace(-2.0, 2.0, 401)
    grid = Grid((x,), (1e-6,), (1.0,), (CYLINDER,), 1.0)
    for size in (1.0, 0.5):
        film = mean_film(SimpleNamespace(grid=grid, h=2.0), np.abs(x), size, np.ones(401))
        assert film == pytest.approx(2.0 * 0.25 * size, rel=0.03)
