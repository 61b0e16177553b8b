"""Images of the pressures beyond both end planes of a finite body: no shear on the planes."""

from __future__ import annotations

import numpy as np

from ehlpetsc.elasticity.half_space import free_kernel
from ehlpetsc.elasticity.kernel import Mesh


def images(mesh: Mesh) -> np.ndarray:
    """Kernel of the images of the pressures beyond both end planes, by the reversed rows, shape (n_y, n_x).

    With the planes half a cell beyond the outer rows, row j is j + l + 1 rows from the image of row l below
    and 2 n_y - 1 - j - l from that above: n_y + j - m and n_y - j + m by the reversed row m = n_y - 1 - l.
    """
    (n_y, n_x), (dy, dx) = mesh.shape, mesh.spacings
    at = free_kernel(n_x, 2 * n_y, dx, dy)
    return at[n_y:] + at[n_y:0:-1]
