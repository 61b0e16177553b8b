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
        self.told = 4 * self.terms + 3
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

    def tell(self, pressure):
        """What this part tells of its own pressures, shape (told,)."""
        told, outer = np.zeros(self.told), np.zeros(self.terms)
        moments = told[: 4 * self.terms].reshape(4, self.terms)
        for k, there, towards in ((0, self.on_right, pressure[::-1]), (1, self.on_left, pressure)):
            if there:
                add_moments(towards[HALO:], self.decay, moments[k])
                outer[:] = 0.0
                add_moments(towards[:HALO], self.decay, outer)
                moments[k + 2] = self._fade * moments[k] + outer
        told[-3:] = self.deflection.sums(pressure)
        return told

    def outside(self, told):
        """What all others do to this part.

        Parameters
        ----------
        told : ndarray, shape (parts, told)

        Returns
        -------
        deflection.Outside
        """
        moments = (told[:, :-3].reshape(-1, 4, self.terms) * self._shares).sum(axis=0)
        moments = self.weights * (moments[:2] + moments[2:])
        curvature = np.zeros(self.deflection.last - self.deflection.first)
        for there, moment, rows in (
            (self.on_left, moments[0], curvature),
            (self.on_right, moments[1], curvature[::-1]),
        ):
            if there:
                add_terms(moment, self.decay, rows)
        sums = told[:, -3:]
        return Outside(curvature, sums.sum(axis=0) - sums[self.part])


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
