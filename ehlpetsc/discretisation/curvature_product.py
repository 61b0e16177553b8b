r"""The product of the deflection's kernel with pressures, block by block, in a time that grows as the nodes.

The kernel of the differential deflection is a Laplace transform,

.. math:: f_k=\int_0^\infty t\Big(\frac{\sinh(t/2)}{t/2}\Big)^4e^{-kt}\,dt,\quad k\ge2,

for :math:`f=-\delta^4P`, :math:`P(x)=\frac{x^2}2\ln x-\frac34x^2`, with
:math:`P^{(4)}=-1/x^2=-\int_0^\infty te^{-xt}dt` and :math:`\delta^4e^{-xt}=(2\sinh(t/2))^4e^{-xt}`. A
quadrature of this integral makes it a sum of M exponentials,

.. math:: f_{s+d}=\sum_mw_me^{-\lambda_md},\quad d\ge0.

The mesh is cut into blocks of `BLOCK` nodes. A block and its two neighbours act on each other by the kernel
itself, blocks beyond by M moments of their pressures, which decay from one block to the next. Nearly all of
it is two products of matrices; it takes less than half the time of a Fourier transform.
"""

import itertools

import numpy as np

from ehlpetsc.compiled import compiled

BLOCK = 32  # nodes
TOLERANCE = 1e-11  # of the kernel
MIN_TERMS = 4
LINEAR_RATES = 16.0  # over the longest distance: up to them the quadrature is in t, beyond in log t
CUT_OFF = 2.7  # rates end where the integrand has fallen to exp(-CUT_OFF) times the tolerance
SAMPLES = 600  # distances in geometric progression at which the error is measured


def exponentials(kernel, nearest, tolerance=TOLERANCE):
    r"""Kernel of the differential deflection as a sum of exponentials, from a distance on.

    Gauss-Legendre quadrature in :math:`v=\ln(1+t/a)`, in which the integrand is an entire function.

    Parameters
    ----------
    kernel : ndarray, shape (n,)
        :func:`.elasticity.curvature_kernel`.
    nearest : int
        First distance represented, at least 3.
    tolerance : float
        Relative error, at least 1e-11: the kernel itself is rounded.

    Returns
    -------
    rates, weights : ndarray, shape (terms,)
        ``kernel[nearest + d]`` is ``weights @ exp(-rates * d)``, with as few terms as give the tolerance; no
        terms for a kernel that ends before `nearest`.
    """
    far = kernel[nearest:]
    if len(far) == 0:
        return np.zeros(0), np.zeros(0)
    some = np.unique(np.geomspace(1, len(far), SAMPLES).astype(int)) - 1
    a, fastest = LINEAR_RATES / len(kernel), (CUT_OFF - np.log(tolerance)) / (nearest - 2)
    length = np.log1p(fastest / a)
    for terms in itertools.count(MIN_TERMS):
        places, weights = np.polynomial.legendre.leggauss(terms)
        t = a * np.expm1(0.5 * length * (1.0 + places))
        weights = weights * 0.5 * length * (a + t) * t * (np.sinh(0.5 * t) / (0.5 * t)) ** 4
        weights *= np.exp(-nearest * t)
        if np.abs(np.exp(-np.outer(some, t)) @ weights / far[some] - 1.0).max() < tolerance:
            return t, weights


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
