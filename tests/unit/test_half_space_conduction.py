"""Conduction into a half-space against closed forms: uniform flux, sinusoid, Jaeger's moving band."""

import numpy as np
import pytest
from support.exact_solutions import moving_band

from ehlpetsc.effects.heat.half_spaces import Body, StepWeights, diffuse, exponentials
from ehlpetsc.physics.contact.grid import Grid
from ehlpetsc.physics.contact.shape import CYLINDER
from ehlpetsc.physics.flash_temperature import Solid, blok_flash_temperature

STEEL = Solid(46.0, 7850.0, 470.0)
FLUX = 1e9  # W/m^2


def test_exponentials_and_temperatures_above_bulk_at_any_step():
    rates, weights = map(np.array, exponentials(1e-8, 1e-3))
    t = np.geomspace(1e-8, 1e-3, 200)
    ratio = np.exp(-np.outer(t, rates)) @ weights * np.sqrt(np.pi * t)
    assert len(rates) <= 16
    np.testing.assert_allclose(ratio, 1.0, rtol=1e-3)
    rng = np.random.default_rng(2)
    for ratio in (0.1, 1.0, 50.0, 1e4):
        terms, new = rng.uniform(0.0, 1.0, (40, 3)) ** 8, np.empty((40, 3))
        diffuse(terms, ratio, new)
        assert new.min() >= 0.0
        np.testing.assert_allclose(new.sum(axis=0), terms.sum(axis=0), rtol=1e-12)
        hot, spread = np.zeros((2, 41, 1))
        hot[20] = 1.0
        diffuse(hot, ratio, spread)
        implicit = max(0.5 * ratio, ratio - 0.5)  # no more of it than keeps the explicit part positive
        kept = spread[20] - implicit * (spread[19] - 2.0 * spread[20] + spread[21])
        assert kept == pytest.approx(max(1.0 - ratio, 0.0), abs=1e-8)


@pytest.mark.parametrize("steps", [1, 2, 30, 1000])
def test_uniform_flux(steps):
    time, dt = 1e-5, 1e-5 / steps
    rates, weights = exponentials(dt, 1e-3)
    step = StepWeights.of(rates, dt, STEEL.effusivity)
    terms = np.zeros(len(rates))
    for _ in range(steps):
        begun = step.decay * terms + step.begin * FLUX
        rise = begun @ weights / STEEL.effusivity + step.response * FLUX
        terms = begun + step.end * FLUX
    assert rise == pytest.approx(2.0 * FLUX * np.sqrt(time / np.pi) / STEEL.effusivity, rel=1e-3)


def body(speed, spacing, nodes, dt=None):
    grid = Grid((np.arange(nodes),), (spacing,), (1.0,), (CYLINDER,), 1.0)
    return Body(STEEL, speed, grid, dt or 0.5 * spacing / speed)


