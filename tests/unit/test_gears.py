"""Involute geometry, load sharing and losses of gear pairs against published figures and closed forms."""

import json
import math
import re
import tomllib
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
from support import CASES, is_line_with, one_fault

from ehlpetsc.analysis.gear_run import FlankDamage, GearRun
from ehlpetsc.base.errors import CaseError, OutputError
from ehlpetsc.case.derived import rating_of
from ehlpetsc.case.keys import template
from ehlpetsc.case.loading import load
from ehlpetsc.commands.gears import main
from ehlpetsc.elasticity.bodies import reduced_modulus
from ehlpetsc.gears import GearPair, path_of_contact
from ehlpetsc.gears.faults import faults, notes
from ehlpetsc.gears.load_sharing import (
    END_STIFFNESS,
    corner_gap,
    edge_contact,
    pair_loads,
    share,
    single_stiffness,
)
from ehlpetsc.gears.path import describe, gear_loss_factor, hertz, loss, mean_friction
from ehlpetsc.gears.standards import bulk_temperatures, loss_factor, values_of
from ehlpetsc.physics.contact.geometry import LINE
from ehlpetsc.physics.contact.hertz import hertz_line
from ehlpetsc.physics.film_formulas import contact_films
from ehlpetsc.physics.oil.laws import viscosity
from ehlpetsc.physics.operation import Conditions
from ehlpetsc.pictures.gears import draw_damage
from ehlpetsc.post.loads import body_points, passage

FZG = {"module": 4.5e-3, "teeth": [16, 24], "pressure_angle": 20.0, "centre_distance": 91.5e-3}  # type C
FZG |= {"tip_diameter": [82.5e-3, 118.4e-3], "face_width": 14e-3, "torque": 302.0, "speed": 2250.0}
STEEL = reduced_modulus((206e9, 206e9), (0.3, 0.3))
CONTACT = """
[contact]
youngs_modulus = [206e9, 206e9]
poisson_ratio = [0.3, 0.3]
[mesh]
inlet = -2.5
outlet = 1.5
points_per_half_width = 50
"""


@pytest.fixture
def case(tmp_path):
    """A case file with a [gears] table, its keys changed."""

    def write(**changes):
        given = {key: value for key, value in (FZG | changes).items() if value is not None}
        table = "".join(f"{key} = {value!r}\n" for key, value in given.items())
        path = tmp_path / "pair.toml"
        path.write_text('title = "FZG C"\n' + CONTACT + "[gears]\n" + table)
        return path

    return write


def at(path, name, values):
    return float(np.interp(path.time[path.index(name)], path.time, values))


TIPS = ("centre_distance", "tip_diameter")
TEETH, TEETH_BACK = ((16, 24), (82.5e-3, 118.4e-3)), ((24, 16), (118.4e-3, 82.5e-3))
RING = FZG | {"teeth": [20, 60], "centre_distance": 0.09, "tip_diameter": [99e-3, 261.75e-3]}
RING["internal"] = True
EQUAL = {"teeth": [20, 20], "profile_shift": [0.5, 0.1], "centre_distance": None, "tip_diameter": None}


def test_geometry_of_racks_driving_wheels_and_rings():
    rack = GearPair(**FZG | {"teeth": (20, 1_000_000), "profile_shift": (0.1, 0.0)} | dict.fromkeys(TIPS))
    points = rack.points
    assert rack.radius(points["E"]) == pytest.approx(points["E"], rel=1e-4)
    depth = (points["C"] - points["A"]) * math.sin(rack.working_angle)
    assert depth == pytest.approx(0.9 * rack.module, rel=1e-4)
    pinion, wheel = (GearPair(**FZG | {"teeth": z, "tip_diameter": d}) for z, d in (TEETH, TEETH_BACK))
    assert wheel.points["A"] == pytest.approx(pinion.line_of_action - pinion.points["E"])
    assert wheel.contact_ratio == pytest.approx(pinion.contact_ratio)
    shifted = {"profile_shift": (0.0, -0.5), "centre_distance": None, "tip_diameter": None}
    pair = GearPair(**RING | shifted | {"module": 3e-3, "teeth": (16, 24)})
    assert math.degrees(pair.working_angle) == pytest.approx(31.0937, abs=1e-4)
    assert 1e3 * pair.centre_distance == pytest.approx(-13.1683, abs=1e-4)
    assert np.multiply(pair.root_diameters, 1e3) == pytest.approx([40.5, -82.5])
    path, pair = path_of_contact(RING), GearPair(**RING)
    (rho_1, rho_2), omega = (path.rho, path.rho - pair.line_of_action), pair.angular_speeds
    assert path.radius == pytest.approx(1.0 / (1.0 / rho_1 - 1.0 / rho_2))
    assert path.speed_2 == pytest.approx(abs(omega[1]) * rho_2)
    assert path.speed_1 - path.speed_2 == pytest.approx((omega[0] + omega[1]) * (rho_1 - pair.points["C"]))
    for arc, speed in zip(pair.flank_arcs(path.rho), (path.speed_1, path.speed_2), strict=True):
        assert arc[-1] == pytest.approx(0.5 * (speed[1:] + speed[:-1]) @ np.diff(path.time))
    # both tips on their circles, about centres 0.09 m apart
    y, x = (getattr(math, name)(pair.working_angle) for name in ("sin", "cos"))
    for point, centre, tip in (("A", -0.09, 0.261750), ("E", 0.0, 0.099)):
        along = path.rho[path.index(point)] - pair.points["C"]
        pitch = pair.base_radii[0] / x - centre
        assert 2.0 * math.hypot(pitch + along * y, along * x) == pytest.approx(tip)
    way = np.linspace(0.0, 1e-3, 50)
    for end, out in (("A", -way), ("E", way)):
        gap = corner_gap(pair, pair.points[end] + out)
        assert gap[0] == 0.0 and (np.diff(gap) > 0.0).all()
    assert share(pair, path.rho).max() <= 1.0 and path.contact_ratio == pytest.approx(1.832, abs=1e-3)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"teeth": [20, 20]}, ["gears.teeth", "more of the wheel"]),
        (EQUAL, ["gears.teeth", "more of the wheel"]),
        ({"tip_diameter": [99e-3, 0.261]}, ["tips of the wheel reach below", "above 0.26"]),
        ({"teeth": [20, 23], "centre_distance": 7.2e-3, "tip_diameter": [97e-3, 99e-3]}, ["cut into those"]),
    ],
)
def test_rings_that_do_not_mesh_are_refused(changes, words):
    assert is_line_with(one_fault(path_of_contact, RING | changes), *words)


