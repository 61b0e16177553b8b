"""Stresses of a half-space at the points of a moving body, row by row, under loads over a plane.

As in :mod:`ehlpetsc.post.stresses.body_stress` loads have cubic pieces along x, with limited slopes, and the
kernels are evaluated at the offset of the body's points from the nodes; across, points are at the nodes
and loads linear. Histories hold sx, sz, txz, as those of a line contact, then sy, txy, tyz.
"""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy import fft

from ehlpetsc.base.compiled import compiled
from ehlpetsc.post.stresses.body_stress import (
    HATS_PER_ELEMENT,
    OFFSETS,
    BodyStress,
    hermite_kernels,
    hermite_shapes,
    limited_slopes,
    low_pass,
)
from ehlpetsc.post.stresses.half_space import (
    COMPONENTS,
    N_LOADS,
    SUMMED_IMAGES,
    fading,
    hat_kernels,
    padded_shape,
    plane_strain,
)

ORDER = [0, 2, 5, 1, 3, 4]  # of the components in histories
IS_EVEN_ACROSS = np.array([True, True, True, True, False, False])  # in this order, of both loads
IS_EVEN_ALONG = np.array([[1, 1, 0, 1, 0, 1], [0, 0, 1, 0, 1, 0]], bool)  # under pressure, under traction
# of spectra at opposite offsets, as numbers (24,): of values, then of slopes
MIRRORED = np.outer([1, -1], np.where(IS_EVEN_ALONG == IS_EVEN_ACROSS, 1, -1)).ravel()
NEAR_ELEMENTS = 8  # beyond, a kernel is smooth over an element
HAT_REACH = 4  # nodes either side whose hats replace the cubic of a node far away
ROWS_AT_ONCE = 32


def _near(distance: np.ndarray, y: np.ndarray, z: float, nu: float, offset: float) -> np.ndarray:
    """Kernels (2 shapes, 2, 6, ny, n) at consecutive distances, each cubic of many hats."""
    hats = HATS_PER_ELEMENT
    first = distance[0] + offset - (hats - 1) / hats
    fine = first + np.arange((distance.size + 1) * hats - 1) / hats
    windows = sliding_window_view(hat_kernels(fine, y, z, nu), 2 * hats - 1, axis=-1)
    shapes = hermite_shapes(np.arange(hats - 1, -hats, -1) / hats).T
    return np.moveaxis(windows[..., ::hats, :] @ shapes, -1, 0)


def _far_weights(offset: float) -> np.ndarray:
    """Weights (2 shapes, 9) of hats on neighbouring nodes with the moments of the cubics up to the eighth."""
    order = np.arange(2 * HAT_REACH + 1)
    t, weights = np.polynomial.legendre.leggauss(8)
    t, weights = np.append(t - 1, t + 1) / 2, np.tile(weights / 2, 2)
    moments = (hermite_shapes(t) * weights) @ (t - offset)[:, None] ** order
    at = order[:, None] - HAT_REACH + t
    of_hats = np.einsum("jtn,t->nj", at[..., None] ** order, weights * (1 - np.abs(t)))
    return np.linalg.solve(of_hats, moments.T).T


def _far(hats: np.ndarray, offset: float) -> np.ndarray:
    """Kernels as of `_near` where they are smooth over an element, from those of hats at the nodes.

    `hats`: kernels of the hats, `HAT_REACH` more at each end.
    """
    windows = sliding_window_view(hats, 2 * HAT_REACH + 1, axis=-1)
    return np.moveaxis(windows @ _far_weights(offset)[:, ::-1].T, -1, 0)


