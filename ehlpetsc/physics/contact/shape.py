r"""Shape of the undeformed solids: their gap is the sum of one :class:`Shape` per axis.

.. math:: g(x,y)=g_x(x)+g_y(y),\qquad g_s(s)=\frac{s^2}{2R_s}+z_s(s)

Parabolas follow the radius of the operating conditions, those of a point contact in the ratio of its radii;
a profile z (crown of a roller, relief of a cam) is that of the body and keeps its heights. Gaps that are no
such sum, as of a globoid worm, are not represented. `tests/unit/test_shape.py` holds both.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np


class Shape(NamedTuple):
    """Gap along one axis; lengths in half-widths a, gaps in a^2/R.

    `curvature`: R over the radius of the parabola, 0 without one.
    `profile`: gap besides as a function of the coordinate; None: none.
    """

    curvature: float = 0.0
    profile: Callable[[np.ndarray], np.ndarray] | None = None

    def parabola(self, s: np.ndarray) -> np.ndarray:
        """Gap of the parabola at the coordinates s."""
        return 0.5 * s**2 * self.curvature

    def beside(self, s: np.ndarray) -> np.ndarray:
        """Gap of the profile at the coordinates s."""
        return np.zeros_like(s) if self.profile is None else self.profile(s)


STRAIGHT, CYLINDER = Shape(), Shape(1.0)
"""No gap, as along a strip; the parabola of the radius R."""
