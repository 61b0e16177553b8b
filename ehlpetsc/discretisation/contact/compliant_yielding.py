r"""Compliant layer on elastic and perfectly plastic solids: the total pressure is bounded.

.. math:: p\le p_y,\quad\delta\ge0,\quad(p_y-p)\,\delta=0,\qquad h=g+\delta,

as in :mod:`.yielding`, the pressure of the solids being :math:`p_c(h)`. Unknowns (q, w): elastic nodes have
w = h. Of yielding ones

* with oil, w = h and q carries the depth, :math:`\delta=D(q+p_c(w)-p_y)`; the pressure of the oil is
  :math:`p_y-p_c(w)`;
* without oil or under a void, :math:`p_c(h_y)=p_y` alone holds the film at :math:`h_y`, and w is the
  separation, :math:`\delta=h_y-w`.
"""

from __future__ import annotations

import numpy as np

from ehlpetsc.base.compiled import compiled
from ehlpetsc.discretisation.contact.compliant import FREE_RISE, CompliantContact, Layer
from ehlpetsc.discretisation.contact.model import ContactModel
from ehlpetsc.discretisation.contact.node_state import (
    AMBIENT_TOLERANCE,
    PRESSURE_AFTER_REFILL,
    NodeState,
    PlasticState,
    limit_cavitation,
)
from ehlpetsc.discretisation.contact.yielding import Yielding
from ehlpetsc.physics.asperities import asperity_pressure, asperity_separation


class CompliantYieldingContact(Yielding, CompliantContact):
    """Compliant layer on solids that yield.

    `yield_pressure`: p_y in p0, of the softer surface.
    `compliance`: D, a^2/R per p0: a scale of the unknown that carries the depth, which no answer depends on.
    """

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
        elastic = super().state(q, np.maximum(w, self.smallest))
        closed, excess = w < self.smallest, elastic.pressure - self.yield_pressure
        by_oil = (excess > 0.0) & (q > AMBIENT_TOLERANCE) & ~closed
        plastic = PlasticState(
            np.where(closed, self.smallest - w, np.where(by_oil, self.compliance * excess, 0.0)),
            by_oil | closed,
            np.where(by_oil, self.compliance, 0.0),
            np.where(closed, -1.0, np.where(by_oil, self.compliance * elastic.p_w, 0.0)),
            np.where(by_oil, 0.0, 1.0),
            np.where(by_oil, -elastic.p_w, 0.0),
        )
        state = self.at_yield_pressure(elastic, plastic, elastic.pressure - np.maximum(q, 0.0))
        return state._replace(h_w=np.where(closed, 0.0, 1.0))

    def reset_yielding(self, q: np.ndarray, w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        w = np.maximum(w, self.smallest)
        return np.minimum(q, self.yield_pressure - self.contact_pressure(w)), w

    def dry_start(self, pressure: np.ndarray, gap: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """See :class:`.model.ContactModel`; what exceeds the yield pressure is the depth over D."""
        excess = np.maximum(pressure - self.yield_pressure, 0.0)
        q, w = super().dry_start(np.minimum(pressure, self.yield_pressure), gap)
        return q, np.where(excess > 0.0, self.smallest - self.compliance * excess, w)

    def clip_step(self, now: np.ndarray, step: np.ndarray, film_after_release: float) -> None:
        limit_steps(now, step, self.law, self.yield_pressure, self.smallest, self.compliance)


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
        by_oil = not closed and q > AMBIENT_TOLERANCE and q + solids > limit
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