@pytest.mark.parametrize(
    ("point", "radius", "speed", "sliding"),
    [
        ("A", 3.871, 2.917, -1.284),
        ("B", 7.270, 3.148, -0.455),
        ("C", 8.382, 3.292, 0.0),
        ("D", 8.729, 3.439, 0.428),
        ("E", 7.651, 3.670, 1.031),
    ],
)
def test_fzg_type_c_has_the_published_path(point, radius, speed, sliding):
    path = path_of_contact(FZG)
    assert 1e3 * at(path, point, path.radius) == pytest.approx(radius, rel=1e-3)
    assert at(path, point, path.entrainment) == pytest.approx(speed, rel=1e-3)
    assert at(path, point, path.slide_roll_ratio) == pytest.approx(sliding, rel=1e-3, abs=1e-12)


def test_fzg_type_c_has_the_published_angle_ratio_and_load():
    path = path_of_contact(FZG)
    assert path.pressure_angle == pytest.approx(22.439, abs=5e-4)
    assert path.contact_ratio == pytest.approx(1.443, abs=5e-4)
    assert at(path, "C", path.load) == pytest.approx(637.7e3, rel=1e-4)
    stages = {70.0: 0.795, 98.9: 0.945, 132.5: 1.093, 171.6: 1.245, 215.6: 1.395, 265.1: 1.547}  # FVA 54/7
    for torque, pressure in stages.items():
        load = at(path, "C", path.load) * torque / 302.0
        found = hertz_line(load, at(path, "C", path.radius), STEEL)[1]
        assert 1e-9 * found == pytest.approx(pressure, rel=1e-2)
    a, p0 = hertz_line(at(path, "C", path.load), at(path, "C", path.radius), STEEL)
    assert a == pytest.approx(0.2452e-3, rel=1e-3) and p0 == pytest.approx(1.656e9, rel=1e-3)


def test_speeds_are_the_derivatives_of_the_arcs_on_both_flanks():
    path = path_of_contact(FZG)
    for speed, arc in zip((path.speed_1, path.speed_2), path.pair.flank_arcs(path.rho), strict=True):
        # speeds are linear in time: the trapezoidal rule is exact
        swept = np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(path.time))
        np.testing.assert_allclose(arc[1:], swept, rtol=1e-9)


PITCH_POINT_BEYOND = {  # teeth, shifts, side
    "internal, before A": ({"teeth": (42, 127), "profile_shift": (0.76, 0.57), "internal": True}, "before A"),
    "internal, after E": ({"teeth": (40, 75), "profile_shift": (-0.3, -0.63), "internal": True}, "after E"),
    "recess": ({"teeth": (30, 40), "centre_distance": 0.105, "tip_diameter": (0.101, 0.1195)}, "before A"),
}


