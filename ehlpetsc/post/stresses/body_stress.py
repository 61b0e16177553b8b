"""Stress histories at points fixed in the body, evaluated where the points are.

Between two frames a body point moves by a part of the node spacing. Linear interpolation, of nodal stresses
or of the load, then cuts the peaks of short ripples: 5 % of the amplitude at ten nodes, and much more of the
damage near the surface, which rises with about the eleventh power. Here the load has cubic pieces
(:mod:`ehlpetsc.post.stresses.load_interpolation`), and their kernels are evaluated at the offset of the
body's points from the nodes, one offset a frame: their spectra are polynomials in the offset, through
Chebyshev points, so that an offset costs a sum of a few tables.
"""

from functools import partial

import numpy as np
from scipy import fft

from ehlpetsc.post.jit import njit
from ehlpetsc.post.stresses.body_points import passage
from ehlpetsc.post.stresses.half_plane import padded_length
from ehlpetsc.post.stresses.load_interpolation import hermite_spectra, limited_slopes

BATCH = 144  # frames a thread takes at a time
IN_CACHE = 8  # frames whose spectra and stresses stay in the cache, where threads do not wait for each other
QUANTUM = 2.0**-24  # of p0 (60 Pa at 1 GPa): histories are kept in single precision on this grid, so that the
#                     rounding noise of the transforms in an unloaded stretch is no cycle
OFFSETS = (1 - np.cos(np.pi * np.arange(6) / 5)) / 2  # Chebyshev points, in elements, even about one half


def in_cache(frames):
    """Slices of so many frames, at most IN_CACHE each."""
    return [slice(begin, min(begin + IN_CACHE, frames)) for begin in range(0, frames, IN_CACHE)]


def offset_weights(offset):
    """Lagrange weights of offsets (frames,) on OFFSETS: shape (frames, len(OFFSETS))."""
    weights = np.ones((offset.size, OFFSETS.size))
    for k, node in enumerate(OFFSETS):
        for other in np.delete(OFFSETS, k):
            weights[:, k] *= (offset - other) / (node - other)
    return weights


def half_element(nx):
    """Spectrum of a shift by half an element."""
    n = padded_length(nx)
    return np.exp(1j * np.pi * np.arange(n // 2 + 1) / n)


def parity_tables(nx, depth):
    r"""Kernel spectra at OFFSETS in real numbers, shape (8, 6, f): half of what complex ones would take.

    Under values kernels A, C are even, B, E odd, under slopes the other way round. The spectrum of an even
    kernel at offset 1/2 + e, or 1/i of that of an odd one, times :math:`e^{-i\omega/2}`, has a real part even
    in e and an imaginary part odd in e. The first three rows hold the one at the three e < 0, the last three
    the other.
    """
    spectra = np.stack([hermite_spectra(nx, depth, d) for d in OFFSETS[:3]], axis=1) * half_element(nx).conj()
    spectra[[1, 3, 4, 6]] *= -1j
    return np.ascontiguousarray(np.concatenate([spectra.real, spectra.imag], axis=1))


def parity_weights(offset):
    """Weights (frames, 6) of the rows of :func:`parity_tables` at offsets (frames,) right of the nodes."""
    weights = offset_weights(offset)
    left, right = weights[:, :3], weights[:, :2:-1]
    return np.concatenate([left + right, left - right], axis=1)


@njit(cache=True, nogil=True)
def _kernel(rows, w, f):
    return complex(
        w[0] * rows[0, f] + w[1] * rows[1, f] + w[2] * rows[2, f],
        w[3] * rows[3, f] + w[4] * rows[4, f] + w[5] * rows[5, f],
    )


@njit(cache=True, nogil=True)
def _spectra(tables, weights, loads, out):
    """out (frames, 3, f) = stress spectra under p, q and their slopes, shifted by half an element."""
    for frame in range(out.shape[0]):
        w, (p, q, dp, dq) = weights[frame], loads[:, frame]
        for f in range(out.shape[2]):
            a, b = _kernel(tables[0], w, f), 1j * _kernel(tables[1], w, f)
            c, e = _kernel(tables[2], w, f), 1j * _kernel(tables[3], w, f)
            da, db = 1j * _kernel(tables[4], w, f), _kernel(tables[5], w, f)
            dc, de = 1j * _kernel(tables[6], w, f), _kernel(tables[7], w, f)
            out[frame, 0, f] = c * p[f] + e * q[f] + dc * dp[f] + de * dq[f]
            out[frame, 1, f] = a * p[f] + b * q[f] + da * dp[f] + db * dq[f]
            out[frame, 2, f] = b * p[f] + c * q[f] + db * dp[f] + dc * dq[f]


class BodyStress:
    """Stresses at body points in a batch of frames, one depth at a time.

    Parameters
    ----------
    nx : int
    depths : ndarray, shape (nz,)
        In elements.
    spread : callable, optional
        Used as `map` for what is prepared for each depth.
    """

    def __init__(self, nx, depths, spread=map):
        self.n = padded_length(nx)
        self.tables = list(spread(partial(parity_tables, nx), depths))
        self._half = half_element(nx)

    def transform(self, pressure, shear):
        """Spectra (4, frames, f) of the loads (frames, nx) and their slopes, shifted by half an element.

        Beyond its ends a load falls to zero over one element.
        """
        loads = np.empty((4, *pressure.shape))
        loads[0], loads[1] = pressure, shear
        limited_slopes(loads[0], loads[2])
        limited_slopes(loads[1], loads[3])
        spectra = np.empty((4, len(pressure), self.n // 2 + 1), complex)
        for part in in_cache(len(pressure)):
            np.multiply(fft.rfft(loads[:, part], self.n), self._half, out=spectra[:, part])
        return spectra

    def __call__(self, depth, spectra, weights):
        """Stresses (frames, 3, n) of depth number `depth` at offsets with these :func:`parity_weights`."""
        out = np.empty((len(weights), 3, self.n // 2 + 1), complex)
        _spectra(self.tables[depth], weights, spectra, out)
        return fft.irfft(out, self.n, overwrite_x=True)


def history_at(loads, surface, s, depth, quantum=0.0):
    """Times and stresses (3, samples) at body point s (m) and depth z (m) while it is among the nodes, Pa."""
    motion = passage(np.array([s]), loads.x, loads.dx, loads.time, loads.speeds[surface])
    enter, leave = int(motion.enter[0]), int(motion.leave[0]) + 1
    stress = BodyStress(loads.x.size, np.array([depth / loads.dx]))
    values = np.zeros((3, max(leave - enter, 0) + 2))
    for begin in range(enter, leave, BATCH):
        frames = np.arange(begin, min(begin + BATCH, leave))
        spectra = stress.transform(*loads.read(surface, frames[0], frames[-1] + 1))
        fields = stress(0, spectra, parity_weights(motion.offset[frames]))
        at = frames - enter + 1
        values[:, at] = fields[np.arange(frames.size), :, motion.shift[frames]].T
    if quantum:
        values = np.floor(values / quantum + 0.5) * quantum
    return loads.time[enter:leave], values
