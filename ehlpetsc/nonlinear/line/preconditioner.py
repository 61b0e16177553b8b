"""The near-exact inverse of a contact's matrix as a PETSc preconditioner, on any number of ranks.

Use: ``-pc_type python -pc_python_type ehlpetsc.nonlinear.line.preconditioner.FarFieldBand`` (the default).

The band of :mod:`.banded_jacobian` includes the far deflection; :mod:`.distributed_lu` splits it by ranks.
The error left to GMRES is that of three exponentials, the same on any number of ranks.
"""

from __future__ import annotations

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from ehlpetsc.discretisation.ehl_problem import EHLProblem
from ehlpetsc.nonlinear import events
from ehlpetsc.nonlinear.line.banded_jacobian import BandedJacobian
from ehlpetsc.nonlinear.line.distributed_lu import DistributedLU, solve
from ehlpetsc.nonlinear.line.jacobian import JacobianOperator
from ehlpetsc.nonlinear.line.node_pairs import node_pairs


class Factors:
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
        with events.FACTOR:
            self.operator = pc.getOperators()[0].getPythonContext()
            self.operator.factors.factor(self.operator)

    def apply(self, pc: PETSc.PC, x: PETSc.Vec, y: PETSc.Vec) -> None:
        """Solve for one right-hand side."""
        operator = self.operator
        b, solution = np.zeros(operator.size), np.empty(operator.size)
        b[operator.active] = x.array_r
        with events.BACK_SOLVE:
            solve(operator.factors.lu.factors, b, solution)
        y.array[:] = solution[operator.active]
