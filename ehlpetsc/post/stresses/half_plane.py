r"""Stresses in the half plane under a line load, by FFT with exact element kernels.

Each body has its own frame: x as in the contact, z into the solid, tension positive, pressure positive,
traction q in +x on the solid. The load is linear between nodes and zero outside.

Half-plane kernels integrated exactly over piecewise-linear (hat) elements.

With u = x - s, D = u^2 + z^2 the plane-strain half plane under pressure p and traction q needs four kernels,

.. math:: A = z^3/D^2,\quad B = z^2u/D^2,\quad C = zu^2/D^2,\quad E = u^3/D^2,

    \sigma_x = -\tfrac2\pi(C*p+E*q),\quad \sigma_z = -\tfrac2\pi(A*p+B*q),
    \quad \tau_{xz} = -\tfrac2\pi(B*p+C*q)

(Holmes et al. 2005, section 2.3). All lengths here are in element lengths, so the integrals are numbers.
"""

from __future__ import annotations

import numpy as np
from scipy import fft


def von_mises_squared(sx: np.ndarray, sy: np.ndarray, sz: np.ndarray, txz: np.ndarray) -> np.ndarray:
    r"""Square of the equivalent stress, in the square of the unit given.

    :math:`\frac12[(\sigma_x-\sigma_y)^2+(\sigma_y-\sigma_z)^2+(\sigma_z-\sigma_x)^2]+3\tau_{xz}^2`, also of
    ranges, with their signs (Holmes et al. 2005, eq. (12)).
    """
    return 0.5 * ((sx - sy) ** 2 + (sy - sz) ** 2 + (sz - sx) ** 2) + 3 * (txz * txz)


GAUSS_DISTANCE = 8.0  # elements: beyond, quadrature is exact to rounding and the closed form has cancellation
GAUSS_NODES, GAUSS_WEIGHTS = np.polynomial.legendre.leggauss(10)
PARITY = np.array([1.0, -1.0, 1.0, -1.0])[:, None]  # of the kernels in u


def point_kernels(u: np.ndarray, z: float) -> np.ndarray:
    """Kernels A, B, C, E at distance u and depth z > 0 or u != 0; shape (4,) + shape of u."""
    d2 = (u * u + z * z) ** 2
    return np.stack([z**3 / d2, z * z * u / d2, z * u * u / d2, u**3 / d2])


def _primitives(u: np.ndarray, z: float) -> tuple[np.ndarray, np.ndarray]:
    """First and second antiderivatives in u of A, B, C, E, with their limits at z = 0."""
    theta = np.arctan2(u, z)
    d = u * u + z * z
    d = np.where(d > 0, d, 1.0)  # u = z = 0: u ln D and z ln D are 0, the rest is the finite part
    log_d = np.log(d)
    zu, zz = z * u / (2 * d), z * z / (2 * d)
    first = np.stack([theta / 2 + zu, -zz, theta / 2 - zu, log_d / 2 + zz])
    second = np.stack(
        [u * theta / 2, -z * theta / 2, u * theta / 2 - z * log_d / 2, u * log_d / 2 - u + 1.5 * z * theta]
    )
    return first, second


def half_hat(u: np.ndarray, z: float) -> np.ndarray:
    """Kernels integrated over the left half of a hat, load 1 + s on -1 <= s <= 0.

    At u = z = 0 the stress of a jump of the traction is infinite; the finite part is returned.
    """
    u = np.asarray(u, float)
    near = np.hypot(u, z) < GAUSS_DISTANCE
    out = np.empty((4, u.size))
    first, second = _primitives(u[near], z)
    out[:, near] = _primitives(u[near] + 1, z)[1] - second - first
    s = (GAUSS_NODES - 1) / 2
    out[:, ~near] = point_kernels(u[~near][:, None] - s, z) @ (GAUSS_WEIGHTS / 2 * (1 + s))
    return out


def hat(u: np.ndarray, z: float) -> np.ndarray:
    """Kernels A, B, C, E (4, n) integrated over a hat of unit height and base -1..1.

    `u` (n,) is the distance from the centre of the hat, `z` the depth, both in elements; at z = 0 the limits
    from inside the body.
    """
    return half_hat(u, z) + PARITY * half_hat(-u, z)


STORED_TOLERANCE = 1e-6  # relative, of stored positions


def spacing(x: np.ndarray) -> float:
    """Spacing of nodes; ValueError for fewer than two nodes or if they are not uniform and increasing."""
    x = np.asarray(x, float)
    dx = (x[-1] - x[0]) / (x.size - 1) if x.ndim == 1 and x.size > 1 else 0.0
    if not (dx > 0 and np.allclose(np.diff(x), dx, STORED_TOLERANCE, 8 * np.spacing(np.abs(x).max()))):
        raise ValueError("x must be a row of at least two nodes, uniformly spaced and increasing")
    return dx


