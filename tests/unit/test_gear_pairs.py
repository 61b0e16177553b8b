"""Gear pairs of contact ratios above 2, of 14.5 degrees, with crowned teeth."""

import math

import numpy as np
import pytest
from support import is_line_with, one_fault

from ehlpetsc.case.keys import template
from ehlpetsc.case.loading import load
from ehlpetsc.gears import GearPair, path_of_contact
from ehlpetsc.gears.command import main
from ehlpetsc.gears.faults import notes
from ehlpetsc.gears.load_sharing import END_STIFFNESS, share
from ehlpetsc.gears.path import gear_loss_factor
from ehlpetsc.gears.standards import loss_factor

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
    assert (
        path.contact_ratio == pytest.approx(ratio_by_tip_angles(pair), rel=1e-12) and path.contact_ratio > 2
    )
    assert (pair.fewest_pairs, pair.rule) == (2, "stiffness")
    points, pitch = pair.points, pair.base_pitch
    assert points["B"] < points["D"]
    rho = np.linspace(points["A"], points["A"] + pitch, 101)
    np.testing.assert_allclose(sum(share(pair, rho + k * pitch) for k in range(-1, 4)), 1.0, rtol=1e-12)
    middle = 0.5 * (points["A"] + points["E"])
    xi = 0.5 + np.array([-1, 0, 1]) / pair.contact_ratio
    k = END_STIFFNESS + 4 * (1 - END_STIFFNESS) * xi * (1 - xi)
    np.testing.assert_allclose(share(pair, middle + pitch * np.arange(-1, 2)), k / k.sum(), rtol=1e-9)


def test_relief_of_tall_teeth_ends_where_two_pairs_carry():
    pair = GearPair(**TALL | {"tip_relief": 20e-6})
    at = np.array([pair.points["A"], pair.points["B"], pair.points["D"], pair.points["E"]])
    loads = share(pair, at)
    assert pair.rule == "tip-relief" and loads[0] == loads[3] == 0.0
    assert loads[1:3] == pytest.approx(0.5, rel=1e-9)  # of equal pairs, a third one just unloaded


def test_losses_of_tall_teeth_are_those_of_pairs_that_share_equally():
    pair = GearPair(**TALL)
    points, pitch = pair.points, pair.base_pitch
    rho = np.linspace(points["A"], points["E"], 400_001)
    pairs = np.floor((rho - points["A"]) / pitch) + np.floor((points["E"] - rho) / pitch) + 1
    sliding = np.abs(rho - points["C"]) * sum(pair.angular_speeds) / pair.base_speed
    expected = (sliding / pairs).mean() * pair.contact_ratio
    assert set(pairs) == {2, 3} and loss_factor(pair) == pytest.approx(expected, rel=1e-4)
    assert gear_loss_factor(path_of_contact(TALL)) == pytest.approx(expected, rel=0.15)


@pytest.mark.parametrize(
    ("change", "parts"),
    [
        ({"load_sharing": "thirds"}, ['"thirds": of contact ratios below 2, here 2.149; ', '"stiffness"']),
        ({"addendum": 2.0, "teeth": (90, 120)}, ["contact ratio 3.", "allowed: 1 to 3"]),
    ],
)
def test_other_sharings_of_tall_teeth_are_refused_in_one_sentence(change, parts):
    assert is_line_with(one_fault(path_of_contact, TALL | change), *parts)


def test_teeth_of_14_5_degrees_are_undercut_below_32():
    assert notes(GearPair(**OLD | {"teeth": (32, 48)})) == []
    (note,) = notes(GearPair(**OLD | {"teeth": (31, 48)}))
    assert "profile_shift = 0 of the pinion: a rack undercuts its teeth below 0.028" in note


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
