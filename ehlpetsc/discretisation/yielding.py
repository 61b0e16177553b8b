r"""Solids that yield: mixed contact with the pressure bounded, on elastic and perfectly plastic solids.

.. math:: p\le p_y,\quad \delta\ge0,\quad (p_y-p)\,\delta=0,

p the whole pressure of oil and solids, :math:`\delta` the depth by which both surfaces together yield where
they face each other; it widens the separation that shape and elastic deflection give:
:math:`h=g+\delta`. With :math:`P=K\max(-w,0)` of :class:`.contact_model.MixedContact`,

.. math:: s=\max(q,0)+P,\quad p=\min(s,p_y),\quad \delta=D\max(s-p_y,0),

and the oil has what the solids leave of p. So the sign of :math:`s-p_y` carries the conditions, and all of
them hold exactly whatever q and w are. Where solids yield, P stays their pressure and q tells of
:math:`\delta`; without oil, or under a void, q stays what it is and P tells.
"""

from contextlib import contextmanager

import numpy as np

from ehlpetsc.discretisation.contact_model import MixedContact, Yield

CARRIES = 0.1  # of the yield pressure
ELASTIC_NODES = 1  # that carry without yielding: with fewer, Newton's method loses the load
HARDENING = 1.0


class YieldingContact(MixedContact):
    """Mixed contact of solids that yield.

    Parameters
    ----------
    boundary_film, stiffness : float
        As of :class:`.contact_model.MixedContact`.
    yield_pressure : float
        p_y in p0, of the softer surface.
    """

    yields = True

    def __init__(self, boundary_film, stiffness, yield_pressure):
        super().__init__(boundary_film, stiffness)
        self.yield_pressure, self.compliance = yield_pressure, 1.0 / stiffness

    @contextmanager
    def elastic(self):
        """For a ``with`` statement: solids that do not yield."""
        limit, self.yield_pressure = self.yield_pressure, np.inf
        try:
            yield
        finally:
            self.yield_pressure = limit

    def pressure(self, q, w):
        """Total pressure in p0, at most the yield pressure."""
        return np.minimum(self._elastic_pressure(q, w), self.yield_pressure)

    def relations(self, q, w):
        """See :class:`.contact_model.Relations`."""
        elastic = super().relations(q, w)
        excess = elastic.pressure - self.yield_pressure
        yielding = excess > 0.0
        by_oil = yielding & (q > 0.0)  # q tells of delta there
        solids = self.contact_pressure(w)
        depth_q = np.where(by_oil, self.compliance, 0.0)
        plastic = Yield(
            self.compliance * np.maximum(excess, 0.0),
            yielding,
            depth_q,
            np.where(yielding, self.compliance * elastic.p_w, 0.0),
            np.where(by_oil, 0.0, 1.0),
            np.where(by_oil, -elastic.p_w, 0.0),
        )
        return elastic._replace(
            oil=np.where(by_oil, self.yield_pressure - solids, q),
            pressure=np.minimum(elastic.pressure, self.yield_pressure),
            p_q=np.where(yielding, 0.0, elastic.p_q),
            p_w=np.where(yielding, 0.0, elastic.p_w),
            plastic=plastic,
        )

    def yielding_and_elastic(self, relations, some):
        """How many of some nodes yield, and how many carry without."""
        yielding, pressure = relations.plastic.yielding[some], relations.pressure[some]
        return yielding.sum(), (~yielding & (pressure > CARRIES * self.yield_pressure)).sum()

    def is_all_yielding(self, yielding, elastic):
        """Whether next to nothing that carries is elastic still, by the numbers of nodes."""
        return yielding > 0 and elastic < ELASTIC_NODES

    def linearised(self, relations, all_yields):
        """The same relations with derivatives that know of the load.

        Where all that carries yields, no pressure depends on any unknown: the solids are then taken to
        harden a little, by which the next iteration reaches nodes that do not carry yet.
        """
        if not all_yields:
            return relations
        y, per_depth = relations.plastic, HARDENING / self.compliance
        return relations._replace(
            p_q=relations.p_q + per_depth * y.depth_q,
            p_w=relations.p_w + per_depth * y.depth_w,
            plastic=y._replace(hardening=HARDENING),
        )

    def contact_pressure(self, w):
        """Pressure of the solids in p0, at most the yield pressure."""
        return np.minimum(self._carried(w), self.yield_pressure)

    def settled(self, q, w):
        """The same pressures and film by unknowns that tell of no yielding: what the next step begins with.

        Parameters
        ----------
        q, w : ndarray, shape (nx,)

        Returns
        -------
        q, w : ndarray, shape (nx,)
        """
        solids = self.contact_pressure(w)
        q = np.minimum(q, self.yield_pressure - solids)
        return q, np.maximum(w, -self.compliance * self.yield_pressure)
