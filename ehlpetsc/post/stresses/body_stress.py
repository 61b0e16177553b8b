"""Stress histories at points fixed in the body, evaluated at the positions of the points.

Between two frames a body point moves by a fraction of the node spacing. Linear interpolation, of nodal
stresses or of the load, would reduce the peaks of short ripples: by 5 % of the amplitude at ten nodes, and
the damage near the surface, which increases with about the eleventh power, by much more. Here the load has
cubic pieces (:mod:`ehlpetsc.post.stresses.body_stress`), and their kernels are evaluated at the
offset of the body's points from the nodes, one offset a frame: their spectra are polynomials in the offset,
through Chebyshev points.

Interpolation of the load between nodes: cubic Hermite pieces with slopes limited next to steep peaks.

The solution has loads at nodes; the stress of a body point also depends on the loads between them. Linear
interpolation reduces the peaks of short ripples. A spline does not, but next to a contact of one to three
nodes it overshoots by up to 14 % of the peak: tension on a surface under pressure. Here slopes are of sixth
order, limited to three times the smaller adjacent secant, which preserves monotonicity (Fritsch & Carlson
(1980), SIAM J. Numer. Anal. 17), or to the slopes of the adjacent parabolas if their curvatures have the
same sign: ripples of ten nodes are accurate to 5e-4 of their amplitude, and steep flanks do not overshoot.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from scipy import fft
from scipy.interpolate import BarycentricInterpolator

from ehlpetsc.base.compiled import compiled
from ehlpetsc.post.stresses.half_plane import hat, padded_length, point_kernels

MAX_CLOSED_FORM = 24  # beyond, a kernel is smooth over an element and quadrature is exact
HATS_PER_ELEMENT = 64  # approximate the cubics of near elements to 2e-4 of a one-node peak
CUBIC_NODES, CUBIC_WEIGHTS = np.polynomial.legendre.leggauss(6)


@compiled(error_model="python", nogil=True)
def _smaller(a: float, b: float) -> float:
    """Number nearer to zero, or zero if the signs differ."""
    nearer = a if abs(a) < abs(b) else b
    return nearer if a * b > 0.0 else 0.0


@compiled(error_model="python", nogil=True)
def _slopes_between(y: np.ndarray, slopes: np.ndarray) -> None:
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
def limited_slopes(loads: np.ndarray, out: np.ndarray) -> None:
    """Set out to the slopes per element of loads (rows, nodes); zero at the three nodes of each end."""
    nodes = loads.shape[1]
    for row in range(loads.shape[0]):
        out[row, :3], out[row, nodes - 3 :] = 0.0, 0.0
        _slopes_between(loads[row], out[row, 3:])


def hermite_shapes(t: np.ndarray) -> np.ndarray:
    """Hermite shape functions of value and slope of a node, (2, n), at t in -1 .. 1 elements from it."""
    r = np.abs(t)
    return np.stack([(1 - r) ** 2 * (1 + 2 * r), t * (1 - r) ** 2])


def _near(u: np.ndarray, z: float) -> np.ndarray:
    t = np.arange(1 - HATS_PER_ELEMENT, HATS_PER_ELEMENT) / HATS_PER_ELEMENT
    distances = HATS_PER_ELEMENT * (u[:, None] - t).ravel()
    kernels = hat(distances, HATS_PER_ELEMENT * z).reshape(4, u.size, t.size)
    return kernels @ hermite_shapes(t).T


def _far(u: np.ndarray, z: float) -> np.ndarray:
    half = (CUBIC_NODES + 1) / 2
    t = np.concatenate([-half, half])
    return point_kernels(u[:, None] - t, z) @ (np.tile(CUBIC_WEIGHTS / 2, 2) * hermite_shapes(t)).T


def hermite_kernels(nx: int, z: float, offset: float) -> np.ndarray:
    """Kernels of the shape functions, -2/pi included, `offset` elements right of the nodes.

    z in elements. Shape (2, 4, padded_length): A, B, C, E of :mod:`ehlpetsc.post.stresses.half_plane` under
    values and under slopes, at distances -nx .. nx - 1, negative ones at the end.
    """
    distance = np.arange(-nx, nx)
    near = np.abs(distance) <= MAX_CLOSED_FORM
    kernels = np.zeros((2, 4, padded_length(nx)))
    for chosen, integrals in ((distance[near], _near), (distance[~near], _far)):
        kernels[:, :, chosen] = -2 / np.pi * np.moveaxis(integrals(chosen + offset, z), -1, 0)
    return kernels


def hermite_spectra(nx: int, z: float, offset: float) -> np.ndarray:
    """Spectra (8, padded_length // 2 + 1) of :func:`hermite_kernels`, under values, then under slopes."""
    return fft.rfft(hermite_kernels(nx, z, offset).reshape(8, -1))


FREQUENCIES_PER_BLOCK = 32
# of p0 (60 Pa at 1 GPa in single precision): histories are rounded to multiples, so that the noise of the
# transforms without load causes no cycles
QUANTA = {"float32": 2.0**-24, "float64": 2.0**-40}
MAX_KZ = 21.0  # wave number times depth; exp(-21) is 1e-9
TAPER_WIDTH = 0.45  # 1/element: wave numbers beyond the cut-off over which the spectrum falls to zero
OFFSETS = (1 - np.cos(np.pi * np.arange(6) / 5)) / 2  # Chebyshev points, in elements
HERMITE_PARITY = np.array([1, -1, 1, -1, -1, 1, -1, 1])[:, None]  # of the kernels under values, then slopes


def offset_weights(offset: np.ndarray) -> np.ndarray:
    """Lagrange weights (frames, 6) of `OFFSETS` at offsets (frames,) from the nodes."""
    return BarycentricInterpolator(OFFSETS, np.eye(OFFSETS.size))(offset)


def low_pass(wave_number: np.ndarray, depth: float, highest: float = np.pi) -> np.ndarray:
    """Factor of each wave number up to the highest [1/element]: 1, then falling smoothly to 0.

    `depth` in elements.

    Stresses of load ripples decay with the depth as exp(-k z). The spectra of the kernels at larger wave
    numbers come from the ends of their range, where the load is zero. A sharp cut-off would distribute them
    over all nodes: 2e-5 of the load at z = 0.5 a with 400 nodes; the smooth one leaves less than 1e-9.
    """
    beyond = wave_number - MAX_KZ / max(depth, MAX_KZ / highest)
    t = np.clip(1 - beyond / TAPER_WIDTH, 0, 1)
    return t**5 * (126 - 420 * t + 540 * t**2 - 315 * t**3 + 70 * t**4)  # four flat derivatives


@lru_cache(maxsize=8)  # for both surfaces, and the passes of a life
def kernel_table(nx: int, depth: float) -> np.ndarray:
    """Kernel spectra (f, 6, 8) at the OFFSETS, up to the last frequency that matters; depth in elements."""
    n = padded_length(nx)
    factor = low_pass(2 * np.pi / n * np.arange(n // 2 + 1), depth)
    left = np.stack([hermite_spectra(nx, depth, offset) for offset in OFFSETS[:3]])
    shift = np.exp(2j * np.pi / n * np.arange(factor.size))  # by an element: mirrored offsets
    spectra = np.concatenate([left, HERMITE_PARITY * shift * left[::-1].conj()]) * factor
    return np.ascontiguousarray(np.moveaxis(spectra[..., : np.count_nonzero(factor)], -1, 0))


@compiled(error_model="python", nogil=True, fastmath={"contract"})
def _multiply(table: np.ndarray, weights: np.ndarray, loads: np.ndarray, out: np.ndarray) -> None:
    """Spectra out (frames, 3, :f) of sx, sz, txz from a kernel_table, weights and loads (frames, 4, >= f).

    `FREQUENCIES_PER_BLOCK` frequencies of all frames at once, so that their part of the table fits in the
    cache.
    """
    kernel = np.empty(8, np.complex128)
    for start in range(0, table.shape[0], FREQUENCIES_PER_BLOCK):
        for frame in range(weights.shape[0]):
            w = weights[frame]
            for k in range(start, min(start + FREQUENCIES_PER_BLOCK, table.shape[0])):
                row = table[k]
                for m in range(8):
                    low = w[0] * row[0, m] + w[1] * row[1, m] + w[2] * row[2, m]
                    kernel[m] = low + w[3] * row[3, m] + w[4] * row[4, m] + w[5] * row[5, m]
                p, q, dp, dq = loads[frame, 0, k], loads[frame, 1, k], loads[frame, 2, k], loads[frame, 3, k]
                a, b, c, e = kernel[0], kernel[1], kernel[2], kernel[3]
                da, db, dc, de = kernel[4], kernel[5], kernel[6], kernel[7]
                out[frame, 0, k] = c * p + e * q + dc * dp + de * dq
                out[frame, 1, k] = a * p + b * q + da * dp + db * dq
                out[frame, 2, k] = b * p + c * q + db * dp + dc * dq


class BodyStress:
    """Stresses at body points in a batch of frames, one depth at a time; depths (nz,) in elements."""

    components, frames_at_once = 3, 8  # frames whose spectra fit in the cache
    rows: tuple[int, ...] = ()

    def __init__(self, nx: int, depths: np.ndarray) -> None:
        self.n = padded_length(nx)
        self.numbers_per_sample = len(depths) * self.components
        self.tables = [kernel_table(nx, depth) for depth in depths]

    def transform(self, pressure: np.ndarray, shear: np.ndarray) -> np.ndarray:
        """Spectra (frames, 4, n/2 + 1) of the loads (frames, nx) and their slopes.

        Beyond the end nodes a load falls to zero over one element.
        """
        loads = np.empty((len(pressure), 4, pressure.shape[1]))
        loads[:, 0], loads[:, 1] = pressure, shear
        for k in range(2):
            limited_slopes(loads[:, k], loads[:, k + 2])
        return fft.rfft(loads, self.n)

    def __call__(self, depth: int, spectra: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """Stresses (frames, 3, n) of depth number `depth` at offsets with these :func:`offset_weights`."""
        out = np.zeros((len(spectra), 3, self.n // 2 + 1), complex)
        _multiply(self.tables[depth], weights, spectra, out)
        return fft.irfft(out, self.n, overwrite_x=True)
