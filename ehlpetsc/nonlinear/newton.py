r"""Newton's method for a system of equations, by PETSc's SNES.

Direct contact: ``vinewtonrsls``. At every iteration the nodes with h at its bound and F > 0 form the contact
set, whose Reynolds rows and films leave the system. Steps whose guess is clear of the bound take the same
iterations without it (``newtonls``), a tenth faster; where a film then reaches the bound, the step
is repeated with it. Mixed contact: ``newtonls`` on the semismooth system, whose unknowns carry the
complementarity in their sign and have no bounds; ``vinewtonrsls`` then takes the same iterations.
"""

from enum import Enum, auto
from typing import Any

import numpy as np
from petsc4py import PETSc

from ehlpetsc.base.errors import SolveFailed, UsageError
from ehlpetsc.discretisation.step_inputs import StepInputs, Watch
from ehlpetsc.discretisation.unknowns import Rows, Unknowns
from ehlpetsc.nonlinear.callbacks import release_frames, set_function_domain_error, weakly
from ehlpetsc.nonlinear.options import RunOptions, raise_refusal
from ehlpetsc.nonlinear.two_fields import TwoFields, owned

LINEAR_WORK = 100  # limit of the linear iterations of a solve, per Newton iteration allowed
START_FACTOR = 7  # iteration limit of a steady start over that of a time step
MAX_ROUNDING_FACTOR = 10.0  # limit of the factor by which rounding may raise Newton's absolute tolerance
# of the oil in the contact, up to which it may raise a default one: rounding limits every oil balance
MAX_ROUNDING = 1e-6
CLEAR_OF_BOUND = 0.02  # of the expected film: minimum film of a guess that is solved without the bound
MAX_SHORTENED_STEPS = 20  # of a solve
REASONS = {v: k for k, v in vars(PETSc.SNES.ConvergedReason).items() if isinstance(v, int)}
OVERFLOW = next(v for v, k in REASONS.items() if k in ("DIVERGED_FUNCTION_NANORINF", "DIVERGED_FNORM_NAN"))
REJECTED_STEP = (
    PETSc.SNES.ConvergedReason.DIVERGED_FUNCTION_DOMAIN,
    PETSc.SNES.ConvergedReason.DIVERGED_LINE_SEARCH,
)


class Phase(Enum):
    """State of a solver: idle, before or after the first residual of a solve, or after one that failed.

    The first residual of a solve is that of its guess, which is evaluated already. After a solve PETSc's
    objects count as failed until its solution is accepted: they keep a failed factorisation and are then
    created anew.
    """

    IDLE = auto()
    BEGUN = auto()
    ITERATING = auto()
    FAILED = auto()


