r"""Free end faces of a roller: deflection of an elastic quarter space by images of the pressures.

Pressures mirrored about a plane leave no shear on it, but a normal stress. To relieve it, the plane is loaded
by that stress, mirrored about the surface; this loads the surface, and so on: alternating half-spaces
(Hetenyi 1960, J. Appl. Mech. 27, 289; Keer, Lee and Mura 1983, Int. J. Solids Struct. 19, 497). With A p
the normal stress of mirrored pressures on the plane, :math:`(1-A^2)^{-1}p` deflects the surface.

The pressure at y' from the end face, with its image at :math:`s=y+y'` across and x along,
:math:`r^2=x^2+s^2`, deflects the surface at y as on a half-space and its image times

.. math::

   \psi=\frac{\pi^2+4}{\pi^2-4}-(1-2\nu)\Big[\frac{2.42-0.66\,\nu}{1-\nu}\frac sr
   -(1.51-0.39\,\nu)\frac{s^2}{r^2}+0.46\frac{s^3}{r^3}\Big]+\frac32\frac{y\,y'}{r^2}.

The first term is exact for long waves along the edge: a wedge under a line load. The others are fitted to the
alternating half-spaces, within .7 % at any place and Poisson's ratio from 0 to .45. They deflect the roller
alone, body 1: the ring is longer and stays a half-space. The end faces are half a cell beyond the outer rows;
of round ends at the edge of the mesh.

This gives up the relief of one end face by the other: both are quarter spaces. Held by
`tests/verification/test_free_ends.py`.
"""

from __future__ import annotations

import numpy as np

from ehlpetsc.elasticity.bodies import Bodies
from ehlpetsc.elasticity.half_space import free_kernel
from ehlpetsc.elasticity.kernel import End, Kernel, Mesh

LONG_WAVES = (np.pi**2 + 4.0) / (np.pi**2 - 4.0)
OF_DISTANCES = 1.5  # factor of y y'/r^2


def image_factor(q: np.ndarray, poisson_ratio: float) -> np.ndarray:
    """Factor psi of an image without its part in y y', q = s/r."""
    nu = poisson_ratio
    by_q = q * ((2.42 - 0.66 * nu) / (1.0 - nu) - q * (1.51 - 0.39 * nu - 0.46 * q))
    return LONG_WAVES - (1.0 - 2.0 * nu) * by_q


def term(bodies: Bodies, mesh: Mesh) -> Kernel | None:
    """Images of the pressures by a roller with free end faces."""
    contact = bodies.contact
    if contact.length is None or not contact.free_ends:
        return None
    return of_quarter_spaces(mesh, contact.poisson_ratio[0]).times(bodies.shares[0])


def of_quarter_spaces(mesh: Mesh, poisson_ratio: float) -> Kernel:
    """What the free ends of a body add to a half-space."""
    (n_y, n_x), (dy, dx) = mesh.shape, mesh.spacings
    rows = 2 * (n_y + sum(mesh.to_ends))
    s = dy * np.maximum(np.arange(rows), 1.0)[:, None]  # the image of a row at the plane is never asked for
    r = np.hypot(dx * np.arange(n_x), s)
    single = image_factor(s / r, poisson_ratio) * free_kernel(n_x, rows, dx, dy)
    double = OF_DISTANCES * dx * dy / r**3
    ends = tuple(End(bool(last), beyond, dy, double[1:]) for last, beyond in enumerate(mesh.to_ends))
    return Kernel(np.zeros(mesh.shape), images(mesh, single), np.zeros_like, ends=ends)


def images(mesh: Mesh, kernel: np.ndarray) -> np.ndarray:
    """Kernel of the images of the pressures beyond both end planes, see :class:`.kernel.Kernel`.

    `kernel`: of one image, at distances in rows from it. With the planes half a cell beyond the outer rows,
    row j is j + l + 1 rows from the image of row l below and 2 n_y - 1 - j - l from that above: n_y + j - m
    and n_y - j + m by the reversed row m = n_y - 1 - l. Rows between the outer ones and a plane count twice.
    """
    n_y = mesh.shape[0]
    below, above = (2 * rows for rows in mesh.to_ends)
    return kernel[below + 1 : below + 2 * n_y] + kernel[above + 1 : above + 2 * n_y][::-1]
