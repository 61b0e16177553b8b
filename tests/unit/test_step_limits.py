"""Limits of the Newton step, and unknowns of the banded factorisation."""

from functools import partial

import numpy as np
import pytest

from ehlpetsc.discretisation.contact.compliant import CompliantContact, Layer
from ehlpetsc.discretisation.contact.direct import (
    DirectContact,
    clip_cavities,
    close_overlaps,
    pressure_change,
)
from ehlpetsc.discretisation.contact.mixed import MixedContact
from ehlpetsc.discretisation.contact.node_state import MIN_OIL_FRACTION, PRESSURE_AFTER_REFILL
from ehlpetsc.discretisation.contact.yielding import (
    CompliantYieldingContact,
    YieldingContact,
    limit_yield_switch,
)
from ehlpetsc.discretisation.unknowns import q_columns, w_columns
from ehlpetsc.nonlinear.line.node_pairs import node_pairs
from ehlpetsc.physics.contact.asperities import LayerLaw


def pairs(*values):
    return np.array(values, dtype=float)


def test_pressure_change_is_limited_in_oil_and_overlaps_clipped():
    now = pairs((0.5, 1.0), (-0.5, 1.0), (0.2, 0.0), (0.2, 0.0))
    step = pairs((0.2, 0.0), (-0.6, 0.0), (-5.0, 0.0), (-0.4, -1.0))
    # a cavity counts from zero on; contact that stays does not count, contact that opens does
    assert pressure_change(now, step, 0.0, 0.0) == pytest.approx(0.4)
    assert pressure_change(now, step, 0.0, -np.inf) == pytest.approx(0.6)
    now, step = pairs((0.0, 1.0), (0.0, 1.0)), pairs((0.0, 0.5), (0.0, 1.5))
    close_overlaps(now, step, 0.0)
    assert (now - step)[:, 0] == pytest.approx([0.0, PRESSURE_AFTER_REFILL])


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
    clip_cavities(now, step, 0.0, 1e-3)
    assert now[0, 0] - step[0, 0] == pytest.approx(expected, rel=1e-6)
    assert step[0, 1] == dh


@pytest.mark.parametrize("film", [0.0, 1e-16])  # what is left of a film is contact as well
def test_solids_that_touch_are_not_pulled(film):
    """They lose their pressure first, then contact, as F = 0 of a gap without oil has no sign."""
    model = DirectContact(0.0, 1e-8)
    now, step = pairs((0.5, film)), pairs((0.7, 0.0))
    model.clip_step(now, step, 1e-3)
    assert now - step == pytest.approx(np.array([[PRESSURE_AFTER_REFILL, film]]), rel=1e-6)
    now, step = now - step, pairs((0.7, 0.0))
    model.clip_step(now, step, 1e-3)
    assert (now - step)[0, 1] == pytest.approx(1e-3, rel=1e-4)


def test_rounding_at_the_yield_pressure_decides_nothing_and_contact_comes_first():
    """A node that has yielded begins the next step at the yield pressure, give or take the last digit."""
    model, found = YieldingContact(0.01, 10.0, 1.5), []
    for q in (np.nextafter(1.5, 0.0), 1.5, np.nextafter(1.5, 2.0)):
        now, step = pairs((q, 0.1)), pairs((-0.2, 0.01))
        assert model.state(*now.T).plastic.yielding.all()
        model.clip_step(now, step, 1e-3)
        found.append((now - step).ravel())
    np.testing.assert_allclose(found, [[1.7, 0.09]] * 3, rtol=1e-12)
    stiffness, limit = 10.0, 1.0
    now = np.array([[0.2, 0.1], [0.2, -0.02], [0.2, 0.1]])
    step = np.array([[-0.3, 0.2], [-0.3, 0.06], [-0.3, 0.12]])
    limit_yield_switch(now, step, stiffness, limit)
    q, w = (now - step).T
    solids = stiffness * np.maximum(-w, 0.0)
    assert q[0] + solids[0] == pytest.approx(limit, rel=1e-8) and 0.0 < solids[0] < 1e-8
    assert q[1] + solids[1] == pytest.approx(limit, rel=1e-8) and solids[1] == pytest.approx(0.8)
    assert (q[2], w[2]) == pytest.approx((0.5, -0.02))


