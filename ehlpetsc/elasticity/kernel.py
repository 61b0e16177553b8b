r"""Deflection of both bodies by the pressure of one cell: the kernel of a contact in the plane.

Both bodies together are a homogeneous half-space of the modulus E' and a sum of terms, the modules of
:mod:`.terms`. Discretisation and preconditioner know the sum alone:

- `direct`: the deflection of a row by the pressures of all rows, a convolution. A coating is such a term.
- `mirrored`: the same by the pressures in reversed order of the rows. The images of the pressures beyond both
  end planes of a finite body are such a term (:mod:`.terms.free_ends`).
- `softening`: the compliance of waves of pressure over :math:`2\pi C/|k|`, that of homogeneous half-spaces.
  The sparse form of the preconditioner is fitted to it at the shortest waves; the long ones it takes from
  `direct`.

This gives up deflections that depend on the place itself, as those of a quarter space do near its edge;
images approximate them. Held by `tests/unit/test_kernels.py`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from ehlpetsc.elasticity.bodies import Bodies
from ehlpetsc.elasticity.half_space import free_kernel, periodic_kernel
from ehlpetsc.elasticity.terms import terms


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


def kernel_of(bodies: Bodies, mesh: Mesh) -> Kernel:
    """Kernel K of both bodies in half-widths; the deflection in a^2/R is C K by pressures in p0."""
    (n_y, n_x), (dy, dx) = mesh.shape, mesh.spacings
    kernel = Kernel((periodic_kernel if mesh.periodic else free_kernel)(n_x, n_y, dx, dy))
    for term in terms():
        if added := term(bodies, mesh):
            kernel = kernel.plus(added)
    return kernel
