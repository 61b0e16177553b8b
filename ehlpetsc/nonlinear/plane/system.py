"""System of equations of a contact in the plane: Jacobian, preconditioner, exchange."""

from __future__ import annotations

import contextlib
import ctypes
from typing import TYPE_CHECKING

from petsc4py import PETSc

from ehlpetsc.discretisation.contact import film_scale_of
from ehlpetsc.discretisation.ehl_problem import problem_of
from ehlpetsc.discretisation.plane.deflection import Deflection
from ehlpetsc.elasticity.bodies import Bodies
from ehlpetsc.elasticity.kernel import Mesh, kernel_of
from ehlpetsc.nonlinear.plane.exchange import PlaneExchange, RankTransposition, first_rows, share_of
from ehlpetsc.nonlinear.plane.jacobian import PlaneJacobian
from ehlpetsc.nonlinear.plane.preconditioner import Elimination
from ehlpetsc.nonlinear.plane.step_limit import ByPressures
from ehlpetsc.nonlinear.two_fields import ZERO_TOLERANCE, Matrices, TwoFields
from ehlpetsc.physics.scales import Scales

if TYPE_CHECKING:
    from ehlpetsc.base.case import Case

# options of glibc's mallopt, and values: M_MMAP_THRESHOLD, M_MMAP_MAX, M_TRIM_THRESHOLD
RETURNING = ((-3, 1 << 25), (-4, 1 << 16), (-1, 1 << 27))


class PlaneMatrices(Matrices):
    """Matrix-free Jacobian; the preconditioner around that of the user's options."""

    keeps_factors = True
    linear_atol = 0.1  # an iteration costs a convolution
    exchange: PlaneExchange
    elimination: Elimination | None = None

    def jacobian(self, ksp: PETSc.KSP) -> PlaneJacobian:
        """See :class:`ehlpetsc.nonlinear.two_fields.Matrices`."""
        self.elimination = Elimination(self.problem, self.ranks, ksp.comm)
        return PlaneJacobian(self.problem, self.exchange, self.ranks, self.elimination, ksp.rtol)

    def begin_solve(self) -> None:
        """See :class:`ehlpetsc.nonlinear.two_fields.Matrices`."""
        if self.elimination.factors:
            self.elimination.begin_solve()

    def renew(self) -> None:
        """See :class:`ehlpetsc.nonlinear.two_fields.Matrices`."""
        self.elimination.renew()

    def keep(self, jacobian: PlaneJacobian) -> None:
        """See :class:`ehlpetsc.nonlinear.two_fields.Matrices`."""
        self.elimination.keep(jacobian)


def return_freed_memory() -> None:
    """Have malloc return freed blocks of 4 MB and more to the system.

    SuperLU_DIST, which Debian's PETSc loads, has it keep them, and factors do not fit the holes of others.
    """
    with contextlib.suppress(AttributeError):  # another C library
        for option in RETURNING:
            ctypes.CDLL(None).mallopt(*option)


def plane_system(
    case: Case, scales: Scales, film_scale: float, comm: PETSc.Comm, bound_tolerance: float = ZERO_TOLERANCE
) -> TwoFields:
    """System of a point contact or a strip; arguments as of :func:`.line.system.line_system`."""
    return_freed_memory()
    grid, ranks = scales.grid, comm.tompi4py()
    cuts = first_rows(grid.shape[0], ranks.size)
    share, has_sides = share_of(grid.shape, cuts[ranks.rank : ranks.rank + 2], grid.periodic)
    transposition = RankTransposition(cuts, ranks) if ranks.size > 1 else None
    mesh = Mesh(grid.shape, grid.increments, grid.periodic, scales.a, grid.to_ends)
    kernel = kernel_of(Bodies.of(case.contact), mesh)
    law = kernel, scales.stiffness, film_scale_of(case, scales, film_scale), grid.periodic
    deflection = Deflection(grid.increments, *law, share.owned, transposition)
    problem = problem_of(case, scales, film_scale, share, deflection, has_sides, bound_tolerance)
    exchange = PlaneExchange(problem, ranks, grid.periodic)
    matrices, limit = PlaneMatrices(problem, exchange, ranks), ByPressures(problem, exchange, ranks)
    return TwoFields(problem, exchange, matrices, limit, comm)
