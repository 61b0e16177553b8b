"""Stress histories at points fixed in the body, evaluated where the points are.

Between two frames a body point moves by a part of the node spacing. Linear interpolation, of nodal stresses
or of the load, then cuts the peaks of short ripples: 5 % of the amplitude at ten nodes, and much more of the
damage near the surface, which rises with about the eleventh power. Here the load has cubic pieces
(:mod:`ehlpetsc.post.stresses.load_interpolation`), and their kernels are evaluated at the offset of the
body's points from the nodes, one offset a frame: their spectra are polynomials in the offset, through
Chebyshev points.
"""

from functools import lru_cache

import numpy as np
from scipy import fft

from ehlpetsc.compiled import compiled
from ehlpetsc.post.stresses.body_points import passage
from ehlpetsc.post.stresses.half_plane import padded_length
from ehlpetsc.post.stresses.load_interpolation import hermite_spectra, limited_slopes

BATCH = 8  # frames transformed at a time: their spectra stay in the cache
QUANTUM = 2.0**-24  # of p0 (60 Pa at 1 GPa): histories are kept in single precision on this grid, so that the
#                     rounding noise of the transforms in an unloaded stretch is no cycle
CUTOFF = 21.0  # k z up to which a wave number k matters at depth z: exp(-21) is 1e-9
TAPER = 0.45  # beyond the cut-off, in 1/element, over which the rest falls to nothing
OFFSETS = (1 - np.cos(np.pi * np.arange(6) / 5)) / 2  # Chebyshev points, in elements


def half_element(nx):
    """Spectrum of a shift by half an element."""
    n = padded_length(nx)
    return np.exp(1j * np.pi * np.arange(n // 2 + 1) / n)


def offset_weights(offset):
    """Weights (2, frames, 3) of the two parts of :func:`kernel_table` at offsets (frames,) from the nodes.

    Sums and differences of the Lagrange weights of OFFSETS that lie symmetrically about one half.
    """
    weights = np.ones((offset.size, OFFSETS.size))
    for k, node in enumerate(OFFSETS):
        for other in np.delete(OFFSETS, k):
            weights[:, k] *= (offset - other) / (node - other)
    left, right = weights[:, :3], weights[:, :2:-1]
    return np.stack([left + right, left - right])


def low_pass(nx, depth):
    """Factor of each frequency (f,): 1, then falling smoothly to 0. Depth in elements.

    Ripples of the load shorter than the depth hardly reach it, as exp(-k z). What the kernels' spectra hold
    beyond comes from the ends of their range and is seen there alone, where the load is zero. A sharp end
    would spread it over all nodes: 2e-5 of the load at z = 0.5 a of 400 nodes; this leaves less than 1e-9.
    """
    n = padded_length(nx)
    wave_number = 2 * np.pi / n * np.arange(n // 2 + 1)
    beyond = wave_number - CUTOFF / max(depth, CUTOFF / np.pi)
    t = np.clip(1 - beyond / TAPER, 0, 1)
    return t**5 * (126 - 420 * t + 540 * t**2 - 315 * t**3 + 70 * t**4)  # four flat derivatives


def kernel_table(nx, depth):
    r"""Kernel spectra at the three lower OFFSETS, as real numbers (2, 3, 8, f); depth in elements.

    Under values kernels A, C are even, B, E odd, under slopes the other way round. The spectrum of an even
    kernel at offset 1/2 + e, or 1/i of that of an odd one, times :math:`e^{-i\omega/2}`, has a real part even
    in e (first) and an imaginary part odd in e (second), so that three offsets give all six. f ends with the
    last frequency that matters.
    """
    factor = low_pass(nx, depth)
    kept = np.count_nonzero(factor)
    spectra = np.stack([hermite_spectra(nx, depth, offset) for offset in OFFSETS[:3]])
    spectra *= half_element(nx).conj() * factor
    spectra[:, [1, 3, 4, 6]] *= -1j
    return np.stack([spectra.real, spectra.imag])[..., :kept].copy()


@compiled(error_model="python", nogil=True, fastmath={"contract"})
def _multiply(real, imaginary, loads, out):
    """out (frames, 3, :f): spectra of sx, sz, txz from kernels (frames, 8, f) and loads (frames, 4, >= f)."""
    for frame in range(real.shape[0]):
        x, y = real[frame], imaginary[frame]
        p, q, dp, dq = loads[frame]
        for k in range(real.shape[2]):
            a, b, c = complex(x[0, k], y[0, k]), complex(x[1, k], y[1, k]), complex(x[2, k], y[2, k])
            e, da, db = complex(x[3, k], y[3, k]), complex(x[4, k], y[4, k]), complex(x[5, k], y[5, k])
            dc, de = complex(x[6, k], y[6, k]), complex(x[7, k], y[7, k])
            out[frame, 0, k] = c * p[k] + de * dq[k] + 1j * (e * q[k] + dc * dp[k])
            out[frame, 1, k] = a * p[k] + db * dq[k] + 1j * (b * q[k] + da * dp[k])
            out[frame, 2, k] = c * q[k] + db * dp[k] + 1j * (b * p[k] + dc * dq[k])


class BodyStress:
    """Stresses at body points in a batch of frames, one depth at a time.

    Parameters
    ----------
    nx : int
    depths : ndarray, shape (nz,)
        In elements.
    """

    def __init__(self, nx, depths):
        self.n, self._half = padded_length(nx), half_element(nx)
        self.tables = [kernel_table(nx, depth) for depth in depths]

    def transform(self, pressure, shear):
        """Spectra (frames, 4, n/2 + 1) of the loads (frames, nx) and their slopes.

        They are shifted by half an element. Beyond its ends a load falls to zero over one element.
        """
        loads = np.empty((len(pressure), 4, pressure.shape[1]))
        loads[:, 0], loads[:, 1] = pressure, shear
        limited_slopes(loads[:, 0], loads[:, 2])
        limited_slopes(loads[:, 1], loads[:, 3])
        return fft.rfft(loads, self.n) * self._half

    def __call__(self, depth, spectra, weights):
        """Stresses (frames, 3, n) of depth number `depth` at offsets with these :func:`offset_weights`."""
        table = self.tables[depth]
        parts = [w @ t.reshape(3, -1) for w, t in zip(weights, table, strict=True)]
        real, imaginary = (part.reshape(-1, *table.shape[2:]) for part in parts)
        out = np.zeros((len(spectra), 3, self.n // 2 + 1), complex)
        _multiply(real, imaginary, spectra, out)
        return fft.irfft(out, self.n, overwrite_x=True)


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
        fields = stress(0, spectra, offset_weights(motion.offset[frames]))
        at = frames - enter + 1
        values[:, at] = fields[np.arange(frames.size), :, motion.shift[frames]].T
    if quantum:
        values = np.rint(values * (1 / quantum)) * quantum
    return loads.time[enter:leave], values
