"""Points and strips under loads, radii and speeds that change with time."""

import numpy as np
import pytest
from support import CASES
from support.convergence import observed_order
from support.points import R, point

from ehlpetsc.case.loading import load
from ehlpetsc.physics.contact.hertz import hertz_ellipse
from ehlpetsc.run.simulation import Simulation

TIGHT = {"snes_atol": 1e-11}
BOTH_WAYS = {"mesh.inlet": -2.0, "mesh.outlet": 2.0}


def ball(changes):
    """Simulation of a circular contact on a coarse mesh."""
    return Simulation(load(point(50.0, 5.0, 8), changes), options=TIGHT)


S = ball({}).scales


def harmonic(travel, depth=0.4, begin=0.0):
    """Load, radii and speeds over the time of a travel in half-widths, those of the scales at both ends.

    `begin`: share of the travel that is left out.
    """
    phase = np.linspace(begin, 1.0, 65)
    factor = 1.0 - depth * np.sin(np.pi * phase) ** 2
    columns = {"load": S.load, "radius": R, "speed_1": S.u, "speed_2": S.u}
    return {"operation.time": travel * S.a / S.u * (phase - begin)} | {
        f"operation.{name}": value * factor for name, value in columns.items()
    }


def state_in_time(changes, steps, share=0.75):
    """State after a share of a table of so many equal steps, and the conditions there."""
    simulation = ball(changes)
    dt = simulation.operation.duration / steps
    states = [simulation.advance(), *(simulation.advance(dt) for _ in range(int(share * steps)))]
    assert not any(state.retries for state in states)
    assert max(state.load_error for state in states) < 1e-10
    return states[-1], simulation.operation.at(states[-1].time)


def steady_under(conditions, changes):
    """Steady state on the same mesh, under the conditions of an instant."""
    columns = {"load": S.load, "radius": R, "speed_1": S.u, "speed_2": S.u}
    table = {
        f"operation.{name}": [now, last]
        for (name, last), now in zip(columns.items(), conditions, strict=True)
    }
    return ball(changes | table | {"operation.time": [0.0, 1.0]}).advance()


def test_constant_conditions_in_a_table_are_the_plain_case():
    wave = {"kind": "sine", "amplitude": 20e-9, "wavelength": S.a, "wavelength_across": S.a}
    plain = {"surface.1.synthetic": wave, "time.travel": 0.5, "motion.slide_roll_ratio": 0.3}
    expected = list(ball(plain))
    table = {"time": [0.0, 3.0 * expected[-1].time], "load": [S.load] * 2, "radius": [R] * 2}
    found = list(ball(plain | {f"operation.{name}": column for name, column in table.items()}))
    assert len(found) == len(expected) > 4
    for one, other in zip(found, expected, strict=True):
        assert one.time == other.time
        np.testing.assert_array_equal(one.pressure, other.pressure)
        np.testing.assert_array_equal(one.film_thickness, other.film_thickness)


def test_dry_ball_under_a_harmonic_load_is_steady_at_every_instant():
    changes = harmonic(2.0) | {"fluid": None}
    state, now = state_in_time(changes, 16)
    steady = steady_under(now, {"fluid": None})
    np.testing.assert_allclose(state.dimensionless.p, steady.dimensionless.p, rtol=0, atol=1e-8)
    hertz = hertz_ellipse(now.load, now.radius, now.radius, S.E)
    assert hertz.a < 0.9 * S.a and state.load == pytest.approx(now.load, rel=1e-10)
    assert state.p_max == pytest.approx(hertz.p0, rel=2e-2)
    assert -state.dimensionless.unknowns.border[0] * S.h == pytest.approx(hertz.approach, rel=1e-2)


def test_slow_harmonic_conditions_approach_the_steady_film():
    """The lag behind the steady film is proportional to the rate of change, zero at the beginning."""
    lags = []
    for travel in (16, 32):
        # a node a step, at a constant speed: the balance of a step is then that of a steady film
        speeds = dict.fromkeys(("operation.speed_1", "operation.speed_2"), [S.u] * 65)
        state, now = state_in_time(harmonic(travel, begin=0.5) | speeds, 4 * travel, 0.5)
        steady = steady_under(now, {})
        lags.append(abs(state.film_central / steady.film_central - 1.0))
    assert lags[-1] < 1.5e-2 and observed_order(lags) == pytest.approx(1.0, abs=0.2)


def test_second_order_in_time():
    table = harmonic(8.0, begin=0.5)
    states = [state_in_time(table, steps, 0.5)[0] for steps in (96, 192, 384)]
    inside = S.grid.inside(0.8)
    for field in ("film_thickness", "pressure"):
        values = [getattr(state, field).ravel()[inside] for state in states]
        differences = [np.sqrt(np.mean((a - b) ** 2)) for a, b in zip(values, values[1:], strict=False)]
        assert observed_order(differences) > 1.8


def test_reversed_motion_turns_the_contact_about_its_axis():
    """A map without symmetry under a ball, sliding, either way: rotation by 180 degrees."""
    heights = 20e-9 * np.random.default_rng(3).standard_normal((9, 9))
    rough = {"surface.1": {"z": heights.tolist(), "spacing": S.a / 5.0}, "time.start": "rough"}
    rough |= BOTH_WAYS | {"time.travel": 0.3, "operation.time": [0.0, 1.0], "motion": None}
    there, back = (
        list(ball(rough | {"operation.speed_1": [1.2 * u] * 2, "operation.speed_2": [0.8 * u] * 2}))
        for u in (S.u, -S.u)
    )
    shape = S.grid.shape
    p = there[-1].dimensionless.p.reshape(shape)
    assert np.abs(p - p[::-1]).max() > 0.1
    for one, other in zip(there, back, strict=True):
        np.testing.assert_allclose(other.dimensionless.p[::-1], one.dimensionless.p, rtol=0, atol=1e-9)
        np.testing.assert_allclose(np.flip(other.film_thickness), one.film_thickness, rtol=1e-8)


def test_strip_under_a_table_is_the_line():
    """Also where the motion turns back; that half strokes mirror each other is tested on the line."""
    table = {
        "operation.time": [0.0, 1e-5, 2e-5, 4e-5],
        "operation.load": [420e3, 527e3, 380e3, 420e3],
        "operation.radius": [0.018, 0.0191, 0.017, 0.018],
        "operation.speed_1": [5.0, 5.6, 0.0, -5.2],
        "operation.speed_2": [4.0, 4.4, 0.0, -5.2],
    }
    mesh = BOTH_WAYS | {"mesh.points_per_half_width": 16, "time": None}
    line, strip = (
        list(Simulation(load(CASES / "table1_smooth.toml", table | mesh | of), options=TIGHT))
        for of in ({}, {"mesh.width": 0.25})
    )
    assert len(line) > 12
    rounding = 1e-12 * max(abs(one.friction) for one in line)  # the last step has 1e-4 of the maximum
    for one, other in zip(line, strip, strict=True):
        expected = np.broadcast_to(one.dimensionless.p, (4, len(one.dimensionless.p)))
        np.testing.assert_allclose(other.dimensionless.p.reshape(4, -1), expected, rtol=0, atol=1e-9)
        assert other.time == one.time
        assert other.friction == pytest.approx(one.friction, rel=1e-9, abs=rounding)
