"""Point contacts: dry ellipses, smooth films, starved inlets, conservation of oil, Newton's order."""

import numpy as np
import pytest
from scipy.special import ellipe, ellipk
from support.convergence import observed_order, order_and_limit
from support.points import R, lowest, moes_film, point

from ehlpetsc.base.compiled import unsigned
from ehlpetsc.case.loading import load
from ehlpetsc.discretisation.finite_volumes import flux_through
from ehlpetsc.discretisation.plane.cross_flow import flux_across
from ehlpetsc.discretisation.step_inputs import shear_constants
from ehlpetsc.physics.contact.hertz import hertz_ellipse
from ehlpetsc.physics.oil.rheology import flow_law
from ehlpetsc.run.simulation import Simulation
from ehlpetsc.stepping import first_guess, steady_start

DRY_MESH = {"inlet": -1.25, "outlet": 1.25, "width": 2.5}
CONTACTS = {
    "direct": {"contact.model": "direct", "contact.boundary_film": None},
    "rigid": {"contact.boundary_film": 1e-11},
}


def radius_ratio(ellipticity):
    """R_y/R_x of b/a, see `ehlpetsc.physics.contact.hertz.hertz_ellipse`."""
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
    simulation = Simulation(load(tables), options={"snes_atol": 1e-10})
    state, s = simulation.advance(), simulation.scales
    assert s.b / s.a == pytest.approx(ellipticity, rel=1e-9)
    exact = np.sqrt(np.maximum(1.0 - s.grid.distance**2, 0.0))
    wrong = np.abs(state.dimensionless.p - exact)
    hertz = hertz_ellipse(s.load, R, R * radius_ratio(ellipticity), s.E)
    approach = -state.dimensionless.unknowns.border[0] * s.h / hertz.approach - 1.0
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
        for height in (16e-9, 4e-9, 1e-9, 1e-10)
    ]
    assert mean[2] < 2.5e-3 and mean[3] < 8e-4
    assert mean[0] > 2.5 * mean[1] > 6.0 * mean[2]


@pytest.mark.parametrize("seed", range(3))
def test_start_of_a_stiff_dry_layer_does_not_depend_on_the_last_digit(seed, monkeypatch):
    """The film is 1e-10 of the deflection, and the law of the layer far from linear in it."""

    def disturbed(*arguments):
        guess = first_guess.hertz_start(*arguments)
        return guess._replace(w=guess.w * (1.0 + 1e-15 * rng.standard_normal(guess.w.size)))

    rng = np.random.default_rng(seed)
    monkeypatch.setattr(steady_start, "hertz_start", disturbed)
    assert dry({"contact.boundary_film": None, "contact.asperity_height": 1e-10}, 1.0, 32)[1] < 8e-4


FILMS = [  # M, L, central and minimum film, pressure in the middle, h00: limits from 129^2 and 257^2
    (20.0, 10.0, 3.950, 2.690, 1.0381, -0.5876),
    (50.0, 5.0, 2.822, 1.646, 1.0086, -0.8327),
    (100.0, 10.0, 3.798, 2.051, 1.0147, -0.8683),
    (200.0, 5.0, 2.565, 1.172, 1.0048, -0.9421),
    (200.0, 10.0, 3.641, 1.740, 1.0100, -0.9216),
]


def smooth(M, L, points, changes=None):
    """Steady state of a smooth contact, its film by Moes and its pressure over p0, shape (ny, nx)."""
    simulation = Simulation(load(point(M, L, points, changes)), options={"snes_atol": 1e-8})
    state, shape = simulation.advance(), simulation.scales.grid.shape
    film = moes_film(simulation.scales, state.film_thickness)
    return simulation, state, film, state.dimensionless.p.reshape(shape)


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


@pytest.mark.parametrize("M, L, central, minimum, pressure, approach", FILMS)
def test_smooth_films_with_their_order(M, L, central, minimum, pressure, approach):
    """On meshes of up to 193^2 nodes, against limits from finer meshes."""
    found = []
    for points in (12, 24, 48) if M == 200.0 and L == 10.0 else (8, 16, 32):
        simulation, state, film, p = smooth(M, L, points)
        middle = len(film) // 2, int(np.argmin(np.abs(simulation.scales.x)))
        found.append((film[middle], lowest(film), p[middle], state.dimensionless.unknowns.border[0]))
        np.testing.assert_allclose(film, film[::-1], rtol=1e-6)
        assert state.load_error < 1e-10 and state.mass_error < 2e-6
    orders, limits = zip(*(order_and_limit(*values) for values in np.array(found).T), strict=True)
    assert 1.8 < orders[0] < 2.2 and limits[0] == pytest.approx(central, rel=2e-3)
    assert found[2][1] + (found[2][1] - found[1][1]) / 3.0 == pytest.approx(minimum, rel=5e-3)
    assert limits[2] == pytest.approx(pressure, abs=5e-4)
    assert limits[3] == pytest.approx(approach, abs=1e-3)


