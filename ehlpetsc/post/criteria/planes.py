r"""Fatigue criteria other than the paper's and their constants; stresses on planes in three dimensions.

Fatemi & Socie (1988), Fatigue Fract. Engng Mater. Struct. 11: shear strain, and the normal stress that opens
a shear crack:

.. math::
    \frac{\Delta\gamma}{2}\Big(1+k\frac{\sigma_{n,\max}}{\sigma_y}\Big)
    = \frac{\tau_f'}{G}(2N)^b + \gamma_f'(2N)^c

with :math:`\tau_f'=\sigma_f'/\sqrt3`, :math:`\gamma_f'=\sqrt3\,\varepsilon_f'` (von Mises). k is fitted to
tests in torsion and in tension; 1 is customary for steel without tests. Torsion tests of a hardened
spring steel: McClaflin & Fatemi (2004), Int. J. Fatigue 26, 773.

Strain ranges come from elastic ones by the same rule as in the paper's criterion (13), the shear as
:math:`\Delta\gamma = \sqrt3\,\Delta\varepsilon(\sqrt3\Delta\tau)` with 3G for E. The maximum
normal stress is elastic and includes the residual stress; compression counts as zero, so that its benefit is
limited to a cycle that ends at zero stress.

The normal of a plane has the angle :math:`\theta` from x towards z in the section
and the tilt :math:`\varphi` out of it; a direction in the plane the angle :math:`\psi` from the section's:

.. math::
    n = (\cos\varphi\cos\theta,\ \sin\varphi,\ \cos\varphi\sin\theta), \quad
    t = \cos\psi\,(-\sin\theta,\ 0,\ \cos\theta)
        + \sin\psi\,(-\sin\varphi\cos\theta,\ \cos\varphi,\ -\sin\varphi\sin\theta)

With :math:`\sigma_y=\nu(\sigma_x+\sigma_z)` and no shear out of the section, shear stress
:math:`t\cdot\sigma n` and normal stress :math:`n\cdot\sigma n` are sums of the three in-plane stresses.
Planes tilted by opposite angles are equivalent, so that tilts from 0 to 90 degrees suffice.

Samples at which the path of the stress turns: the stress on a plane is a weighted sum of the three stresses.
Samples at which one of 13 such sums reverses by more than a tolerance are kept, and between them samples off
the straight line; the path between kept samples is straight and monotone, so that the stress on any plane has
no larger reversal between them than about the tolerance.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from math import asin, atan2, cos, exp, log, pi, sin, sqrt

import numpy as np

from ehlpetsc.base.compiled import ZERO, compiled
from ehlpetsc.base.errors import PostError
from ehlpetsc.base.materials import PLASTIC_STRAIN
from ehlpetsc.post.fatigue.strain_life import Material, interpolate

JACOBI_SWEEPS = 4
AXIS_TOLERANCE = 0.02  # of the widest of the three axes of a path: reversals that are left out
GRID_STEP = pi / 12  # between the planes and directions of the coarse grid


@compiled(error_model="python", nogil=True)
def plane_weights(theta: float, phi: float, psi: float, nu: float) -> tuple[tuple, tuple, float]:
    """Weights (3,) of sx, sz, txz in shear and normal stress on a plane, of residual stress in the latter."""
    x, y, z = cos(phi) * cos(theta), sin(phi), cos(phi) * sin(theta)
    c, s = cos(psi), sin(psi)
    tx = -c * sin(theta) - s * sin(phi) * cos(theta)
    ty = s * cos(phi)
    tz = c * cos(theta) - s * sin(phi) * sin(theta)
    shear = x * tx + nu * y * ty, z * tz + nu * y * ty, x * tz + z * tx
    return shear, (x * x + nu * y * y, z * z + nu * y * y, 2 * x * z), x * x + y * y


@compiled(error_model="python", nogil=True)
def tensor_weights(theta: float, phi: float, psi: float) -> tuple[tuple, tuple, float]:
    """Weights (6,) of sx, sz, txz, sy, txy, tyz as those of :func:`plane_weights`."""
    x, y, z = cos(phi) * cos(theta), sin(phi), cos(phi) * sin(theta)
    c, s = cos(psi), sin(psi)
    tx = -c * sin(theta) - s * sin(phi) * cos(theta)
    ty = s * cos(phi)
    tz = c * cos(theta) - s * sin(phi) * sin(theta)
    shear = x * tx, z * tz, x * tz + z * tx, y * ty, x * ty + y * tx, y * tz + z * ty
    return shear, (x * x, z * z, 2 * x * z, y * y, 2 * x * y, 2 * y * z), x * x + y * y


def planes_and_directions(step: float = GRID_STEP, components: int = 3) -> np.ndarray:
    """Angles (count, 3) in radians of planes and directions in them, both about `step` apart.

    Of three components, planes without tilt have shear only in the direction of the section, the plane of the
    section has none, and tilts both ways are equivalent.
    """
    degrees, rows = np.degrees(step), []
    in_section = components == 3
    for tilt in np.arange(0.0 if in_section else degrees - 90.0, 90.0, degrees):
        count = max(1, round(180 / degrees * np.cos(np.radians(tilt))))
        directions = degrees * np.arange(round(180.0 / degrees) if tilt or not in_section else 1)
        rows += [(theta, tilt, psi) for theta in 180 / count * np.arange(count) for psi in directions]
    return np.radians(rows)


@compiled(error_model="python", nogil=True)
def on_plane(angles: np.ndarray, stress: np.ndarray, law: tuple, work: tuple) -> None:
    """Fill in the shear stress, as an equivalent stress, and the normal stress."""
    size = stress.shape[1]
    if stress.shape[0] == 3:
        shear, normal, share = plane_weights(angles[0], angles[1], angles[2], law[0])
        a, b, c = shear
        work[2][:size] = 3**0.5 * (a * stress[0] + b * stress[1] + c * stress[2])
        a, b, c = normal
        work[3][:size] = law[1] * share + (a * stress[0] + b * stress[1] + c * stress[2])
        return
    in_shear, across, share = tensor_weights(angles[0], angles[1], angles[2])
    root, residual = 3**0.5, law[1] * share
    for i in range(size):
        along, normal = 0.0, residual
        for k in range(6):
            along += root * in_shear[k] * stress[k, i]
            normal += across[k] * stress[k, i]
        work[2][i], work[3][i] = along, normal


@compiled(error_model="python", nogil=True)
def _principal_axes(tensor: np.ndarray, axes: np.ndarray) -> None:
    """Set the columns of axes (3, 3) to principal directions by Jacobi's rotations; tensor gets diagonal."""
    axes[:] = 0.0
    for k in range(3):
        axes[k, k] = 1.0
    for _ in range(JACOBI_SWEEPS):
        for i in range(2):
            for j in range(i + 1, 3):
                if tensor[i, j] == 0.0:
                    continue
                angle = 0.5 * atan2(2 * tensor[i, j], tensor[j, j] - tensor[i, i])
                c, s = cos(angle), sin(angle)
                for k in range(3):
                    a, b = tensor[k, i], tensor[k, j]
                    tensor[k, i], tensor[k, j] = c * a - s * b, s * a + c * b
                    a, b = axes[k, i], axes[k, j]
                    axes[k, i], axes[k, j] = c * a - s * b, s * a + c * b
                for k in range(3):
                    a, b = tensor[i, k], tensor[j, k]
                    tensor[i, k], tensor[j, k] = c * a - s * b, s * a + c * b


