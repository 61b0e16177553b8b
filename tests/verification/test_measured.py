"""Friction of discs and gears beside measurements, as cases/measured.md publishes it."""

import sys

import numpy as np
import pytest
from support import CASES
from support.published_values import CMOD_FRICTION

from ehlpetsc.analysis.gear_run import GearRun
from ehlpetsc.api import solve
from ehlpetsc.case.loading import load

sys.path.append(str(CASES / "paper"))
import discs

PUBLISHED = (  # computed on a/60
    (0.0291, 0.0368, 0.0423, 0.0440),
    (0.0318, 0.0382, 0.0416, 0.0397),
    (0.0329, 0.0381, 0.0387, 0.0316),
    (0.0495, 0.0500, 0.0505, 0.0501),
    (0.0088, 0.0157, 0.0228, 0.0255),
)
FIRST_OF_PAO = [4, 0]  # measured 0.0062


@pytest.mark.parametrize("number, curve", enumerate(discs.MEASURED))
def test_friction_of_discs_on_two_meshes(number, curve):
    """On a/60 the published values, on a/30 within 0.5 %."""
    coarse, fine = (
        [discs.friction(curve.oil, curve.speed, ratio, points) for ratio in discs.RATIOS]
        for points in discs.MESHES
    )
    np.testing.assert_allclose(fine, PUBLISHED[number], atol=6e-5)
    np.testing.assert_allclose(coarse, fine, rtol=5e-3)


def test_discs_are_near_their_measured_friction():
    """Fifteen of twenty within 8 %, all but one within 15 %, all within the 0.005 of the measured ones."""
    measured, computed = np.array([curve.friction for curve in discs.MEASURED]), np.array(PUBLISHED)
    error = np.abs(computed / measured - 1.0)
    assert (error <= 0.08).sum() >= 15
    assert np.argwhere(error > 0.15).tolist() == [FIRST_OF_PAO]
    assert np.abs(computed - measured).max() < discs.BAND


@pytest.mark.slow
def test_friction_of_smooth_gears(tmp_path):
    """C-mod at 8.3 m/s, a/20, within 3 %."""
    case = load(CASES / "cmod.toml", {"mesh.points_per_half_width": 20})
    solve(case, tmp_path / "cmod.h5", progress=False).close()
    figures = GearRun(tmp_path / "cmod.h5").figures()
    assert figures["mean friction coefficient"] == pytest.approx(CMOD_FRICTION, rel=0.03)
