"""Conditions that change with time: load, radius and speeds, reversal, squeeze."""

import numpy as np
import pytest
from driving import CASES

from ehlpetsc.case.loading import load
from ehlpetsc.gears import path_of_contact
from ehlpetsc.run.simulation import Simulation

COARSE = {"mesh.points_per_half_width": 50, "mesh.inlet": -2.5, "mesh.outlet": 1.5}


def states(name, overrides):
    """All accepted solutions of a case."""
    simulation = Simulation(load(CASES / name, overrides))
    return simulation, [state.solution for state in simulation]


def scaled(simulation, name, solution):
    return getattr(solution, name) * {"h": simulation.scales.h, "p": simulation.scales.p0}[name]


@pytest.mark.parametrize("name", ["table1_smooth.toml", "table1_mixed.toml"])
def test_constant_conditions_in_a_table_are_the_plain_case(name):
    plain = COARSE | {"time.travel": 0.4, "time.courant": 0.5}
    if name == "table1_smooth.toml":
        plain["surface.slow.synthetic"] = {"kind": "sine", "amplitude": 5e-8, "wavelength": 1e-4}
    simulation, expected = states(name, plain)
    s = simulation.scales
    table = {
        "operation.time": [0.0, s.duration],
        "operation.load": [s.load] * 2,
        "operation.radius": [s.R] * 2,
        "operation.speed_1": [s.u1] * 2,
        "operation.speed_2": [s.u2] * 2,
    }
    _, found = states(name, plain | table)
    assert len(found) == len(expected) > 20
    for one, other in zip(found, expected, strict=True):
        assert one.time == pytest.approx(other.time, rel=1e-12)
        np.testing.assert_allclose(one.p, other.p, atol=1e-9)
        np.testing.assert_allclose(one.h, other.h, atol=1e-9 * other.h.min())


FZG = {
    "module": 4.5e-3,
    "teeth": [16, 24],
    "centre_distance": 91.5e-3,
    "tip_diameter": [82.5e-3, 118.4e-3],
    "face_width": 14e-3,
    "torque": 302.0,
    "speed": 2250.0,
    "tip_relief": 20e-6,
}
WAVE = {"synthetic": {"kind": "sine", "amplitude": 1e-7, "wavelength": 3e-4}}
BOTH_WAVY = {"surface.fast": WAVE, "surface.slow": WAVE, "time": None}


def test_the_profile_of_a_flank_is_met_by_its_arc_length_from_the_first_contact():
    simulation = Simulation(load(CASES / "table1_mixed.toml", COARSE | {"gears": FZG} | BOTH_WAVY))
    path, roughness = path_of_contact(FZG), simulation.roughness
    started = np.interp(0.05 * path.load.max(), path.load[:50], path.time[:50])
    for point in "BCD":
        time = path.time_at(point) - started
        arcs = path.pair.flank_arcs(path.pair.points[point])
        heights = [1e-7 * np.cos(2 * np.pi * arc / 3e-4) for arc in arcs]
        middle = roughness.phi_after(np.zeros(1), simulation.operation.travelled(time))
        assert middle[0] == pytest.approx(-sum(heights), abs=2e-11)
    shift = path.pair.hunting_shift
    second = Simulation(simulation.case, pass_number=2)
    offsets = np.subtract(second.scene.positions.profile_offsets, simulation.scene.positions.profile_offsets)
    assert offsets == pytest.approx((0.0, shift))


def test_a_body_that_reverses_shows_the_same_points_on_its_way_back():
    table = {
        "operation.time": [0.0, 1e-4, 2e-4],
        "operation.speed_1": [2.0, 0.0, -2.0],
        "operation.speed_2": [2.0, 2.0, 2.0],
    }
    sides = {"mesh.inlet": -2.0, "mesh.outlet": 2.0, "mesh.points_per_half_width": 50}
    simulation = Simulation(load(CASES / "table1_mixed.toml", table | sides | BOTH_WAVY))
    x, moved = simulation.scales.x * simulation.scales.a, simulation.operation.travelled
    fast, slow = simulation.roughness.fast, simulation.roughness.slow
    assert not fast.enters and slow.enters
    there, back = moved(0.4e-4)[0], moved(1.6e-4)[0]
    assert there == pytest.approx(back, rel=1e-9)
    np.testing.assert_allclose(fast.height(x - there), fast.height(x - back), atol=1e-12)
    assert fast.height(x).std() > 0.5e-7 and fast.s[0] <= x[0] - moved(1e-4)[0]
