"""Records of a kernel: the mesh on which it deflects the nodes, and its parts."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np


class Mesh(NamedTuple):
    """Nodes of a contact in the plane.

    `shape`: rows, nodes in a row. `spacings`: dy, dx in half-widths. `periodic`: across.
    `a`: half-width [m].
    `to_ends`: rows between the outer rows and the end faces of a finite body, below and above.
    """

    shape: Sequence[int]
    spacings: Sequence[float]
    periodic: bool
    a: float
    to_ends: tuple[int, int] = (0, 0)


class Kernel(NamedTuple):
    r"""Deflection at the nodes by the pressure of one cell.

    `direct`: at distances 0 .. n - 1 nodes, shape (n_y, n_x).
    `mirrored`: at distances 1 - n .. n - 1 across, by the pressures in reversed order of the rows, shape
        (2 n_y - 1, n_x); None: none.
    `is_homogeneous`: whether it is that of homogeneous half-spaces, or of a term whether the bodies stay so.
    `softening`: of wave numbers k in 1/a: compliance over :math:`2\pi C/k`; of a term what it adds.
    """

    direct: np.ndarray
    mirrored: np.ndarray | None = None
    softening: Callable[[np.ndarray], np.ndarray] = np.ones_like
    is_homogeneous: bool = True

    def plus(self, term: Kernel) -> Kernel:
        """Sum of a kernel and a term."""
        both = [one for one in (self.mirrored, term.mirrored) if one is not None]
        return Kernel(
            self.direct + term.direct,
            sum(both[1:], start=both[0]) if both else None,
            lambda k: self.softening(k) + term.softening(k),
            self.is_homogeneous and term.is_homogeneous,
        )
