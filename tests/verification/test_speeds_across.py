"""Speeds that vary across: Heathcote slip and spin against closed integrals; films, steps in time, heat."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipe

from ehlpetsc.case.loading import load
from ehlpetsc.effects.scene import Scene
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.simulation import Simulation
from ehlpetsc.stepping.observables import Observation

BALL, GROOVE, SPIN = 6.35e-3, 6.604e-3, 150.0  # m, rad/s
GROOVED = {"contact.groove_radius": GROOVE}
TABLES = {
    "title": "a ball in its groove",
    "contact": {
        "radius": [4.6e-3, 1.0 / (1.0 / BALL - 1.0 / GROOVE)],
        "load": 100.0,
        "material": "100Cr6",
        "model": "mixed",
    },
    "fluid": {"viscosity": 0.02, "law": "roelands", "pressure_viscosity": 2e-8, "density": "incompressible"},
    "motion": {"entrainment_speed": 2.0, "slide_roll_ratio": 0.0},
    "mesh": {"inlet": -2.2, "outlet": 1.6, "width": 2.6, "points_per_half_width": [8, 10]},
}
FINE = {"mesh.inlet": -1.2, "mesh.outlet": 1.2, "mesh.points_per_half_width": 50, "mesh.width": 2.4}
FILM, EYRING = 2e-7, 4e6  # m, Pa


def ball(changes=None):
    return load(TABLES, changes)


def solved(changes=None):
    (state,) = Simulation(ball(changes), options={"snes_atol": "1e-10"})
    return state


def observed(changes):
    """Contact whose oil is not under pressure, FILM thick, sheared in the part (1 - r^2)^2 of the gap."""
    case = ball(FINE | changes)
    s = Scales.of(case)
    part = np.maximum(1.0 - s.grid.distance**2, 0.0) ** 2
    zero, full = np.zeros(s.grid.n), np.ones(s.grid.n, dtype=bool)
    loads = SimpleNamespace(
        oil_pressure=zero, friction_pressure=zero, film=zero + FILM / s.h, sheared_oil=full
    )
    nodes = SimpleNamespace(reynolds_unknown=part - 1.0)
    inputs = SimpleNamespace(boundary_friction=0.0, fluid=case.fluid)
    solution = SimpleNamespace(loads=loads, nodes=nodes, inputs=inputs)
    scene = Scene(case, s, None, (0.0, 0.0))
    return Observation(scene, None, SimpleNamespace(solution=solution), s.conditions, None, 0.0)


def test_speeds_of_a_ball_in_the_groove_of_an_inner_ring():
    """Distances of the surface of contact from both axes, by the circles of ball and groove."""
    across = Scales.of(ball(GROOVED)).across
    ring = 1.0 / (1.0 / 4.6e-3 - 1.0 / BALL)  # radius of the raceway
    curved = 2.0 / (1.0 / BALL + 1.0 / GROOVE)
    rise = curved - np.sqrt(curved**2 - across.y**2)
    u1, u2 = across.surfaces(Scales.of(ball(GROOVED)).conditions)
    np.testing.assert_allclose(u1, 2.0 * (1.0 - rise / BALL), rtol=1e-4)
    np.testing.assert_allclose(u2, 2.0 * (1.0 + rise / ring), rtol=1e-4)
    np.testing.assert_allclose(u1 - u2, -2.0 * across.y**2 / (2.0 * curved * 4.6e-3), rtol=1e-9, atol=1e-15)


def polar(a, b, order=40):
    """Places and weights of Gauss' rule over an ellipse of the half-widths a and b."""
    nodes, weights = np.polynomial.legendre.leggauss(order)
    r, angle = 0.5 * (nodes + 1.0), np.pi / 2 * (nodes + 1.0)  # of one half, symmetric about y
    x, y = a * np.outer(r, np.cos(angle)), b * np.outer(r, np.sin(angle))
    return x, y, 2.0 * a * b * np.outer(0.5 * weights * r, np.pi / 2 * weights), (1.0 - r[:, None] ** 2) ** 2


@pytest.mark.parametrize("stress", [None, EYRING])
def test_friction_moment_and_power_of_a_given_film_are_their_integrals(stress):
    """Newton's law: closed; Eyring's: Gauss' rule in polar coordinates, exact to ten digits."""
    found = observed(
        GROOVED | {"motion.spin": SPIN, "motion.slide_roll_ratio": 0.01} | {"fluid.eyring_stress": stress}
    )
    s = found.scene.scales
    rise, middle, fluidity = s.across.curvatures, 0.02, FILM / 0.02
    k = s.u1 * rise[0] - s.u2 * rise[1]
    area = np.pi * s.a * s.b
    if stress is None:
        force = area / fluidity * (middle / 3.0 + k * s.b**2 / 24.0)
        moment = area / fluidity * SPIN * (s.a**2 + s.b**2) / 24.0
        power = middle**2 / 3.0 + middle * k * s.b**2 / 12.0 + k**2 * s.b**4 / 80.0
        power = area / fluidity * (power + SPIN**2 * (s.a**2 + s.b**2) / 24.0)
    else:
        force = moment = power = 0.0
        for sign in (1.0, -1.0):
            x, y, weights, part = polar(s.a, s.b)
            along, across = middle + k * y**2 + SPIN * sign * y, -SPIN * x
            speed = np.hypot(along, across)
            of_speed = 0.5 * weights * part * stress * np.arcsinh(speed / (fluidity * stress)) / speed
            force += (of_speed * along).sum()
            moment += (of_speed * (sign * y * along - x * across)).sum()
            power += (of_speed * speed**2).sum()
    assert found.friction_2 == pytest.approx(force, rel=3e-4)
    assert found.spin_moment == pytest.approx(moment, rel=3e-4)
    assert found.sliding_power == pytest.approx(power, rel=3e-4)
    assert found.friction_power == pytest.approx(power, rel=3e-4)  # no pressure: nothing rolls


