r"""Deflection of both bodies by the pressure of one cell: the kernel of a contact in the plane.

Both bodies together are a homogeneous half-space of the modulus E' and a sum of terms. A term is one function
in a module of its own and one entry in `TERMS`::

    def term(bodies: Bodies, mesh: Mesh) -> Kernel | None

It returns what it adds to the kernel K of the homogeneous half-spaces, in the unit of K, or None for bodies
that it does not concern; the part of body i has the factor ``bodies.shares[i]``, its share of the compliance.
Discretisation and preconditioner know the sum alone:

- `direct`: the deflection of a row by the pressures of all rows, a convolution. A coating is such a term.
- `mirrored`: the same by the pressures in reversed order of the rows. The images of the pressures beyond both
  end planes of a finite body are such a term (:mod:`.images`).
- `softening`: the compliance of waves of pressure over :math:`2\pi C/|k|`, that of homogeneous half-spaces.
  The sparse form of the preconditioner is fitted to it at the shortest waves; the long ones it takes from
  `direct`.

This gives up deflections that depend on the place itself, as those of a quarter space do near its edge;
images approximate them. Held by `tests/unit/test_kernels.py`.
"""

from __future__ import annotations

from collections.abc import Callable

from ehlpetsc.elasticity.bodies import Bodies
from ehlpetsc.elasticity.half_space import free_kernel, periodic_kernel
from ehlpetsc.elasticity.images import free_ends
from ehlpetsc.elasticity.kernel import Kernel, Mesh
from ehlpetsc.elasticity.layered import layers

TERMS: tuple[Callable[[Bodies, Mesh], Kernel | None], ...] = (layers, free_ends)


def kernel_of(bodies: Bodies, mesh: Mesh) -> Kernel:
    """Kernel K of both bodies in half-widths; the deflection in a^2/R is C K by pressures in p0."""
    (n_y, n_x), (dy, dx) = mesh.shape, mesh.spacings
    kernel = Kernel((periodic_kernel if mesh.periodic else free_kernel)(n_x, n_y, dx, dy))
    for term in TERMS:
        if added := term(bodies, mesh):
            kernel = kernel.plus(added)
    return kernel
