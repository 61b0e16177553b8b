r"""What far pressures do to a part of the mesh, told by moments of them.

The kernel of the differential deflection falls as :math:`1/k^2`, which is a Laplace transform: from `HALO`
nodes on it is a sum of M exponentials to 1e-11 of its value, 24 to 36 of them for 300 to 13,000 nodes,

.. math:: f_{H+1+d}=\sum_mw_me^{-\lambda_md},\quad d\ge0,

and all pressures to the left of a part's window enter its rows by M moments,

.. math:: \sum_{j<s}f_{i-j}\,p_j=\sum_mw_me^{-\lambda_m(i-first)}A_m,\quad
   A_m=\sum_{j<s}p_je^{-\lambda_m(s-1-j)},\quad s=first-H,

those to the right by as many. Every part tells the moments of its own nodes; each adds up what the others
tell.
"""

import numpy as np

from ehlpetsc.discretisation.deflection import HALO, Outside

TOLERANCE = 1e-11  # of the kernel
SLOWEST, FASTEST = 0.7, 20.0  # rates: over the whole mesh, over the halo
TERMS = range(16, 65, 4)
SAMPLES = 600  # of the kernel that the fit is made on, at distances in geometric progression


def exponentials(kernel, nearest):
    """Rates and weights for a kernel from a distance on.

    Parameters
    ----------
    kernel : ndarray, shape (n,)
    nearest : int
        First distance that counts.

    Returns
    -------
    rates, weights : ndarray, shape (terms,)
        ``kernel[nearest + d]`` is ``weights @ exp(-rates * d)`` to `TOLERANCE` with as few terms as possible,
        or as nearly as rounding allows.
    """
    far, best = kernel[nearest:], (np.inf,)
    some = np.unique(np.geomspace(1, len(far), SAMPLES).astype(int)) - 1
    for terms in TERMS:
        rates = np.geomspace(SLOWEST / len(far), FASTEST / HALO, terms)
        basis = np.exp(-np.outer(some, rates)) / far[some, None]
        weights = np.linalg.lstsq(basis, np.ones(len(some)), rcond=1e-15)[0]
        error = np.abs(basis @ weights - 1.0).max()
        best = min(best, (error, rates, weights), key=lambda fit: fit[0])
        if error < TOLERANCE:
            break
    return best[1:]


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
        self.deflection, d = deflection, deflection
        self.part, parts, local = part, len(cuts) - 1, d.last - d.first
        self.rates, weights = exponentials(d.curvature, HALO + 1)
        self.terms = len(self.rates)
        self.told = 4 * self.terms + 3
        falling = np.exp(-np.outer(self.rates, np.arange(local)))
        sides = [part > 0, part < parts - 1]  # is there anything to the left, to the right
        received = [weights * falling.T, weights * falling.T[::-1]]
        self._received = [rows.copy() if there else None for rows, there in zip(received, sides, strict=True)]
        inner = falling[:, : local - HALO]
        telling = [inner, inner[:, ::-1]]
        self._telling = [rows.copy() if there else None for rows, there in zip(telling, sides, strict=True)]
        self._outer = falling[:, :HALO]
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
        told, to_left, to_right = np.zeros(self.told), *self._telling
        moments = told[: 4 * self.terms].reshape(4, self.terms)
        if to_right is not None:
            moments[0] = to_right @ pressure[:-HALO]
            moments[2] = self._fade * moments[0] + self._outer @ pressure[: -HALO - 1 : -1]
        if to_left is not None:
            moments[1] = to_left @ pressure[HALO:]
            moments[3] = self._fade * moments[1] + self._outer @ pressure[:HALO]
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
        curvature = 0.0
        for k, received in enumerate(self._received):
            if received is not None:
                curvature = curvature + received @ (moments[k] + moments[k + 2])
        sums = told[:, -3:]
        return Outside(curvature, sums.sum(axis=0) - sums[self.part])
