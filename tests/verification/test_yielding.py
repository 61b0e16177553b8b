"""Solids that yield: the convergence check of every step, dry cylinders beyond yield, passes."""

import numpy as np
import pytest
from support import CASES

from ehlpetsc.case.loading import load
from ehlpetsc.elasticity.half_plane import deflection_kernel
from ehlpetsc.run.simulation import Simulation

MIXED = "contact.model=mixed"
MESH = ("mesh.inlet=-1.5", "mesh.outlet=1.3", "mesh.points_per_half_width=60")
ROUGH = (*MESH, "time.travel=2.4", "time.courant=1.0")
RIDGE = (
    MIXED,
    "mesh.inlet=-1.5",
    "mesh.points_per_half_width=60",
    "surface.2.scale=6",
    "fluid.viscosity=0.002",
    "time.travel=3.5",
    "time.courant=1.2",
)


@pytest.fixture(scope="module")
def rough():
    """A run over the measured surfaces whose asperities yield."""
    simulation = Simulation(load(CASES / "table1_mixed.toml", [*ROUGH, "contact.yield_pressure=2.5e9"]))
    return simulation, list(simulation)


def added(simulation, state):
    """Depth that a step adds to both surfaces, in a^2/R."""
    return state.dimensionless.records["plastic_deformation"].added / simulation.scales.h


@pytest.mark.slow
def test_yielding_steps_pass_the_convergence_check(rough):
    simulation, states = rough
    bound, film = simulation.case.contact.yield_pressure[0], simulation.case.contact.boundary_film
    assert sum(state.yielding for state in states) > 20
    for state in states:
        depth = added(simulation, state)
        assert state.pressure.max() <= bound * (1.0 + 2e-16) and depth.min() >= 0.0
        assert (depth[state.pressure < bound * (1.0 - 1e-15)] == 0.0).all()
        assert state.film_thickness.min() >= film * (1.0 - 1e-15)
        assert state.load_error < 1e-10 and state.mass_error < 1e-6
    assert sum(state.retries > 0 for state in states) <= 0.01 * len(states)


@pytest.mark.slow
def test_plastic_deformation_is_added_to_both_bodies(rough):
    simulation, states = rough
    scales, sets = simulation.scales, simulation.dimensionless.records["plastic_deformation"].depth
    total = sum(added(simulation, state).sum() for state in states) * scales.h * scales.spacing
    assert sum(one.volume for one in sets) == pytest.approx(total, rel=1e-12)
    assert sets[0].volume == pytest.approx(sets[1].volume, rel=1e-12)


def test_softer_surface_takes_all_plastic_deformation():
    keys = [*ROUGH, "contact.yield_pressure=[9e9, 2.5e9]", "time.travel=1.6"]
    case = load(CASES / "table1_mixed.toml", keys)
    *_, last = Simulation(case)
    fast, slow = last.dimensionless.records["plastic_deformation"].depth
    assert fast.volume == 0.0 < last.set_volume
    assert slow.volume == pytest.approx(last.set_volume, rel=1e-12)


@pytest.mark.slow
def test_unreached_yield_pressure_gives_the_elastic_result():
    elastic, yielding = (
        list(Simulation(load(CASES / "table1_mixed.toml", [*ROUGH, "time.travel=1.6", *more])))
        for more in ((), ("contact.yield_pressure=100e9",))
    )
    for one, other in zip(elastic, yielding, strict=True):
        np.testing.assert_allclose(other.pressure, one.pressure, rtol=0, atol=1e-12 * one.p_max)
        np.testing.assert_allclose(other.film_thickness, one.film_thickness, rtol=1e-12)
        assert other.newton == one.newton and other.yielding == 0


def pressed(share, mesh, before=None):
    """A dry cylinder on an unyielding gap of next to nothing, p0 so many times the yield pressure."""
    half = 1.2 * max(1.0, 0.25 * np.pi * share)
    keys = [f"mesh.inlet={-half}", f"mesh.outlet={half}", f"mesh.points_per_half_width={mesh}"]
    hertz = Simulation(load(CASES / "dry_hertz.toml")).scales.p0
    case = load(
        CASES / "dry_hertz.toml",
        [MIXED, "contact.boundary_film=1e-9", f"contact.yield_pressure={hertz / share}", *keys],
    )
    simulation = Simulation(case, after=before)
    return simulation, simulation.advance()