class NewtonSolver:
    """Newton's method for one system, by SNES.

    `options`: of PETSc's objects; default: none of the user.

    Attributes
    ----------
    snes : petsc4py.PETSc.SNES
    tolerance : float
        Absolute tolerance of the last solve.
    bounded : bool
        Whether SNES enforces the bound of the contact model.
    linear_iterations : int
        GMRES iterations of all solves so far.
    """

    def __init__(self, system: TwoFields, options: RunOptions | None = None):
        self.system, self.problem = system, system.problem
        self._options = options or RunOptions()
        self._petsc_objects = owned(self)
        self._watch: Watch = None
        self._phase = Phase.IDLE
        self._before, self._share = None, 1.0  # unknowns before the last step; share of the next one
        self._unconstrained = self._reaches_bound = False
        # other line searches may end at another point than the last trial point
        self._accepts_last = self._options.value("snes_linesearch_type") == "basic"
        # the Jacobian before the next residual, which takes as much memory; other types of SNES may need it
        # once more, as may a search that a bound has ended
        others = any(name == "snes_type" or name.startswith("snes_lag_") for name in self._options.given)
        self._releases = self._accepts_last and system.model.lower_bound is None and not others
        self.snes: Any = None
        self._unconstrained_snes: Any = None
        self.tolerance: float = None
        self.linear_iterations = 0
        self._create()
        snes: Any = self.snes
        self.bounded = snes.getType() == "vinewtonrsls"
        self._max_it, self._atol, self._linear_max_it = snes.max_it, snes.atol, snes.ksp.max_it

    @property
    def bound(self) -> float:
        """Minimum film of the contact model in a^2/R."""
        return self.system.model.minimum_film

    def _create(self) -> None:
        system, model = self.system, self.system.model
        self.snes = self._snes_of_type("newtonls" if model.lower_bound is None else "vinewtonrsls")
        if system.operator is None:
            system.create_matrices(self.snes.ksp)
        self._set_jacobian(self.snes)
        if self.snes.getType() == "vinewtonrsls":
            self.snes.setVariableBounds(*system.bounds)
            if model.starts_unconstrained and "snes_type" not in self._options.given:
                self._unconstrained_snes = self._snes_of_type("newtonls")
                self._set_jacobian(self._unconstrained_snes)

    def _snes_of_type(self, kind: str) -> PETSc.SNES:
        """SNES of a type, or of the user's ``-snes_type``; `UsageError` where an option is refused."""
        snes = PETSc.SNES().create(self.system.comm)
        self._petsc_objects.append(snes)
        try:
            snes.setOptionsPrefix(self._options.prefix)
            snes.setType(kind)
            snes.setFunction(weakly(self._function), self.system.f)
            snes.setFromOptions()
        except PETSc.Error as error:
            raise_refusal(error, self._options.given)
        if snes.getType() == "vinewtonssls":
            raise UsageError(
                "-snes_type vinewtonssls needs the whole deflection in an assembled matrix; "
                "allowed: vinewtonrsls, and types without bounds where nothing touches"
            )
        snes.setLineSearchPreCheck(weakly(self._before_step))
        # an error inside of PETSc could not be followed by a shorter step: a reason of the same meaning
        snes.setErrorIfNotConverged(False)
        if snes.ksp.getErrorIfNotConverged():
            snes.ksp.setErrorIfNotConverged(False)
            snes.setMaxLinearSolveFailures(1)
        return snes

    def _set_jacobian(self, snes: PETSc.SNES) -> None:
        snes.setJacobian(weakly(self._jacobian), self.system.operator, self.system.preconditioned)

    def _function(self, snes: PETSc.SNES, x: PETSc.Vec, f: PETSc.Vec) -> None:
        if self._phase is Phase.BEGUN:  # evaluated anew where SNESVI has projected the guess onto the bounds
            f.array[:], self._phase = self.system.evaluation(x).residual, Phase.ITERATING
            return
        if self._releases:
            self.system.jacobian.release()
        f.array[:] = self.system.evaluate(x, self._reaches_bound).residual
        if self.system.bound_reached:
            set_function_domain_error(snes)  # rejects the step

    def _jacobian(
        self, snes: PETSc.SNES, x: PETSc.Vec, operator: PETSc.Mat, preconditioner: PETSc.Mat
    ) -> None:
        is_solving = self._phase in (Phase.BEGUN, Phase.ITERATING)
        self.system.linearise(x, self._accepts_last and is_solving)
        remaining = LINEAR_WORK * snes.max_it - snes.getLinearSolveIterations()
        snes.ksp.setTolerances(max_it=min(self._linear_max_it, max(remaining, 1)))
        operator.assemble()

    def _before_step(self, x: PETSc.Vec, y: PETSc.Vec) -> bool:
        if self._watch:
            self._watch()
        self._before = x.array_r.copy()
        self.system.limit_step(x, y)
        if self._share < 1.0:
            y.scale(self._share)
            self._share = 1.0
        if self._unconstrained:
            self._reaches_bound = self.system.reaches_bound(x, y)
        return True

    def start_iterations(self, needed: int | None = None) -> int:
        """Iteration limit of a steady start.

        Exponential residuals fall by a factor e an iteration, so it needs more than a time step; a limit set
        by the user holds for both.
        """
        if "snes_max_it" in self._options.given:
            return self._max_it
        return needed or START_FACTOR * self._max_it

    def prepare(self, state: Unknowns, inputs: StepInputs) -> None:
        """Linearise at a state whose factors every later solve begins with, where its matrices keep any."""
        if not self.system.matrices.keeps_factors:
            return
        self.system.set_initial_guess(state, inputs)
        with np.errstate(over="ignore", invalid="ignore"):
            self.system.linearise(self.system.x)
            self.system.matrices.keep(self.system.jacobian)
        self.system.jacobian.release()

    def residual(self) -> Rows:
        """Residual of the last solution."""
        return self.system.residual()

    def solve(
        self, guess: Unknowns, inputs: StepInputs, max_it: int | None = None, watch: Watch = None
    ) -> tuple[Unknowns, int]:
        """Solution from an initial guess, and the number of iterations; raise `SolveFailed` without one.

        Parameters
        ----------
        guess, inputs
        max_it
            Iteration limit in place of ``-snes_max_it``.
        watch
            Called in every iteration on every rank; an exception that it raises ends the solve.
        """
        spent, self._watch = 0, watch
        if self._is_clear_of_bound(guess.w, inputs):
            try:
                return self._solve(self._unconstrained_snes, guess, inputs, max_it)
            except SolveFailed as error:  # at the bound, or with any other cause: repeated with the bound
                spent = error.iterations
        try:
            solution, iterations = self._solve(self.snes, guess, inputs, max_it)
        except SolveFailed as error:
            raise error.after(spent) from error
        return solution, iterations + spent

    def _is_clear_of_bound(self, w: np.ndarray, inputs: StepInputs) -> bool:
        """Whether a step can begin without the bound, which saves a tenth of the time."""
        possible = self._unconstrained_snes is not None and inputs.history is not None
        return possible and w.min() > self.bound + CLEAR_OF_BOUND * self.problem.film_scale

    def _solve(
        self, snes: PETSc.SNES, guess: Unknowns, inputs: StepInputs, max_it: int | None
    ) -> tuple[Unknowns, int]:
        """Solution and iterations; a step to a residual that is not finite is repeated at half its length.

        A step that is not finite itself, since its linear solve has failed, ends the solve.
        """
        self.system.set_initial_guess(guess, inputs)
        limit, unconstrained = max_it or self._max_it, snes is self._unconstrained_snes
        spent, share = 0, 1.0
        for _ in range(MAX_SHORTENED_STEPS):
            if self._phase is Phase.FAILED:
                self._renew()
            snes = self._unconstrained_snes if unconstrained else self.snes
            self._unconstrained, self._share, self._before = unconstrained, share, None
            snes.setForceIteration(inputs.history is None)  # so that it follows small changes of the oil
            self._run(snes, limit - spent)
            taken = snes.getIterationNumber()
            spent += taken + 1
            if snes.getConvergedReason() != OVERFLOW or self._before is None or spent >= limit:
                break
            if snes.ksp.getConvergedReason() == PETSc.KSP.ConvergedReason.DIVERGED_NANORINF:
                break
            share = 0.5 * share if taken == 0 else 0.5
            self.system.continue_from(self._before)
        self._before = None
        if self._releases:
            self.system.jacobian.release()
        return self._solution(snes, spent - 1)

    def _run(self, snes: PETSc.SNES, max_it: int) -> None:
        """Run SNES from the unknowns of the system."""
        self._reaches_bound, self._phase = False, Phase.BEGUN
        try:
            with np.errstate(over="ignore", invalid="ignore"):
                self._set_tolerances(snes, max_it)
                snes.solve(None, self.system.x)
            snes.setTolerances(max_it=self._max_it, atol=self._atol)  # for -snes_view
        except PETSc.Error as error:
            raised = error.__cause__  # exception of a callback, which newer releases wrap
            if raised and not isinstance(raised, PETSc.Error):
                raise raised from None
            release_frames(error)
            snes.destroy()
            raise_refusal(error, self._options.given)
        except BaseException as error:
            release_frames(error)
            raise
        finally:
            self._phase = Phase.FAILED
        self.linear_iterations += snes.getLinearSolveIterations()

    def _set_tolerances(self, snes: PETSc.SNES, max_it: int) -> None:
        system = self.system
        if "ksp_atol" not in self._options.given:
            snes.ksp.setTolerances(atol=system.matrices.linear_atol * self._atol)
        system.matrices.begin_solve()
        highest = MAX_ROUNDING_FACTOR * self._atol
        if "snes_atol" not in self._options.given:
            highest = max(highest, MAX_ROUNDING * system.oil_in_contact())
        self.tolerance = min(max(self._atol, system.rounding()), highest)
        snes.setTolerances(max_it=max_it, atol=self.tolerance)
        if snes.rtol > 0.0 or snes.stol > 0.0:  # set by the user; stol accepts the residual of the guess
            factor = 1.0 if snes.stol > 0.0 else snes.rtol
            system.f.array[:] = system.evaluation(system.x).residual
            self.tolerance = max(self.tolerance, factor * system.f.norm())

    def _solution(self, snes: PETSc.SNES, iterations: int) -> tuple[Unknowns, int]:
        reason = snes.getConvergedReason()
        if reason > 0 or reason in REJECTED_STEP:  # which fails no factorisation
            self._phase = Phase.IDLE
        if reason <= 0:
            raise SolveFailed("SNES", REASONS.get(reason, str(reason)), iterations)
        solution = self.system.solution()
        if not all(np.isfinite(part.sum()) for part in solution):
            raise SolveFailed("SNES", "NOT_FINITE", iterations)
        bound = self.system.model.lower_bound
        if bound is not None and not self.bounded and solution.w.min() < bound:
            raise SolveFailed("SNES", "FILM_BELOW_ITS_BOUND", iterations)
        return solution, iterations

    def _renew(self) -> None:
        """Create PETSc's objects anew after a failed solve."""
        while self._petsc_objects:
            self._petsc_objects.pop().destroy()
        self.system.matrices.renew()
        self._create()
