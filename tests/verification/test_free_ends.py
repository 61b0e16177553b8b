"""Images with their factor against a quarter space by alternating half-spaces and by finite elements."""

from functools import cache

import numpy as np
import pytest
from support.alternating_half_spaces import FreeEnds, factors, rows_beyond_images
from support.dry_half_space import HalfSpaces, dry_pressure
from support.quarter_space import compliance, half_space

from ehlpetsc.case.loading import load
from ehlpetsc.elasticity.terms.free_ends import OF_DISTANCES, image_factor
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.simulation import Simulation

ROWS, WIDTH = 60, 0.12  # as far as 7.2/k


@pytest.mark.parametrize(("poisson_ratio", "at_edge"), [(0.0, 1.0), (0.2, 1.108), (0.3, 1.218)])
def test_alternating_half_spaces_deflect_as_finite_elements(poisson_ratio, at_edge):
    """Waves along the edge: deflection of rows by each row, and by all over that far from the edge."""
    far = 2.0 * (1.0 - poisson_ratio**2)
    exact = compliance(1.0, WIDTH, ROWS, 1, poisson_ratio) / far
    mirrored = compliance(1.0, WIDTH, ROWS, 1, poisson_ratio, True) / far
    near = slice(0, 25)
    np.testing.assert_allclose(mirrored.sum(axis=1)[near], 1.0, rtol=5e-3)
    assert exact[0].sum() == pytest.approx(at_edge, abs=4e-3)
    images = half_space(1.0, WIDTH, ROWS, poisson_ratio, 1.0)
    found = (images + rows_beyond_images(1.0, WIDTH, ROWS, poisson_ratio)) / far
    np.testing.assert_allclose(found.sum(axis=1)[near], exact.sum(axis=1)[near], rtol=2e-3)
    np.testing.assert_allclose(found[near, near], exact[near, near], atol=1.5e-3)


@pytest.mark.parametrize("poisson_ratio", [0.0, 0.2, 0.3, 0.45])
def test_images_deflect_as_alternating_half_spaces(poisson_ratio):
    """At any place: x over y + y' from .05 to 20, from y = y' to y' near the edge."""
    x, t = np.geomspace(0.05, 20.0, 12), np.array([0.0, 0.4, 0.7, 0.99])
    q = 1.0 / np.hypot(1.0, x)[:, None]
    psi = image_factor(q, poisson_ratio) + OF_DISTANCES * 0.25 * (1.0 - t * t) * q * q
    np.testing.assert_allclose(psi, factors(x, t, poisson_ratio), rtol=7e-3)


@cache
def quarter_spaces(shape, spacings, modulus):
    """Deflection of rollers on one mesh, of Poisson's ratio 0.3."""
    images = HalfSpaces(shape, spacings, modulus, 0.5)
    return FreeEnds(images, shape, spacings, modulus, 0.3)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("profile", "expected", "ends"),
    [
        ({"kind": "circular", "radius": 0.02, "straight": 3e-3}, 1e-3, 1e-3),
        ({"kind": "lundberg"}, 1e-3, 2e-3),
        ({"kind": "iso", "diameter": 0.012}, 1e-3, 1e-3),
        (None, 2e-3, 5e-3),
    ],
    ids=["arcs", "lundberg", "iso", "straight"],
)
def test_dry_roller_has_the_pressure_of_quarter_spaces(profile, expected, ends):
    """Maximum and the load of each row, over the largest."""
    contact = {"radius": 6e-3, "length": 4e-3, "load": 800.0, "youngs_modulus": 207e9, "poisson_ratio": 0.3}
    contact |= {"profile": profile} if profile else {}
    mesh = {"inlet": -1.6, "outlet": 1.6, "points_per_half_width": [10, 34]}
    case = load({"title": "free ends", "contact": contact, "mesh": mesh})
    pressure, scales = Simulation(case).advance().pressure, Scales.of(case)
    grid = scales.grid
    gap = scales.h * grid.undeformed().reshape(grid.shape)
    exact = quarter_spaces(grid.shape, grid.spacings, scales.E)
    found = dry_pressure(gap, 800.0, np.prod(grid.spacings), exact, 1e-7)
    assert pressure.max() == pytest.approx(found.max(), rel=expected)
    load_along, of_quarter_spaces = pressure.sum(axis=1), found.sum(axis=1)
    np.testing.assert_allclose(load_along, of_quarter_spaces, atol=ends * of_quarter_spaces.max())
