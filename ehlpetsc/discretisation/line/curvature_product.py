r"""The product of the deflection's kernel with pressures, block by block, in a time that grows as the nodes.

The kernel of the differential deflection is a Laplace transform,

.. math:: f_k=\int_0^\infty t\Big(\frac{\sinh(t/2)}{t/2}\Big)^4e^{-kt}\,dt,\quad k\ge2,

for :math:`f=-\delta^4P`, :math:`P(x)=\frac{x^2}2\ln x-\frac34x^2`, with
:math:`P^{(4)}=-1/x^2=-\int_0^\infty te^{-xt}dt` and :math:`\delta^4e^{-xt}=(2\sinh(t/2))^4e^{-xt}`. A
quadrature of this integral makes it a sum of M exponentials,

.. math:: f_{s+d}=\sum_mw_me^{-\lambda_md},\quad d\ge0.

The mesh is a row of blocks of `BLOCK` nodes. A block and its two neighbours act on each other by the kernel
itself, blocks beyond by M moments of their pressures, which decay from one block to the next. Nearly all of
it is two products of matrices; it takes less than half the time of a Fourier transform.

A rank has some of the blocks. The outer ones receive from other ranks what they would receive from blocks on
the same rank: the sums over the neighbour's outer block, and moments.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ehlpetsc.base.compiled import compiled

BLOCK = 16  # nodes
TOLERANCE = 1e-11  # of the kernel
MIN_TERMS = 4
LINEAR_RATES = 16.0  # over the longest distance: up to them the quadrature is in t, beyond in log t
CUT_OFF = 2.7  # rates end where the integrand has fallen to exp(-CUT_OFF) times the tolerance
SAMPLES = 600  # distances in geometric progression at which the error is measured


def exponentials(
    kernel: np.ndarray, nearest: int, tolerance: float = TOLERANCE
) -> tuple[np.ndarray, np.ndarray]:
    r"""Kernel of the differential deflection as a sum of exponentials, from a distance on.

    Gauss-Legendre quadrature in :math:`v=\ln(1+t/a)`, in which the integrand is an entire function.

    `kernel`: :func:`ehlpetsc.elasticity.half_plane.curvature_kernel`, shape (n,).
    `nearest`: first distance represented, at least 3.
    `tolerance`: relative error, at least 1e-11: the kernel itself is rounded.

    Returns rates and weights, shape (terms,): ``kernel[nearest + d]`` is ``weights @ exp(-rates * d)``, with
    as few terms as give the tolerance; no terms for a kernel that ends before `nearest`.
    """
    far = kernel[nearest:]
    if len(far) == 0:
        return np.zeros(0), np.zeros(0)
    sampled = np.unique(np.geomspace(1, len(far), SAMPLES).astype(int)) - 1
    a, fastest = LINEAR_RATES / len(kernel), (CUT_OFF - np.log(tolerance)) / (nearest - 2)
    length = np.log1p(fastest / a)
    terms, error = MIN_TERMS, np.inf
    while error >= tolerance:
        abscissae, weights = np.polynomial.legendre.leggauss(terms)
        t = a * np.expm1(0.5 * length * (1.0 + abscissae))
        weights = weights * 0.5 * length * (a + t) * t * (np.sinh(0.5 * t) / (0.5 * t)) ** 4
        weights *= np.exp(-nearest * t)
        error = np.abs(np.exp(-np.outer(sampled, t)) @ weights / far[sampled] - 1.0).max()
        terms += 1
    return t, weights


class Blocks(NamedTuple):
    r"""Product :math:`\sum_kf_kp_{i+k}` over the nodes of the mesh, at the blocks of one rank.

    `matrices`: sums at a block, its right and its left neighbour and moments to both sides, by its pressures,
        shape (BLOCK, 3 BLOCK + 2 terms); sums by the moments that arrive, (2 terms, BLOCK); factor of a
        moment a block further, (terms,); factors of every rank's moments (inner blocks, outer block) at the
        outer block of this rank, (ranks, 2, terms).
    `room`: pressures of the blocks; sums and moments by them; the others as of :func:`scan_moments`.
    """

    rank: int
    matrices: tuple
    room: tuple

    @classmethod
    def of(
        cls,
        kernel: np.ndarray,
        cuts: Sequence[int] | None = None,
        rank: int = 0,
        tolerance: float = TOLERANCE,
    ) -> Blocks:
        """Blocks of a rank.

        `kernel`: f at distances of 0 .. n-1 nodes, shape (n,).
        `cuts`: first nodes of all ranks, multiples of `BLOCK`, and n; by default one rank has the mesh.
        `tolerance`: relative error of f beyond `BLOCK` nodes.
        """
        cuts = (0, len(kernel)) if cuts is None else cuts
        rates, weights = exponentials(kernel, BLOCK + 1, tolerance)
        blocks, terms = -((cuts[rank] - cuts[rank + 1]) // BLOCK), len(rates)
        to_the_end = np.arange(BLOCK)[::-1, None]
        moments = [np.exp(-rates * to_the_end), np.exp(-rates * to_the_end[::-1])]
        matrices = (
            np.hstack([*_near(kernel), *moments]),
            np.concatenate([(weights * moment).T for moment in moments[::-1]]),
            np.exp(-BLOCK * rates),
            _translation(cuts, rank, rates),
        )
        sent, incoming = np.empty((blocks, 3 * BLOCK + 2 * terms)), np.zeros((2, 2, terms))
        return cls(
            rank, matrices, (np.zeros((blocks, BLOCK)), sent, incoming, np.empty((blocks + 2, 2 * terms)))
        )

    @property
    def message_size(self) -> int:
        """Numbers that a rank sends: one half for ranks on its right, one for those on its left.

        Each has the sums over the outer block at the block beyond, the moments of all other blocks, and those
        of the outer one.
        """
        return 2 * (BLOCK + 2 * len(self.matrices[2]))


def _near(kernel: np.ndarray) -> list[np.ndarray]:
    """Matrices of the sums over a block at itself, at the block on its right and at that on its left."""
    padded = np.zeros(2 * BLOCK)
    padded[: len(kernel)] = kernel[: 2 * BLOCK]
    offset = np.arange(BLOCK) - np.arange(BLOCK)[:, None]
    return [padded[np.abs(offset + shift)] for shift in (0, BLOCK, -BLOCK)]


def _translation(cuts: Sequence[int], rank: int, rates: np.ndarray) -> np.ndarray:
    factors = np.zeros((len(cuts) - 1, 2, len(rates)))
    for other in range(len(factors)):
        if abs(other - rank) == 1:  # its outer block reaches this one by the kernel
            factors[other, 0] = 1.0
        elif other != rank:
            left, right = sorted((other, rank))
            factors[other, 1] = np.exp(-rates * (cuts[right] - cuts[left + 1] - BLOCK))
            factors[other, 0] = np.exp(-BLOCK * rates) * factors[other, 1]
    return factors


def product(blocks: Blocks, pressure: np.ndarray) -> np.ndarray:
    """Sums on one rank, from the pressures (n,) of the mesh."""
    messages = np.empty((1, 1 + blocks.message_size))[:, 1:]  # as from other ranks, behind their loads
    pack(*blocks, pressure, messages[0])
    return unpack(*blocks, messages)[: len(pressure)]


@compiled
def pack(rank: int, matrices: tuple, room: tuple, pressure: np.ndarray, message: np.ndarray) -> None:
    """Begin the product with the pressures of this rank, and fill in its message to the others."""
    of_pressures, _, decay, _ = matrices
    pressures, near_and_moments, incoming, arriving = room
    for b in range(len(pressures)):  # numba takes long to compile assignments of slices
        begin = b * BLOCK
        for i in range(min(BLOCK, len(pressure) - begin)):
            pressures[b, i] = pressure[begin + i]
    np.dot(pressures, of_pressures, near_and_moments)
    terms, half, last = len(decay), len(message) // 2, len(near_and_moments) - 1
    for m in range(terms):
        for k in range(2):
            incoming[0, k, m] = incoming[1, k, m] = 0.0
    scan_moments(near_and_moments, decay, incoming, arriving)
    for k in range(BLOCK):
        message[k] = near_and_moments[last, BLOCK + k]
        message[half + k] = near_and_moments[0, 2 * BLOCK + k]
    for m in range(terms):
        message[BLOCK + m] = arriving[len(arriving) - 1, m]
        message[half + BLOCK + m] = arriving[0, terms + m]
        message[BLOCK + terms + m] = near_and_moments[last, 3 * BLOCK + m]
        message[half + BLOCK + terms + m] = near_and_moments[0, 3 * BLOCK + terms + m]


@compiled
def unpack(rank: int, matrices: tuple, room: tuple, messages: np.ndarray) -> np.ndarray:
    """Sums at the nodes of all blocks of this rank, from the messages of all ranks, one in each row."""
    _, of_moments, decay, translation = matrices
    _, near_and_moments, incoming, arriving = room
    ranks, last = len(messages), len(near_and_moments) - 1
    half = messages.shape[1] // 2
    if ranks > 1:
        receive_moments(messages, rank, translation, incoming)
        scan_moments(near_and_moments, decay, incoming, arriving)
    sums = np.dot(arriving[1:-1], of_moments)
    for b in range(last + 1):
        for i in range(BLOCK):
            sums[b, i] += near_and_moments[b, i]
    for b in range(1, last + 1):
        for i in range(BLOCK):
            sums[b, i] += near_and_moments[b - 1, BLOCK + i]
            sums[b - 1, i] += near_and_moments[b, 2 * BLOCK + i]
    for i in range(BLOCK):
        if rank > 0:
            sums[0, i] += messages[rank - 1, i]
        if rank < ranks - 1:
            sums[last, i] += messages[rank + 1, half + i]
    return sums.ravel()


@compiled
def receive_moments(messages: np.ndarray, rank: int, translation: np.ndarray, incoming: np.ndarray) -> None:
    """Sum up the moments that arrive from all other ranks."""
    terms = translation.shape[2]
    for other in range(len(messages)):
        if other != rank:
            side = 0 if other < rank else 1  # on which this rank receives it
            inner = side * (BLOCK + 2 * terms) + BLOCK
            for m in range(terms):
                moments = messages[other, inner + m], messages[other, inner + terms + m]
                incoming[side, 0, m] += translation[other, 0, m] * moments[0]
                incoming[side, 0, m] += translation[other, 1, m] * moments[1]
                if abs(other - rank) == 1:
                    incoming[side, 1, m] = moments[1]


@compiled
def scan_moments(sent: np.ndarray, decay: np.ndarray, incoming: np.ndarray, arriving: np.ndarray) -> None:
    """Fill in the moments that arrive at each block from blocks two and more away.

    `sent`: its last columns are the moments that each block sends to the right and to the left, shape
        (blocks, 3 BLOCK + 2 terms).
    `decay`: factor of a moment a block further, shape (terms,).
    `incoming`: from left and from right: what arrives at the outer block, and what is added at the block
        behind it, shape (2, 2, terms).
    `arriving`: of the blocks and of one beyond either end, shape (blocks + 2, 2 terms).
    """
    blocks, terms = len(sent), len(decay)
    to_right, to_left = 3 * BLOCK, 3 * BLOCK + terms
    for m in range(terms):
        arriving[0, m] = arriving[blocks + 1, terms + m] = 0.0
        arriving[1, m], arriving[blocks, terms + m] = incoming[0, 0, m], incoming[1, 0, m]
        arriving[2, m] = decay[m] * arriving[1, m] + incoming[0, 1, m]
        arriving[blocks - 1, terms + m] = decay[m] * arriving[blocks, terms + m] + incoming[1, 1, m]
    for b in range(2, blocks + 1):
        back = blocks - 1 - b
        for m in range(terms):
            arriving[b + 1, m] = decay[m] * arriving[b, m] + sent[b - 2, to_right + m]
            arriving[back + 1, terms + m] = (
                decay[m] * arriving[back + 2, terms + m] + sent[back + 2, to_left + m]
            )
