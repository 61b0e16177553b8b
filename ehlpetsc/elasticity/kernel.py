r"""Deflection of both bodies by the pressure of one cell: the kernel of a contact in the plane.

Both bodies together are a homogeneous half-space of the modulus E' and a sum of terms, the modules of
:mod:`.terms`. Discretisation and preconditioner know the sum alone:

- `direct`: the deflection of a row by the pressures of all rows, a convolution. A coating is such a term.
- `mirrored`: the same by the pressures in reversed order of the rows. The images of the pressures beyond both
  end faces of a finite body are such a term (:mod:`.terms.free_ends`).
- `ends`: the same with both rows weighted by their distance from an end face, for the same bodies.
- `softening`: the compliance of waves of pressure over :math:`2\pi C/|k|`, that of homogeneous half-spaces.
  The sparse form of the preconditioner is fitted to it at the shortest waves; the long ones it takes from
  `direct`.

This gives up other deflections that depend on the place itself. Held by `tests/unit/test_kernels.py`.
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


class End(NamedTuple):
    r"""Deflection of row j by the pressures of rows l near one end face, :math:`y_jK_{j+l}y_l`.

    `is_last`: the end of the last row, from which rows count then. `beyond`: rows from the end face to the
    mesh. `step`: dy in a; row j is y = (beyond + j + 1/2) dy from the end face.
    `kernel`: at j + l + 2 beyond = 0, 1, ... as far as the other end face, shape (.., n_x).
    """

    is_last: bool
    beyond: int
    step: float
    kernel: np.ndarray


class Kernel(NamedTuple):
    r"""Deflection at the nodes by the pressure of one cell.

    `direct`: at distances 0 .. n - 1 nodes, shape (n_y, n_x).
    `mirrored`: at distances 1 - n .. n - 1 across, by the pressures in reversed order of the rows, shape
        (2 n_y - 1, n_x); None: none.
    `ends`: deflections weighted by distances from the end faces.
    `is_homogeneous`: whether it is that of homogeneous half-spaces, or of a term whether the bodies stay so.
    `softening`: of wave numbers k in 1/a: compliance over :math:`2\pi C/k`; of a term what it adds.
    """

    direct: np.ndarray
    mirrored: np.ndarray | None = None
    softening: Callable[[np.ndarray], np.ndarray] = np.ones_like
    is_homogeneous: bool = True
    ends: tuple[End, ...] = ()

    def plus(self, term: Kernel) -> Kernel:
        """Sum of a kernel and a term."""
        both = [one for one in (self.mirrored, term.mirrored) if one is not None]
        return Kernel(
            self.direct + term.direct,
            sum(both[1:], start=both[0]) if both else None,
            lambda k: self.softening(k) + term.softening(k),
            self.is_homogeneous and term.is_homogeneous,
            self.ends + term.ends,
        )

    def times(self, factor: float) -> Kernel:
        """Deflections of the kernel times a factor."""
        return self._replace(
            direct=factor * self.direct,
            mirrored=None if self.mirrored is None else factor * self.mirrored,
            ends=tuple(end._replace(kernel=factor * end.kernel) for end in self.ends),
        )


def kernel_of(bodies: Bodies, mesh: Mesh) -> Kernel:
    """Kernel K of both bodies in half-widths; the deflection in a^2/R is C K by pressures in p0."""
    (n_y, n_x), (dy, dx) = mesh.shape, mesh.spacings
    kernel = Kernel((periodic_kernel if mesh.periodic else free_kernel)(n_x, n_y, dx, dy))
    for term in terms():
        if added := term(bodies, mesh):
            kernel = kernel.plus(added)
    return kernel
