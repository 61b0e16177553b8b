r"""Stresses in the half-space under pressure and traction over a plane, by FFT with exact kernels.

Frame and signs of :mod:`ehlpetsc.post.stresses.half_plane`, y across: z into the solid, tension positive,
pressure positive, traction q in +x on the solid. The load is linear between nodes along x and across, so that
summed over y the kernels are those of the half plane.

Kernels of Boussinesq's and Cerruti's point loads (Johnson, Contact Mechanics, sections 3.2 and 3.6), with
:math:`V=1/R`, :math:`\chi=\ln(R+z)`, :math:`\Omega=z\chi-R` and indices for derivatives:

.. math::
    2\pi\sigma_z &= (V_z-zV_{zz})*p - zV_{xz}*q \\
    2\pi\sigma_x &= (2\nu V_z-zV_{xx}-(1-2\nu)\chi_{xx})*p + (2(1+\nu)V_x+2\nu\Omega_{xxx}-z\chi_{xxx})*q \\
    2\pi\sigma_y &= (2\nu V_z-zV_{yy}-(1-2\nu)\chi_{yy})*p + (2\nu V_x+2\nu\Omega_{xyy}-z\chi_{xyy})*q \\
    2\pi\tau_{xy} &= (-zV_{xy}-(1-2\nu)\chi_{xy})*p + (V_y+2\nu\Omega_{xxy}-z\chi_{xxy})*q \\
    2\pi\tau_{yz} &= -zV_{yz}*p - zV_{xy}*q \\
    2\pi\tau_{xz} &= -zV_{xz}*p + (V_z-zV_{xx})*q

The integral over a hat in x and y is the second difference in both of a function F with
:math:`\partial_x^2\partial_y^2F=f`. Parts of F linear in x or in y drop out and are omitted.
"""

from __future__ import annotations

from math import asinh, atan2, log, pi, sqrt
from typing import NamedTuple

import numpy as np
from scipy import fft
from scipy.special import erfc

from ehlpetsc.base.compiled import compiled
from ehlpetsc.post.stresses.half_plane import checked_load, hat, spacing

COMPONENTS = 6
N_LOADS = 2
MIN_DISTANCE = 1e-100  # distance from a singular line; the factor of the logarithm is zero there
# Images of a periodic load, in periods: their sum fades out smoothly, so that it is exact but for the mean
FADE, FADE_WIDTH, SUMMED_IMAGES = 4.5, 1.2, 9


class StressTensor(NamedTuple):
    """Stress components [Pa], tension positive."""

    sx: np.ndarray
    sy: np.ndarray
    sz: np.ndarray
    txy: np.ndarray
    tyz: np.ndarray
    txz: np.ndarray