LAYER = Layer(LayerLaw(1e-3, 100.0), 1.0, 10.0, contact_pressure=1e-2)
SOLIDS, COMPLIANT = partial(MixedContact, 0.1, 10.0), partial(CompliantContact, LAYER)
YIELDING = partial(YieldingContact, 0.1, 10.0, 0.6)
PLASTIC, SMALLEST = partial(CompliantYieldingContact, LAYER, 0.6, 0.1), 1e-3 * np.log(100.0 / 0.6)


@pytest.mark.parametrize("model", [partial(DirectContact, 0.0), SOLIDS, COMPLIANT, YIELDING, PLASTIC])
def test_film_is_that_of_the_state(model):
    q, w = np.random.default_rng(1).uniform(-1.0, 1.0, (2, 500))
    w[:200] = SMALLEST * np.linspace(-1.0, 3.0, 200)  # about the film of yielding
    np.testing.assert_array_equal(model().film(q, w), model().state(q, w).film)


@pytest.mark.parametrize(
    "model, q, w",
    [
        (SOLIDS, [0.5, -0.3, -0.3, 0.2], [1.0, 0.2, -0.02, -0.05]),
        (YIELDING, [0.5, 0.4, -0.3, -0.3], [1.0, -0.05, -0.02, -0.07]),
        (YIELDING, [0.02, 0.4, -0.3, -0.3], [1.0, -0.05, -0.07, -0.07]),  # all that carry yield
        (COMPLIANT, [0.5, -0.3, -0.3, 0.2], [5e-3, 0.5, 2e-3, 2e-3]),  # one void on asperities
        (PLASTIC, [0.5, 0.4, -0.3, -0.3], [20e-3, 1.1 * SMALLEST, 3e-3, 0.9 * SMALLEST]),
        (PLASTIC, [0.02, 0.6, -0.3, -0.3], [20e-3, 1.1 * SMALLEST, 9e-3, 0.9 * SMALLEST]),
    ],
)
def test_unknowns_of_the_band_change_all_properties_alike(model, q, w):
    model, rng, owned = model(), np.random.default_rng(5), slice(0, len(q))
    state = model.linearised(model.state(np.array(q), np.array(w)), owned, lambda sums: sums)
    rows, stencil = rng.standard_normal((len(q), 8)), np.arange(len(q))[:, None] - np.arange(4)
    entries, unknowns = node_pairs(state, model.compliance, rows, stencil)
    p_first, separation_first, separation_second, by_pairs = entries
    pairs = rng.standard_normal((len(q), 2))
    changes = np.einsum("kni,nk->ni", unknowns[:, owned], pairs)
    pressure, oil, film, separation = (state.derivatives() * changes.T).sum(axis=1)
    (first, second), places = pairs.T, (q_columns, w_columns)
    np.testing.assert_allclose(p_first * first, pressure, rtol=1e-12, atol=1e-12)
    found = separation_first * first + separation_second * second
    np.testing.assert_allclose(found, separation, rtol=1e-12, atol=1e-12)
    found = sum((of(by_pairs) * change[stencil]).sum(1) for of, change in zip(places, pairs.T, strict=True))
    expected = sum(
        (of(rows) * change[stencil]).sum(1) for of, change in zip(places, (oil, film), strict=True)
    )
    np.testing.assert_allclose(found, expected, rtol=1e-9)


def test_depth_of_yielding_solids_remains_where_oil_returns():
    now, step = pairs((-0.3, 0.9 * SMALLEST)), pairs((-0.5, 0.0))
    model = PLASTIC()
    model.clip_step(now, step, 0.0)
    before, after = (model.state(*unknowns.T).plastic for unknowns in (now, now - step))
    assert after.depth == pytest.approx(before.depth, rel=1e-5) and after.depth_q[0] > before.depth_q[0]
