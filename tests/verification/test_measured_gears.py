"""Friction and lives of gears beside measurements, as cases/measured.md publishes them."""

import sys

import numpy as np
import pytest
from support import CASES

from ehlpetsc.api import solve
from ehlpetsc.case.loading import load, members
from ehlpetsc.post.run import Job
from ehlpetsc.post.run import run as post
from ehlpetsc.results.post_result import PostResult

sys.path.append(str(CASES / "paper"))
import cmod

CMOD_SMOOTH = 0.0447, 0.0426, 0.0396, 0.0369, 0.0296  # computed on a/20
CMOD_LAYER = 0.0640, 0.0588, 0.0511, 0.0464, 0.0369
CMOD_STRIP = 0.0307  # at 20 m/s, border 40 um, on a/16
LIVES = 3.0  # of superfinished over ground gears, by the damage from 0.3 a down


@pytest.mark.parametrize("number", [3, 4])
def test_friction_of_smooth_gears(number, tmp_path):
    """C-mod at 8.3 and 20 m/s on a/20: the published value."""
    found = cmod.found("smooth", cmod.MEASURED[number].rotation, 20, tmp_path)
    assert found.friction == pytest.approx(CMOD_SMOOTH[number], abs=6e-5)


@pytest.mark.parametrize("point, friction", zip(cmod.MEASURED, CMOD_LAYER, strict=True))
def test_friction_of_gears_with_all_roughness_in_the_layer(point, friction, tmp_path):
    """C-mod on a/20: the published value, within 10 % of the measured one, 15 % at 20 m/s."""
    found = cmod.found("layer", point.rotation, 20, tmp_path)
    assert found.friction == pytest.approx(friction, abs=6e-5)
    assert found.friction == pytest.approx(point.friction, rel=0.15 if point.speed == 20.0 else 0.1)
    assert found.solids < found.friction and found.share > point.share


@pytest.mark.slow
def test_friction_of_gears_as_a_strip_of_isotropic_roughness(tmp_path, monkeypatch):
    """C-mod at 20 m/s on a/16: the published value, between smooth flanks and the layer."""
    point = cmod.MEASURED[-1]
    monkeypatch.setitem(cmod.MODELS, "strip", cmod.Model("", (16, 32), cmod.strip(*cmod.SHORT, (2, 3))))
    found = cmod.found("strip", point.rotation, 16, tmp_path)
    assert found.friction == pytest.approx(CMOD_STRIP, abs=2e-4)
    assert CMOD_SMOOTH[-1] < found.friction < CMOD_LAYER[-1]


@pytest.mark.slow
def test_ratio_of_lives_of_ground_and_superfinished_gears(tmp_path):
    """Ratio of the largest damage 0.3 a deep as published, at 0.05 a ten times that; two nodes a step."""
    deepest = []
    for _, member in members(load(CASES / "superfinished.toml", {"time.courant": 2.0})):
        file = tmp_path / f"{len(deepest)}.h5"
        solve(member, file, progress=False).close()
        post(Job(str(file), str(file.with_suffix(".post.h5"))))
        damage = PostResult(file.with_suffix(".post.h5")).damage
        deepest.append(np.max([np.nanmax(damage[side], axis=1) for side in "12"], axis=0))
    ratios = deepest[0] / deepest[1].max()
    assert ratios[4:].max() == pytest.approx(LIVES, rel=0.03)
    assert ratios[1] > 10.0 * LIVES
