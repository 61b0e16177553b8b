r"""Mixed contact of elastic and perfectly plastic solids: the total pressure is bounded.

.. math:: p\le p_y,\quad \delta\ge0,\quad (p_y-p)\,\delta=0,

p the total pressure of oil and solids, :math:`\delta` the depth by which both surfaces together yield where
they face each other; it widens the separation that shape and elastic deflection give:
:math:`h=g+\delta`. With :math:`P=K\max(-w,0)` of :class:`.mixed.MixedContact`,

.. math:: s=\max(q,0)+P,\quad p=\min(s,p_y),\quad \delta=D\max(s-p_y,0),

and the oil pressure is p less that of the solids. So the sign of :math:`s-p_y` carries the conditions, and
all of them hold exactly at any q and w. Where solids yield, P remains their pressure and q carries
:math:`\delta`; without oil, or under a void, q keeps its meaning and P carries :math:`\delta`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ehlpetsc.base.compiled import compiled
from ehlpetsc.discretisation.contact.mixed import MixedContact, limit_contact_switch
from ehlpetsc.discretisation.contact.model import ContactModel
from ehlpetsc.discretisation.contact.node_state import (
    PRESSURE_AFTER_REFILL,
    NodeState,
    PlasticState,
)

MIN_CARRYING_PRESSURE = 0.1  # of the yield pressure: nodes above it carry
ELASTIC_NODES = 1  # that carry without yielding: with fewer, Newton's method loses the load
HARDENING = 1.0


class Yielding(ContactModel):
    """State and linearisation of models whose nodes may yield, all at once too."""

    def at_yield_pressure(self, elastic: NodeState, plastic: PlasticState, solids: np.ndarray) -> NodeState:
        """State of the nodes with the pressure of those that yield at its limit.

        `solids`: pressure of the solids in p0.
        """
        by_oil = plastic.depth_q > 0.0
        return elastic._replace(
            reynolds_unknown=np.where(by_oil, self.yield_pressure - solids, elastic.reynolds_unknown),
            pressure=np.minimum(elastic.pressure, self.yield_pressure),
            p_q=np.where(plastic.yielding, 0.0, elastic.p_q),
            p_w=np.where(plastic.yielding, 0.0, elastic.p_w),
            plastic=plastic,
        )

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
    """Mixed contact of solids that yield.

    `boundary_film`, `stiffness`: as of :class:`.mixed.MixedContact`.
    `yield_pressure`: p_y in p0, of the softer surface.
    """

    def __init__(self, boundary_film: float, stiffness: float, yield_pressure: float):
        super().__init__(boundary_film, stiffness)
        self.yield_pressure, self.compliance = yield_pressure, 1.0 / stiffness

    def elastic(self) -> ContactModel | None:
        return MixedContact(self.boundary_film, self.stiffness)

    def state(self, q: np.ndarray, w: np.ndarray) -> NodeState:
        elastic = super().state(q, w)
        excess = elastic.pressure - self.yield_pressure
        yielding = excess > 0.0
        by_oil = yielding & (q > 0.0)  # q carries delta there
        solids = self.contact_pressure(w)
        plastic = PlasticState(
            self.compliance * np.maximum(excess, 0.0),
            yielding,
            np.where(by_oil, self.compliance, 0.0),
            np.where(yielding, self.compliance * elastic.p_w, 0.0),
            np.where(by_oil, 0.0, 1.0),
            np.where(by_oil, -elastic.p_w, 0.0),
        )
        return self.at_yield_pressure(elastic, plastic, solids)

    def reset_yielding(self, q: np.ndarray, w: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        solids = self.contact_pressure(w)
        q = np.minimum(q, self.yield_pressure - solids)
        return q, np.maximum(w, -self.compliance * self.yield_pressure)

    def clip_step(self, now: np.ndarray, step: np.ndarray, film_after_release: float) -> None:
        limit_contact_switch(now, step, self.stiffness, film_after_release)
        limit_yield_switch(now, step, self.stiffness, self.yield_pressure)


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
        yields = max(q, 0.0) + solids > limit
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