@compiled(error_model="python", nogil=True)
def shear_planes(stress: np.ndarray, begin: int, end: int, angles: np.ndarray) -> None:
    """Angles (2, 3) of both planes of maximum shear between two samples."""
    tensor, axes = np.empty((3, 3)), np.empty((3, 3))
    for row, column, part in ((0, 0, 0), (2, 2, 1), (0, 2, 2), (1, 1, 3), (0, 1, 4), (1, 2, 5)):
        tensor[row, column] = tensor[column, row] = stress[part, end] - stress[part, begin]
    _principal_axes(tensor, axes)
    low, high = 0, 0
    for k in range(3):
        low = k if tensor[k, k] < tensor[low, low] else low
        high = k if tensor[k, k] > tensor[high, high] else high
    for turn in range(2):
        sign = 1.0 - 2.0 * turn
        x, y, z = (axes[:, high] + sign * axes[:, low]) / sqrt(2.0)
        tx, ty, tz = (axes[:, high] - sign * axes[:, low]) / sqrt(2.0)
        theta, phi = atan2(z, x), asin(min(max(y, -1.0), 1.0))
        along = cos(theta) * tz - sin(theta) * tx
        across = cos(phi) * ty - sin(phi) * (cos(theta) * tx + sin(theta) * tz)
        angles[turn] = theta, phi, atan2(across, along)


