"""The near-exact inverse of a contact's matrix as a PETSc preconditioner, on any number of ranks.

Use: ``-pc_type python -pc_python_type ehlpetsc.nonlinear.preconditioner.FarFieldBand`` (the default).

The band of :mod:`.banded_jacobian`, far deflection included, split between ranks by :mod:`.spike`.
What GMRES has left to do is the error of three exponentials, the same on any number of ranks.
"""

from ehlpetsc.nonlinear import events as log


class FarFieldBand:
    """PETSc calls `setUp` for a new matrix and `apply` for every right-hand side.

    Attributes
    ----------
    solver : solver.Solver
        The one whose solve this is, set by itself: the matrix that PETSc hands over is without the films in
        contact, and without the far deflection.
    """

    solver = None

    def setUp(self, pc):
        with log.FACTOR:
            s = self.solver
            self.kept, touching = s.in_system()
            # in every solve anew, so that a run that was stopped goes on as if it had not been
            first = s.snes.getIterationNumber() == 0
            s.split.factor(s.slope, s.problem.flow_values, touching, anew=first)

    def apply(self, pc, x, y):
        b, out, count = x.array_r, y.array, len(self.kept)
        with log.BACK_SOLVE:
            solution, approach = self.solver.split.solve(b[:count], self.kept, b[count:].sum())
            out[:count] = solution[self.kept]
            out[count:] = approach  # on the last rank