@pytest.mark.parametrize("pair", PITCH_POINT_BEYOND)
def test_path_is_from_a_to_e_where_the_pitch_point_lies_beyond_them(pair, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    teeth, side = PITCH_POINT_BEYOND[pair]
    gears = {"module": 3e-3, "face_width": 30e-3, "torque": 500.0, "speed": 1000.0} | teeth
    path = path_of_contact(gears)
    points = path.pair.points
    assert (path.rho[0], path.rho[-1], path.time[0]) == (points["A"], points["E"], 0.0)
    sliding = np.sign(path.speed_1 - path.speed_2)
    assert (sliding == (1.0 if side == "before A" else -1.0)).all()
    case = load({"title": "pair", "gears": gears, **tomllib.loads(CONTACT)})
    assert case.conditions.time[-1] == pytest.approx((points["E"] - points["A"]) / path.pair.base_speed)
    (tmp_path / "pair.toml").write_text(case.text)
    assert main(["pair.toml"]) == 0
    printed = capsys.readouterr().out
    assert f"mm {side}: the flanks slide in one direction" in printed
    assert ["A", "B", "D", "E"] in [line.split() for line in printed.splitlines()]
    # half of the load outside B to D: the integral by the formula of Niemann and Winter
    rho = np.linspace(points["A"], points["E"], 200_001)
    halves = np.where((rho < points["B"]) | (rho > points["D"]), 0.5, 1.0)
    expected = (halves * np.abs(np.subtract(*path.pair.speeds(rho)))).mean() * path.contact_ratio
    assert loss_factor(path.pair) == pytest.approx(expected / path.pair.base_speed, rel=1e-4)


RULES = {
    "thirds": {"load_sharing": "thirds"},
    "stiffness": {"load_sharing": "stiffness"},
    "stiffness with relief": {"load_sharing": "stiffness", "tip_relief": 20e-6},
    "tip-relief": {"tip_relief": 20e-6},
    "long relief": {"tip_relief": 80e-6},
}


HIGH_RATIO = {"teeth": (40, 80), "module": 2e-3, "centre_distance": 120e-3, "load_sharing": "thirds"}
RULES |= {
    "thirds at 1.77": HIGH_RATIO | {"tip_diameter": (84e-3, 164e-3)},
    "thirds at 1.93": HIGH_RATIO | {"tip_diameter": (84.4e-3, 164.4e-3), "torque": 600.0},
}


@pytest.mark.parametrize("rule", RULES)
def test_loads_of_all_pairs_are_the_total_at_every_position(rule):
    pair = GearPair(**(FZG | RULES[rule]))
    assert faults(pair) == []
    rho = np.linspace(pair.points["A"] - 3e-3, pair.points["E"] + 3e-3, 5001)
    total = sum(share(pair, rho + k * pair.base_pitch) for k in range(-3, 4))
    np.testing.assert_allclose(total, 1.0, atol=1e-12)
    load = share(pair, rho)
    ends = [pair.points[name] + k * pair.base_pitch for name in "ABCDE" for k in range(-3, 4)]
    np.testing.assert_allclose(sum(share(pair, np.add(ends, k * pair.base_pitch)) for k in range(-6, 7)), 1.0)
    assert np.abs(np.diff(load)).max() < 0.01  # continuous, also where pairs come and go
    assert load[0] == load[-1] == 0.0
    if pair.contact_ratio < 1.7:  # with more, edges of both neighbours carry beside a pair
        assert load.max() == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize(
    ("rule", "at_a"),
    [("thirds", 1 / 3), ("stiffness", 0.3709), ("stiffness with relief", 0.2373), ("tip-relief", 0.3070)]
    + [("long relief", 0.0)],
)
def test_load_that_equilibrium_leaves_at_a(rule, at_a):
    """By hand: k_A/(k_A + k_D) = 0.55/(0.55 + 0.933), and (1 - c' C_a/w')/2 of two equal pairs."""
    pair = GearPair(**(FZG | RULES[rule]))
    assert share(pair, np.array([pair.points["A"]]))[0] == pytest.approx(at_a, abs=1e-4)
    assert path_of_contact(pair).load[0] / pair.normal_load == pytest.approx(at_a, abs=1e-4)


def test_tip_edge_touches_before_a_where_the_bent_pair_lets_it():
    pair = GearPair(**(FZG | {"load_sharing": "stiffness"}))
    (r1, r2), points = pair.base_radii, pair.points
    before, tip = 0.8e-3, 0.5 * pair.tip_diameter[1]
    turned = pair.working_angle - math.acos(r2 / tip) - before / r2
    x, y = pair.centre_distance - tip * math.cos(turned), tip * math.sin(turned)
    roll = np.linspace(0.0, 1.0, 200_001)  # the involute of the pinion in the position before A
    angle = (points["A"] - before) / r1 - pair.working_angle - roll + np.arctan(roll)
    radii = r1 * np.hypot(1.0, roll)
    gap = r1 * (math.atan2(y, x) - np.interp(math.hypot(x, y), radii, angle))
    assert corner_gap(pair, np.array([points["A"] - before]))[0] == pytest.approx(gap, rel=1e-6)
    assert gap == pytest.approx(28.7e-6, rel=0.02)
    way, carried = edge_contact(pair)["A"]
    alone = pair.normal_load / single_stiffness(pair) / 0.967  # the other pair, near D, carries all
    assert corner_gap(pair, np.array([points["A"] - way]))[0] == pytest.approx(alone, rel=0.02)
    assert carried == pytest.approx(0.3709, abs=1e-4) and way == pytest.approx(1.09e-3, rel=0.01)


def test_single_stiffness_of_iso_6336():
    """By hand: q' = 0.06339 mm um/N for 16 and 24 teeth with 0.1817 and 0.1715, times 0.8 and 0.975."""
    pair = GearPair(**(FZG | {"profile_shift": (0.1817, 0.1715)}))
    assert single_stiffness(pair) == pytest.approx(0.8 * 0.975 / 0.06339 * 1e9, rel=1e-3)
    assert single_stiffness(GearPair(**FZG)) == pytest.approx(single_stiffness(pair), rel=1e-4)
    stiff = GearPair(**(FZG | {"mesh_stiffness": 20e9}))
    assert single_stiffness(stiff) == 20e9
    described = "; ".join(describe(path_of_contact(stiff)))
    bends = f"one pair bends by {stiff.normal_load / 20e3:.1f} µm"
    assert f"single stiffness c' of a tooth pair 20.00 N/(mm µm), as given: {bends}" in described


OWN = {key: FZG[key] for key in ("module", "teeth", "face_width", "torque", "speed")}


def test_profile_shift_gives_the_play_free_pair():
    """FZG C-GF: 91.5 mm, tips of 82.46 and 118.36 mm; another pair checked against DIN 3960."""
    pair = GearPair(**OWN, profile_shift=(0.1817, 0.1715))
    assert pair.centre_distance == pytest.approx(91.5e-3, abs=1e-6)
    assert pair.tip_diameter == pytest.approx((82.46e-3, 118.36e-3), abs=0.01e-3)
    own = OWN | {"module": 3e-3, "teeth": (19, 47)}
    pair = GearPair(**own, profile_shift=(0.5, 0.3))
    # inv aw = inv 20 + 2 tan 20 0.8/66 = 0.023728, aw = 23.2136 degrees
    assert math.degrees(pair.working_angle) == pytest.approx(23.2136, abs=1e-4)
    assert pair.centre_distance == pytest.approx(99e-3 * 0.939693 / 0.919042, rel=1e-5)
    shortening = 99e-3 + 0.8 * 3e-3 - pair.centre_distance
    expected = [57e-3 + 6e-3 * 1.5, 141e-3 + 6e-3 * 1.3]
    assert pair.tip_diameter == pytest.approx([d - 2.0 * shortening for d in expected], rel=1e-12)
    clearance = pair.centre_distance - 0.5 * (pair.tip_diameter[0] + pair.root_diameters[1])
    assert clearance == pytest.approx(0.25 * 3e-3, rel=1e-9)
    assert faults(pair) == []
    (fault,) = faults(GearPair(**own | {"internal": True}, profile_shift=(0.5, 0.3)))
    assert fault.endswith("allowed: a sum below 0.573")  # inv 20 28/(2 tan 20)
    unshifted = GearPair(**OWN, profile_shift=(0.2, -0.2))
    assert unshifted.centre_distance == pytest.approx(90e-3, rel=1e-12)
    assert unshifted.tip_diameter == pytest.approx((82.8e-3, 115.2e-3), rel=1e-12)


def test_helical_slice():
    keys = OWN | {"profile_shift": (0.0, 0.0), "load_sharing": "stiffness"}
    spur, narrow = (GearPair(**keys, helix_angle=angle) for angle in (0, 1e-6))
    rho = np.linspace(spur.points["A"], spur.points["E"], 301)
    np.testing.assert_allclose(share(narrow, rho), share(spur, rho), atol=1e-4)
    pair = GearPair(**OWN, profile_shift=(0.0, 0.0), helix_angle=20.0)
    assert pair.rule == "stiffness" and faults(pair) == []
    np.testing.assert_allclose(pair_loads(pair, rho)[0].sum(axis=1), 1.0, atol=1e-12)
    assert pair.centre_distance == pytest.approx(90e-3 / math.cos(math.radians(20.0)), rel=1e-12)
    sine = math.sin(math.radians(20.0))
    assert pair.overlap_ratio == pytest.approx(14.0 * sine / (math.pi * 4.5), rel=1e-12)
    helix = math.asin(sine * math.cos(math.radians(20.0)))
    at_c, (r1, r2) = pair.points["C"], [r * math.tan(pair.working_angle) for r in pair.base_radii]
    assert pair.radius(at_c) == pytest.approx(r1 * r2 / (r1 + r2) / math.cos(helix), rel=1e-12)
    first, second = pair.speeds(at_c)
    assert first == pytest.approx(second, rel=1e-12)


def test_load_over_the_path_of_a_file_and_moduli_of_both_flanks(case, tmp_path):
    (tmp_path / "tca.csv").write_text("path [mm], load [N/mm]\n-8, 0\n-4, 300\n4, 600\n9, 0\n")
    loaded = load(case(load_file="tca.csv"))
    pair = loaded.gears.pair
    path = path_of_contact(pair)
    found = np.interp([-2e-3, 9.5e-3], path.rho - pair.points["C"], path.load)
    assert found == pytest.approx([375e3, 0.0], rel=1e-3)
    by_keys = load(case(path=[-8e-3, -4e-3, 4e-3, 9e-3], load=[0.0, 3e5, 6e5, 0.0]))
    for one in (loaded, by_keys):
        assert one.conditions.load.max() == pytest.approx(600e3, rel=1e-3)
    (tmp_path / "tca.csv").write_text("path [mm], load [N/mm]\n4, 300\n-4, 300\n")
    with pytest.raises(CaseError, match="increases"):
        load(case(load_file="tca.csv"))
    alike = {"contact.youngs_modulus": 206e9, "contact.poisson_ratio": 0.3}
    assert load(case(), alike).time.travel == load(case()).time.travel > 10.0


def rated(*keys):
    return rating_of(load(CASES / "fzg.toml", list(keys)), CASES)


def test_standards_for_fzg_c_at_stage_9():
    """302 N m, 2250 1/min, FVA 3 at 90 degrees: each standard's number, at C if it varies."""
    rating = rated()
    at, path, found = rating.path.index("C"), rating.path, values_of(rating)
    assert rating.roughness == pytest.approx(0.25e-6, rel=1e-6)
    # 0.048 (637.7/(6.584 8.382))^0.2 12.85^-0.05 0.25^0.25
    assert found["mean friction coefficient"] == pytest.approx(0.04873, rel=1e-3)
    assert values_of(rated("gears.oil_factor=0.65"))["mean friction coefficient"] == pytest.approx(
        0.65 * found["mean friction coefficient"], rel=1e-12
    )
    assert found["loss factor H_V"] == pytest.approx(0.1958, abs=5e-5)
    assert found["power lost"] == pytest.approx(100 * 0.04873 * 0.1958, rel=1e-3)
    # 1.6 8.382e-3 (16.76e-9 226.4e9)^0.6 (0.01285 3.292/1.8976e9)^0.7 (637.7e3/1.8976e9)^-0.13 m
    assert found["mean film"][at] == pytest.approx(0.1863, abs=0.001)
    assert found["minimum lambda_GF"][at] == pytest.approx(found["mean film"][at] / 0.25, rel=1e-9)
    assert found["maximum flash temperature"][at] == pytest.approx(0.0, abs=0.1)
    # at E: 1.11 0.04873 w 3.783/(13028 (5.562^0.5 + 1.778^0.5) (2a)^0.5)
    load, a = path.load[-1], hertz(path, rating.modulus)[0][-1]
    by_hand = 1.11 * 0.04873 * load * 3.783 / (13027.6 * (5.562**0.5 + 1.778**0.5) * (2 * a) ** 0.5)
    assert found["maximum flash temperature"][-1] == pytest.approx(by_hand, rel=1e-3)
    rise = found["bulk temperature"] - 363.15
    flash = found["maximum flash temperature"]
    mean = np.interp(np.linspace(*path.rho[[0, -1]], 4001), path.rho, flash).mean()
    assert rise == pytest.approx(0.47 * mean, rel=1e-3)


def test_bulk_temperature_of_smooth_flanks_takes_the_losses_of_the_oil_film():
    """ISO/TR 14179-2 has no friction where Ra is 0; the film's is Eyring's at the mean Hertz pressure."""
    keys = ("heat.bulk_temperature=losses", "heat.reference_temperature=363.15", "surface={}")
    shear = ["fluid.eyring_stress=5e6", "fluid.limiting_shear=0.5", "fluid.eyring_stress_pressure=0"]
    case = load(CASES / "fzg.toml", [*keys, *shear])
    rating, path = rating_of(case, CASES), path_of_contact(case.gears.pair)
    assert rating.roughness == 0.0 and 370.0 < rating.bulk  # of Ra 0.25 um
    at, fluid, modulus = len(path.rho) // 4, case.fluid, rating.modulus
    conditions = Conditions(path.load[at], path.radius[at], path.speed_1[at], path.speed_2[at])
    film = contact_films(LINE, modulus, 1.0, fluid, conditions)[0]
    p = path.load[at] / (2.0 * hertz(path, modulus)[0][at])
    eta = fluid.viscosity * np.exp(viscosity(np.array([p]), fluid)[0][0])
    rate = abs(path.speed_1[at] - path.speed_2[at]) / film
    stress = fluid.eyring_stress * np.arcsinh(eta * rate / fluid.eyring_stress)
    assert rating.film_friction[at] == pytest.approx(stress / p, rel=1e-6)
    rises = [loss(path, rating.film_friction), loss(path, 0.04873)]  # in proportion to those of Ra 0.25 um
    assert rating.bulk - 363.15 == pytest.approx(19.6 * rises[0] / rises[1], rel=0.1)


def test_loss_factors_and_bulk_temperature_of_the_losses():
    plain = path_of_contact(FZG)
    assert loss_factor(plain.pair) == pytest.approx(0.1958, abs=5e-5)
    # relief equal to the deflection: the share is linear from A to B, and sliding from C on
    path = path_of_contact(FZG | {"tip_relief": plain.pair.normal_load / single_stiffness(plain.pair)})
    points = path.pair.points
    rho = np.linspace(points["A"], points["E"], 200_001)
    incoming = (rho - points["A"]) / (points["B"] - points["A"])
    leaving = (points["E"] - rho) / (points["E"] - points["D"])
    share = np.minimum(np.minimum(incoming, leaving), 1.0)
    sliding = np.abs(rho - points["C"]) * sum(path.pair.angular_speeds) / path.pair.base_speed
    expected = (share * sliding).mean() * path.contact_ratio
    assert gear_loss_factor(path) == pytest.approx(expected, rel=1e-4)
    friction = 0.04 + 0.01 * path.rho / path.rho[-1]
    assert 0.04 < mean_friction(path, friction) < 0.05
    assert loss(path, 0.05) == pytest.approx(0.05 * gear_loss_factor(path), rel=1e-12)
    keys = ("heat.bulk_temperature=losses", "heat.reference_temperature=363.15")
    assert rated(*keys).bulk == pytest.approx(bulk_temperatures(rated())[0], abs=0.1)
    # 71.16 kW, 0.96 %, half of it from 2 pi d^2/4 + pi d b
    rating = rated(*keys, "gears.heat_transfer=500.0")
    heat = 0.5 * 71157.0 * 0.04873 * gear_loss_factor(rating.path)
    rises = [heat / 500.0 / (math.pi * d * (d / 2 + 14e-3)) for d in (82.5e-3, 118.4e-3)]
    assert rating.bulk == pytest.approx(363.15 + sum(rises) / 2, abs=0.1)
    with pytest.raises(CaseError, match="temperature of the oil"):
        load(CASES / "fzg.toml", ["heat.bulk_temperature=losses"])


@pytest.mark.parametrize(("teeth", "partners"), [((16, 24), 3), ((17, 24), 24), ((20, 20), 1)])
def test_hunting_teeth(teeth, partners):
    pair = GearPair(**(FZG | {"teeth": teeth}))
    assert pair.partners == partners
    if teeth == (16, 24):
        assert pair.hunting_shift == pytest.approx(pair.flank_arcs(pair.points["E"])[1], rel=1e-14)
    if partners == 1:
        assert pair.hunting_shift == 0.0


POINTED = {"module": 3e-3, "teeth": [10, 60], "profile_shift": [1.0, 0]}
POINTED |= {"centre_distance": None, "tip_diameter": None}


@pytest.mark.parametrize("key", ["contact.load", "contact.radius", "motion.entrainment_speed"])
def test_values_that_follow_from_gears_are_refused(case, key):
    with pytest.raises(CaseError, match=rf"{key} = 1.0: follows from \[gears\]"):
        load(case(), {key: 1.0})


@pytest.mark.parametrize(
    ("change", "parts"),
    [
        ({"tip_diameter": [72e-3, 108e-3]}, ["tip_diameter = [0.072, 0.108]: ", " 0.0915 m"]),
        ({"tip_diameter": [78e-3, 0.114]}, ["tip_diameter = [0.078, 0.114]: ", " 0.786", " 1 to 3"]),
        ({"tip_diameter": [60e-3, 118.4e-3]}, ["tip_diameter = 0.06 of the pinion: ", " 0.067658 m"]),
        ({"tip_diameter": [82.5e-3, 130e-3]}, ["tip_diameter: ", "(interference)", " wheel: below 0.1232 m"]),
        ({"centre_distance": 80e-3}, ["centre_distance = 0.08: ", " 0.084572 m"]),
        ({"torque": 302e3}, ["torque = 302000: ", "module = 0.0045", " bends by 51.8 mm", "0.1 modules"]),
        ({"load_sharing": "tip-relief"}, ["tip_relief ", "missing"]),
        ({"load_sharing": "thirds", "helix_angle": 10.0}, ['"thirds"', '"stiffness"']),
        ({"centre_distance": None}, ["centre_distance missing", "profile_shift"]),
        ({"profile_shift": [0.3, 0.1715]}, ["centre_distance = 0.0915", " 0.09197 m", "0.02 modules"]),
        (POINTED, ["tip_diameter = 0.0415 of the pinion", "pointed", " -0.48 mm"]),
        (POINTED | {"teeth": [60, 10], "profile_shift": [0, 1.0]}, ["of the wheel", " -0.48 mm"]),
        ({"path": [-7.5, 0.0, 8.0], "load": [2e5, 6e5, 2e5]}, ["path = -7.5 to 8 m", "0.0349 m", "[mm]"]),
        ({"path": [-7.5e-3, 0.0, 8e-3], "load": [200, 600, 200]}, ["load: ", "0.000732 of", "637.7 kN/m"]),
        ({"path": [-7.5e-3, 0.0, 8e-3], "load": [6e5, 2e6, 6e5]}, ["load: ", "2.38 of", "0.67 to 1.5"]),
    ],
)
def test_impossible_geometry_is_refused_in_one_line(change, parts, case, capsys):
    given = {key: value for key, value in (FZG | change).items() if value is not None}
    assert is_line_with(one_fault(path_of_contact, given), *parts)
    assert main([str(case(**change))]) == 2
    assert capsys.readouterr().err.count("\n") == 1


@pytest.mark.parametrize(
    ("change", "parts"),
    [
        (POINTED | {"profile_shift": [0.6, 0]}, ["tips of the pinion are 0.499 mm", "0.2 modules"]),
        (POINTED | {"teeth": [16, 24], "profile_shift": [0, 0]}, ["= 0 of the pinion", "below 0.0642"]),
        ({"path": [-7.5e-3, 0.0, 8e-3], "load": [2e5, 6e5, 2e5]}, ["gears.load", "0.732 of the load"]),
    ],
)
def test_thin_tips_undercut_and_loads_that_hardly_fit_are_warned_of(change, parts, case):
    pair = load(case(**change)).gears.pair
    (note,) = notes(pair)
    assert all(part in note for part in parts), note
    assert f"warning: {note}" in describe(path_of_contact(pair))
    assert notes(GearPair(**FZG)) == []


def test_gears_prints_the_table_and_writes_picture_and_csv(case, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = case(tip_relief=20e-6)
    assert main([str(path), "--csv", "mesh.csv"]) == 0
    printed = capsys.readouterr().out
    assert "contact ratio 1.443" in printed
    (line,) = (line for line in printed.splitlines() if line.startswith("R, mm"))
    radii = [float(word) for word in line.split()[2:]]
    assert radii == pytest.approx([3.871, 7.270, 8.382, 8.729, 7.651], rel=1e-3)
    assert (tmp_path / "pair.path.png").read_bytes().startswith(b"\x89PNG")
    assert not (tmp_path / "pair.gears.png").exists()  # the name of the picture of its result
    rows = np.loadtxt(tmp_path / "mesh.csv", delimiter=",", skiprows=1)
    assert rows[0, 0] == 0.0 and (np.diff(rows[:, 0]) > 0).all() and (rows[:, 1] > 0).all()
    assert main(["no.toml"]) == 2
    assert is_line_with(capsys.readouterr().err, "no.toml: ", "No such file")


def write_damage(path):
    """Damage of two flanks at a point of the surface and at one below it."""
    with h5py.File(path, "w") as file:
        file.attrs["a"] = 0.25e-3
        s = np.linspace(-8e-3, 0.0, 81)
        file["damage/s"], file["damage/z_over_a"] = s, [0.0, 0.1]
        damage = np.full((2, 81), np.nan)
        damage[1, 20] = 2e-3  # s = -6 mm
        damage[0, 60] = 1e-3
        file["damage/1"], file["damage/2"] = damage, 0.5 * damage


def test_runs_until_bulk_temperatures_are_those_of_the_losses(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    keys = ["heat.bulk_temperature=losses", "heat.reference_temperature=363", "surface={}", "time.courant=12"]
    words = [word for key in (*keys, "mesh.points_per_half_width=12") for word in ("--set", key)]
    assert main([str(CASES / "fzg.toml"), *words, "--run", "gear.h5"]) == 0
    *_, last, file = capsys.readouterr().out.splitlines()
    used, found = ([float(word) for word in re.findall(r"\d+\.\d", part)] for part in last.split(";"))
    assert file == "gear.h5" and 368.0 < found[0] < 379.0
    assert abs(used[0] - found[0]) < 1.0
    write_damage(tmp_path / "gear.post.h5")
    assert main(["gear.h5", "gear.h5"]) == 0
    printed = capsys.readouterr().out
    assert re.search(r"loss factor H_V 0.18\d*, 0.18\d*; 0.1958, 0.1958 by Niemann", printed)
    endings = (".gears", ".gears.temperatures", ".gears.flanks")
    assert {path.name for path in tmp_path.glob("*.png")} == {f"gear{ending}.png" for ending in endings}
    index = {"members": [{"file": "gear.h5", "value": 302.0}]}
    (tmp_path / "gear.series.json").write_text(json.dumps(index))
    assert main(["gear.series.json"]) == 0
    assert (tmp_path / "gear.stages.png").stat().st_size > 10_000


def test_scalars_are_averaged_over_a_fiftieth_of_the_path_and_flanks_pass_all_of_it():
    k = np.arange(301.0)
    found = GearRun.averaged(SimpleNamespace(rho=k), k**2)[3:-3]  # over three steps either side
    np.testing.assert_allclose(found, k[3:-3] ** 2 + 4.0)
    x, moved = np.linspace(-3.0, 1.5, 46), np.linspace(0.0, 20.0, 100)
    s = body_points(x, 0.1, [moved])
    through = s[passage(s, x, 0.1, moved).complete]
    assert (through[0], through[-1]) == pytest.approx((-18.5, -3.0))
    flank = s[passage(s, x, 0.1, moved, (-20.0, 0.0)).complete]
    assert (flank[0], flank[-1]) == pytest.approx((-20.0, 0.0))


def test_flank_damage_is_indexed_by_arc_length_and_depth(tmp_path):
    path = path_of_contact(FZG)
    write_damage(tmp_path / "run.post.h5")
    found = FlankDamage(tmp_path / "run.post.h5", (1e-5, 5e-5))
    assert found.arcs[0][0] == pytest.approx(1e-5) and (np.diff(found.arcs[1]) > 0).all()
    maxima = found.maxima()
    assert maxima["pinion"] == pytest.approx((0.002, 6.01e-3, 25e-6))
    assert maxima["wheel"] == pytest.approx((0.001, 6.05e-3, 25e-6))
    run = SimpleNamespace(damage=found, path=path, title="made")
    draw_damage([run], tmp_path / "flanks.png")
    assert (tmp_path / "flanks.png").stat().st_size > 10_000
    (tmp_path / "bad.post.h5").write_bytes(b"no HDF5")
    with pytest.raises(OutputError, match="bad.post.h5"):
        FlankDamage(tmp_path / "bad.post.h5", (0.0, 0.0))


TALL = {"module": 3e-3, "teeth": (32, 48), "profile_shift": (0.0, 0.0), "addendum": 1.3}
TALL |= {"face_width": 14e-3, "torque": 30.0, "speed": 2250.0}
OLD = TALL | {"pressure_angle": 14.5, "addendum": 1.0, "tip_clearance": 0.157}


def ratio_by_tip_angles(pair):
    """Contact ratio of pairs without shift: z (tan of the tip's angle - tan alpha)/(2 pi), summed."""
    cosine, tangent = math.cos(pair.working_angle), math.tan(pair.working_angle)
    tips = [math.acos(z / (z + 2.0 * pair.addendum) * cosine) for z in pair.teeth]
    return sum(z * (math.tan(tip) - tangent) for z, tip in zip(pair.teeth, tips, strict=True)) / (2 * math.pi)


@pytest.mark.parametrize("keys", [TALL, OLD | {"teeth": (36, 60)}])
def test_three_pairs_share_the_load_by_their_stiffness(keys):
    path = path_of_contact(keys)
    pair = path.pair
    assert path.contact_ratio == pytest.approx(ratio_by_tip_angles(pair), rel=1e-12)
    assert path.contact_ratio > 2
    assert (pair.fewest_pairs, pair.rule) == (2, "stiffness")
    points, pitch = pair.points, pair.base_pitch
    assert points["B"] < points["D"]
    rho = np.linspace(points["A"], points["A"] + pitch, 101)
    np.testing.assert_allclose(sum(share(pair, rho + k * pitch) for k in range(-1, 4)), 1.0, rtol=1e-12)
    middle = 0.5 * (points["A"] + points["E"])
    xi = 0.5 + np.array([-1, 0, 1]) / pair.contact_ratio
    k = END_STIFFNESS + 4 * (1 - END_STIFFNESS) * xi * (1 - xi)
    np.testing.assert_allclose(share(pair, middle + pitch * np.arange(-1, 2)), k / k.sum(), rtol=1e-9)


def test_relief_losses_and_undercut_of_tall_teeth():
    pair = GearPair(**TALL | {"tip_relief": 20e-6})
    at = np.array([pair.points["A"], pair.points["B"], pair.points["D"], pair.points["E"]])
    loads = share(pair, at)
    assert pair.rule == "tip-relief" and loads[0] == loads[3] == 0.0
    assert loads[1:3] == pytest.approx(0.5, rel=1e-9)  # of equal pairs, a third one just unloaded
    pair = GearPair(**TALL)
    points, pitch = pair.points, pair.base_pitch
    rho = np.linspace(points["A"], points["E"], 400_001)
    pairs = np.floor((rho - points["A"]) / pitch) + np.floor((points["E"] - rho) / pitch) + 1
    sliding = np.abs(rho - points["C"]) * sum(pair.angular_speeds) / pair.base_speed
    expected = (sliding / pairs).mean() * pair.contact_ratio
    assert set(pairs) == {2, 3} and loss_factor(pair) == pytest.approx(expected, rel=1e-4)
    assert gear_loss_factor(path_of_contact(TALL)) == pytest.approx(expected, rel=0.15)
    assert notes(GearPair(**OLD | {"teeth": (32, 48)})) == []
    (note,) = notes(GearPair(**OLD | {"teeth": (31, 48)}))
    assert "profile_shift = 0 of the pinion: a rack undercuts its teeth below 0.028" in note


@pytest.mark.parametrize(
    ("change", "parts"),
    [
        ({"load_sharing": "thirds"}, ['"thirds": of contact ratios below 2, here 2.149; ', '"stiffness"']),
        ({"addendum": 2.0, "teeth": (90, 120)}, ["contact ratio 3.", "allowed: 1 to 3"]),
    ],
)
def test_other_sharings_of_tall_teeth_are_refused_in_one_sentence(change, parts):
    assert is_line_with(one_fault(path_of_contact, TALL | change), *parts)


def test_a_crowned_section_is_a_point_contact(tmp_path, capsys):
    (tmp_path / "g.toml").write_text(template("gears"))
    words = [str(tmp_path / "g.toml"), "--crowned", "C"]
    assert main([*words, "0.02 mm"]) == 0
    (tmp_path / "c.toml").write_text(capsys.readouterr().out)
    case = load(tmp_path / "c.toml")
    path = path_of_contact(load(tmp_path / "g.toml").gears.pair)
    assert case.kind == "point" and case.time is None and case.motion.slide_roll_ratio == 0.0
    assert case.contact.load == pytest.approx(path.load[path.index("C")] * 14e-3, rel=1e-5)
    assert case.contact.radius == pytest.approx(path.radius[path.index("C")], rel=1e-5)
    assert case.contact.radius_across == pytest.approx(14e-3**2 / (8 * 20e-6), rel=1e-5)
    for depth, message in (("5 um", "the ellipse is 23.3 mm wide, the face 14 mm"), ("soon", 'as "10 um"')):
        assert main([*words, depth]) == 2
        assert is_line_with(capsys.readouterr().err, message)