@dataclass(frozen=True)
class Criteria:
    """Constants of the criteria in addition to those of the strain-life curves, SI units.

    The limits by default: 375 MPa, the amplitude 0.25 p of the shear stress parallel to the surface at the
    Hertz pressure of 1.5 GPa, the fatigue limit of bearing steel in ISO 281:2007 (in a point contact a von
    Mises stress of 0.9 GPa), and sqrt(3) of it in bending.
    """

    normal_sensitivity: float = 1.0  # k of Fatemi and Socie; 1 is customary without tests
    yield_strength: float | None = None  # sigma_y; None: cyclic, at 0.2 % plastic strain, K' 0.002^n'
    torsion_limit: float = 375e6  # tau_w of Dang Van
    bending_limit: float = 375e6 * sqrt(3)  # sigma_w of Dang Van

    def __post_init__(self) -> None:
        if self.torsion_limit < self.bending_limit / 2:
            raise PostError(
                f"post.torsion_limit = {self.torsion_limit}: must be half of bending_limit or more "
                "(Dang Van's constant a would be negative)"
            )

    @property
    def hydrostatic_slope(self) -> float:
        """a of Dang Van's criterion."""
        return 3 * (self.torsion_limit / self.bending_limit - 0.5)

    def sensitivity(self, material: Material) -> float:
        """k/sigma_y of Fatemi and Socie, 1/Pa."""
        cyclic = material.hardening_coefficient * PLASTIC_STRAIN**material.cyclic_hardening
        return self.normal_sensitivity / (self.yield_strength or cyclic)


@compiled(error_model="python", nogil=True)
def cycle_damage(width: float, normal: float, law: tuple) -> float:
    """1/N of a cycle of sqrt(3) times the shear stress, of a range and a maximum normal stress [Pa].

    `law`: of :func:`.critical_plane.plane_law`.
    """
    _, _, sensitivity, curve, lives, _ = law
    if width <= 0:
        return 0.0
    parameter = interpolate(2 * log(width), curve)
    if normal > 0:
        parameter += log(1 + sensitivity * normal)
    return exp(min(interpolate(parameter, lives), 700.0))


def _directions(axes: int) -> np.ndarray:
    """Unit vectors (count, axes) along the edges and diagonals of a cube, one of each opposite pair."""
    ways = np.array([way for way in product((-1.0, 0.0, 1.0), repeat=axes) if way > (0.0,) * axes])
    return ways / np.linalg.norm(ways, axis=1)[:, None]


DIRECTIONS, DIRECTIONS_OF_SIX = _directions(3), _directions(5)


@compiled(error_model="python", nogil=True)
def _mark_reversals(values: np.ndarray, tolerance: float, is_kept: np.ndarray) -> None:
    """Mark the samples at which a series reverses by more than the tolerance."""
    top = bottom = sign = 0
    for k in range(1, values.size):
        if sign >= 0:
            if values[k] > values[top]:
                top = k
            elif values[top] - values[k] > tolerance:
                is_kept[top] = True
                sign, bottom = -1, k
        if sign <= 0:
            if values[k] < values[bottom]:
                bottom = k
            elif values[k] - values[bottom] > tolerance:
                is_kept[bottom] = True
                sign, top = 1, k
    if sign:
        is_kept[top if sign > 0 else bottom] = True


@compiled(error_model="python", nogil=True)
def _off_line(points: np.ndarray, first: int, last: int) -> tuple[int, float]:
    """Sample with the maximum distance from the straight line between two samples, and this distance."""
    axes, length = points.shape[0], 0.0
    for axis in range(axes):
        length += (points[axis, last] - points[axis, first]) ** 2
    index, largest = first, 0.0
    for k in range(first + 1, last):
        along = 0.0
        for axis in range(axes):
            step = points[axis, last] - points[axis, first]
            along += (points[axis, k] - points[axis, first]) * step
        along = min(max(along / length, 0.0), 1.0) if length > 0 else 0.0
        away = 0.0
        for axis in range(axes):
            step = points[axis, last] - points[axis, first]
            away += (points[axis, k] - points[axis, first] - along * step) ** 2
        if away > largest:
            index, largest = k, away
    return index, sqrt(largest)


@compiled(error_model="python", nogil=True)
def turning_samples(points: np.ndarray, size: int, indices: np.ndarray) -> int:
    """Write the indices of the samples to keep of points (3 or 5, :size); return their number."""
    extent = 0.0
    for k in range(points.shape[0]):
        extent = max(extent, points[k, :size].max() - points[k, :size].min())
    tolerance = AXIS_TOLERANCE * extent
    is_kept = np.zeros(size, np.bool_)
    is_kept[0] = is_kept[size - 1] = True
    directions = DIRECTIONS if points.shape[0] == 3 else DIRECTIONS_OF_SIX
    along = np.empty(size)
    for way in directions:
        along[:] = 0.0
        for axis in range(points.shape[0]):
            if way[axis] != 0.0:
                for k in range(size):
                    along[k] += way[axis] * points[axis, k]
        _mark_reversals(along, tolerance, is_kept)
    count, first = 0, ZERO
    ends = np.empty(size, np.int64)
    for last in range(size):
        if not is_kept[last]:
            continue
        ends[0], open_ends = last, 1
        while open_ends:  # stack of the ends of the remaining intervals
            end = ends[open_ends - 1]
            index, away = _off_line(points, first, end)
            if away > tolerance:
                ends[open_ends] = index
                open_ends += 1
            else:
                indices[count] = end
                count += 1
                first = end
                open_ends -= 1
    return count
