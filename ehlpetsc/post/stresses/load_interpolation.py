"""Interpolation of the load between nodes: cubic Hermite pieces with slopes limited next to steep peaks.

The solution has loads at nodes; the stress of a body point also depends on the loads between them. Linear
interpolation reduces the peaks of short ripples. A spline does not, but next to a contact of one to three
nodes it overshoots by up to 14 % of the peak: tension on a surface under pressure. Here slopes are of sixth
order, limited to three times the smaller adjacent secant, which preserves monotonicity (Fritsch & Carlson
(1980), SIAM J. Numer. Anal. 17), or to the slopes of the adjacent parabolas if their curvatures have the
same sign: ripples of ten nodes are accurate to 5e-4 of their amplitude, and steep flanks do not overshoot.
"""

import numpy as np
from scipy import fft

from ehlpetsc.compiled import compiled
from ehlpetsc.post.stresses.half_plane import padded_length
from ehlpetsc.post.stresses.kernels import hat, point_kernels

NEAR_ELEMENTS = 24  # beyond, a kernel is smooth over an element and quadrature is exact
HATS_PER_ELEMENT = 64  # approximate the cubics of near elements to 2e-4 of a one-node peak
GAUSS_NODES, GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(6)


@compiled(error_model="python", nogil=True)
def _smaller(a, b):
    """Number nearer to zero, or zero if the signs differ."""
    nearer = a if abs(a) < abs(b) else b
    return nearer if a * b > 0.0 else 0.0


@compiled(error_model="python", nogil=True)
def _slopes_between(y, slopes):
    """Slopes of one row of values at all nodes but three at each end; without branches, for vectorisation."""
    y1, y2, y3, y4, y5, y6 = y[1:], y[2:], y[3:], y[4:], y[5:], y[6:]
    for i in range(y.size - 6):
        left, right = y3[i] - y2[i], y4[i] - y3[i]
        bend = right - left
        left_bend = _smaller(y1[i] - 2 * y2[i] + y3[i], bend)
        right_bend = _smaller(y3[i] - 2 * y4[i] + y5[i], bend)
        straight = 3 * _smaller(left, right)  # keeps monotone values monotone
        curved = 3 * _smaller(left + left_bend / 2, right - right_bend / 2)
        smooth = abs(_smaller(left_bend, right_bend))  # allows the top of a ripple between nodes
        high = 0.75 * (right + left) - 0.15 * (y5[i] - y1[i]) + (y6[i] - y[i]) / 60
        high = max(high, min(0.0, straight, curved, -smooth))
        slopes[i] = min(high, max(0.0, straight, curved, smooth))


@compiled(error_model="python", nogil=True)
def limited_slopes(loads, out):
    """Set out to the slopes per element of loads (rows, nodes); zero at the three nodes of each end."""
    nodes = loads.shape[1]
    for row in range(loads.shape[0]):
        out[row, :3], out[row, nodes - 3 :] = 0.0, 0.0
        _slopes_between(loads[row], out[row, 3:])


def _shapes(t):
    """Hermite shape functions of value and slope of a node, (2, n), at t in -1 .. 1 elements from it."""
    r = np.abs(t)
    return np.stack([(1 - r) ** 2 * (1 + 2 * r), t * (1 - r) ** 2])


def _near(u, z):
    t = np.arange(1 - HATS_PER_ELEMENT, HATS_PER_ELEMENT) / HATS_PER_ELEMENT
    distances = HATS_PER_ELEMENT * (u[:, None] - t).ravel()
    kernels = hat(distances, HATS_PER_ELEMENT * z).reshape(4, u.size, t.size)
    return kernels @ _shapes(t).T


def _far(u, z):
    half = (GAUSS_NODES + 1) / 2
    t = np.concatenate([-half, half])
    return point_kernels(u[:, None] - t, z) @ (np.tile(GAUSS_WEIGHTS / 2, 2) * _shapes(t)).T


def hermite_spectra(nx, z, offset):
    """Spectra of the kernels of the shape functions, -2/pi included, `offset` elements right of the nodes.

    z in elements. Shape (8, padded_length // 2 + 1): A, B, C, E of :mod:`ehlpetsc.post.stresses.kernels`
    under values, then under slopes.
    """
    n = padded_length(nx)
    distance = np.arange(-nx, nx)
    near = np.abs(distance) <= NEAR_ELEMENTS
    kernels = np.zeros((2, 4, n))
    for chosen, integrals in ((distance[near], _near), (distance[~near], _far)):
        kernels[:, :, chosen] = -2 / np.pi * np.moveaxis(integrals(chosen + offset, z), -1, 0)
    return fft.rfft(kernels.reshape(8, n))
