"""Von Mises' equivalent of a plane stress state or of a range of it; of arrays or of numbers."""

from __future__ import annotations

import numpy as np


def von_mises_squared(sx: np.ndarray, sy: np.ndarray, sz: np.ndarray, txz: np.ndarray) -> np.ndarray:
    r"""Square of the equivalent stress, in the square of the unit given.

    :math:`\frac12[(\sigma_x-\sigma_y)^2+(\sigma_y-\sigma_z)^2+(\sigma_z-\sigma_x)^2]+3\tau_{xz}^2`, also of
    ranges, with their signs (Holmes et al. 2005, eq. (12)).
    """
    return 0.5 * ((sx - sy) ** 2 + (sy - sz) ** 2 + (sz - sx) ** 2) + 3 * (txz * txz)