@compiled(error_model="python", nogil=True)
def _integrate(x: float, y: float, z: float, nu: float, out: np.ndarray) -> None:
    """Set out (2, 6) to the functions F of the kernels of pressure and traction, times 2 pi."""
    xx, yy, zz = x * x, y * y, z * z
    r = sqrt(xx + yy + zz)
    log_x = asinh(x / max(sqrt(yy + zz), MIN_DISTANCE))
    log_y = asinh(y / max(sqrt(xx + zz), MIN_DISTANCE))
    log_z = log(max(r + z, MIN_DISTANCE))
    angle_z, turned = atan2(x * y, z * r), x * y * (xx + yy) / max(r + z, MIN_DISTANCE)
    angle_x, angle_y = atan2(turned, xx * r + yy * z), atan2(turned, yy * r + xx * z)
    v_xx, v_yy = y * log_y - r, x * log_x - r
    v_xy = x * log_y + y * log_x - z * angle_z
    v_xz, v_yz = -y * angle_z - z * log_x, -x * angle_z - z * log_y
    v_x = x * y * log_y - x * r / 2 + (yy - zz) / 2 * log_x - y * z * angle_z
    v_y = x * y * log_x - y * r / 2 + (xx - zz) / 2 * log_y - x * z * angle_z
    v_z = z * r - x * y * angle_z - x * z * log_x - y * z * log_y
    chi_xx = (yy - xx) / 2 * log_z - z * r / 2 + y * z * log_y + x * y * angle_x
    chi_yy = (xx - yy) / 2 * log_z - z * r / 2 + x * z * log_x + x * y * angle_y
    chi_xy = x * y * log_z + z * v_xy + (xx * angle_x + yy * angle_y + zz * angle_z) / 2
    chi_xxx, chi_xxy = y * angle_x - x * log_z, y * log_z + z * log_y + x * angle_x
    omega_xxx = z * chi_xxx - x * v_xx
    omega_xxy = z * chi_xxy - y * r / 2 - (xx + zz) / 2 * log_y
    free = 1 - 2 * nu
    out[0, 0] = 2 * nu * v_z - z * v_xx - free * chi_xx
    out[0, 1] = 2 * nu * v_z - z * v_yy - free * chi_yy
    out[0, 2] = v_z + z * (v_xx + v_yy)
    out[0, 3] = -z * v_xy - free * chi_xy
    out[0, 4] = -z * v_yz
    out[0, 5] = -z * v_xz
    out[1, 0] = 2 * (1 + nu) * v_x + 2 * nu * omega_xxx - z * chi_xxx
    out[1, 1] = z * (chi_xxx + v_xz) - 2 * nu * omega_xxx
    out[1, 2] = -z * v_xz
    out[1, 3] = v_y + 2 * nu * omega_xxy - z * chi_xxy
    out[1, 4] = -z * v_xy
    out[1, 5] = v_z - z * v_xx


@compiled(error_model="python", nogil=True)
def _bend(low: float, middle: float, high: float) -> float:
    """Second difference."""
    return (low - middle) + (high - middle)


@compiled(error_model="python", nogil=True)
def _fill(x: np.ndarray, y: np.ndarray, z: float, nu: float, out: np.ndarray) -> None:
    """Set out (2, 6, ny - 2, nx - 2) to second differences over the uniform corners x (nx,), y (ny,)."""
    corners, bends = np.empty((x.size, 2, 6)), np.empty((3, x.size - 2, 2, 6))
    scale = 1 / (2 * pi * (x[1] - x[0]) * (y[1] - y[0]))
    for j in range(y.size):
        for i in range(x.size):
            _integrate(x[i], y[j], z, nu, corners[i])
        new, middle, old = bends[j % 3], bends[(j + 2) % 3], bends[(j + 1) % 3]
        for i in range(x.size - 2):
            for load in range(2):
                for part in range(6):
                    low, high = corners[i, load, part], corners[i + 2, load, part]
                    new[i, load, part] = _bend(low, corners[i + 1, load, part], high)
                    if j > 1:
                        bend = _bend(old[i, load, part], middle[i, load, part], new[i, load, part])
                        out[load, part, j - 2, i] = scale * bend


def hat_kernels(x: np.ndarray, y: np.ndarray, z: float, nu: float) -> np.ndarray:
    """Stresses (2, 6, ny, nx) under a unit pressure and a unit traction that are hats along x and y.

    Distances x (nx,), y (ny,) from the centre, z >= 0; the base of the hats is two spacings of x and y.
    """

    def corners(at: np.ndarray) -> np.ndarray:
        return np.concatenate([at[:1] - (at[1] - at[0]), at, at[-1:] + (at[1] - at[0])])

    out = np.empty((N_LOADS, COMPONENTS, y.size, x.size))
    _fill(corners(x), corners(y), float(z), nu, out)
    return out


def plane_strain(kernels: np.ndarray, nu: float) -> np.ndarray:
    """Kernels (2, 6, ...) of a load that does not depend on y from -2/pi times A, B, C, E of the
    half plane (4, ...).
    """
    a, b, c, e = kernels
    zero = np.zeros_like(a)
    return np.stack([[c, nu * (a + c), a, zero, zero, b], [e, nu * (b + e), b, zero, zero, c]])


def fading(periods: float | np.ndarray) -> np.ndarray:
    """Weight of an image at a distance in periods."""
    return erfc((periods - FADE) / FADE_WIDTH) / 2


