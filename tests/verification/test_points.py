"""Point contacts: dry ellipses, smooth films, conservation of oil, Newton's order, amplitudes of waves."""

import numpy as np
import pytest
from scipy.special import ellipe, ellipk
from support.convergence import observed_order, order_and_limit
from support.points import R, moes_film, point

from ehlpetsc.case.loading import load
from ehlpetsc.physics.hertz import hertz_ellipse
from ehlpetsc.run.simulation import Simulation

DRY_MESH = {"inlet": -1.25, "outlet": 1.25, "width": 2.5}
CONTACTS = {
    "direct": {"contact.model": "direct", "contact.boundary_film": None},
    "rigid": {"contact.boundary_film": 1e-11},
}


def radius_ratio(ellipticity):
    """R_y/R_x of b/a, see `ehlpetsc.physics.hertz.hertz_ellipse`."""
    if ellipticity == 1.0:
        return 1.0
    k = min(ellipticity, 1.0 / ellipticity)
    first, second = ellipk(1.0 - k * k), ellipe(1.0 - k * k)
    ratio = (second / k**2 - first) / (first - second)
    return ratio if ellipticity > 1.0 else 1.0 / ratio


def dry(changes, ellipticity, points, load_error=1e-10):
    """Errors of the pressure in p0, within 0.9 of the ellipse and mean; relative error of the approach."""
    tables = point(50.0, 5.0, points, changes)
    tables = {key: tables[key] for key in ("title", "contact")}
    tables["mesh"] = DRY_MESH | {"points_per_half_width": points}
    tables["contact"]["radius"] = [R, R * radius_ratio(ellipticity)]
    simulation = Simulation(load(tables))
    state, s = simulation.advance(), simulation.scales
    assert s.b / s.a == pytest.approx(ellipticity, rel=1e-9)
    exact = np.sqrt(np.maximum(1.0 - s.grid.distance**2, 0.0))
    wrong = np.abs(state.solution.p - exact)
    hertz = hertz_ellipse(s.load, R, R * radius_ratio(ellipticity), s.E)
    approach = -state.solution.h00 * s.h / hertz.approach - 1.0
    assert state.load_error < load_error
    return wrong[s.grid.distance < 0.9].max(), wrong.mean(), abs(approach)


@pytest.mark.parametrize("contact", CONTACTS)
def test_dry_circle_with_its_order(contact):
    inside, mean, approach = np.array([dry(CONTACTS[contact], 1.0, n) for n in (16, 32, 64)]).T
    assert inside[-1] < 2e-4 and approach[-1] < 1e-4
    assert observed_order(inside) > 1.9
    assert observed_order(mean) > 1.4  # infinite slope at the edge


@pytest.mark.parametrize("ellipticity", (8.0, 0.125))
@pytest.mark.parametrize("contact", CONTACTS)
def test_dry_ellipses_on_cells_of_their_shape(contact, ellipticity):
    """Both half-widths have the same number of nodes; the load is balanced to the tolerance."""
    inside, _, approach = dry(CONTACTS[contact], ellipticity, [32, 32], 1e-7)
    assert inside < 1e-3 and approach < 1e-3


def test_dry_layer_tends_to_hertz():
    """A layer of vanishing height is a smooth surface."""
    mean = [
        dry({"contact.boundary_film": None, "contact.asperity_height": height}, 1.0, 32)[1]
        for height in (16e-9, 4e-9, 1e-9)
    ]
    assert mean[2] < 2.5e-3
    assert mean[0] > 2.5 * mean[1] > 6.0 * mean[2]


FILMS = [  # M, L, central and minimum film, pressure in the middle, h00: limits from 129^2 and 257^2
    (20.0, 10.0, 3.950, 2.690, 1.0381, -0.5876),
    (50.0, 5.0, 2.822, 1.646, 1.0086, -0.8327),
    (100.0, 10.0, 3.798, 2.051, 1.0147, -0.8683),
    (200.0, 5.0, 2.565, 1.172, 1.0048, -0.9421),
    (200.0, 10.0, 3.641, 1.740, 1.0100, -0.9216),
]


def smooth(M, L, points, changes=None):
    """Steady state of a smooth contact, its film by Moes and its pressure over p0, shape (ny, nx)."""
    simulation = Simulation(load(point(M, L, points, changes)))
    state, shape = simulation.advance(), simulation.scales.grid.shape
    film = moes_film(simulation.scales, state.film_thickness)
    return simulation, state, film, state.solution.p.reshape(shape)


@pytest.mark.parametrize("ellipticity, M", ((8.0, 1000.0), (0.125, 5.0)))
def test_lubricated_ellipses_on_cells_of_their_shape(ellipticity, M):
    """Films change little with the mesh, and the preconditioner serves cells of any shape."""
    films = []
    for points in (16, 24):
        radii = {"contact.radius": [R, R * radius_ratio(ellipticity)]}
        _, state, *_ = smooth(M, 10.0, [points, points], radii)
        assert state.gmres < 10 * state.newton
        films.append(state.film_central)
    assert films[0] == pytest.approx(films[1], rel=0.05)


@pytest.mark.parametrize("M, L, central, lowest, pressure, approach", FILMS)
def test_smooth_films_with_their_order(M, L, central, lowest, pressure, approach):
    """On 33^2, 65^2 and 129^2 nodes, against limits from finer meshes."""
    found = []
    for points in (8, 16, 32):
        simulation, state, film, p = smooth(M, L, points)
        middle = len(film) // 2, int(np.argmin(np.abs(simulation.scales.x)))
        found.append((film[middle], film.min(), p[middle], state.solution.h00))
        np.testing.assert_allclose(film, film[::-1], rtol=1e-6)
        assert state.load_error < 1e-10 and state.mass_error < 2e-6
    orders, limits = zip(*(order_and_limit(*values) for values in np.array(found).T), strict=True)
    assert 1.8 < orders[0] < 2.2 and limits[0] == pytest.approx(central, rel=2e-3)
    # at a node: the place of the minimum between the nodes changes from mesh to mesh
    assert found[-1][1] == pytest.approx(lowest, rel=2e-2)
    assert limits[2] == pytest.approx(pressure, abs=5e-4)
    assert limits[3] == pytest.approx(approach, abs=1e-3)
