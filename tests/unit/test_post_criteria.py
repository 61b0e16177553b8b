"""Criteria against closed cases: pure shear, uniaxial, hydrostatic, proportional; and against all planes."""

from functools import partial

import numpy as np
import pytest

from ehlpetsc import post
from ehlpetsc.post import Criteria, Material, cycles_to_failure, dang_van, stress
from ehlpetsc.post.criteria.critical_plane import plane_damage, plane_law, plane_workspace
from ehlpetsc.post.criteria.dang_van import smallest_ball
from ehlpetsc.post.criteria.planes import plane_weights, planes_and_directions, turning_samples

STEEL = Material()
SHEAR = Criteria(normal_sensitivity=0.0)  # shear strain alone
damage, critical_plane = (partial(call, strain="direct") for call in (post.damage, post.critical_plane))
WAVE = np.sin(np.linspace(0, 2 * np.pi, 41))  # reversed, its peaks among the samples
PULSE = np.sin(np.linspace(0, np.pi, 41)) ** 2
NONE = 0 * WAVE


def life(parameter, elastic, plastic, b, c):
    """N of elastic (2N)^b + plastic (2N)^c = parameter, by bisection."""
    low, high = -50.0, 100.0
    for _ in range(200):
        y = (low + high) / 2
        above = np.log(elastic * np.exp(b * y) + plastic * np.exp(c * y)) > np.log(parameter)
        low, high = (y, high) if above else (low, y)
    return np.exp(y) / 2


def shear_life(amplitude, opening, steel):
    """N under shear stress +-amplitude whose strain amplitude counts `opening` times."""
    G = steel.youngs_modulus / (2 * (1 + steel.poisson_ratio))
    plastic = (np.sqrt(3) * amplitude / steel.hardening_coefficient) ** (1 / steel.cyclic_hardening)
    strain = amplitude / G + np.sqrt(3) * plastic
    strength, ductility = steel.fatigue_strength / np.sqrt(3), steel.fatigue_ductility * np.sqrt(3)
    return life(strain * opening, strength / G, ductility, steel.b, steel.c)


@pytest.mark.parametrize("tau", [2e8, 5e8, 9e8])
def test_pure_shear(tau):
    found = critical_plane(NONE, NONE, tau * WAVE, STEEL, SHEAR)
    assert found.damage == pytest.approx(1 / shear_life(tau, 1.0, STEEL), rel=1e-8)
    assert found.inclination % 90 == pytest.approx(0, abs=1e-9) and found.tilt == 0
    soft = Material(poisson_ratio=0.5)  # 3G = E: the paper's equivalent range says the same
    expected = damage(NONE, NONE, tau * WAVE, soft).damage
    assert critical_plane(NONE, NONE, tau * WAVE, soft, SHEAR).damage == pytest.approx(expected, rel=1e-8)


def test_fatemi_socie_in_pure_shear_and_tension_is_the_worst_of_all_planes():
    tau, k = 5e8, Criteria().sensitivity(STEEL)
    turned = np.radians(np.linspace(0, 45, 400))
    lives = [shear_life(tau * np.cos(2 * t), 1 + k * tau * np.sin(2 * t), STEEL) for t in turned]
    found = critical_plane(NONE, NONE, tau * WAVE, STEEL)
    assert found.damage == pytest.approx(1 / min(lives), rel=5e-3) and found.damage <= 1.000001 / min(lives)
    best = np.degrees(turned[np.argmin(lives)])
    assert min(abs(found.inclination - place) for place in (best, 90 - best, 90 + best, 180 - best)) < 1.0
    bar, sigma = Material(poisson_ratio=0.0), 8e8
    k = Criteria().sensitivity(bar)
    angles = np.radians(np.linspace(1, 89, 600))  # of the normal from the load
    shear, normal = sigma * np.sin(2 * angles) / 2, sigma * np.cos(angles) ** 2
    worst = min(shear_life(t, 1 + k * n, bar) for t, n in zip(shear, normal, strict=True))
    assert critical_plane(NONE, sigma * WAVE, NONE, bar).damage == pytest.approx(1 / worst, rel=5e-3)


@pytest.mark.parametrize("sigma", [5e8, 1e9, 1.6e9])
def test_uniaxial(sigma):
    bar = Material(poisson_ratio=0.0)  # no stress out of the section
    found = critical_plane(NONE, sigma * WAVE, NONE, bar, SHEAR)
    assert found.damage == pytest.approx(1 / shear_life(sigma / 2, 1.0, bar), rel=1e-8)


