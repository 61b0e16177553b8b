r"""Elastic and perfectly plastic solids, without and with a layer: the total pressure is bounded.

.. math:: p\le p_y,\quad \delta\ge0,\quad (p_y-p)\,\delta=0,\qquad h=g+\delta,

p the total pressure of oil and solids, :math:`\delta` the depth by which both surfaces together yield where
they face each other; it widens the separation g that shape and elastic deflection give. P(w) is the pressure
that elastic solids would have, :math:`s=\max(q,0)+P` that of both. Of the nodes at which :math:`s>p_y`

* those with oil have :math:`\delta=D(s-p_y)`, which q carries; P remains the pressure of the solids and
  :math:`p_y-P` is that of the oil;
* those without oil, or under a void, have :math:`P>p_y`, that is :math:`w<w_y` with :math:`P(w_y)=p_y`;
  :math:`\delta=w_y-w`, and q keeps its meaning.

So the signs of :math:`s-p_y` and q carry the conditions, and all of them hold exactly at any q and w; a node
at :math:`p_y` but for rounding, as those that have yielded begin the next step, counts as yielding. Rigid
solids, :math:`P=K\max(-w,0)`, are :class:`.mixed.MixedContact`; those of a layer, :math:`P=p_c(w)`,
:class:`.compliant.CompliantContact`. A layer on solids that yield is a class of its own although the hardness
of its asperities bounds their pressure too: oil and asperities together load the solids, whose depth is a
result that running in, lives and the mixed contacts of the published cases are about.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ehlpetsc.base.compiled import compiled
from ehlpetsc.discretisation.contact.compliant import FREE_RISE, CompliantContact, Layer
from ehlpetsc.discretisation.contact.mixed import MixedContact, limit_contact_switch
from ehlpetsc.discretisation.contact.model import ContactModel
from ehlpetsc.discretisation.contact.node_state import (
    AMBIENT_TOLERANCE,
    PRESSURE_AFTER_REFILL,
    NodeState,
    PlasticState,
    limit_cavitation,
)
from ehlpetsc.physics.contact.asperities import asperity_pressure, asperity_separation

MIN_CARRYING_PRESSURE = 0.1  # of the yield pressure: nodes above it carry
ELASTIC_NODES = 1  # that carry without yielding: with fewer, Newton's method loses the load
HARDENING = 1.0


class Yielding(ContactModel):
    """Solids that yield; the law of the elastic ones is that of the other base class.

    `yield_pressure`: p_y in p0, of the softer surface.
    `compliance`: D, a^2/R per p0: a scale of the unknown that carries the depth, which no answer depends on.
    `smallest`: w_y.
    """

    smallest: float

    def yielded(
        self,
        elastic: NodeState,
        solids: np.ndarray,
        by_oil: np.ndarray,
        closed: np.ndarray,
        depth: np.ndarray,
        depth_w: np.ndarray | float,
    ) -> NodeState:
        """State of the nodes, from that of elastic ones.

        `solids`: P in p0.
        `by_oil`, `closed`: masks of yielding nodes with oil, and of those without.
        `depth`, `depth_w`: depth of those without oil, and its derivative with respect to w.
        """
        excess, yielding = elastic.pressure - self.yield_pressure, by_oil | closed
        return elastic._replace(
            reynolds_unknown=np.where(by_oil, self.yield_pressure - solids, elastic.reynolds_unknown),
            pressure=np.minimum(elastic.pressure, self.yield_pressure),
            p_q=np.where(yielding, 0.0, elastic.p_q),
            p_w=np.where(yielding, 0.0, elastic.p_w),
            h_w=np.where(closed, 0.0, elastic.h_w),
            plastic=PlasticState(
                depth=np.where(closed, depth, np.where(by_oil, self.compliance * excess, 0.0)),
                yielding=yielding,
                depth_q=np.where(by_oil, self.compliance, 0.0),
                depth_w=np.where(closed, depth_w, np.where(by_oil, self.compliance * elastic.p_w, 0.0)),
                reynolds_q=np.where(by_oil, 0.0, 1.0),
                reynolds_w=np.where(by_oil, -elastic.p_w, 0.0),
            ),
        )

    def reset_yielding(self, q: np.ndarray, w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        q = np.minimum(q, self.yield_pressure - self.contact_pressure(w))
        return q, np.maximum(w, self.smallest)

    def linearised(self, state: NodeState, owned: slice, ranks_sum: Callable) -> NodeState:
        """See :class:`.model.ContactModel`.

        Where all nodes that carry yield, no pressure depends on any unknown: the solids are then taken to
        harden a little, by which the next iteration reaches nodes that do not carry yet.
        """
        is_yielding, pressure = state.plastic.yielding[owned], state.pressure[owned]
        is_elastic = ~is_yielding & (pressure > MIN_CARRYING_PRESSURE * self.yield_pressure)
        yielding, elastic = ranks_sum((is_yielding.sum(), is_elastic.sum()))
        if not yielding > 0 or elastic >= ELASTIC_NODES:
            return state
        y, per_depth = state.plastic, HARDENING / self.compliance
        return state._replace(
            p_q=state.p_q + per_depth * y.depth_q,
            p_w=state.p_w + per_depth * y.depth_w,
            plastic=y._replace(hardening=HARDENING),
        )


class YieldingContact(Yielding, MixedContact):
    """Rigid mixed contact of solids that yield.

    `boundary_film`, `stiffness`: as of :class:`.mixed.MixedContact`; D is 1/K.
    """

    def __init__(self, boundary_film: float, stiffness: float, yield_pressure: float):
        super().__init__(boundary_film, stiffness)
        self.yield_pressure, self.compliance = yield_pressure, 1.0 / stiffness
        self.smallest = -self.compliance * yield_pressure

    def elastic(self) -> ContactModel | None:
        return MixedContact(self.boundary_film, self.stiffness)

    def state(self, q: np.ndarray, w: np.ndarray) -> NodeState:
        elastic = super().state(q, w)
        excess = elastic.pressure - self.yield_pressure
        yielding = excess > -AMBIENT_TOLERANCE
        by_oil, closed = yielding & (q > 0.0), yielding & ~(q > 0.0)
        depth, depth_w = self.compliance * excess, self.compliance * elastic.p_w
        return self.yielded(elastic, self.contact_pressure(w), by_oil, closed, depth, depth_w)

    def clip_step(self, now: np.ndarray, step: np.ndarray, film_after_release: float) -> None:
        limit_contact_switch(now, step, self.stiffness, film_after_release)
        limit_yield_switch(now, step, self.stiffness, self.yield_pressure)


class CompliantYieldingContact(Yielding, CompliantContact):
    """Compliant layer on solids that yield: without oil the film stays at w_y."""

    def __init__(self, layer: Layer, yield_pressure: float, compliance: float):
        super().__init__(layer)
        self.yield_pressure, self.compliance = yield_pressure, compliance
        self.smallest = asperity_separation(yield_pressure, *self.law)
        self.minimum_film = max(self.minimum_film, self.smallest)

    def elastic(self) -> ContactModel | None:
        return CompliantContact(self.layer)

    def contact_pressure(self, w: np.ndarray) -> np.ndarray:
        """Pressure of the asperities in p0, at most the yield pressure."""
        return super().contact_pressure(np.maximum(w, self.smallest))

    def state(self, q: np.ndarray, w: np.ndarray) -> NodeState:
        elastic, closed = super().state(q, np.maximum(w, self.smallest)), w < self.smallest
        yielding = elastic.pressure > self.yield_pressure - AMBIENT_TOLERANCE
        by_oil = yielding & (q > AMBIENT_TOLERANCE) & ~closed
        solids = elastic.pressure - np.maximum(q, 0.0)
        return self.yielded(elastic, solids, by_oil, closed, self.smallest - w, -1.0)

    def dry_start(self, pressure: np.ndarray, gap: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """See :class:`.model.ContactModel`; what exceeds the yield pressure is the depth over D."""
        excess = np.maximum(pressure - self.yield_pressure, 0.0)
        q, w = super().dry_start(np.minimum(pressure, self.yield_pressure), gap)
        return q, np.where(excess > 0.0, self.smallest - self.compliance * excess, w)

    def clip_step(self, now: np.ndarray, step: np.ndarray, film_after_release: float) -> None:
        limit_steps(now, step, self.law, self.yield_pressure, self.smallest, self.compliance)


@compiled
def limit_yield_switch(now: np.ndarray, step: np.ndarray, stiffness: float, limit: float) -> None:
    """Limit steps in place where solids begin or cease to yield: both stop just beyond.

    The excess is what oil and solids would carry over `limit`. Where they yield and there is oil, q carries
    the excess and the oil has the rest of the pressure; oil that is left without pressure is a void from then
    on, under which w carries the excess, and the other way round.
    """
    for i in range(len(now)):
        q, new_q = now[i, 0], now[i, 0] - step[i, 0]
        solids, new_solids = stiffness * max(-now[i, 1], 0.0), stiffness * max(-now[i, 1] + step[i, 1], 0.0)
        yields = max(q, 0.0) + solids > limit - AMBIENT_TOLERANCE
        by_oil = yields and q > 0.0
        excess = (new_q if by_oil else max(new_q, 0.0)) + new_solids - limit
        if not yields and excess <= 0.0:
            continue
        if yields != (excess > 0.0):
            excess = -PRESSURE_AFTER_REFILL if yields else PRESSURE_AFTER_REFILL
            if (solids > 0.0) != (new_solids > 0.0):  # both at once would be reversed in the next iteration
                excess, new_solids = PRESSURE_AFTER_REFILL, max(solids, PRESSURE_AFTER_REFILL)
        if by_oil or new_q > 0.0:
            if new_solids < limit - PRESSURE_AFTER_REFILL:
                new_q = limit + excess - new_solids
            elif by_oil:
                new_q, new_solids = -PRESSURE_AFTER_REFILL, limit + excess
            else:
                new_solids = limit - PRESSURE_AFTER_REFILL
                new_q = excess + PRESSURE_AFTER_REFILL
        else:
            new_solids = limit + excess
        step[i, 0] = q - new_q
        if new_solids > 0.0:
            step[i, 1] = now[i, 1] + new_solids / stiffness


@compiled
def limit_steps(
    now: np.ndarray, step: np.ndarray, law: tuple, limit: float, smallest: float, compliance: float
) -> None:
    """Limit steps in place as in elastic contact, and where solids begin or cease to yield.

    Both stop just beyond; the depth then changes as the linearised excess does.
    """
    tiny = PRESSURE_AFTER_REFILL
    for i in range(len(now)):
        q, w = now[i, 0], now[i, 1]
        closed = w < smallest
        solids, slope = asperity_pressure(max(w, smallest), *law)
        by_oil = not closed and q > AMBIENT_TOLERANCE and q + solids > limit - AMBIENT_TOLERANCE
        new_q, new_w = q - limit_cavitation(q, step[i, 0]), w - step[i, 1]
        if not closed:
            new_w = max(new_w, asperity_separation(max(2.0 * solids, FREE_RISE), *law))
        new_solids = asperity_pressure(max(new_w, smallest), *law)[0]
        edge = asperity_separation(limit - 2.0 * tiny, *law)
        if by_oil:
            excess = q + solids - limit - step[i, 0] + slope * (new_w - w)
            if excess <= 0.0:
                new_w = max(new_w, edge)
                new_solids = asperity_pressure(new_w, *law)[0]
                new_q = limit - tiny - new_solids
            elif new_solids < limit - tiny:
                new_q = limit + excess - new_solids
            else:
                new_q, new_w = -tiny, smallest - compliance * excess
        elif closed:
            if new_w >= smallest:
                new_q, new_w = min(new_q, tiny), edge
            elif new_q > AMBIENT_TOLERANCE:
                new_q, new_w = (smallest - new_w) / compliance + 2.0 * tiny, edge
        elif max(new_q, 0.0) + new_solids > limit:
            if new_q <= AMBIENT_TOLERANCE:
                new_w = smallest - compliance * tiny
            elif new_solids < limit - tiny:
                new_q = limit + tiny - new_solids
            else:
                new_q, new_w = 3.0 * tiny, edge
        step[i, 0], step[i, 1] = q - new_q, w - new_w
