r"""What far pressures do to a part of the mesh, told by moments of them.

From `HALO` nodes on the kernel of the differential deflection is a sum of M exponentials
(:mod:`.curvature_product`), 24 to 36 of them for 300 to 13,000 nodes,

.. math:: f_{H+1+d}=\sum_mw_me^{-\lambda_md},\quad d\ge0,

and all pressures to the left of a part's window enter its rows by M moments,

.. math:: \sum_{j<s}f_{i-j}\,p_j=\sum_mw_me^{-\lambda_m(i-first)}A_m,\quad
   A_m=\sum_{j<s}p_je^{-\lambda_m(s-1-j)},\quad s=first-H,

those to the right by as many. Every part tells the moments of its own nodes; each adds up what the others
tell.
"""

import numpy as np

from ehlpetsc.compiled import compiled
from ehlpetsc.discretisation.curvature_product import exponentials
from ehlpetsc.discretisation.deflection import HALO, Outside

SUMS = 3  # of :meth:`.deflection.Deflection.sums`
LEFT_OVER = -40.0  # logarithm of a share that is next to nothing


class FarPressures:
    """Moments of one part, and what those of all others do to it.

    Parameters
    ----------
    deflection : deflection.Deflection
        Of this part.
    cuts : sequence of int
        First nodes of all parts, and the number of nodes.
    part : int

    Attributes
    ----------
    told : int
        Numbers that a part tells: to its right and to its left the moments without the outer nodes, which its
        neighbour knows, and with them; and its sums.
    """

    def __init__(self, deflection, cuts, part):
        self.deflection = d = deflection
        self.part = part
        self.rates, self.weights = exponentials(d.curvature, HALO + 1)
        self.terms, self.decay = len(self.rates), np.exp(-self.rates)
        self.told = 4 * self.terms + SUMS
        self.on_left, self.on_right = part > 0, part < len(cuts) - 2  # is there another part
        self._fade = np.exp(-self.rates * HALO)
        self._shares = self._shares_of(cuts, part)

    def _shares_of(self, cuts, part):
        """By what the moments told by every part count here, shape (parts, 4, terms)."""
        parts = len(cuts) - 1
        shares = np.zeros((parts, 4, self.terms))
        for other in range(parts):
            beside = abs(other - part) == 1
            if other < part:
                gap = 0 if beside else cuts[part] - HALO - cuts[other + 1]
                shares[other, 0 if beside else 2] = np.exp(-self.rates * gap)
            elif other > part:
                gap = 0 if beside else cuts[other] - HALO - cuts[part + 1]
                shares[other, 1 if beside else 3] = np.exp(-self.rates * gap)
        return shares

    def tell(self, pressure, told):
        """Fill in what this part tells of its own pressures, shape (told,)."""
        sides = self.on_right, self.on_left
        fill_in_told(pressure, sides, self.decay, self._fade, self.deflection.under_sums, told)

    def outside(self, told):
        """What all others do to this part.

        Parameters
        ----------
        told : ndarray, shape (parts, told)

        Returns
        -------
        deflection.Outside
        """
        outside = Outside(np.empty(self.deflection.last - self.deflection.first), np.empty(SUMS))
        sides = self.on_left, self.on_right
        fill_in_outside(told, self.part, self._shares, sides, self.weights, self.decay, *outside)
        return outside


@compiled
def fill_in_told(pressure, sides, decay, fade, under_sums, told):
    """Fill in moments and sums, see :meth:`FarPressures.tell`.

    Parameters
    ----------
    pressure : ndarray, shape (nodes,)
    sides : pair of bool
        Is there another part to the right, to the left.
    decay, fade : ndarray, shape (terms,)
        What is left of a moment a node and `HALO` nodes further.
    under_sums : ndarray, shape (3, nodes)
    told : ndarray, shape (4 terms + 3,)
    """
    terms = len(decay)
    told[:] = 0.0
    for k in range(2):
        if sides[k]:
            towards = pressure[::-1] if k == 0 else pressure[::1]
            inner, all_of_it = told[k * terms : (k + 1) * terms], told[(k + 2) * terms : (k + 3) * terms]
            add_moments(towards[HALO:], decay, inner)
            add_moments(towards[:HALO], decay, all_of_it)
            for m in range(terms):
                all_of_it[m] += fade[m] * inner[m]
    for k in range(len(under_sums)):
        for node in range(len(pressure)):
            told[4 * terms + k] += under_sums[k, node] * pressure[node]


@compiled
def fill_in_outside(told, part, shares, sides, weights, decay, curvature, sums):
    """Fill in curvature and sums, see :meth:`FarPressures.outside`.

    Parameters
    ----------
    told : ndarray, shape (parts, 4 terms + 3)
    part : int
    shares : ndarray, shape (parts, 4, terms)
    sides : pair of bool
        Is there another part to the left, to the right.
    weights, decay : ndarray, shape (terms,)
    curvature : ndarray, shape (nodes,)
    sums : ndarray, shape (3,)
    """
    terms, moments = len(decay), np.empty(len(decay))
    curvature[:], sums[:] = 0.0, 0.0
    for k in range(2):
        if sides[k]:
            moments[:] = 0.0
            for other in range(len(told)):
                for m in range(terms):
                    moments[m] += shares[other, k, m] * told[other, k * terms + m]
                    moments[m] += shares[other, k + 2, m] * told[other, (k + 2) * terms + m]
            add_terms(weights * moments, decay, curvature[::1] if k == 0 else curvature[::-1])
    for other in range(len(told)):
        if other != part:
            sums += told[other, 4 * terms :]


@compiled(fastmath={"contract"})
def add_moments(pressure, decay, moments):
    """Add to the moments, shape (terms,), sums over pressures times ``decay**distance``, the first at 0.

    Four nodes at once, since each product waits for the one before; none beyond which nothing is left.
    """
    for m in range(len(decay)):
        d = decay[m]
        d4 = d**4
        reach = min(len(pressure), int(LEFT_OVER / np.log(d)) + 1)
        blocks = reach // 4
        a0 = a1 = a2 = a3 = 0.0
        for j in range(reach - 1, 4 * blocks - 1, -1):
            a0 = a0 * d + pressure[j]
        for b in range(blocks - 1, -1, -1):
            j = 4 * b
            a0 = a0 * d4 + pressure[j]
            a1 = a1 * d4 + pressure[j + 1]
            a2 = a2 * d4 + pressure[j + 2]
            a3 = a3 * d4 + pressure[j + 3]
        moments[m] += a0 + d * (a1 + d * (a2 + d * a3))


@compiled(fastmath={"contract"})
def add_terms(moments, decay, rows):
    """Add to the rows the sums of exponentials ``moments * decay**distance``, as :func:`add_moments` does."""
    for m in range(len(decay)):
        d, s = decay[m], moments[m]
        d2, d4 = d * d, d**4
        reach = min(len(rows), int(LEFT_OVER / np.log(d)) + 1)
        blocks = reach // 4
        for b in range(blocks):
            i = 4 * b
            rows[i] += s
            rows[i + 1] += s * d
            rows[i + 2] += s * d2
            rows[i + 3] += s * d2 * d
            s *= d4
        for i in range(4 * blocks, reach):
            rows[i] += s
            s *= d