def padded_length(nx: int) -> int:
    """FFT length of the linear convolution of nx nodes with nx offsets in both directions.

    2 nx - 1 would suffice; with 2 nx the kernels between two nodes are symmetric.
    """
    return fft.next_fast_len(2 * nx, real=True)


def checked_load(
    nodes: tuple[int, ...],
    z: float | np.ndarray,
    pressure: np.ndarray,
    shear: np.ndarray | None,
    poisson_ratio: float,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Depths, pressure and traction as arrays of floats, without traction zero; ValueError for bad ones.

    `nodes`: shape of the nodes, the last axes of the loads.
    """
    z, pressure = np.asarray(z, float), np.asarray(pressure, float)
    shear = np.zeros_like(pressure) if shear is None else np.asarray(shear, float)
    if pressure.shape[-len(nodes) :] != nodes or shear.shape != pressure.shape:
        raise ValueError(f"pressure and traction must have one value a node, (..., {nodes}), and one shape")
    if not -1 < poisson_ratio <= 0.5:
        raise ValueError("Poisson's ratio must lie between -1 and 0.5")
    if not (np.isfinite(z).all() and (z >= 0).all()):
        raise ValueError("depths must be finite and not negative")
    return z, pressure, shear


def _combined(kernels: np.ndarray, p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Stresses sx, sz, txz from kernels A, B, C, E times pressure and traction."""
    a, b, c, e = kernels
    return np.stack([c * p + e * q, a * p + b * q, b * p + c * q])


def stress(
    x: np.ndarray, z: float | np.ndarray, pressure: np.ndarray, shear: np.ndarray | None, poisson_ratio: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    r"""Plane-strain stresses under a load that is linear between nodes, to rounding.

    .. math::
        \sigma_x = -\tfrac{2z}{\pi}\int\tfrac{p\,(x-s)^2}{D^2}ds - \tfrac2\pi\int\tfrac{q\,(x-s)^3}{D^2}ds

        \sigma_z = -\tfrac{2z^3}{\pi}\int\tfrac{p}{D^2}ds - \tfrac{2z^2}{\pi}\int\tfrac{q\,(x-s)}{D^2}ds

        \tau_{xz} = -\tfrac{2z^2}{\pi}\int\tfrac{p\,(x-s)}{D^2}ds
        - \tfrac{2z}{\pi}\int\tfrac{q\,(x-s)^2}{D^2}ds

    with :math:`D=(x-s)^2+z^2` (Holmes et al. 2005, section 2.3, restored). At z = 0 the limits from inside:
    -p and the principal value for the traction; at an end node with traction without the infinite part.

    `x`: uniform nodes [m], shape (nx,).
    `z`: depth, or depths (nz,) [m].
    `pressure`, `shear`: pressure and traction in +x on this solid [Pa], shape (..., nx).
    `poisson_ratio`: checked, but the three in-plane stresses do not depend on it; the fourth is
        :math:`\sigma_y=\nu(\sigma_x+\sigma_z)`.

    Returns sx, sz, txz [Pa], shape (..., nz, nx), without the axis nz if z is a number.
    """
    x = np.asarray(x, float)
    z, pressure, shear = checked_load(x.shape, z, pressure, shear, poisson_ratio)
    nx, n, depths = x.size, padded_length(x.size), np.atleast_1d(z) / spacing(x)
    distance = np.arange(1 - nx, nx)
    kernels = np.zeros((4, depths.size, n))
    kernels[..., distance] = np.stack([hat(distance, depth) for depth in depths], axis=1)
    p, q = (fft.rfft(load, n)[..., None, :] for load in (pressure, shear))
    fields = fft.irfft(_combined(fft.rfft(kernels), p, q), n)[..., :nx]
    # the hats of the end nodes lack their outer halves
    left = np.stack([half_hat(np.arange(nx), depth) for depth in depths], axis=1)
    for node, half in ((0, left), (-1, PARITY[..., None] * left[..., ::-1])):
        fields -= _combined(half, pressure[..., node, None, None], shear[..., node, None, None])
    sx, sz, txz = -2 / np.pi * (fields if z.ndim else fields[..., 0, :])
    return sx, sz, txz


def von_mises(sx: np.ndarray, sz: np.ndarray, txz: np.ndarray, poisson_ratio: float) -> np.ndarray:
    """Von Mises stress under plane strain, Pa."""
    return np.sqrt(von_mises_squared(sx, poisson_ratio * (sx + sz), sz, txz))
