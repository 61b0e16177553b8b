"""Rolling friction of smooth, flooded contacts beside published multigrid fits and a measured exponent."""

import sys

import numpy as np
import pytest
from support import CASES

sys.path.append(str(CASES / "paper"))
import measured_data
import rolling_friction


def test_rolling_friction_of_lines():
    """M from 2 to 50, L 8 and 16, inlet as asked for: over the fit 1 in the mean within 3 %, each 8 %."""
    pairs = [pair for pair in rolling_friction.LINES if pair[1] != 12.0]
    ratios = np.array([rolling_friction.line_ratio(*pair, 60) for pair in pairs])
    assert ratios.mean() == pytest.approx(1.0, abs=0.03)
    assert np.abs(ratios - 1.0).max() < 0.08


def test_rolling_friction_of_a_ball():
    """With the oil outside the mesh equal on two sizes within 3 %, the fit within 5 %; alone less."""
    (near, near_total), (far, far_total) = (
        rolling_friction.ball_ratios(20.0, 8.0, size, 8) for size in rolling_friction.SIZES
    )
    assert near < 0.75 < far < 0.9
    assert near_total == pytest.approx(far_total, rel=0.03)
    assert far_total == pytest.approx(1.0, abs=0.05)


def test_rolling_friction_of_discs_hardly_rises_with_the_load():
    """Measured to its power of 0.31, computed below 0.05."""
    data = measured_data.read("aihara_discs.csv").where(viscosity=13e-6, speed=4.0)
    found = [rolling_friction.disc_friction(13e-6, 4.0, load) for load in data["load"]]
    assert rolling_friction.exponent(data["load"], data["friction"]) == pytest.approx(0.31, abs=5e-3)
    assert abs(rolling_friction.exponent(data["load"], np.array(found))) < 0.05