@pytest.mark.parametrize("peclet", [0.1, 1.0, 10.0, 100.0])
def test_moving_band(peclet):
    """Jaeger's band, its Peclet number u b/(2 chi), by the steady solution that a run starts from."""
    half, nodes = 1e-4, 301
    dx, speed = half / 50, 2.0 * STEEL.diffusivity * peclet / half
    x = dx * np.arange(-(nodes // 2), nodes // 2 + 1)
    flux = np.where(np.abs(x) < half - 0.5 * dx, FLUX, np.where(np.abs(x) < half + 0.5 * dx, 0.5 * FLUX, 0.0))
    exact = moving_band(x, flux, STEEL.diffusivity, STEEL.conductivity, speed)
    rise, _ = body(speed, dx, nodes).steady(flux, speed)
    np.testing.assert_allclose(rise, exact, atol=0.01 * exact.max())


@pytest.mark.parametrize("peclet", [1.0, 10.0, 100.0])
def test_moving_flux_in_time(peclet):
    half, nodes = 1e-4, 301
    dx, speed = half / 50, 2.0 * STEEL.diffusivity * peclet / half
    x = dx * np.arange(-(nodes // 2), nodes // 2 + 1)
    flux = FLUX * np.sqrt(np.maximum(1.0 - (x / half) ** 2, 0.0))
    exact = moving_band(x, flux, STEEL.diffusivity, STEEL.conductivity, speed)
    one = body(speed, dx, nodes)
    record = one.cold()
    for step in range(1, 1000 if peclet < 5.0 else 500):
        moved = one.advance(record, 0.5 * step * dx, 0.5 * dx / speed, speed, flux)
        record = one.accept(moved, flux)
        rise = moved.history + moved.response * flux
    np.testing.assert_allclose(rise, exact, atol=0.01 * exact.max())
    begun = one.record(flux, one.steady(flux, speed)[1])
    moved = one.advance(begun, 0.5 * dx, 0.5 * dx / speed, speed, flux)
    np.testing.assert_allclose(moved.history + moved.response * flux, exact, atol=0.01 * exact.max())


@pytest.mark.parametrize("ratio", [0.1, 2.0, 400.0])
def test_a_sinusoid_along_the_surface(ratio):
    r"""Flux cos(ks) on a body at rest from time 0: T = q erf(sqrt(chi k^2 t))/(k conductivity)."""
    from scipy.special import erf

    nodes, wave = 257, 2.0 * np.pi / 64
    dx, steps = 1e-6, 40
    dt = ratio * dx**2 / STEEL.diffusivity
    flux = FLUX * (1.0 + np.cos(wave * np.arange(nodes)))
    rates, weights = exponentials(dt, 100 * dt)
    step = StepWeights.of(rates, dt, STEEL.effusivity)
    terms = np.zeros((nodes, len(rates)))
    for _ in range(steps):
        given, new = step.decay * terms + flux[:, None] * step.begin, np.empty_like(terms)
        diffuse(given, ratio, new)
        rise = new @ weights / STEEL.effusivity + step.response * flux
        terms = new + flux[:, None] * step.end
    swing = 0.5 * (rise[128] - rise[128 + 32])
    k = wave / dx
    exact = FLUX * erf(k * np.sqrt(STEEL.diffusivity * steps * dt)) / (k * STEEL.conductivity)
    # steps longer than the wave's own diffusion time are not resolved: their flux acts without diffusion
    resolved = k * k * STEEL.diffusivity * dt < 0.05
    assert swing == pytest.approx(exact, rel=0.01 if resolved else 3.0)
    assert swing > 0.99 * exact


def test_shifted_distance_origin_moves_no_heat():
    dx, speed = 2e-6, 5.0
    one, flux = body(speed, dx, 60), np.full(60, FLUX)
    begun = one.record(flux, one.steady(flux, speed)[1])
    dt = 0.5 * dx / speed
    rises = [one.advance(begun, start + 0.5 * dx, dt, speed, flux).history for start in (0.0, -40 * dx)]
    np.testing.assert_allclose(rises[1], rises[0], rtol=1e-12)


@pytest.mark.parametrize("fraction", [0.0, 0.3])
def test_cells_of_the_body_take_all_heat(fraction):
    one = body(5.0, 2e-6, 60)
    moved = one.advance(one.cold(), -fraction * 2e-6, 2e-7, 5.0, np.zeros(60))
    flux = np.random.default_rng(1).uniform(0.0, FLUX, 60)
    assert one.accept(moved, flux).flux.sum() == pytest.approx(flux.sum(), rel=1e-14)


def plane(nodes, half, ny, periodic=False):
    """Grid of square cells; lengths in the half-width `half` [m], 1.6 ahead of and behind its middle."""
    step = 1.0 / nodes
    x, y = step * np.arange(-int(1.6 * nodes), int(1.6 * nodes) + 1), step * (np.arange(ny) - 0.5 * (ny - 1))
    return Grid((y, x), (step * half, step * half), (1.0, 1.0), (CYLINDER, CYLINDER), 1.0, periodic=periodic)


def moving_point(x, y, half, speed):
    r"""Temperature at x, y in half-widths under the elliptic flux of a circle, by Jaeger's (1942) integral.

    :math:`T=\frac1{2\pi k}\int\frac qRe^{-u(R-x+x')/(2\chi)}dA'`, in polar coordinates about the point.
    """
    points, weights = np.polynomial.legendre.leggauss(300)
    angle, root = np.pi * (points + 1.0)[:, None], 0.5 * (points + 1.0)
    R, cosine = 2.2 * root**2, np.cos(angle)
    square = (x - R * cosine) ** 2 + (y - R * np.sin(angle)) ** 2
    flux = FLUX * np.sqrt(np.maximum(1.0 - square, 0.0))
    kernel = np.exp(-0.5 * speed * half / STEEL.diffusivity * R * (1.0 - cosine))
    integral = np.pi * weights @ (flux * kernel) @ (2.2 * root * weights)
    return half * integral / (2 * np.pi * STEEL.conductivity)


@pytest.mark.parametrize("rows", [45, 81])
@pytest.mark.parametrize("peclet", [0.0, 0.2, 2.0, 50.0])
def test_moving_point(peclet, rows):
    """Elliptic flux of a circle, Peclet number u a/(2 chi), on meshes little and much wider than it.

    Steady, and steps from it: heat leaves a slow body, or one at rest, through the sides of the mesh.
    """
    half = 1e-4
    grid, speed = plane(20, half, rows), 2.0 * STEEL.diffusivity * peclet / half
    y, x = grid.coordinates
    flux = FLUX * np.sqrt(np.maximum(1.0 - x**2 - y**2, 0.0))
    dt = 0.5 * grid.spacings[1] / max(speed, 0.2)
    one = Body(STEEL, speed, grid, dt)
    rise, terms = one.steady(flux, speed)
    record = one.record(flux, terms)
    for step in range(1, 6):
        moved = one.advance(record, step * speed * dt, dt, speed, flux)
        record = one.accept(moved, flux)
    after = moved.history + moved.response * flux
    for at_x, at_y in ((0.0, 0.0), (0.5, 0.0), (-0.5, 0.0), (0.5, 0.5), (0.0, -0.75)):
        node, exact = np.argmin((x - at_x) ** 2 + (y - at_y) ** 2), moving_point(at_x, at_y, half, speed)
        assert rise[node] == pytest.approx(exact, rel=0.005)
        assert after[node] == pytest.approx(exact, rel=0.01)


def test_rows_alike_are_the_row_alone():
    grid, speed, dt = plane(20, 1e-4, 5, periodic=True), 3.0, 1e-6
    row = np.random.default_rng(3).uniform(0.0, FLUX, grid.shape[1])
    line = Grid(grid.axes[1:], grid.spacings[1:], (1.0,), (CYLINDER,), 1.0)
    rises = []
    for one, flux in ((Body(STEEL, speed, line, dt), row), (Body(STEEL, speed, grid, dt), np.tile(row, 5))):
        record = one.record(flux, one.steady(flux, speed)[1])
        for step in range(1, 4):
            moved = one.advance(record, step * speed * dt, dt, speed, flux)
            record = one.accept(moved, flux)
        rises.append(moved.history)
    np.testing.assert_allclose(rises[1].reshape(5, -1), np.tile(rises[0], (5, 1)), rtol=1e-12)


def test_a_sinusoid_across_a_strip():
    r"""Flux cos(ky) on a body at rest from time 0: T = q erf(sqrt(chi k^2 t))/(k conductivity)."""
    from scipy.special import erf

    grid, dt, steps = plane(10, 1e-5, 64, periodic=True), 2e-9, 40
    wave = 2.0 * np.pi / 32
    flux = np.repeat(FLUX * np.cos(wave * (np.arange(64) + 0.5)), grid.shape[1])
    one = Body(STEEL, 0.0, grid, dt)
    record = one.cold()
    for _ in range(steps):
        moved = one.advance(record, 0.0, dt, 0.0, flux)
        record = one.accept(moved, flux)
    rise, k = moved.history + moved.response * flux, wave / grid.spacings[0]
    middle = grid.shape[1] // 2
    rise, flux = (grid.rows(values)[:, middle] for values in (rise, flux))
    exact = erf(k * np.sqrt(STEEL.diffusivity * steps * dt)) / (k * STEEL.conductivity)
    np.testing.assert_allclose(rise, exact * flux, atol=0.01 * exact * FLUX)


def test_blok_is_the_largest_temperature_of_a_fast_hertz_band():
    """Blok's 1.11 of a parabolic or elliptic flux under two fast bodies, which share the heat."""
    a, load, friction, u1, u2 = 3.36e-4, 527e3, 0.05, 31.25, 18.75
    dx = a / 200
    x = dx * np.arange(-600, 601)
    total = friction * (u1 - u2) * 2.0 * load / (np.pi * a) * np.sqrt(np.maximum(1.0 - (x / a) ** 2, 0.0))
    share = np.sqrt(u1) / (np.sqrt(u1) + np.sqrt(u2))
    rise = moving_band(x, share * total, STEEL.diffusivity, STEEL.conductivity, u1)
    flash = blok_flash_temperature(friction, load, u1 - u2, u1, u2, a, (STEEL.effusivity,) * 2)
    assert rise.max() == pytest.approx(flash, rel=0.03)