def test_a_ball_that_rolls_without_a_force_has_two_bands_of_pure_rolling():
    """At b/sqrt(8) where a Newtonian film is sheared in proportion to (1 - r^2)^2."""

    def force(ratio):
        return observed(GROOVED | {"motion.slide_roll_ratio": ratio}).friction_2

    ratio = brentq(force, 0.0, 0.02, xtol=1e-12)
    s = Scales.of(ball(GROOVED | {"motion.slide_roll_ratio": ratio}))
    np.testing.assert_allclose(
        s.across.rolling_rows(s.conditions), np.array([-1, 1]) * s.b / 8**0.5, rtol=1e-3
    )


DRY = {"fluid": None, "mesh.inlet": -1.2, "mesh.outlet": 1.2, "mesh.width": 2.4}
DRY |= {"contact.model": None, "contact.boundary_friction": 0.1}


def test_a_dry_ball_in_spin_has_the_moment_of_the_ellipse():
    r""":math:`M=\frac38\mu FbE(1-a^2/b^2)`, b the major half-width."""
    found = solved(DRY | {"mesh.points_per_half_width": 20, "motion.spin": SPIN})
    s = Scales.of(ball())
    moment = 0.375 * 0.1 * 100.0 * s.b * ellipe(1.0 - (s.a / s.b) ** 2)
    assert found.spin_moment == pytest.approx(moment, rel=5e-3)
    assert found.friction_power == pytest.approx(moment * SPIN, rel=5e-3)
    assert abs(found.friction) < 1e-3 * 0.1 * 100.0


def test_a_dry_ball_without_a_force_slides_beyond_035_b():
    r"""Coulomb friction of Hertz' pressure: :math:`c-c^3/3=1/3`, c = .3473 (Heathcote)."""
    s = Scales.of(ball(GROOVED))
    k = s.u * (s.across.curvatures[0] - s.across.curvatures[1])
    shares = []
    places = 17.5 / 60.0, 0.3473, 24.5 / 60.0  # of the bands over b: between rows
    for place in places:
        ratio = -k * (place * s.b) ** 2 / s.u
        keys = DRY | GROOVED | {"mesh.points_per_half_width": [16, 60], "motion.slide_roll_ratio": ratio}
        shares.append(solved(keys).friction / (0.1 * 100.0))
    expected = [3.0 * (place - place**3 / 3.0) - 1.0 for place in places]
    np.testing.assert_allclose(shares[::2], expected[::2], atol=2e-3)
    assert abs(shares[1]) < 0.02  # a row's share


def test_the_film_of_a_newtonian_oil_does_not_feel_a_spin_that_leaves_its_mean_speed():
    still, spinning = solved(), solved({"motion.spin": SPIN})
    np.testing.assert_array_equal(still.film_thickness, spinning.film_thickness)
    np.testing.assert_array_equal(still.pressure, spinning.pressure)
    assert spinning.spin_moment > 0.0
    assert spinning.sliding_power == pytest.approx(SPIN * spinning.spin_moment, rel=1e-9)
    assert abs(spinning.friction_1 - still.friction_1) < 1e-9 * abs(still.friction_1)
    rolling = -2.0 * (still.friction + still.friction_1)
    assert spinning.friction_power - spinning.sliding_power == pytest.approx(rolling, rel=1e-9)


def test_the_film_of_each_row_follows_its_own_mean_speed():
    """Of a body that turns about the normal, beside one that does not: power .65 to .72 of the speed."""
    one, other = (solved({"motion.spin": [0.0, sign * 3000.0]}) for sign in (1.0, -1.0))
    np.testing.assert_allclose(one.film_thickness, other.film_thickness[::-1], rtol=1e-7)
    s = Scales.of(ball({"motion.spin": [0.0, 3000.0]}))
    speeds, middle = s.across.entrainment(s.conditions), np.argmin(abs(s.x))
    row = np.argmin(abs(s.across.y - 0.4 * s.b))
    ratio = one.film_thickness[row, middle] / one.film_thickness[-1 - row, middle]
    assert speeds[row] / speeds[-1 - row] > 1.3
    assert 0.6 < np.log(ratio) / np.log(speeds[row] / speeds[-1 - row]) < 0.75


def test_a_steady_state_of_rows_at_their_speeds_stays_in_steps_of_any_length():
    for courant in (0.5, 3.0):
        keys = GROOVED | {"motion.spin": [300.0, 600.0], "time": {"travel": 2.0, "courant": courant}}
        states = list(Simulation(ball(keys), options={"snes_atol": "1e-10"}))
        first, last = states[0], states[-1]
        assert len(states) > 4
        np.testing.assert_allclose(last.film_thickness, first.film_thickness, rtol=1e-6)
        assert max(state.mass_error for state in states) < 1e-7


def test_heat_of_sliding_and_spin_is_their_power_and_lowers_friction():
    """Beside the heat of the pressure flow, which a ball that only rolls has too."""
    eyring, heat = {"fluid.eyring_stress": EYRING}, {"heat": {"bulk_temperature": 333.0}}
    spinning = GROOVED | eyring | {"motion.spin": 4.0 * SPIN}
    rolling, cold, warm = solved(eyring | heat), solved(spinning), solved(spinning | heat)
    assert warm.heat_error < 1e-8
    assert warm.heat - rolling.heat == pytest.approx(warm.sliding_power, rel=0.03)
    assert 0.5 * cold.sliding_power < warm.sliding_power < cold.sliding_power
