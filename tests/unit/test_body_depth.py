"""Depths of earlier passes: a profile that begins further on brings them in with its heights."""

import numpy as np
import pytest
from support import CASES

from ehlpetsc.case.loading import load
from ehlpetsc.effects.depths import PlasticDeformation, PlasticRecord, Wear, WearRecord
from ehlpetsc.effects.effect import Scene, Step
from ehlpetsc.physics import operation_of
from ehlpetsc.physics.scales import Scales
from ehlpetsc.surfaces.motion.body_field import BodyField, BodyFields

PASS, SHIFT = 4, 50e-6  # m
ROUNDING = 1e-17  # m
KEYS = ["mesh.points_per_half_width=40", f"time.pass_shift={SHIFT}"]


def made(kind, *keys):
    """The effect in pass `PASS`, and a record of pits 40 nm deep all over both bodies."""
    case = load(CASES / "running_in.toml", [*KEYS, *keys])
    scales = Scales.of(case)
    effect = kind(Scene.of_pass(case, scales, operation_of(case, scales), PASS))
    zero, reach = BodyFields.zero(scales.spacing), 6.0 * scales.a
    faces = np.arange(-reach, reach, 0.25 * scales.spacing)
    pits = 40e-9 * (np.arange(len(faces) - 1) % 12 < 5)
    depth = BodyFields(*(BodyField.zero(scales.spacing).add(faces, pits) for _ in range(2)))
    record = PlasticRecord(depth, np.zeros(scales.nx), zero)
    return effect, record if kind is PlasticDeformation else WearRecord(depth, zero)


def in_gap(effect, record, way=0.0):
    return effect.in_gap(record, Step(0.0, None, (way, way), None))


@pytest.mark.parametrize("kind", [PlasticDeformation, Wear])
def test_steady_start_has_no_depth_ahead_of_a_shifted_profile(kind):
    effect, before = made(kind)
    one, other = in_gap(effect, before)
    assert one.max() > 20e-9 and other.max() > 20e-9, "all that is there"
    record = effect.start(before)
    after, ahead = in_gap(effect, record)
    np.testing.assert_allclose(after, one, atol=ROUNDING, err_msg="surface 1 begins where it did before")
    np.testing.assert_allclose(ahead, 0.0, atol=ROUNDING)
    assert record.depth is before.depth, "hidden, not removed"


def test_depth_enters_with_the_profile():
    effect, before = made(PlasticDeformation)
    record, scales = effect.start(before), effect.scene.scales
    way = 1.5 * scales.a
    there, seen = in_gap(effect, before, way)[1], in_gap(effect, record, way)[1]
    behind = effect.scene.roughness.surface_2.entered(scales.x * scales.a - way)
    inside, ahead = behind == 1.0, behind == 0.0
    assert inside.sum() > 40 and ahead.sum() > 40
    np.testing.assert_allclose(seen[inside], there[inside], atol=ROUNDING)
    np.testing.assert_allclose(seen[ahead], 0.0, atol=ROUNDING)
    assert np.all(seen <= there + ROUNDING)


def test_depth_added_ahead_of_the_profile_is_included():
    effect, before = made(PlasticDeformation)
    record = effect.start(before)
    added = np.full(effect.scene.scales.nx, 1e-8)
    depth = effect.scene.mesh_on_bodies.add(record.depth, (0.0, 0.0), [added, added])
    np.testing.assert_allclose(in_gap(effect, record._replace(depth=depth))[1][1:-1], 1e-8, rtol=1e-9)


def test_unshifted_pass_includes_all_depth():
    effect, before = made(PlasticDeformation, "time.pass_shift=0.0")
    assert effect.start(before).hidden.volume == 0.0


def test_uniform_depth_is_included_everywhere():
    """A life gives the stretch ahead of its columns their mean wear, which stays."""
    effect, before = made(Wear)
    even = before.depth.surface_2._replace(depth=np.full_like(before.depth.surface_2.depth, 2e-6))
    record = effect.start(before._replace(depth=before.depth._replace(surface_2=even)))
    np.testing.assert_allclose(in_gap(effect, record)[1], 2e-6, rtol=1e-9)
