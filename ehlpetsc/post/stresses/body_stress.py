"""Stress histories at points fixed in the body, evaluated where the points are.

Between two frames a body point moves by a part of the node spacing. Linear interpolation, of nodal stresses
or of the load, then cuts the peaks of short ripples: 5 % of the amplitude at ten nodes, and much more of the
damage near the surface, which rises with about the eleventh power. Here the load has cubic pieces
(:mod:`ehlpetsc.post.stresses.load_interpolation`), and their kernels are evaluated at the offset of the
body's points from the nodes, one offset a frame: their spectra are polynomials in the offset, through
Chebyshev points, so that an offset costs a sum of a few tables.
"""

from functools import lru_cache, partial

import numpy as np
from scipy import fft

from ehlpetsc.post.stresses.body_points import passage
from ehlpetsc.post.stresses.half_plane import padded_length
from ehlpetsc.post.stresses.load_interpolation import hermite_spectra, limited_slopes
from ehlpetsc.post.stresses.paired_spectra import LANES, LOADS, blocks_of, in_blocks, paired_spectra, separate

BATCH = 144  # frames a thread takes at a time
IN_CACHE = 8  # frames whose spectra and stresses stay in the cache, where threads do not wait for each other
QUANTUM = 2.0**-24  # of p0 (60 Pa at 1 GPa): histories are kept in single precision on this grid, so that the
#                     rounding noise of the transforms in an unloaded stretch is no cycle
FELT = 21.0  # k z up to which a wave number k is felt at depth z: exp(-21) is 1e-9
FADING = 0.45  # beyond, an element, in which the rest falls to nothing
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


def kept_share(nx, depth):
    """Share that is kept of each frequency: all, then falling smoothly to none. Depth in elements.

    Ripples of the load shorter than the depth hardly reach it, as exp(-k z). What the kernels' spectra hold
    beyond comes from the ends of their range and is seen there alone, where the load is zero. A sharp end
    would spread it over all nodes: 2e-5 of the load at z = 0.5 a of 400 nodes; this leaves less than 1e-9.
    """
    n = padded_length(nx)
    wave_number = 2 * np.pi / n * np.arange(n // 2 + 1)
    beyond = wave_number - FELT / max(depth, FELT / np.pi)
    t = np.clip(1 - beyond / FADING, 0, 1)
    return t**5 * (126 - 420 * t + 540 * t**2 - 315 * t**3 + 70 * t**4)  # four flat derivatives


def parity_tables(nx, depth):
    r"""Kernel spectra at OFFSETS in real numbers, half of what complex ones would take; (48, f) in blocks.

    Under values kernels A, C are even, B, E odd, under slopes the other way round. The spectrum of an even
    kernel at offset 1/2 + e, or 1/i of that of an odd one, times :math:`e^{-i\omega/2}`, has a real part even
    in e and an imaginary part odd in e. The first three rows hold the one at the three e < 0, the last three
    the other.
    """
    spectra = np.stack([hermite_spectra(nx, depth, d) for d in OFFSETS[:3]], axis=1) * half_element(nx).conj()
    spectra[[1, 3, 4, 6]] *= -1j
    share = kept_share(nx, depth)
    kept = np.count_nonzero(share)
    rows = np.concatenate([spectra.real, spectra.imag], axis=1) * share
    return in_blocks(rows[..., :kept].reshape(-1, kept))


def parity_weights(offset):
    """Weights (frames, 6) of the rows of :func:`parity_tables` at offsets (frames,) right of the nodes."""
    weights = offset_weights(offset)
    left, right = weights[:, :3], weights[:, :2:-1]
    return np.concatenate([left + right, left - right], axis=1)


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
        half = half_element(nx)
        self._half = half.real.copy(), half.imag.copy()

    def transform(self, pressure, shear):
        """Spectra (frames, ...) of the loads (frames, nx) and their slopes, shifted by half an element.

        Beyond its ends a load falls to zero over one element. Layout: :mod:`paired_spectra`.
        """
        loads = np.empty((4, *pressure.shape))
        loads[0], loads[1] = pressure, shear
        limited_slopes(loads[0], loads[2])
        limited_slopes(loads[1], loads[3])
        spectra = np.empty((len(pressure), blocks_of(self.n) * LOADS * LANES))
        paired = np.zeros((2, IN_CACHE, self.n), complex)
        for part in in_cache(len(pressure)):
            some = slice(part.stop - part.start)
            paired[:, some, : pressure.shape[1]].real = loads[::2, part]
            paired[:, some, : pressure.shape[1]].imag = loads[1::2, part]
            separate(*fft.fft(paired[:, some]), *self._half, spectra[part])
        return spectra

    def paired(self, depth, spectra, weights):
        """Stresses (pairs, 3, n, 2) of depth number `depth` at offsets with these :func:`parity_weights`.

        The last axis is a frame and the next; without a next one its values are 0.
        """
        out = np.empty(((len(weights) + 1) // 2, 3, self.n), complex)
        paired_spectra(self.tables[depth], weights, spectra, out.view(float))
        return fft.ifft(out, overwrite_x=True).view(float).reshape(*out.shape, 2)

    def __call__(self, depth, spectra, weights):
        """The same as (frames, 3, n)."""
        pairs = np.moveaxis(self.paired(depth, spectra, weights), -1, 1)
        return pairs.reshape(-1, *pairs.shape[2:])[: len(weights)]


@lru_cache(maxsize=8)
def _at_depth(nx, depth):
    """Stresses of one depth: to prepare them takes longer than a history."""
    return BodyStress(nx, np.array([depth]))


def history_at(loads, surface, s, depth, quantum=0.0):
    """Times and stresses (3, samples) at body point s (m) and depth z (m) while it is among the nodes, Pa."""
    motion = passage(np.array([s]), loads.x, loads.dx, loads.travelled[surface])
    enter, leave = int(motion.enter[0]), int(motion.leave[0]) + 1
    stress = _at_depth(loads.x.size, depth / loads.dx)
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