def sum_images(kernels: np.ndarray, mean: np.ndarray) -> np.ndarray:
    """Kernels (2, 6, ny, ...) of a load of period ny cells across.

    `kernels` (2, 6, (2 IMAGES + 1) ny, ...) are those of one cell, ascending in y, its own period in the
    middle; `mean` (2, 6, ...) is their sum over y, which converges too slowly.
    """
    total = kernels.shape[2]
    ny = total // (2 * SUMMED_IMAGES + 1)
    periods = np.abs(np.arange(total) - SUMMED_IMAGES * ny - ny // 2) / ny
    faded = fading(periods)
    shape = *kernels.shape[:2], 2 * SUMMED_IMAGES + 1, ny, *kernels.shape[3:]
    one = np.einsum("lcijx,ij->lcjx", kernels.reshape(shape), faded.reshape(-1, ny))
    return one + ((mean - one.sum(axis=2)) / ny)[:, :, None]


def rows_across(ny: int, periodic: bool) -> np.ndarray:
    """Distances of rows in cells, ascending, whose kernels a load of ny rows needs."""
    if periodic:
        return np.arange(-SUMMED_IMAGES * ny - ny // 2, (SUMMED_IMAGES + 1) * ny - ny // 2, dtype=float)
    return np.arange(1.0 - ny, ny)


def padded_shape(ny: int, nx: int, periodic: bool) -> tuple[int, int]:
    """Shape of the transforms of a convolution that is not periodic along x, nor across unless asked for."""
    along = fft.next_fast_len(2 * nx, real=True)
    return (ny if periodic else fft.next_fast_len(2 * ny - 1, real=True)), along


def _kernels(ny: int, nx: int, width: float, z: float, nu: float, periodic: bool) -> np.ndarray:
    """Kernels (2, 6, rows, columns) of all distances in the layout of the transforms; lengths over dx."""
    distance, rows = np.arange(1.0 - nx, nx), rows_across(ny, periodic)
    kernels = hat_kernels(distance, width * rows, z, nu)
    if periodic:
        kernels = sum_images(kernels, plane_strain(-2 / np.pi * hat(distance, z), nu))
        rows = np.arange(ny) - ny // 2
    out = np.zeros((N_LOADS, COMPONENTS, *padded_shape(ny, nx, periodic)))
    out[:, :, rows.astype(int)[:, None], distance.astype(int)] = kernels
    return out


def stress_plane(
    x: np.ndarray,
    y: np.ndarray,
    z: float | np.ndarray,
    pressure: np.ndarray,
    shear_x: np.ndarray | None,
    poisson_ratio: float,
    periodic: bool = False,
) -> StressTensor:
    r"""Stresses of the elastic half-space under a load over a plane, to rounding for the load given.

    The load is linear between nodes along x and across, and falls to zero over one spacing beyond the end
    nodes. At z = 0 the limits from inside.

    `x`, `y`: uniform nodes [m], shapes (nx,), (ny,).
    `z`: depth, or depths (nz,) [m].
    `pressure`, `shear_x`: pressure and traction in +x on this solid [Pa], shape (..., ny, nx).
    `periodic`: the load repeats across with the period ny spacings (a strip), instead of being zero outside.

    Returns sx, sy, sz, txy, tyz, txz [Pa], shape (..., nz, ny, nx), without the axis nz if z is a number.
    """
    x, y = np.asarray(x, float), np.asarray(y, float)
    ny, nx = y.size, x.size
    z, pressure, shear = checked_load((ny, nx), z, pressure, shear_x, poisson_ratio)
    dx, shape = spacing(x), padded_shape(ny, nx, periodic)
    loads = fft.rfft2(np.stack([pressure, shear]), shape)[:, None]
    layers = []
    for depth in np.atleast_1d(z) / dx:
        spectra = fft.rfft2(_kernels(ny, nx, spacing(y) / dx, depth, poisson_ratio, periodic))
        spectra = spectra.reshape(N_LOADS, COMPONENTS, *(1,) * (pressure.ndim - 2), *spectra.shape[-2:])
        layers.append(fft.irfft2((spectra * loads).sum(axis=0), shape)[..., :ny, :nx])
    return StressTensor(*(np.stack(layers, axis=-3) if z.ndim else layers[0]))
