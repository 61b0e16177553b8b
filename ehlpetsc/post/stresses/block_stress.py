"""Stresses of a half-space at the points of a moving body, row by row, under loads over a plane.

As in :mod:`ehlpetsc.post.stresses.body_stress` loads have cubic pieces along x, with limited slopes, and the
kernels are evaluated at the offset of the body's points from the nodes; across, points are at the nodes
and loads linear. Histories hold sx, sz, txz, as those of a line contact, then sy, txy, tyz.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from scipy import fft

from ehlpetsc.base.compiled import compiled
from ehlpetsc.post.stresses.body_stress import (
    COMPONENT_BYTES,
    HATS_PER_ELEMENT,
    OFFSETS,
    hermite_kernels,
    hermite_shapes,
    limited_slopes,
    low_pass,
)
from ehlpetsc.post.stresses.half_space import (
    COMPONENTS,
    IMAGES,
    LOADS,
    hat_kernels,
    padded_shape,
    plane_strain,
    sum_images,
)

ORDER = [0, 2, 5, 1, 3, 4]  # of the components in histories
IS_EVEN_ACROSS = np.array([True, True, True, True, False, False])  # in this order, of both loads
IS_EVEN_ALONG = np.array([[1, 1, 0, 1, 0, 1], [0, 0, 1, 0, 1, 0]], bool)  # under pressure, under traction
NEAR_ELEMENTS = 8  # along x; beyond, cubics may consist of fewer hats
FAR_HATS_PER_ELEMENT = 8
ROWS_AT_ONCE = 32


def _along(distance: np.ndarray, y: np.ndarray, z: float, nu: float, offset: float, hats: int) -> np.ndarray:
    """Kernels (2 shapes, 2, 6, ny, n) at consecutive distances, each cubic of `hats` an element."""
    first = distance[0] + offset - (hats - 1) / hats
    fine = first + np.arange((distance.size + 1) * hats - 1) / hats
    windows = sliding_window_view(hat_kernels(fine, y, z, nu)[:, :, 1:-1], 2 * hats - 1, axis=-1)
    return np.moveaxis(
        windows[..., ::hats, :] @ hermite_shapes(np.arange(hats - 1, -hats, -1) / hats).T, -1, 0
    )


def _rows(ny: int, periodic: bool) -> int:
    """Number of rows at distances of 0 or more whose kernels are needed."""
    return (IMAGES + 1) * ny if periodic else ny


def _kernels(
    shape: tuple[int, int], width: float, z: float, nu: float, offset: float
) -> Iterator[np.ndarray]:
    """Blocks of rows 0, 1, ... of the kernels (2 shapes, 2, 6, rows, 2 nx) at distances -nx .. nx - 1."""
    count, nx = shape
    distance = np.arange(-nx, nx)
    near = slice(max(nx - NEAR_ELEMENTS, 0), nx + NEAR_ELEMENTS + 1)
    for first in range(0, count, ROWS_AT_ONCE):
        y = width * np.arange(first - 1.0, min(first + ROWS_AT_ONCE, count) + 1)
        block = _along(distance, y, z, nu, offset, FAR_HATS_PER_ELEMENT)
        block[..., near] = _along(distance[near], y, z, nu, offset, HATS_PER_ELEMENT)
        yield block[:, :, ORDER]


def _mirrored(kernels: np.ndarray) -> np.ndarray:
    """Kernels of rows -n .. n from those of rows 0 .. n, axis -2."""
    signs = np.where(IS_EVEN_ACROSS, 1.0, -1.0)[:, None, None]
    return np.concatenate([signs * kernels[..., :0:-1, :], kernels], axis=-2)


def offset_spectra(
    ny: int, nx: int, width: float, z: float, nu: float, offset: float, periodic: bool
) -> np.ndarray:
    """Spectra (2 shapes, 2, 6, ky, kx) of the kernels `offset` elements right of the nodes, ky from 0 on."""
    blocks = _kernels((_rows(ny, periodic), nx), width, z, nu, offset)
    kernels = _mirrored(np.concatenate(list(blocks), axis=-2))
    middle = kernels.shape[-2] // 2
    rows = np.arange(-middle, middle + 1)
    if periodic:
        first, line = middle - IMAGES * ny - ny // 2, hermite_kernels(nx, z, offset)[..., np.arange(-nx, nx)]
        images = kernels[..., first : first + (2 * IMAGES + 1) * ny, :]
        means = [plane_strain(shape, nu)[:, ORDER] for shape in line]
        kernels = np.stack([sum_images(*both) for both in zip(images, means, strict=True)])
        rows = np.arange(ny) - ny // 2
    shape = padded_shape(ny, nx, periodic)
    padded = np.zeros((*kernels.shape[:3], *shape))
    padded[..., rows[:, None], np.arange(-nx, nx)] = kernels
    return fft.rfft2(padded)[..., : shape[0] // 2 + 1, :]


def kernel_table(ny: int, nx: int, width: float, depth: float, nu: float, periodic: bool) -> np.ndarray:
    """Kernel spectra (ky, 24, 6, 2, kx) at the OFFSETS, up to the last wave numbers that matter.

    The 24 are the components under pressure, traction and the slopes of both, the 2 real and imaginary parts.
    Width of rows and depth in elements along x. Kernels at an offset from the next node are mirrored ones.
    """
    rows, columns = padded_shape(ny, nx, periodic)
    along = 2 * np.pi / columns * np.arange(columns // 2 + 1)
    across = 2 * np.pi / (rows * width) * np.arange(rows // 2 + 1)
    wave_number = np.hypot(along, across[:, None])
    factor = low_pass(wave_number, depth, wave_number.max() * (1 + 1e-9))
    kept = np.s_[: np.count_nonzero(factor[:, 0]), : np.count_nonzero(factor[0])]
    signs = np.where(IS_EVEN_ALONG == IS_EVEN_ACROSS, 1, -1) * np.array([1, -1])[:, None, None]
    turn = signs[..., None, None] * np.exp(1j * along)
    shape = factor[kept].shape
    table = np.empty((shape[0], LOADS * LOADS * COMPONENTS, OFFSETS.size, 2, shape[1]))
    for k in range(OFFSETS.size // 2):
        left = factor * offset_spectra(ny, nx, width, depth, nu, OFFSETS[k], periodic)
        for place, spectra in ((k, left), (OFFSETS.size - 1 - k, turn * left.conj())):
            by_row = np.moveaxis(spectra.reshape(-1, *factor.shape)[:, *kept], 1, 0)
            table[:, :, place, 0], table[:, :, place, 1] = by_row.real, by_row.imag
    return table


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
    """Add to spectra out (frames, 6, rows, kx) from a kernel_table, weights and loads (frames, 4, rows, kx).

    Rows of negative wave numbers follow from those of positive ones by the signs (6,).
    """
    rows, count = out.shape[2], table.shape[4]
    real, imaginary = np.empty(count), np.empty(count)
    for row in range(table.shape[0]):
        mirrored = (rows - row) % rows
        for frame in range(weights.shape[0]):
            w = weights[frame]
            for m in range(table.shape[1]):
                load, part = m // 6, m % 6
                for half, values in ((0, real), (1, imaginary)):
                    at = table[row, m, :, half]
                    for k in range(count):
                        low = w[0] * at[0, k] + w[1] * at[1, k] + w[2] * at[2, k]
                        values[k] = low + w[3] * at[3, k] + w[4] * at[4, k] + w[5] * at[5, k]
                _add_product(real, imaginary, loads[frame, load, row], 1.0, out[frame, part, row])
                if mirrored != row:
                    load_row, sign = loads[frame, load, mirrored], signs[part]
                    _add_product(real, imaginary, load_row, sign, out[frame, part, mirrored])


class BlockStress:
    """Stresses at body points in a batch of frames, one depth at a time.

    `width`: spacing across and `depths` (nz,) in elements along x.
    """

    components, frames_at_once = COMPONENTS, 2

    def __init__(self, ny: int, nx: int, width: float, depths: np.ndarray, nu: float, periodic: bool) -> None:
        self.rows, self.shape = (ny,), padded_shape(ny, nx, periodic)
        self.bytes_per_sample = len(depths) * ny * COMPONENTS * COMPONENT_BYTES
        self.tables = [kernel_table(ny, nx, width, depth, nu, periodic) for depth in depths]

    def transform(self, pressure: np.ndarray, shear: np.ndarray) -> np.ndarray:
        """Spectra (frames, 4, rows, n/2 + 1) of the loads (frames, ny, nx) and their slopes along x.

        Beyond the end nodes a load falls to zero over one element.
        """
        loads = np.empty((len(pressure), 4, *pressure.shape[1:]))
        loads[:, 0], loads[:, 1] = pressure, shear
        for frame in loads:
            for k in range(LOADS):
                limited_slopes(frame[k], frame[k + LOADS])
        rows, columns = self.shape
        return fft.fft(fft.rfft(loads, columns), rows, axis=-2, overwrite_x=True)

    def __call__(self, depth: int, spectra: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """Stresses (frames, 6, ny, n) of depth number `depth` at offsets with these `offset_weights`."""
        table, (rows, columns) = self.tables[depth], self.shape
        out = np.zeros((len(spectra), COMPONENTS, rows, table.shape[-1]), complex)
        _multiply(table, weights, spectra, np.where(IS_EVEN_ACROSS, 1.0, -1.0), out)
        lines = fft.ifft(out, axis=-2, overwrite_x=True)[:, :, : self.rows[0]]
        return fft.irfft(lines, columns)
