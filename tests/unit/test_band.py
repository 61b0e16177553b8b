"""Unknowns of the banded factorisation: translated back they are the changes of q and w."""

import numpy as np

from ehlpetsc.discretisation.contact.compliant import CompliantContact, Layer


def test_compliant_node_changes_follow_from_its_unknown_pair():
    """Full of oil (p, h), under a void (q, h), and (p, q) where asperities are stiff there."""
    layer = Layer(decay=1e-3, prefactor=100.0, slope_modulus=1.0, contact_pressure=1e-2, high_pressure=0.1)
    model, w = CompliantContact(layer), np.array([5e-3, 20e-3, 2e-3])
    nodes = model.state(np.array([0.5, -0.3, -0.3]), w)
    q_change, w_change = np.array([0.1, 0.2, -0.1]), np.array([1e-4, -2e-4, 3e-5])
    p_change = nodes.p_q * q_change + nodes.p_w * w_change
    found = np.array([[p_change[0], w_change[0]], [q_change[1], w_change[1]], [p_change[2], q_change[2]]])
    model.from_band(nodes, slice(0, 3), found)
    np.testing.assert_allclose(found, np.stack([q_change, w_change], axis=1), rtol=1e-12)