def test_near_inlet_starves_thick_films():
    """The film of low M is 5 % thinner behind an inlet at -2.5 a; 4.16 and 4.171 by two other programs."""
    wide = {"mesh.inlet": -4.5}
    films = []
    for points in (8, 16):
        simulation = Simulation(load(point(20.0, 10.0, points, wide, width=6.0)))
        film = moes_film(simulation.scales, simulation.advance().film_thickness)
        films.append(film.ravel()[simulation.scales.grid.distance < 1e-9].item())
    assert films[1] + (films[1] - films[0]) / 3.0 == pytest.approx(4.165, rel=3e-3)


def fluxes(simulation):
    """Mass flow through the faces behind each node along x, and those below each node and above the last."""
    s, solution = simulation.scales, simulation.dimensionless.solution
    (n_y, n_x), (dy, dx), inputs = s.grid.shape, s.grid.increments, solution.inputs
    reynolds = simulation.stepper.problem.reynolds
    at = reynolds.properties(solution.nodes.reynolds_unknown, solution.nodes.film, inputs.oil)
    constants = (s.h, *shear_constants(inputs, s), *reynolds.gap)
    table, table_across = inputs.flow_table, inputs.cross_flow_table
    along, across = ((s.p0 / (s.a * step), *constants) for step in (dx, dy))
    x, y = np.zeros((n_y, n_x)), np.zeros((n_y + 1, n_x))
    for row in range(n_y + 1):
        for i in range(n_x):
            here = (row + 1) * (n_x + 1) + i
            if row < n_y:
                nodes = map(unsigned, (here - min(i, 1), here, here + 1))
                x[row, i] = dy * flux_through(at, *nodes, table, along)[0]
            nodes = map(unsigned, (here - n_x - 1, here))
            y[row, i] = dx * flux_across(at, *nodes, table_across, across, flow_law(inputs.fluid))[0]
    return x, y


def test_no_oil_is_lost_in_any_rectangle():
    """Flow through closed lines over the flow through the contact, a sliding Eyring film."""
    eyring = {"motion.slide_roll_ratio": 0.5, "fluid.eyring_stress": 5e6}
    simulation = Simulation(load(point(50.0, 5.0, 8, eyring)), options={"snes_atol": 1e-10})
    simulation.advance()
    x, y = fluxes(simulation)
    middle = np.abs(simulation.scales.grid.axes[0]) < 1.0
    through = x[middle, np.argmin(np.abs(simulation.scales.x))].sum()
    rng = np.random.default_rng(1)
    for _ in range(200):
        (low, high), (left, right) = (np.sort(rng.choice(n, 2, replace=False)) for n in (len(y), x.shape[1]))
        rows, columns = slice(low, high), slice(left + 1, right + 1)
        net = (x[rows, right] - x[rows, left]).sum() + (y[high, columns] - y[low, columns]).sum()
        assert abs(net) < 1e-10 * through
    assert np.abs(y[len(y) // 4]).sum() > 1e-2 * through  # oil leaks across


@pytest.mark.parametrize("contact", [{}, {"contact.boundary_film": None, "contact.asperity_height": 20e-9}])
def test_newton_is_quadratic_with_exact_linear_solves(contact):
    """33^2 nodes: the number of digits doubles."""
    exact = {"snes_atol": 1e-11, "ksp_rtol": 1e-12, "ksp_max_it": 400, "ksp_gmres_restart": 400}
    simulation, norms = Simulation(load(point(20.0, 10.0, 8, contact)), options=exact), []
    simulation.stepper.solver.snes.setMonitor(lambda snes, iteration, norm: norms.append(norm))
    simulation.advance()
    for before, after in zip(norms[-4:-1], norms[-3:], strict=True):
        assert after < 10.0 * before**2