def test_hydrostatic_tension_and_residual_stress():
    fluid, size = Material(poisson_ratio=0.5), 4e8
    assert critical_plane(size * WAVE, size * WAVE, NONE, fluid).damage < 1e-30
    limits = Criteria(torsion_limit=4e8, bending_limit=6e8)
    slope = 3 * (4 / 6 - 0.5)
    assert dang_van(size * WAVE, size * WAVE, NONE, 0.5, limits) == pytest.approx(slope * size / 4e8)
    assert dang_van(-size * PULSE, -size * PULSE, NONE, 0.5, limits) == pytest.approx(0, abs=1e-12)
    pulse = -1.5e9 * PULSE
    shear = critical_plane(0 * pulse, pulse, 0 * pulse, STEEL, SHEAR).damage
    plain = critical_plane(0 * pulse, pulse, 0 * pulse, STEEL).damage
    assert plain == pytest.approx(shear, rel=1e-9)  # no plane is opened
    pulled = critical_plane(0 * pulse, pulse, 0 * pulse, STEEL, residual_stress=5e8)
    pressed = critical_plane(0 * pulse, pulse, 0 * pulse, STEEL, residual_stress=-5e8)
    assert pulled.damage > 1.5 * plain and pressed.damage == pytest.approx(plain, rel=1e-9)


def test_pressure_at_the_surface_damages_out_of_plane():
    """At z = 0 sx = sz = -p: no shear in the section, (1 - 2 nu) p/2 half way out of it."""
    p = 4e9
    found = critical_plane(-p * PULSE, -p * PULSE, NONE, STEEL)
    assert found.tilt == pytest.approx(45, abs=1e-6)
    expected = 1 / shear_life((1 - 0.6) * p / 4, 1.0, STEEL)
    assert found.damage == pytest.approx(expected, rel=1e-8)
    in_section = planes_and_directions()[:12]
    assert on_planes(in_section, -p * PULSE, -p * PULSE, NONE) < 1e-30


def on_planes(grid, sx, sz, txz):
    """Largest damage of one history on planes of a grid, each counted on all samples."""
    law, work = plane_law(0.0, STEEL, Criteria(), "direct"), plane_workspace(sx.size)
    history = np.stack([sx, sz, txz])
    return max(plane_damage(g, history, law, 0.0, work) for g in grid)


def contact_like(seed, samples=300):
    """A smooth passage of pressure with ripples and friction: non-proportional, tension behind."""
    rng = np.random.default_rng(seed)
    x = np.linspace(-2, 2, samples)
    ripple = np.interp(x, np.linspace(-2, 2, 40), rng.normal(size=40))
    load = np.exp(-(x**2) * 2) * (1 + 0.5 * ripple) * 1.5e9
    return -0.6 * load + 4e8 * x * np.exp(-(x**2)), -load, 0.5e9 * x * np.exp(-(x**2)) * (1 + 0.3 * ripple)


@pytest.mark.parametrize("components", [3, 6])
def test_grid_has_each_direction_once(components):
    """A second one half a turn away would be the second best plane of each best one."""
    assert planes_and_directions(components=components)[:, 2].max() < np.pi - 1e-3


def test_plane_search_equals_exhaustive_search_also_in_reversed_time_and_in_blocks():
    for seed in range(3):
        parts = contact_like(seed)
        tried = on_planes(planes_and_directions(np.radians(9.0)), *parts)
        assert critical_plane(*parts, STEEL).damage >= 0.98 * tried > 0
    parts = np.array(contact_like(7))
    forwards = critical_plane(*parts, STEEL).damage
    assert critical_plane(*parts[:, ::-1], STEEL).damage == pytest.approx(forwards, rel=0.02)
    parts = np.array([contact_like(k) for k in range(4)]).transpose(1, 0, 2).reshape(3, 2, 2, -1)
    found = critical_plane(*parts, STEEL)
    assert found.damage.shape == found.tilt.shape == (2, 2)
    single = critical_plane(*parts[:, 1, 0], STEEL)
    assert np.ndim(single.damage) == 0 and single.damage == found.damage[1, 0]


def test_critical_planes_may_be_closed_at_all_times():
    """Static stress closes the planes of the largest shear and opens others, which promise more at first."""
    constants = Criteria(normal_sensitivity=0.3)
    tau, unit, turned = 3e8, 1.0 / constants.sensitivity(STEEL), np.radians(6.0)
    mean, deviation = -0.842 * unit, 1.332 * unit
    along = deviation * np.cos(turned) + tau * WAVE
    shear = deviation * np.sin(turned) + NONE
    found = critical_plane(mean + along, mean - along, shear, STEEL, constants=constants)
    assert found.damage == pytest.approx(1 / shear_life(tau, 1.0, STEEL), rel=1e-3)


@pytest.mark.parametrize("direction", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 2, 2), (1, 1, -2)])
def test_path_reduction_keeps_ends_and_bends(direction):
    path, places = np.outer(direction, np.linspace(0.0, 1.0, 21)), np.empty(21, np.int64)
    assert turning_samples(path, 21, places) == 2
    assert places[:2].tolist() == [0, 20]
    path[:, 8] += 0.2 * np.roll(direction, 1)
    count = turning_samples(path, 21, places)
    assert 8 in places[:count] and count <= 5


