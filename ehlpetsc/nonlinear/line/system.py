"""System of equations of a line contact: problem, Jacobian, and its near-exact inverse as a preconditioner.

Use: ``-pc_type python -pc_python_type ehlpetsc.nonlinear.line.system.FarFieldBand`` (the default), on any
number of ranks.

The band of :mod:`.banded_jacobian` includes the far deflection; :mod:`.distributed_lu` splits it by ranks.
The error left to GMRES is that of three exponentials, the same on any number of ranks.
"""

from __future__ import annotations

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from ehlpetsc.base.case import Case
from ehlpetsc.discretisation.ehl_problem import EHLProblem, problem_of
from ehlpetsc.discretisation.line.deflection import Deflection
from ehlpetsc.discretisation.unknowns import Share
from ehlpetsc.nonlinear.line.banded_jacobian import BandedJacobian
from ehlpetsc.nonlinear.line.distributed_lu import DistributedLU, solve
from ehlpetsc.nonlinear.line.exchange import LineExchange, first_nodes
from ehlpetsc.nonlinear.line.jacobian import JacobianOperator, NearFieldMatrix
from ehlpetsc.nonlinear.line.node_pairs import node_pairs
from ehlpetsc.nonlinear.options import BACK_SOLVE, FACTOR
from ehlpetsc.nonlinear.step_limit import Linearised
from ehlpetsc.nonlinear.two_fields import ZERO_TOLERANCE, Matrices, TwoFields
from ehlpetsc.physics.scales import Scales


class LineFactors:
    """Factors of one scene, kept from one matrix to the next.

    PETSc creates a new preconditioner whenever the contact set changes.
    """

    def __init__(self, problem: EHLProblem, ranks: MPI.Comm):
        self.lu = DistributedLU(BandedJacobian(problem), -problem.deflection.end_row_coefficient, ranks)
        self.fresh, self._owned = False, problem.owned

    def invalidate(self) -> None:
        """Factor the next matrix anew, so that a run continues after a restart as it would have without."""
        self.fresh = False

    def factor(self, operator: JacobianOperator) -> None:
        """Factor for the state of a :mod:`ehlpetsc.nonlinear.two_fields`."""
        state, derivatives = operator.state, operator.reynolds_derivatives
        entries, unknowns = node_pairs(state, operator.model.compliance, derivatives, self.lu.band.stencil)
        self.lu.factor(entries, operator.inactive_nodes, anew=not self.fresh)
        self.fresh = True
        self.lu.units[:] = unknowns[:, self._owned]


class FarFieldBand:
    """Context of PETSc's Python preconditioner."""

    def setUp(self, pc: PETSc.PC) -> None:
        """Factor for the state of the operator."""
        with FACTOR:
            self.operator = pc.getOperators()[0].getPythonContext()
            self.operator.factors.factor(self.operator)

    def apply(self, pc: PETSc.PC, x: PETSc.Vec, y: PETSc.Vec) -> None:
        """Solve for one right-hand side."""
        operator = self.operator
        b, solution = np.zeros(operator.size), np.empty(operator.size)
        b[operator.active] = x.array_r
        with BACK_SOLVE:
            solve(operator.factors.lu.factors, b, solution)
        y.array[:] = solution[operator.active]


def line_problem(
    case: Case, scales: Scales, film_scale: float, first: int, last: int, bound_tolerance: float = 0.0
) -> EHLProblem:
    """Problem of the nodes first .. last-1 of a line contact.

    `film_scale`: expected film in a^2/R.
    `bound_tolerance`: of the active set in a^2/R: films this close to their bound count as on it.
    """
    deflection = Deflection(scales.grid.n, scales.grid.dx, first, last)
    share = Share(first, last, deflection.window, deflection.owned)
    return problem_of(case, scales, film_scale, share, deflection, bound_tolerance=bound_tolerance)


class LineMatrices(Matrices):
    """Block tridiagonal factors with the far deflection, or an assembled matrix for PETSc's preconditioners.

    A band is factored in less time than it takes to keep it.

    `near_field`: nodes of deflection on either side in the assembled matrix.
    """

    exchange: LineExchange
    factors: LineFactors | None = None

    def __init__(self, problem: EHLProblem, exchange: LineExchange, ranks: MPI.Comm, near_field: int):
        super().__init__(problem, exchange, ranks)
        self.near_field = near_field

    def jacobian(self, ksp: PETSc.KSP) -> JacobianOperator:
        """See :class:`.two_fields.Matrices`."""
        is_ours = ksp.pc.getType() == "python" and isinstance(ksp.pc.getPythonContext(), FarFieldBand)
        self.factors = LineFactors(self.problem, self.ranks) if is_ours else None
        return JacobianOperator(self.problem, self.exchange.linear, self.ranks, self.factors)

    def assembled(self, ksp: PETSc.KSP, sizes: tuple) -> NearFieldMatrix | None:
        """See :class:`.two_fields.Matrices`."""
        if self.factors:
            return None
        matrix = PETSc.Mat().createAIJ((sizes, sizes), comm=ksp.comm)
        return NearFieldMatrix(self.problem, self.near_field, matrix)

    def begin_solve(self) -> None:
        """See :class:`.two_fields.Matrices`."""
        if self.factors:
            self.factors.invalidate()


def line_system(
    case: Case, scales: Scales, film_scale: float, comm: PETSc.Comm, bound_tolerance: float = ZERO_TOLERANCE
) -> TwoFields:
    """System of a line contact.

    `film_scale`: expected film in a^2/R.
    `bound_tolerance`: tolerance of the active set in a^2/R, ``-snes_vi_zero_tolerance`` of SNES: films this
        close to their bound count as on it.
    """
    cuts, ranks = first_nodes(scales.grid.n, comm.size), comm.tompi4py()
    first, last = cuts[comm.rank : comm.rank + 2]
    problem = line_problem(case, scales, film_scale, first, last, bound_tolerance)
    exchange = LineExchange(problem, cuts, ranks)
    matrices = LineMatrices(problem, exchange, ranks, case.mesh.near_field)
    return TwoFields(problem, exchange, matrices, Linearised(problem, ranks), comm)
