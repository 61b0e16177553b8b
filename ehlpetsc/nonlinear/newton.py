r"""Newton's method for a system of equations, by PETSc's SNES.

Direct contact: ``vinewtonrsls``. At every iteration the nodes with h at its bound and F > 0 form the contact
set, whose Reynolds rows and films leave the system. Steps that begin clear of the bound take the same
iterations without it (``newtonls``), which is a tenth quicker; those that come to touch begin anew with it.
Mixed contact: ``newtonls`` on the semismooth system, whose unknowns carry the complementarity in their sign
and have no bounds; ``vinewtonrsls`` then takes the same iterations.
"""

import numpy as np
from petsc4py import PETSc

from ehlpetsc.errors import SolveFailed
from ehlpetsc.nonlinear import snes as snes_objects
from ehlpetsc.nonlinear.preconditioner import FarFieldBand
from ehlpetsc.nonlinear.snes import owned, weakly

LINEAR_ATOL = 1e-2  # of Newton's absolute tolerance: where a linear residual is small enough
LINEAR_WORK = 100  # linear iterations for each of Newton's that is allowed, at most, over a whole solve
LONGER_START = 7  # times the iterations of a time step
LOOSEST = 10.0  # times Newton's absolute tolerance: what rounding may make of it
CLEAR = 0.02  # of the expected film over the bound: a step may begin without it


