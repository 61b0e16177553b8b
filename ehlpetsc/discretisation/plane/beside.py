"""Deflection of a window by the pressures of the smooth roller beside it.

They are linear along x and constant across a row, as the kernel has them: the same function on rows of the
window. Without roughness on the rows of the roller a window is then that roller to rounding.
"""

from __future__ import annotations

import numpy as np

from ehlpetsc.base.case import Contact
from ehlpetsc.discretisation.plane.deflection import Convolution, Transposition
from ehlpetsc.elasticity.bodies import Bodies
from ehlpetsc.elasticity.kernel import Mesh, kernel_of
from ehlpetsc.physics.contact.window import WindowGrid
from ehlpetsc.physics.scales import Scales


def gap_and_load_beside(
    contact: Contact, scales: Scales, grid: WindowGrid, pressure: np.ndarray
) -> tuple[np.ndarray, float]:
    """Gap of a window by the pressures beside it in a^2/R, flat, and their integral, in p0 and a.

    `pressure`: of the smooth roller at its nodes in p0, flat.
    """
    whole, inside = grid.whole, slice(grid.to_ends[0], grid.to_ends[0] + grid.shape[0])
    parts = sum((*grid.to_ends, grid.shape[0])) // whole.shape[0]
    beside = whole.rows(pressure).copy()
    beside[inside.start // parts : inside.stop // parts] = 0.0
    fine = np.repeat([np.interp(grid.x, whole.x, row) for row in beside], parts, axis=0)
    kernel = kernel_of(Bodies.of(contact), Mesh(fine.shape, grid.increments, False, scales.a))
    product = Convolution(kernel.times(scales.stiffness), False, Transposition())
    gap = product(fine.ravel()).reshape(fine.shape)[inside]
    return gap.ravel(), float(whole.cell * beside.sum())
