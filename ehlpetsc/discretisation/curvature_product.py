r"""The product of the deflection's kernel with pressures, block by block, in a time that grows as the nodes.

The kernel of the differential deflection falls as :math:`1/k^2`, which is a Laplace transform: beyond a
distance it is a sum of M exponentials to 1e-11 of its value,

.. math:: f_{s+d}=\sum_mw_me^{-\lambda_md},\quad d\ge0.

The mesh is cut into blocks of `BLOCK` nodes. A block and its two neighbours act on each other by the kernel
as it is, blocks beyond by M moments of their pressures, which fade from one block to the next. Nearly all of
it is two products of matrices; it takes less than half the time of a Fourier transform.
"""

import numpy as np

from ehlpetsc.compiled import compiled

BLOCK = 32  # nodes
TOLERANCE = 1e-11  # of the kernel
SLOWEST, FASTEST = 0.7, 20.0  # rates: over the whole mesh, over what is taken exactly
TERMS = range(8, 65, 2)
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
        or as nearly as rounding allows; no terms for a kernel that ends before.
    """
    far, best = kernel[nearest:], (np.inf, np.zeros(0), np.zeros(0))
    if len(far) == 0:
        return best[1:]
    some = np.unique(np.geomspace(1, len(far), SAMPLES).astype(int)) - 1
    for terms in TERMS:
        rates = np.geomspace(SLOWEST / len(far), FASTEST / (nearest - 1), terms)
        basis = np.exp(-np.outer(some, rates)) / far[some, None]
        weights = np.linalg.lstsq(basis, np.ones(len(some)), rcond=1e-15)[0]
        error = np.abs(basis @ weights - 1.0).max()
        best = min(best, (error, rates, weights), key=lambda fit: fit[0])
        if error < TOLERANCE:
            break
    return best[1:]


class CurvatureProduct:
    r"""Sums :math:`\sum_kf_kp_{i+k}` over the nodes of a mesh, or of a part of it.

    Parameters
    ----------
    kernel : ndarray, shape (n,)
        f at distances of 0 .. n-1 nodes.
    """

    def __init__(self, kernel):
        self.n, blocks = len(kernel), -(-len(kernel) // BLOCK)
        rates, weights = exponentials(kernel, BLOCK + 1)
        self._fade, terms = np.exp(-BLOCK * rates), len(rates)
        self._of_pressures = np.hstack([*self._near(kernel), *self._moments(rates)])
        self._of_moments = np.concatenate([(weights * shares).T for shares in self._moments(rates)[::-1]])
        self._pressures, self._sums = np.zeros((blocks, BLOCK)), np.empty((blocks, BLOCK))
        self._near_and_moments = np.empty((blocks, 3 * BLOCK + 2 * terms))
        self._arriving = np.zeros((blocks, 2 * terms))

    @staticmethod
    def _near(kernel):
        """What a block does to itself, to the block on its right and to that on its left."""
        known = np.zeros(2 * BLOCK)
        known[: len(kernel)] = kernel[: 2 * BLOCK]
        apart = np.arange(BLOCK) - np.arange(BLOCK)[:, None]
        return [known[np.abs(apart + shift)] for shift in (0, BLOCK, -BLOCK)]

    @staticmethod
    def _moments(rates):
        """What a block's pressures count in the moments that it sends to the right and to the left."""
        to_the_end = np.arange(BLOCK)[::-1, None]
        return [np.exp(-rates * to_the_end), np.exp(-rates * to_the_end[::-1])]

    def __call__(self, pressure):
        """Sums for `pressure` (n,), shape (n,)."""
        self._pressures.ravel()[: self.n] = pressure
        np.dot(self._pressures, self._of_pressures, out=self._near_and_moments)
        moments_arriving(self._near_and_moments, self._fade, self._arriving)
        np.dot(self._arriving, self._of_moments, out=self._sums)
        add_near(self._near_and_moments, self._sums)
        return self._sums.ravel()[: self.n].copy()


@compiled
def moments_arriving(sent, fade, arriving):
    """Fill in the moments that arrive at each block from left and right, of blocks two and more away.

    Parameters
    ----------
    sent : ndarray, shape (blocks, 3 BLOCK + 2 terms)
        Its last columns are the moments that each block sends to the right and to the left.
    fade : ndarray, shape (terms,)
        What is left of a moment a block further.
    arriving : ndarray, shape (blocks, 2 terms)
        Zero at first.
    """
    blocks, terms = len(sent), len(fade)
    to_right, to_left = sent.shape[1] - 2 * terms, sent.shape[1] - terms
    for b in range(2, blocks):
        for m in range(terms):
            arriving[b, m] = fade[m] * arriving[b - 1, m] + sent[b - 2, to_right + m]
    for b in range(blocks - 3, -1, -1):
        for m in range(terms):
            arriving[b, terms + m] = fade[m] * arriving[b + 1, terms + m] + sent[b + 2, to_left + m]


@compiled
def add_near(near, sums):
    """Add what blocks do to themselves and to their neighbours: columns of `near` one block wide each."""
    blocks, width = sums.shape
    for b in range(blocks):
        for i in range(width):
            sums[b, i] += near[b, i]
    for b in range(1, blocks):
        for i in range(width):
            sums[b, i] += near[b - 1, width + i]
            sums[b - 1, i] += near[b, 2 * width + i]
