"""Limits of the Newton step, and unknowns of the banded factorisation."""

import numpy as np
import pytest

from ehlpetsc.discretisation.contact.compliant import CompliantContact, Layer
from ehlpetsc.discretisation.contact.direct import clip_cavities, close_overlaps, pressure_change
from ehlpetsc.discretisation.contact.node_state import MIN_OIL_FRACTION, PRESSURE_AFTER_REFILL
from ehlpetsc.discretisation.contact.yielding import limit_yield_switch
from ehlpetsc.physics.asperities import LayerLaw


def pairs(*values):
    return np.array(values, dtype=float)


def test_pressure_change_is_limited_in_oil():
    now = pairs((0.5, 1.0), (-0.5, 1.0), (0.2, 0.0), (0.2, 0.0))
    step = pairs((0.2, 0.0), (-0.6, 0.0), (-5.0, 0.0), (-0.4, -1.0))
    # a cavity counts from zero on; contact that stays does not count, contact that opens does
    assert pressure_change(now, step, 0.0, 0.0) == pytest.approx(0.4)
    assert pressure_change(now, step, 0.0, -np.inf) == pytest.approx(0.6)


@pytest.mark.parametrize(
    "q, dq, h, dh, expected",
    [
        (0.5, 0.2, 1.0, 0.0, 0.3),  # oil stays oil: as it is
        (-0.5, -1.0, 1.0, 0.0, PRESSURE_AFTER_REFILL),  # a cavity that fills
        (-0.5, 0.6, 1.0, 0.0, MIN_OIL_FRACTION * 0.5 - 1.0),  # one that would be emptied
        (0.5, 3.0, 1.0, 0.0, MIN_OIL_FRACTION - 1.0),  # oil that would be a void at once
        (-0.5, -0.1, 1.0, 0.0, -0.4),  # a void that shrinks
        (-0.5, -0.1, 1.0, 1.0, PRESSURE_AFTER_REFILL),  # a void that closes
    ],
)
def test_cavities_keep_a_minimum_of_oil(q, dq, h, dh, expected):
    now, step = pairs((q, h)), pairs((dq, dh))
    clip_cavities(now, step, 0.0)
    assert now[0, 0] - step[0, 0] == pytest.approx(expected, rel=1e-6)
    assert step[0, 1] == dh


def test_overlaps_are_clipped_to_contact():
    now, step = pairs((0.0, 1.0), (0.0, 1.0)), pairs((0.0, 0.5), (0.0, 1.5))
    close_overlaps(now, step, 0.0)
    assert (now - step)[:, 0] == pytest.approx([0.0, PRESSURE_AFTER_REFILL])


def test_contact_precedes_yielding_in_a_step():
    """A step to both at once stops where solids begin to carry, at the yield pressure."""
    stiffness, limit = 10.0, 1.0
    now = np.array([[0.2, 0.1], [0.2, -0.02], [0.2, 0.1]])
    step = np.array([[-0.3, 0.2], [-0.3, 0.06], [-0.3, 0.12]])
    limit_yield_switch(now, step, stiffness, limit)
    q, w = (now - step).T
    solids = stiffness * np.maximum(-w, 0.0)
    assert q[0] + solids[0] == pytest.approx(limit, rel=1e-8) and 0.0 < solids[0] < 1e-8
    assert q[1] + solids[1] == pytest.approx(limit, rel=1e-8) and solids[1] == pytest.approx(0.8)
    assert (q[2], w[2]) == pytest.approx((0.5, -0.02))


def test_compliant_node_changes_follow_from_its_unknown_pair():
    """Full of oil (p, h), under a void (q, h), and (p, q) where asperities are stiff there."""
    layer = Layer(LayerLaw(1e-3, 100.0), 1.0, 10.0, contact_pressure=1e-2, high_pressure=0.1)
    model, w = CompliantContact(layer), np.array([5e-3, 20e-3, 2e-3])
    nodes = model.state(np.array([0.5, -0.3, -0.3]), w)
    q_change, w_change = np.array([0.1, 0.2, -0.1]), np.array([1e-4, -2e-4, 3e-5])
    p_change = nodes.p_q * q_change + nodes.p_w * w_change
    found = np.array([[p_change[0], w_change[0]], [q_change[1], w_change[1]], [p_change[2], q_change[2]]])
    model.from_band(nodes, slice(0, 3), found)
    np.testing.assert_allclose(found, np.stack([q_change, w_change], axis=1), rtol=1e-12)