def test_proportional_load_keeps_its_plane_and_weights_are_those_of_the_tensor():
    parts = np.array([0.3, -1.0, 0.4])[:, None] * WAVE
    small, large = (critical_plane(*(size * parts), STEEL, SHEAR) for size in (4e8, 8e8))
    assert (small.inclination, small.tilt) == pytest.approx((large.inclination, large.tilt), abs=1e-9)
    assert small.damage < large.damage
    assert dang_van(*(8e8 * parts), 0.3) == pytest.approx(2 * dang_van(*(4e8 * parts), 0.3), rel=1e-9)
    rng = np.random.default_rng(3)
    nu = 0.3
    for theta, phi, psi in rng.uniform(0, np.pi, (20, 3)):
        sx, sz, txz = rng.normal(size=3)
        tensor = np.array([[sx, 0, txz], [0, nu * (sx + sz), 0], [txz, 0, sz]])
        n = np.array([np.cos(phi) * np.cos(theta), np.sin(phi), np.cos(phi) * np.sin(theta)])
        across = np.array([-np.sin(theta), 0, np.cos(theta)])
        t = np.cos(psi) * across + np.sin(psi) * np.cross(across, n)
        values = np.array([sx, sz, txz])
        shear, normal, share = plane_weights(theta, phi, psi, nu)
        assert values @ np.array(shear) == pytest.approx(t @ tensor @ n)
        assert values @ np.array(normal) == pytest.approx(n @ tensor @ n)
        assert share == pytest.approx(n @ np.diag([1, 1, 0]) @ n)


def test_dang_van_under_hertz_reaches_one_at_the_iso_281_limit():
    """The default limit is read from 1.5 GPa of ISO 281: half a half-width below the contact U is 1."""
    x = np.linspace(-6, 6, 1201)
    pressure = 1.5e9 * np.sqrt(np.clip(1 - x**2, 0, None))
    use = [dang_van(*stress(x, z, pressure, None, 0.3), 0.3) for z in (0.0, 0.3, 0.5, 0.7)]
    assert use[2] == pytest.approx(1.0, rel=1e-3) and max(use) == use[2]
    assert use[0] == pytest.approx((1 - 0.6) * 1.5e9 / 4 / 375e6, rel=1e-6)  # out of the section
    limits = Criteria(torsion_limit=4e8, bending_limit=6e8)
    assert dang_van(NONE, NONE, 4e8 * WAVE, 0.3, limits) == pytest.approx(1, rel=1e-9)
    assert dang_van(NONE, 6e8 * WAVE, NONE, 0.0, limits) == pytest.approx(1, rel=1e-9)
    assert dang_van(0 * PULSE, 0 * PULSE, 4e8 * PULSE, 0.3, limits) == pytest.approx(0.5, rel=1e-9)
    residual = dang_van(NONE, NONE, 4e8 * WAVE, 0.3, limits, residual_stress=3e8)
    assert residual == pytest.approx(1 + limits.hydrostatic_slope * 2e8 / 4e8, rel=1e-9)
    assert dang_van(NONE, NONE, 4e8 * WAVE, 0.3, limits, residual_stress=-3e8) == pytest.approx(1)


@pytest.mark.slow
def test_smallest_ball():
    rng = np.random.default_rng(0)
    for count in (1, 2, 3, 4, 50, 1000):
        points = rng.normal(size=(3, count))
        centre, radius = smallest_ball(points)
        centre = np.array(centre)
        away = np.linalg.norm(points - centre[:, None], axis=0)
        assert away.max() == pytest.approx(radius, rel=1e-8, abs=1e-12)
        for step in 1e-3 * rng.normal(size=(30, 3)):  # no centre near by does better
            moved = np.linalg.norm(points - (centre + step)[:, None], axis=0).max()
            assert moved >= radius - 1e-12
    for unit in (1e-5, 1e9):  # whatever the unit of stress
        found = smallest_ball(unit * points)
        assert found[1] == pytest.approx(unit * radius, rel=1e-8)
        assert found[0] == pytest.approx(tuple(unit * centre), rel=1e-8)
    line = np.outer([1.0, 2.0, 2.0], np.linspace(-1, 2, 31))
    centre, radius = smallest_ball(line)
    assert radius == pytest.approx(4.5) and centre == pytest.approx((0.5, 1, 1))


def test_strain_rule_applies_on_planes():
    direct = critical_plane(NONE, NONE, 9e8 * WAVE, STEEL, SHEAR).damage
    neuber = critical_plane(NONE, NONE, 9e8 * WAVE, STEEL, SHEAR, strain="neuber").damage
    uniaxial = Material(youngs_modulus=1.5 * 207e9 / 1.3)
    dsv = np.sqrt(3) * 1.8e9
    assert neuber == pytest.approx(1 / cycles_to_failure(dsv, uniaxial, strain="neuber"), rel=1e-8)
    assert neuber < direct / 10
