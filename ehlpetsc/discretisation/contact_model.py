r"""What the two unknowns of a node stand for: pressures, film and the separation of the solids.

The first unknown q is the oil's: its pressure :math:`p_f=\max(q,0)`, its void fraction :math:`\max(-q,0)`.
The second one w is the solids':

* *direct* contact (Holmes et al. 2005): w is the film h itself, bounded below; at the bound the oil's
  pressure is the solids' too, and Reynolds' equation is left out there;
* *mixed* contact: the solids have a pressure p_c of their own, :math:`p=p_f+p_c`, complementary to the
  film over the boundary film :math:`h_b`,

  .. math:: h-h_b\ge0,\quad p_c\ge0,\quad p_c(h-h_b)=0,

  which the sign of w carries: :math:`h=h_b+\max(w,0)`, :math:`p_c=K\max(-w,0)`. All three hold exactly,
  whatever w is, and Reynolds' equation holds at every node. Solids that yield: :mod:`.yielding`.

Lengths in x are in half widths, films in a^2/R, pressures in p0.
"""

from typing import NamedTuple

import numpy as np

from ehlpetsc.compiled import compiled

ROUNDING = 1e-12  # pressure in p0: the ambient one of the inlet is zero give or take this


def full_of_oil(q):
    """Nodes with a pressure and no void; which side of zero rounding is on must not matter."""
    return q > -ROUNDING


class Yield(NamedTuple):
    """What yielding solids add to :class:`Relations`; arrays of shape (nx,).

    Attributes
    ----------
    depth
        delta, by which solids that face each other yield in the step.
    yielding
        Nodes where they do, of bool.
    depth_q, depth_w, oil_q, oil_w
        Derivatives of delta, and of `Relations.oil`, with respect to q and w.
    hardening
        Pressure that Newton's method is told to rise with what q and w would carry over the yield pressure.
    """

    depth: np.ndarray
    yielding: np.ndarray
    depth_q: np.ndarray
    depth_w: np.ndarray
    oil_q: np.ndarray
    oil_w: np.ndarray
    hardening: float = 0.0


class Relations(NamedTuple):
    """What q and w mean at every node, with derivatives; arrays of shape (nx,).

    Attributes
    ----------
    oil
        What the oil's flow knows of q: its pressure or, negative, its void fraction.
    pressure, film
        Total pressure p; film h, of which the oil's flow knows.
    p_q, p_w, h_w
        Derivatives of p with respect to q and w, of h with respect to w.
    touching
        Nodes whose solids carry, of bool.
    plastic : Yield or None
        None where solids are elastic.
    """

    oil: np.ndarray
    pressure: np.ndarray
    film: np.ndarray
    p_q: np.ndarray
    p_w: np.ndarray
    h_w: np.ndarray
    touching: np.ndarray
    plastic: Yield | None = None

    @property
    def separation(self):
        """Film less what the solids have yielded: what shape and elastic deflection give."""
        return self.film if self.plastic is None else self.film - self.plastic.depth

    @property
    def separation_q(self):
        """Derivative of the separation with respect to q."""
        return np.zeros_like(self.film) if self.plastic is None else -self.plastic.depth_q

    @property
    def separation_w(self):
        """Derivative of the separation with respect to w."""
        return self.h_w if self.plastic is None else self.h_w - self.plastic.depth_w

    def changes(self, nodes):
        """Changes of oil, pressure, film and separation with q and w.

        Parameters
        ----------
        nodes : ndarray, shape (nodes, 2)
            Changes of q and w at the nodes of the relations.

        Returns
        -------
        oil, pressure, film, separation : ndarray
        """
        oil, pressure, film = elastic_changes(self.p_q, self.p_w, self.h_w, nodes)
        if self.plastic is None:
            return oil, pressure, film, film
        y, (v_q, v_w) = self.plastic, nodes.T
        return y.oil_q * v_q + y.oil_w * v_w, pressure, film, film - (y.depth_q * v_q + y.depth_w * v_w)


@compiled
def elastic_changes(p_q, p_w, h_w, nodes):
    """Changes of q, pressure and film, see :meth:`Relations.changes`."""
    q, pressure, film = np.empty(len(nodes)), np.empty(len(nodes)), np.empty(len(nodes))
    for i in range(len(nodes)):
        q[i], w = nodes[i, 0], nodes[i, 1]
        pressure[i] = p_q[i] * q[i] + p_w[i] * w
        film[i] = h_w[i] * w
    return q, pressure, film


class DirectContact:
    """The film is the second unknown, bounded below by `bound` (a^2/R); `dry`: q is the pressure as it is.

    Attributes
    ----------
    near : float
        Films above the bound that the solver does not tell from it, in a^2/R; it sets its own.
    """

    is_mixed = yields = False

    def __init__(self, bound, dry):
        self.bound, self.dry = bound, dry
        self.thinnest = bound
        self.near = 0.0

    def pressure(self, q, w):
        """Total pressure in p0."""
        return q if self.dry else np.maximum(q, 0.0)

    def relations(self, q, w):
        """See :class:`Relations`."""
        pressure, p_q = self.pressure(q, w), np.ones(len(q)) if self.dry else full_of_oil(q) * 1.0
        return Relations(q, pressure, w, p_q, np.zeros(len(w)), np.ones(len(w)), w <= self.bound)

    def in_contact(self, w, imbalance):
        """Nodes that a solution leaves out of Reynolds' equation: at the bound, or near it with F > 0."""
        return (w <= self.bound) | ((w <= self.bound + self.near) & (imbalance > 0.0))

    def contact_pressure(self, w):
        """Not known apart from the oil's: zero."""
        return np.zeros_like(w)

    def from_film(self, h):
        """The second unknown of an open gap."""
        return np.maximum(h, self.bound)

    def second_unknown(self, h, contact_pressure):
        """The second unknown of a film, whatever pressure the solids had."""
        return self.from_film(h)


class MixedContact:
    """Oil and solids carry side by side.

    Parameters
    ----------
    boundary_film : float
        h_b in a^2/R.
    stiffness : float
        K, p0 per a^2/R: a scale between the two meanings of w, which no answer depends on.
    """

    is_mixed, yields = True, False

    def __init__(self, boundary_film, stiffness):
        self.boundary_film, self.stiffness = boundary_film, stiffness
        self.thinnest = boundary_film

    def pressure(self, q, w):
        """Total pressure in p0."""
        return self._elastic_pressure(q, w)

    def relations(self, q, w):
        """See :class:`Relations`."""
        touching, pressure = w < 0.0, self._elastic_pressure(q, w)
        p_w = np.where(touching, -self.stiffness, 0.0)
        film = self.boundary_film + np.maximum(w, 0.0)
        return Relations(q, pressure, film, full_of_oil(q) * 1.0, p_w, np.where(touching, 0.0, 1.0), touching)

    def in_contact(self, w, imbalance):
        """Nodes whose solids carry, of a solution."""
        return w < 0.0

    def _elastic_pressure(self, q, w):
        return np.maximum(q, 0.0) + self._carried(w)

    def _carried(self, w):
        return self.stiffness * np.maximum(-w, 0.0)

    def contact_pressure(self, w):
        """Pressure of the solids in p0."""
        return self._carried(w)

    def from_film(self, h):
        """The second unknown of an open gap; none where the film is below the boundary film."""
        return np.maximum(h - self.boundary_film, 0.0)

    def second_unknown(self, h, contact_pressure):
        """The second unknown of a film and the solids' pressure in p0."""
        return np.where(contact_pressure > 0.0, -contact_pressure / self.stiffness, self.from_film(h))
