"""The near-exact inverse of a contact's matrix as a PETSc preconditioner, on any number of ranks.

Use: ``-pc_type python -pc_python_type ehlpetsc.nonlinear.preconditioner.FarFieldBand`` (the default).

The band of :mod:`.banded_jacobian`, far deflection included, split between ranks by :mod:`.distributed_lu`.
What GMRES has left to do is the error of three exponentials, the same on any number of ranks.
"""

from ehlpetsc.nonlinear import events
from ehlpetsc.nonlinear.preconditioner.banded_jacobian import BandedJacobian
from ehlpetsc.nonlinear.preconditioner.distributed_lu import DistributedLU


class Factors:
    """The factors of one scene, kept from one matrix to the next: PETSc makes a preconditioner anew
    whenever the contact set changes.

    Parameters
    ----------
    problem : ehl_problem.EHLProblem
    ranks : mpi4py communicator
    """

    def __init__(self, problem, ranks):
        self.lu = DistributedLU(BandedJacobian(problem), -problem.deflection.end_row_coefficient, ranks)
        self.fresh = False

    def invalidate(self):
        """Factor the next matrix anew, so that a run continues after a restart as it would have without."""
        self.fresh = False

    def factor(self, operator):
        """Factor for the state of a :mod:`ehlpetsc.nonlinear.operators.jacobian_operator`."""
        state, derivatives = operator.state, operator.reynolds_derivatives
        entries = operator.model.band_entries(state, derivatives, self.lu.band.stencil)
        self.lu.factor(entries, operator.dropped, anew=not self.fresh)
        self.fresh = True


class FarFieldBand:
    """PETSc calls `setUp` for a new matrix and `apply` for every right-hand side."""

    def setUp(self, pc):
        """Take the state from the operator and factor for it."""
        with events.FACTOR:
            self.operator = pc.getOperators()[0].getPythonContext()
            self.operator.factors.factor(self.operator)

    def apply(self, pc, x, y):
        """Solve."""
        o, problem = self.operator, self.operator.problem
        with events.BACK_SOLVE:
            rows, load = o.rows_for_band(x.array_r)
            solution, approach = o.factors.lu.solve(rows, o.kept, load.sum())
            o.model.from_band(o.state, problem.own, solution.reshape(-1, 2))
            o.take_from_band(solution, approach, y.array)