def _add_rows(out: np.ndarray, block: np.ndarray, first: int, period: int) -> None:
    """Add kernels of the rows `first`, ... and of those at the opposite distances to the rows of `out`.

    Those of a load of a period (0: none) are repeated; images fade out.
    """
    rows, signs = out.shape[-2], np.where(IS_EVEN_ACROSS, 1.0, -1.0)[:, None]
    for row in range(first, first + block.shape[-2]):
        values = block[..., row - first, :] * (fading(row / period) if period else 1.0)
        out[..., (rows // 2 + row) % rows, :] += values
        if row:
            out[..., (rows // 2 - row) % rows, :] += signs * values


def hat_sums(ny: int, nx: int, width: float, z: float, nu: float, periodic: bool) -> np.ndarray:
    """Kernels (2, 6, rows, 2 nx + 2 REACH) of hats at the nodes, summed over the images of a period."""
    count, rows = ((SUMMED_IMAGES + 1) * ny, ny) if periodic else (ny, 2 * ny - 1)
    distance = np.arange(-nx - HAT_REACH, nx + HAT_REACH, dtype=float)
    sums = np.zeros((N_LOADS, COMPONENTS, rows, distance.size))
    for first in range(0, count, ROWS_AT_ONCE):
        hats = hat_kernels(distance, width * np.arange(first, first + ROWS_AT_ONCE), z, nu)[:, ORDER]
        _add_rows(sums, hats[..., : count - first, :], first, ny if periodic else 0)
    return sums


def offset_spectra(
    sums: np.ndarray, ny: int, width: float, z: float, nu: float, offset: float, periodic: bool
) -> np.ndarray:
    """Spectra (2 shapes, 2, 6, ky, kx) of the kernels `offset` elements right of the nodes, ky from 0 on.

    `sums`: of :func:`hat_sums`.
    """
    rows, nx = sums.shape[-2], sums.shape[-1] // 2 - HAT_REACH
    kernels = _far(sums, offset)
    if z < NEAR_ELEMENTS:
        y, reach = width * np.arange(int(NEAR_ELEMENTS / width) + 2), min(NEAR_ELEMENTS, nx - 1)
        hats = hat_kernels(np.arange(-reach - HAT_REACH, reach + HAT_REACH + 1.0), y, z, nu)
        refined = _near(np.arange(-reach, reach + 1), y, z, nu, offset) - _far(hats, offset)
        refined = refined[:, :, ORDER, : None if periodic else ny]
        _add_rows(kernels[..., nx - reach : nx + reach + 1], refined, 0, ny if periodic else 0)
    if periodic:
        line = hermite_kernels(nx, z, offset)[..., np.arange(-nx, nx)]
        means = np.stack([plane_strain(shape, nu)[:, ORDER] for shape in line])
        kernels += ((means - kernels.sum(axis=-2)) / ny)[..., None, :]
    shape = padded_shape(ny, nx, periodic)
    padded = np.zeros((*kernels.shape[:3], *shape))
    padded[..., (np.arange(rows) - rows // 2)[:, None], np.arange(-nx, nx)] = kernels
    return fft.rfft2(padded)[..., : shape[0] // 2 + 1, :]


def kernel_table(ny: int, nx: int, width: float, depth: float, nu: float, periodic: bool) -> np.ndarray:
    """Kernel spectra (ky, 24, 3, 2, kx) at the OFFSETS below 1/2, up to the last wave numbers that matter.

    The 24 are the components under pressure, traction and the slopes of both, the 2 real and imaginary parts.
    Width of rows and depth in elements along x. Phases are those about half an element, so that the kernels
    at the opposite offset, which are mirrored, have conjugate spectra, times the sign of `MIRRORED`.
    """
    rows, columns = padded_shape(ny, nx, periodic)
    along = 2 * np.pi / columns * np.arange(columns // 2 + 1)
    across = 2 * np.pi / (rows * width) * np.arange(rows // 2 + 1)
    wave_number = np.hypot(along, across[:, None])
    factor = low_pass(wave_number, depth, wave_number.max() * (1 + 1e-9))
    kept = np.s_[: np.count_nonzero(factor[:, 0]), : np.count_nonzero(factor[0])]
    shape, half = factor[kept].shape, OFFSETS.size // 2
    table = np.empty((shape[0], MIRRORED.size, half, 2, shape[1]))
    sums = hat_sums(ny, nx, width, depth, nu, periodic)
    for k in range(half):
        spectra = offset_spectra(sums, ny, width, depth, nu, OFFSETS[k], periodic)
        spectra = factor * np.exp(-0.5j * along) * spectra
        by_row = np.moveaxis(spectra.reshape(-1, *factor.shape)[:, *kept], 1, 0)
        table[:, :, k, 0], table[:, :, k, 1] = by_row.real, by_row.imag
    return table


def half_weights(weights: np.ndarray) -> np.ndarray:
    """Weights (frames, 2, 3) of even and of odd parts of a kernel_table from those (frames, 6) of OFFSETS."""
    half = weights.shape[1] // 2
    left, right = weights[:, :half], weights[:, : half - 1 : -1]
    return np.stack([left + right, left - right], axis=1)


@compiled(error_model="python", nogil=True, fastmath={"contract"})
def _add_product(
    real: np.ndarray, imaginary: np.ndarray, load: np.ndarray, sign: float, out: np.ndarray
) -> None:
    """Add sign times a kernel times a load to out (kx,)."""
    for k in range(real.size):
        u, v = load[k].real, load[k].imag
        out[k] += complex(sign * (real[k] * u - imaginary[k] * v), sign * (real[k] * v + imaginary[k] * u))


@compiled(error_model="python", nogil=True, fastmath={"contract"})
def _multiply(
    table: np.ndarray, weights: np.ndarray, loads: np.ndarray, signs: np.ndarray, out: np.ndarray
) -> None:
    """Add to spectra out (frames, 6, rows, kx) from a kernel_table, its weights, loads (frames, 4, rows, kx).

    Rows of negative wave numbers follow from those of positive ones by the signs (6,).
    """
    rows, count = out.shape[2], table.shape[4]
    real, imaginary = np.empty(count), np.empty(count)
    for row in range(table.shape[0]):
        mirrored = (rows - row) % rows
        for frame in range(weights.shape[0]):
            for m in range(table.shape[1]):
                load, part = m // 6, m % 6
                for half, values in ((0, real), (1, imaginary)):
                    at = table[row, m, :, half]
                    w = weights[frame, half if MIRRORED[m] > 0 else 1 - half]
                    for k in range(count):
                        values[k] = w[0] * at[0, k] + w[1] * at[1, k] + w[2] * at[2, k]
                _add_product(real, imaginary, loads[frame, load, row], 1.0, out[frame, part, row])
                if mirrored != row:
                    load_row, sign = loads[frame, load, mirrored], signs[part]
                    _add_product(real, imaginary, load_row, sign, out[frame, part, mirrored])


class BlockStress(BodyStress):
    """Stresses at body points in a batch of frames, one depth at a time.

    `width`: spacing across and `depths` (nz,) in elements along x.
    """

    components = COMPONENTS

    def __init__(self, ny: int, nx: int, width: float, depths: np.ndarray, nu: float, periodic: bool) -> None:
        self.rows, self.nodes, self.shape = (ny,), nx, padded_shape(ny, nx, periodic)
        self.numbers_per_sample = len(depths) * ny * COMPONENTS
        self.tables = [kernel_table(ny, nx, width, depth, nu, periodic) for depth in depths]

    def transform(self, pressure: np.ndarray, shear: np.ndarray) -> np.ndarray:
        """Spectra (frames, 4, rows, n/2 + 1) of the loads (frames, ny, nx) and their slopes along x, with
        the other half of the phases of a kernel_table.

        Beyond the end nodes a load falls to zero over one element.
        """
        loads = np.empty((len(pressure), 4, *pressure.shape[1:]))
        loads[:, 0], loads[:, 1] = pressure, shear
        for frame in loads:
            for k in range(N_LOADS):
                limited_slopes(frame[k], frame[k + N_LOADS])
        rows, columns = self.shape
        spectra = fft.rfft(loads, columns)
        spectra *= np.exp(1j * np.pi / columns * np.arange(spectra.shape[-1]))
        return fft.fft(spectra, rows, axis=-2, overwrite_x=True)

    def __call__(self, depth: int, spectra: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """Stresses (frames, 6, ny, nx) of depth number `depth` at offsets with these `offset_weights`."""
        table, (rows, columns) = self.tables[depth], self.shape
        out = np.zeros((len(spectra), COMPONENTS, rows, table.shape[-1]), complex)
        _multiply(table, half_weights(weights), spectra, np.where(IS_EVEN_ACROSS, 1.0, -1.0), out)
        found = np.empty((len(spectra), COMPONENTS, self.rows[0], self.nodes))
        for frame, field in zip(out, found, strict=True):  # one by one: within the cache
            lines = fft.ifft(frame, axis=-2, overwrite_x=True)[:, : self.rows[0]]
            field[:] = fft.irfft(lines, columns)[..., : self.nodes]
        return found
