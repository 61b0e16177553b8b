r"""Images of the pressures beyond both end planes of a finite body: free end faces of a roller.

Pressures mirrored about a plane leave no shear on it. Its normal stress remains; relieving it too lets the
surface near the edge sink deeper, for which the images have the factor

.. math:: \psi=1.29-\frac{0.08-0.5\,\nu}{1-\nu}

of Guilbault (2011), J. Tribol. 133, 031402, 1.39 for steel. It is of the roller alone, body 1: the ring is
longer and stays a half-space. The end faces are half a cell beyond the outer rows; of round ends at the edge
of the mesh.

This gives up the exact deflection of a quarter space. The formula is quoted second-hand, and held by finite
elements of one. Of steel under waves along the edge the images deflect at most 4.7 % too little, at any
distance from it. Of dry rollers the maximum pressure and the load of a row over the largest are within .2 and
2 % where the profile unloads the ends, and 4.4 and 4.8 % too high at the sharp end of a straight one;
`tests/verification/test_free_ends.py` holds all. There 1.5 would be right, and wrong for the others: exact
images depend on both distances from the plane and on the wave along it.
"""

from __future__ import annotations

import numpy as np

from ehlpetsc.elasticity.bodies import Bodies
from ehlpetsc.elasticity.half_space import free_kernel
from ehlpetsc.elasticity.kernel import Kernel, Mesh


def image_factor(poisson_ratio: float) -> float:
    """Factor of the images of a body with free end faces."""
    return 1.29 - (0.08 - 0.5 * poisson_ratio) / (1.0 - poisson_ratio)


def term(bodies: Bodies, mesh: Mesh) -> Kernel | None:
    """Images of the pressures by a roller with free end faces."""
    contact = bodies.contact
    if contact.length is None or not contact.free_ends:
        return None
    factor = bodies.shares[0] * image_factor(contact.poisson_ratio[0])
    return Kernel(np.zeros(mesh.shape), factor * images(mesh), np.zeros_like)


def images(mesh: Mesh) -> np.ndarray:
    """Kernel of the images of the pressures beyond both end planes, see :class:`.kernel.Kernel`.

    With the planes half a cell beyond the outer rows, row j is j + l + 1 rows from the image of row l below
    and 2 n_y - 1 - j - l from that above: n_y + j - m and n_y - j + m by the reversed row m = n_y - 1 - l.
    Rows between the outer ones and a plane count twice.
    """
    (n_y, n_x), (dy, dx) = mesh.shape, mesh.spacings
    below, above = (2 * rows for rows in mesh.to_ends)
    at = free_kernel(n_x, 2 * n_y + max(below, above), dx, dy)
    return at[below + 1 : below + 2 * n_y] + at[above + 1 : above + 2 * n_y][::-1]