def bounded_reference(x, limit):
    """Pressure of a parabola pressed flat, 0 <= p <= limit, by projected descent on the elastic energy."""
    dx = x[1] - x[0]
    kernel = (deflection_kernel(len(x)) - np.log(dx)) * dx / np.pi
    influence = kernel[np.abs(np.subtract.outer(np.arange(len(x)), np.arange(len(x))))]
    gap, load = 0.5 * x**2, 0.5 * np.pi / dx
    influence -= influence.min()  # a constant moves the approach alone
    rate = 1.0 / np.abs(np.linalg.eigvalsh(influence)).max()

    def onto_the_load(p):
        low, high = -p.max(), limit - p.min()
        for _ in range(60):
            shift = 0.5 * (low + high)
            low, high = (shift, high) if np.clip(p + shift, 0.0, limit).sum() < load else (low, shift)
        return np.clip(p + high, 0.0, limit)

    p = y = onto_the_load(np.sqrt(np.maximum(1.0 - x**2, 0.0)))
    t = 1.0
    for _ in range(500):  # Nesterov's momentum
        new = onto_the_load(y - rate * (influence @ y + gap))
        t, old = 0.5 * (1.0 + np.sqrt(1.0 + 4.0 * t * t)), t
        y, p = new + (old - 1.0) / t * (new - p), new
    return p


@pytest.mark.parametrize("share", [1.25, 2.0])
def test_dry_cylinder_minimises_the_bounded_energy(share):
    simulation, state = pressed(share, 40)
    expected = bounded_reference(simulation.scales.x, 1.0 / share)
    np.testing.assert_allclose(state.pressure / simulation.scales.p0, expected, atol=2e-3)
    assert state.load_error < 1e-10


@pytest.mark.parametrize("share, mesh", [(2.0, 60), (4.0, 50), (4.0, 60), (4.0, 200)])
def test_fully_plastic_pressure_is_uniform_over_the_load_width(share, mesh):
    """Far beyond yield the elastic rest at the edges is next to nothing: p_y over W/p_y."""
    simulation, state = pressed(share, mesh)
    bound = simulation.case.contact.yield_pressure[0]
    flat = (state.pressure == state.pressure.max()).sum() * simulation.scales.spacing
    assert state.pressure.max() == pytest.approx(bound, rel=1e-15)
    assert flat == pytest.approx(simulation.scales.load / bound, abs=3.0 * simulation.scales.spacing)


@pytest.mark.slow
def test_pressure_converges_with_the_mesh_far_beyond_yield():
    """At p0 = 2 p_y, against the finest mesh: first order, for the edge falls to zero within a few nodes."""
    meshes, finest = (25, 50, 100, 200, 400, 800), 1600
    simulation, state = pressed(2.0, finest)
    x, exact = simulation.scales.x, state.pressure
    flat = (exact == exact.max()).sum() * simulation.scales.spacing
    errors = []
    for mesh in meshes:
        simulation, state = pressed(2.0, mesh)
        scales = simulation.scales
        errors.append(np.abs(state.pressure - np.interp(scales.x, x, exact)).mean() / scales.p0)
        width = (state.pressure == state.pressure.max()).sum() * scales.spacing
        assert abs(width - flat) < 3.0 * scales.spacing, mesh
    order = -np.polyfit(np.log(meshes), np.log(errors), 1)[0]
    assert order > 0.9 and errors[-1] < 1e-4, (order, errors)


def test_plastic_deformation_converges_with_the_mesh():
    """Volume and greatest depth at p0 = 1.25 p_y, against the finest mesh: first order or better."""
    found = []
    for mesh in (25, 50, 100, 400):
        simulation, state = pressed(1.25, mesh)
        found.append((state.set_volume, added(simulation, state).max()))
    errors = np.abs(np.array(found[:-1]) / found[-1] - 1.0)
    assert (errors[-1] < 2e-3).all() and (errors[-1] < 0.5 * errors[0]).all(), errors


def test_reloading_adds_no_plastic_deformation():
    simulation, state = pressed(2.0, 50)
    _, again = pressed(2.0, 50, simulation)
    assert again.set_volume - state.set_volume < 2e-4 * state.set_volume
    np.testing.assert_allclose(again.pressure, state.pressure, atol=5e-4 * state.p_max)


@pytest.mark.slow
def test_second_pass_over_a_ridge_is_nearly_elastic():
    case = load(CASES / "ridge.toml", [*RIDGE, "contact.yield_pressure=2e9"])
    before, volumes = None, []
    for _ in range(2):
        before = Simulation(case, after=before)
        *_, last = before
        volumes.append(last.set_volume)
    assert volumes[0] > 1e-13 and volumes[1] - volumes[0] < 0.01 * volumes[0]
