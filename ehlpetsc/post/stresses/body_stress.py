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

from ehlpetsc.compiled import compiled
from ehlpetsc.post.stresses.body_points import passage
from ehlpetsc.post.stresses.half_plane import padded_length
from ehlpetsc.post.stresses.load_interpolation import hermite_spectra, limited_slopes

BATCH = 144  # frames a thread takes at a time
IN_CACHE = 8  # frames whose spectra and stresses stay in the cache, where threads do not wait for each other
QUANTUM = 2.0**-24  # of p0 (60 Pa at 1 GPa): histories are kept in single precision on this grid, so that the
#                     rounding noise of the transforms in an unloaded stretch is no cycle
TILE = 128  # frequencies whose kernels stay in the first cache
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


@compiled(error_model="python", nogil=True, fastmath={"contract"})
def _kernel(rows, w, f):
    return (
        w[0] * rows[0, f] + w[1] * rows[1, f] + w[2] * rows[2, f],
        w[3] * rows[3, f] + w[4] * rows[4, f] + w[5] * rows[5, f],
    )


@compiled(error_model="python", nogil=True, fastmath={"contract"})
def _stress_spectra(tables, w, loads, frame, start, stop, out):
    """Real and imaginary parts of the stress spectra of one frame, frequencies start .. stop-1: out (6, f).

    Under p, q and their slopes, shifted by half an element. Kernels B, E under values, A, C under slopes are
    i times what the tables hold.
    """
    for f in range(start, stop):
        ar, ai = _kernel(tables[0], w, f)
        bi, br = _kernel(tables[1], w, f)
        cr, ci = _kernel(tables[2], w, f)
        ei, er = _kernel(tables[3], w, f)
        dai, dar = _kernel(tables[4], w, f)
        dbr, dbi = _kernel(tables[5], w, f)
        dci, dcr = _kernel(tables[6], w, f)
        der, dei = _kernel(tables[7], w, f)
        br, er, dar, dcr = -br, -er, -dar, -dcr
        pr, pi, qr, qi = (
            loads[0, frame, f].real,
            loads[0, frame, f].imag,
            loads[1, frame, f].real,
            loads[1, frame, f].imag,
        )
        xr, xi, yr, yi = (
            loads[2, frame, f].real,
            loads[2, frame, f].imag,
            loads[3, frame, f].real,
            loads[3, frame, f].imag,
        )
        g = f - start
        out[0, g] = cr * pr - ci * pi + er * qr - ei * qi + dcr * xr - dci * xi + der * yr - dei * yi
        out[1, g] = cr * pi + ci * pr + er * qi + ei * qr + dcr * xi + dci * xr + der * yi + dei * yr
        out[2, g] = ar * pr - ai * pi + br * qr - bi * qi + dar * xr - dai * xi + dbr * yr - dbi * yi
        out[3, g] = ar * pi + ai * pr + br * qi + bi * qr + dar * xi + dai * xr + dbr * yi + dbi * yr
        out[4, g] = br * pr - bi * pi + cr * qr - ci * qi + dbr * xr - dbi * xi + dcr * yr - dci * yi
        out[5, g] = br * pi + bi * pr + cr * qi + ci * qr + dbr * xi + dbi * xr + dcr * yi + dci * yr


@compiled(error_model="python", nogil=True)
def _paired_spectra(tables, weights, loads, out):
    """out (pairs, 3, n): spectra of a frame's stresses plus i times those of the next frame.

    Two real inverse transforms then cost one complex one. The tables of TILE frequencies stay in the cache.
    """
    frames, half, n = weights.shape[0], loads.shape[2], out.shape[2]
    one, other = np.zeros((6, TILE)), np.zeros((6, TILE))
    for start in range(0, half, TILE):
        stop = min(start + TILE, half)
        for pair in range(out.shape[0]):
            _stress_spectra(tables, weights[2 * pair], loads, 2 * pair, start, stop, one)
            if 2 * pair + 1 < frames:
                _stress_spectra(tables, weights[2 * pair + 1], loads, 2 * pair + 1, start, stop, other)
            else:
                other[:] = 0.0
            for part in range(3):
                row = out[pair, part]
                for f in range(start, stop):
                    xr, xi = one[2 * part, f - start], one[2 * part + 1, f - start]
                    yr, yi = other[2 * part, f - start], other[2 * part + 1, f - start]
                    if f == 0 or 2 * f == n:  # of real functions these are real
                        row[f] = complex(xr, yr)
                    else:
                        row[f] = complex(xr - yi, xi + yr)
                        row[n - f] = complex(xr + yi, yr - xi)


@compiled(error_model="python", nogil=True)
def _separate(paired, half, out):
    """Spectra (2, frames, f) of two real functions from that of one plus i times the other, times half."""
    n = paired.shape[1]
    for frame in range(paired.shape[0]):
        row = paired[frame]
        for f in range(half.size):
            a, b = row[f], row[n - f if f else 0].conjugate()
            out[0, frame, f] = 0.5 * (a + b) * half[f]
            out[1, frame, f] = complex(0.5 * (a - b).imag, -0.5 * (a - b).real) * half[f]


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
        paired = np.zeros((2, IN_CACHE, self.n), complex)
        for part in in_cache(len(pressure)):
            paired[:, : part.stop - part.start, : pressure.shape[1]].real = loads[::2, part]
            paired[:, : part.stop - part.start, : pressure.shape[1]].imag = loads[1::2, part]
            for k, values in enumerate(fft.fft(paired[:, : part.stop - part.start])):
                _separate(values, self._half, spectra[2 * k : 2 * k + 2, part])
        return spectra

    def paired(self, depth, spectra, weights):
        """Stresses (pairs, 3, n, 2) of depth number `depth` at offsets with these :func:`parity_weights`.

        The last axis is a frame and the next; without a next one its values are 0.
        """
        out = np.empty(((len(weights) + 1) // 2, 3, self.n), complex)
        _paired_spectra(self.tables[depth], weights, spectra, out)
        return fft.ifft(out, overwrite_x=True).view(float).reshape(*out.shape, 2)

    def __call__(self, depth, spectra, weights):
        """The same as (frames, 3, n)."""
        pairs = np.moveaxis(self.paired(depth, spectra, weights), -1, 1)
        return pairs.reshape(-1, *pairs.shape[2:])[: len(weights)]


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
        values = np.rint(values * (1 / quantum)) * quantum
    return loads.time[enter:leave], values