class NewtonSolver:
    """SNES of one system.

    Parameters
    ----------
    system : systems.two_fields.TwoFields

    Attributes
    ----------
    watch : callable or None
        Called in every iteration on every rank; what it raises ends the solve.
    limited : bool
        Whether ``-snes_max_it`` is the user's word, then also for steady starts.
    tolerance : float
        What the last solve was asked to bring the residual to.

    Raises
    ------
    UsageError
        PETSc refuses an option, or the system does.
    """

    def __init__(self, system):
        self.system, self.problem = system, system.problem
        self.watch = None
        self.limited = self.touched = self.begins = self.without_bound = False
        self._made = owned(self)
        self._create()

    @property
    def bound(self):
        """Thinnest film that the contact model allows, in a^2/R."""
        return self.system.model.minimum_film

    def _create(self):
        system, options = self.system, PETSc.Options()
        self.snes = self._snes_of_type("newtonls" if system.model.lower_bound is None else "vinewtonrsls")
        self.linear_limit = self.snes.ksp.max_it
        self.follows = not options.hasName("ksp_atol")
        if system.operator is None:
            system.create_matrices(with_band=is_ours(self.snes.ksp.pc))
        self._give_jacobian(self.snes)
        self.bounded, self.free = self.snes.getType() == "vinewtonrsls", None
        if self.bounded:
            system.give_bounds(self.snes)
            if system.model.starts_unconstrained and not options.hasName("snes_type"):
                self.free = self._snes_of_type("newtonls")
                self._give_jacobian(self.free)

    def _snes_of_type(self, kind):
        system = self.system
        snes = snes_objects.create(system.comm, kind, system.f, self._function, self._before_step)
        self._made.append(snes)
        return snes

    def _give_jacobian(self, snes):
        snes.setJacobian(weakly(self._jacobian), self.system.operator, self.system.preconditioned)

    def _function(self, snes, x, f):
        evaluation = self.system.evaluation(x) if self.begins else self.system.evaluate(x)
        self.begins = False
        if self.touched:
            f.array[:] = np.nan  # ends the solve on all ranks
        else:
            f.array[:] = evaluation.residual

    def _jacobian(self, snes, x, operator, preconditioner):
        self.system.linearise(x)
        left = LINEAR_WORK * snes.max_it - snes.getLinearSolveIterations()
        snes.ksp.setTolerances(max_it=min(self.linear_limit, max(left, 1)))
        operator.assemble()

    def _before_step(self, x, y):
        if self.watch:
            self.watch()
        self.system.limit_step(x, y)
        if self.without_bound:
            self.touched = self.system.touches(x, y)
        return True

    def start_iterations(self, needed=None):
        """Iterations that a steady start may take: what is exponential falls by one exponent in each."""
        return self.snes.max_it if self.limited else needed or LONGER_START * self.snes.max_it

    def residual(self):
        """Rows of the last solution: deflection and Reynolds at every node, shape (nx,), and the load's."""
        return self.system.residual()

    def mass_imbalance(self):
        """F of the last solution at every node, shape (nx,)."""
        return self.residual()[1]

    def solve(self, q, w, h00, inputs, max_it=None):
        """Solve from the given start, with `max_it` iterations instead of the usual number at most.

        Parameters
        ----------
        q, w : ndarray, shape (nx,)
        h00 : float
        inputs : ehl_problem.StepInputs
        max_it : int, optional

        Returns
        -------
        q, w : ndarray, shape (nx,)
        h00 : float
        iterations : int

        Raises
        ------
        SolveFailed
        """
        guess, spent = (q, w, h00, inputs), 0
        if self._clear_of_the_bound(w, inputs):
            try:
                return self._solve(self.free, guess, max_it)
            except SolveFailed as error:  # it comes to touch, or it would not do better with a bound
                spent = error.iterations
        try:
            *solution, iterations = self._solve(self.snes, guess, max_it)
        except SolveFailed as error:
            error.iterations += spent
            raise
        return *solution, iterations + spent

    def _clear_of_the_bound(self, w, inputs):
        """Whether a step can begin without the bound, which costs a tenth of an iteration."""
        away = self.free is not None and inputs.history is not None
        return away and w.min() > self.bound + CLEAR * self.problem.film_scale

    def _solve(self, snes, guess, max_it):
        self.system.begin(*guess)
        self.without_bound, self.touched, self.begins = snes is self.free, False, True
        usual = self.snes.max_it, self.snes.atol
        try:
            self._set_tolerances(snes, usual[0] if max_it is None else max_it)
            snes.solve(None, self.system.x)
            self.snes.setTolerances(max_it=usual[0], atol=usual[1])
        except PETSc.Error as error:
            raised = error.__cause__  # by what PETSc called: newer releases wrap it
            if raised and not isinstance(raised, PETSc.Error):
                raise raised from None
            self.snes.destroy()
            snes_objects.raise_refusal(error)
        return self._solution(snes)

    def _set_tolerances(self, snes, max_it):
        atol, system = self.snes.atol, self.system
        if self.follows:
            snes.ksp.setTolerances(atol=LINEAR_ATOL * atol)
        if system.factors:
            system.factors.of_a_new_solve()
        self.tolerance = min(max(atol, system.rounding()), LOOSEST * atol)
        snes.setTolerances(max_it=max_it, atol=self.tolerance)
        if snes.rtol > 0.0 or snes.stol > 0.0:  # the user's: obeyed; a solution is no worse than its guess
            snes.computeFunction(system.x, system.f)
            share = 1.0 if snes.stol > 0.0 else snes.rtol
            self.tolerance = max(self.tolerance, share * system.f.norm())

    def _solution(self, snes):
        reason, iterations = snes.getConvergedReason(), snes.getIterationNumber()
        if reason <= 0:
            if not (self.without_bound and reason == PETSc.SNES.ConvergedReason.DIVERGED_FNORM_NAN):
                # a failed factorisation stays failed in PETSc's solver objects; a film that touched does not
                self._renew()
            raise SolveFailed(snes_objects.REASONS.get(reason, str(reason)), iterations)
        q, w, h00 = self.system.solution()
        if not np.isfinite([q.sum(), w.sum(), h00]).all():
            raise SolveFailed("NOT_FINITE", iterations)
        bound = self.system.model.lower_bound
        if bound is not None and not self.bounded and w.min() < bound:
            raise SolveFailed("FILM_BELOW_ITS_BOUND", iterations)
        return q, w, h00, iterations

    def _renew(self):
        while self._made:
            self._made.pop().destroy()
        self._create()


def is_ours(pc):
    """Whether a preconditioner is the one of this program."""
    return pc.getType() == "python" and isinstance(pc.getPythonContext(), FarFieldBand)
