"""What Newton's steps are kept to."""

import numpy as np
import pytest

from ehlpetsc.nonlinear.systems.step_limits import (
    OIL_KEPT,
    REFILLED,
    keep_oil,
    largest_change,
    let_overlaps_touch,
)


def pairs(*values):
    return np.array(values, dtype=float)


def test_largest_change_is_of_pressures_in_oil():
    now = pairs((0.5, 1.0), (-0.5, 1.0), (0.2, 0.0), (0.2, 0.0))
    step = pairs((0.2, 0.0), (-0.6, 0.0), (-5.0, 0.0), (-0.4, -1.0))
    # a cavity counts from zero on; contact that stays does not count, contact that opens does
    assert largest_change(now, step, 0.0, 0.0) == pytest.approx(0.4)
    assert largest_change(now, step, 0.0, -np.inf) == pytest.approx(0.6)


@pytest.mark.parametrize(
    "q, dq, h, dh, expected",
    [
        (0.5, 0.2, 1.0, 0.0, 0.3),  # oil stays oil: as it is
        (-0.5, -1.0, 1.0, 0.0, REFILLED),  # a cavity that fills
        (-0.5, 0.6, 1.0, 0.0, OIL_KEPT * 0.5 - 1.0),  # one that would be emptied
        (0.5, 3.0, 1.0, 0.0, OIL_KEPT - 1.0),  # oil that would be a void at once
        (-0.5, -0.1, 1.0, 0.0, -0.4),  # a void that shrinks
        (-0.5, -0.1, 1.0, 1.0, REFILLED),  # a void that closes
    ],
)
def test_cavities_keep_oil(q, dq, h, dh, expected):
    now, step = pairs((q, h)), pairs((dq, dh))
    keep_oil(now, step, 0.0)
    assert now[0, 0] - step[0, 0] == pytest.approx(expected, rel=1e-6)
    assert step[0, 1] == dh


def test_overlaps_touch():
    now, step = pairs((0.0, 1.0), (0.0, 1.0)), pairs((0.0, 0.5), (0.0, 1.5))
    let_overlaps_touch(now, step, 0.0)
    assert (now - step)[:, 0] == pytest.approx([0.0, REFILLED])
