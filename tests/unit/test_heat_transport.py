"""Transport of heat by the film: order, bounds and balance, between walls that take none."""

import numpy as np
import pytest

from ehlpetsc.effects.heat.film_law import FilmLaw
from ehlpetsc.effects.heat.transport import explicit_transport, heat_taken, transport
from ehlpetsc.physics.laws import padded
from ehlpetsc.physics.rheology import NEWTON, FlowLaw

INLET, CAPACITY, LENGTH, TRAVEL = 363.0, 1e5, 1.0, 0.4
LAW = FilmLaw(
    (0, padded((0.0, 1.0, 1.0)), 300.0), True, 1.0, tuple(FlowLaw(NEWTON)), np.inf, 0.14, 0.0, 0.0, 0.0
)


def carried(profile, nodes, way=1.0, moving=False):
    """Rise over INLET at the begin and the end, and the largest imbalance, of oil moved by TRAVEL.

    At the begin the oil starts from rest, or it is moving already.
    """
    courant = 0.5
    dx = LENGTH / nodes
    x = dx * (np.arange(nodes) + 0.5)
    dt, steps = courant * dx, round(TRAVEL / (courant * dx))
    full, zero = np.ones(nodes), np.zeros(nodes)
    stored, flow = CAPACITY / dt * full, way * CAPACITY / dx * np.ones(nodes + 1)
    along = x if way > 0.0 else LENGTH - x
    begin = profile(along)
    change, t, worst = begin - profile(along + dx * courant) if moving else zero, INLET + begin, 0.0
    kept = 0.5 * stored * change
    for _ in range(steps):
        film = zero, 1e-6 * full, full, t, stored, change, kept, flow
        a, b = explicit_transport(stored, flow, t, INLET)
        walls = [INLET * full] * 2 + [1e12 * full] * 2
        of_nodes = np.array((a, b, zero, zero, *walls, full, INLET * full, INLET * full))
        new, q1, q2, _, beyond = out = [np.empty(nodes) for _ in range(5)]
        assert transport(b / a, zero.copy(), b / a, *film, INLET, INLET, tuple(LAW), of_nodes, *out) == 1
        taken = heat_taken(t, stored, kept, flow, INLET, new, beyond)
        worst = max(worst, abs(taken + q1.sum() + q2.sum()))
        change, t, kept = new - t, new, beyond
    return begin, t - INLET, worst / (CAPACITY / dt * begin.sum())


def hump(x):
    return 50.0 * np.exp(-(((x - 0.3) / 0.08) ** 2))


def block(x):
    return 50.0 * (np.abs(x - 0.3) < 0.05)


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_smooth_hump_is_carried_with_second_order(way):
    errors = []
    for nodes in (100, 200, 400):
        x = (np.arange(nodes) + 0.5) / nodes
        end = carried(hump, nodes, way, moving=True)[1]
        exact = hump((x if way > 0.0 else LENGTH - x) - TRAVEL)
        errors.append(np.sqrt(np.mean((end - exact) ** 2)))
    assert np.log2(errors[1] / errors[2]) > 1.7
    assert errors[2] < 0.5


def test_a_block_has_no_new_extremes_and_loses_no_heat():
    begin, end, imbalance = carried(block, 200)
    assert end.min() >= 0.0
    assert end.max() <= 50.0 * 1.01
    assert imbalance < 1e-12
    assert end[-1] < 1e-3  # nothing has left
    assert end.sum() == pytest.approx(begin.sum(), rel=1e-3)


def test_both_ways_are_mirror_images():
    there, back = carried(block, 100)[1], carried(block, 100, way=-1.0)[1]
    np.testing.assert_allclose(back[::-1], there, atol=1e-9)
