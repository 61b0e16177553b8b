r"""What far pressures do to a part of the mesh, told by moments of them.

From `HALO` nodes on the kernel of the differential deflection is a sum of M exponentials
(:mod:`.curvature_product`), 24 to 36 of them for 300 to 13,000 nodes,

.. math:: f_{H+1+d}=\sum_mw_me^{-\lambda_md},\quad d\ge0,

and all pressures to the left of a part's window enter its rows by M moments,

.. math:: \sum_{j<s}f_{i-j}\,p_j=\sum_mw_me^{-\lambda_m(i-first)}A_m,\quad
   A_m=\sum_{j<s}p_je^{-\lambda_m(s-1-j)},\quad s=first-H,

those to the right by as many. Every part tells the moments of its own nodes; each adds up what the others
tell. Nodes are taken in blocks: most of it is one product of matrices.
"""

import numpy as np

from ehlpetsc.compiled import compiled
from ehlpetsc.discretisation.curvature_product import BLOCK, exponentials
from ehlpetsc.discretisation.deflection import HALO, Outside

SUMS = 3  # of :meth:`.deflection.Deflection.sums`


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
        self.rates, self.weights = exponentials(d.curvature, HALO + 1)
        self.terms, local = len(self.rates), d.last - d.first
        self.told = 4 * self.terms + SUMS
        self.on_left, self.on_right = part > 0, part < len(cuts) - 2  # is there another part
        self._others = np.arange(len(cuts) - 1) != part
        self._shares = self._shares_of(cuts, part)
        self._of_node = np.exp(-self.rates * np.arange(BLOCK)[:, None])
        self._by_term = self._of_node.T.copy()
        self._over_halo, self._over_block = np.exp(-self.rates * HALO), np.exp(-self.rates * BLOCK)
        blocks = -(-local // BLOCK)
        self._pressures, self._moments = np.zeros((blocks, BLOCK)), np.empty((blocks, self.terms))

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
        """Fill in `told`, shape (told,), by the local pressures."""
        told[:] = 0.0
        moments = told[: 4 * self.terms].reshape(4, self.terms)
        if self.on_right:
            self._fill_in(pressure[::-1], moments[0], moments[2])
        if self.on_left:
            self._fill_in(pressure, moments[1], moments[3])
        told[4 * self.terms :] = self.deflection.sums(pressure)

    def _fill_in(self, pressure, inner, whole):
        """Moments at the first node of pressures without the `HALO` first ones, and of all."""
        self._pressures.ravel()[: len(pressure) - HALO] = pressure[HALO:]
        np.dot(self._pressures, self._of_node, out=self._moments)
        add_up(self._moments, self._over_block, inner)
        whole[:] = pressure[:HALO] @ self._of_node[:HALO] + self._over_halo * inner

    def outside(self, told):
        """What all others do to this part.

        Parameters
        ----------
        told : ndarray, shape (parts, told)

        Returns
        -------
        deflection.Outside
        """
        terms, local = self.terms, self.deflection.last - self.deflection.first
        moments = (self._shares * told[:, : 4 * terms].reshape(self._shares.shape)).sum(axis=0)
        curvature = np.zeros(local)
        if self.on_left:
            curvature += self._sums(moments[0] + moments[2])[:local]
        if self.on_right:
            curvature += self._sums(moments[1] + moments[3])[local - 1 :: -1]
        return Outside(curvature, self._others @ told[:, 4 * terms :])

    def _sums(self, moments):
        """Of exponentials, at nodes one after the other; with those that fill up the last block."""
        fade(self.weights * moments, self._over_block, self._moments)
        return np.dot(self._moments, self._by_term).ravel()


@compiled
def add_up(of_blocks, over_block, moments):
    """Fill in the moments, shape (terms,), of all blocks by those of each, shape (blocks, terms).

    `over_block` (terms,) is what is left of a moment a block further.
    """
    moments[:] = 0.0
    for b in range(len(of_blocks) - 1, -1, -1):
        for m in range(len(moments)):
            moments[m] = moments[m] * over_block[m] + of_blocks[b, m]


@compiled
def fade(moments, over_block, of_blocks):
    """Fill in what is left of moments (terms,) at each block, shape (blocks, terms); changes `moments`."""
    for b in range(len(of_blocks)):
        for m in range(len(moments)):
            of_blocks[b, m] = moments[m]
            moments[m] *= over_block[m]
