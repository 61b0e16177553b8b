r"""Normal and shear stresses of plane strain on planes in three dimensions, as weights of (sx, sz, txz).

The normal of a plane has the angle :math:`\theta` from x towards z in the section and the tilt
:math:`\varphi` out of it; a direction in the plane the angle :math:`\psi` from the section's:

.. math::
    n = (\cos\varphi\cos\theta,\ \sin\varphi,\ \cos\varphi\sin\theta), \quad
    t = \cos\psi\,(-\sin\theta,\ 0,\ \cos\theta)
        + \sin\psi\,(-\sin\varphi\cos\theta,\ \cos\varphi,\ -\sin\varphi\sin\theta)

With :math:`\sigma_y=\nu(\sigma_x+\sigma_z)` and no shear out of the section, shear stress
:math:`t\cdot\sigma n`, normal stress :math:`n\cdot\sigma n` and normal strain are sums of the three in-plane
stresses. Planes tilted by opposite angles are equivalent, so that tilts from 0 to 90 degrees suffice.
"""

from math import cos, pi, sin

import numpy as np

from ehlpetsc.base.compiled import compiled

GRID_STEP = 15.0  # degrees between the planes and directions of the coarse grid


@compiled(error_model="python", nogil=True)
def _normal(theta: float, phi: float) -> tuple[float, float, float]:
    return cos(phi) * cos(theta), sin(phi), cos(phi) * sin(theta)


@compiled(error_model="python", nogil=True)
def shear_weights(theta: float, phi: float, psi: float, nu: float) -> tuple[float, float, float]:
    """Weights (3,) of sx, sz, txz in the shear stress on a plane along a direction in it."""
    x, y, z = _normal(theta, phi)
    c, s = cos(psi), sin(psi)
    tx = -c * sin(theta) - s * sin(phi) * cos(theta)
    ty = s * cos(phi)
    tz = c * cos(theta) - s * sin(phi) * sin(theta)
    return x * tx + nu * y * ty, z * tz + nu * y * ty, x * tz + z * tx


@compiled(error_model="python", nogil=True)
def normal_weights(theta: float, phi: float, nu: float) -> tuple[float, float, float]:
    """Weights (3,) of sx, sz, txz in the normal stress on a plane."""
    x, y, z = _normal(theta, phi)
    return x * x + nu * y * y, z * z + nu * y * y, 2 * x * z


@compiled(error_model="python", nogil=True)
def strain_weights(theta: float, phi: float, nu: float) -> tuple[float, float, float]:
    """Weights (3,) of sx, sz, txz in E times the normal strain, the stress in uniaxial loading."""
    a, b, c = normal_weights(theta, phi, nu)
    return (1 + nu) * (a - nu), (1 + nu) * (b - nu), (1 + nu) * c


@compiled(error_model="python", nogil=True)
def residual_share(theta: float, phi: float) -> float:
    """Normal stress on a plane under a unit residual stress along the surface, in x and y."""
    x, y, _ = _normal(theta, phi)
    return x * x + y * y


def planes(step: float = GRID_STEP) -> np.ndarray:
    """Angles (count, 3) in radians of planes about `step` degrees apart, direction 0."""
    rows = []
    for tilt in np.arange(0.0, 90.0, step):
        count = max(1, round(180 / step * np.cos(np.radians(tilt))))
        rows += [(theta, tilt, 0.0) for theta in 180 / count * np.arange(count)]
    rows.append((0.0, 90.0, 0.0))
    return np.radians(rows)


def planes_and_directions(step: float = GRID_STEP) -> np.ndarray:
    """Angles (count, 3) in radians of planes and directions in them, both about `step` degrees apart.

    Planes without tilt have shear only in the direction of the section; the plane of the section has none.
    """
    psi = np.radians(np.arange(0.0, 180.0, step))
    rows = []
    for theta, phi, _ in planes(step):
        if phi < pi / 2 - 1e-9:
            rows += [(theta, phi, direction) for direction in (psi if phi > 0 else psi[:1])]
    return np.array(rows)


def described(theta: np.ndarray, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Angles of a plane's normal [degrees]: 0 to 180 from x towards z in the section, 0 to 90 out of it."""
    x, y, z = np.cos(phi) * np.cos(theta), np.sin(phi), np.cos(phi) * np.sin(theta)
    tilt = np.degrees(np.arctan2(np.abs(y), np.hypot(x, z)))
    return np.degrees(np.arctan2(z, x)) % 180.0, tilt
