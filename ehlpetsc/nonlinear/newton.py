r"""SNES set-up for one solve: Newton's method with the exact deflection in the operator.

Direct contact: ``vinewtonrsls``. At every iteration the nodes with h at its bound and F > 0 form the contact
set, whose Reynolds rows and films leave the system. Steps that begin clear of the bound take the same
iterations without it (``newtonls``), which is a tenth quicker; those that come to touch begin anew with it.
Mixed contact: ``newtonls`` on the semismooth system, whose unknowns carry the complementarity in their sign
(asked for ``vinewtonrsls``, it is :mod:`.variational_inequality`). Either way the operator is matrix-free
(:mod:`.operators`), so that Newton converges as with the full Jacobian, and its preconditioner
(:mod:`ehlpetsc.nonlinear.preconditioner`) has the far field too, by exponentials. Other preconditioners
(``-pc_type lu`` ...) get the near-field matrix.

Newton's steps are limited in the line search's pre-check (:mod:`ehlpetsc.nonlinear.step_limits`).
"""

import numpy as np
from petsc4py import PETSc

from ehlpetsc.discretisation.deflection import HALO
from ehlpetsc.discretisation.ehl_problem import EHLProblem
from ehlpetsc.discretisation.finite_volumes import reynolds_rounding
from ehlpetsc.discretisation.interleaving import count, firsts, pairs, seconds
from ehlpetsc.errors import SolveFailed, UsageError
from ehlpetsc.nonlinear import events, step_limits
from ehlpetsc.nonlinear import snes as snes_objects
from ehlpetsc.nonlinear.exchange import Exchange, everywhere, largest
from ehlpetsc.nonlinear.operators.jacobian_operator import JacobianOperator, NearFieldMatrix
from ehlpetsc.nonlinear.preconditioner import FarFieldBand
from ehlpetsc.nonlinear.preconditioner.exponential_kernel import GROUP
from ehlpetsc.nonlinear.preconditioner.far_field_band import Factors
from ehlpetsc.nonlinear.snes import owned, weakly

LINEAR_ATOL = 1e-2  # of Newton's absolute tolerance: where a linear residual is small enough
LINEAR_WORK = 100  # linear iterations for each of Newton's that is allowed, at most, over a whole solve
LONGER_START = 7  # times the iterations of a time step
ROUNDING = 2.0  # times what a last digit of every unknown can make of the residual
LOOSEST = 10.0  # times Newton's absolute tolerance: what rounding may make of it
ZERO_TOLERANCE = 1e-8  # of PETSc: how near to its bound an unknown is taken to be on it
CLEAR = 0.02  # of the expected film over the bound: a step may begin without it
OPENED = 1e-3  # of the expected film: what solids that part get in that iteration


class NewtonSolver:
    """Holds vectors, matrices and SNES of one scene on one communicator.

    Parameters
    ----------
    case, scales, film_scale
        As in :class:`ehlpetsc.discretisation.ehl_problem.EHLProblem`.
    comm : MPI communicator

    Attributes
    ----------
    watch : callable or None
        Called in every iteration on every rank; what it raises ends the solve.
    limited : bool
        Whether ``-snes_max_it`` is the user's word, then also for steady starts.
    tolerance : float
        What the last solve was asked to bring the residual to.
    """

    unknowns = 2  # of a node

    def __init__(self, case, scales, film_scale, comm=PETSc.COMM_WORLD):
        n, rank, size = scales.nx, comm.rank, comm.size
        most = max(n // (HALO + GROUP), 1)  # a part must be as wide as what its neighbours know of it
        if size > most:
            raise UsageError(f"{size} ranks for {n} nodes; allowed: at most {most}")
        cuts = [n * k // size // GROUP * GROUP for k in range(size)] + [n]
        first, last = cuts[rank], cuts[rank + 1]
        self.n, self.local, self.first, self.comm = n, last - first, first, comm
        self.problem = EHLProblem(case, scales, film_scale, first, last)
        self.model = self.problem.model
        self._create_vectors(count)
        self.exchange = Exchange(self.problem, cuts, comm.tompi4py(), self.unknowns)
        self.near_field = case.mesh.near_field
        self._create_bounds()
        self.jacobian = self.place = self.rows = self.watch = None
        self.limited = self.touched = self.begins = self.without_bound = False
        self._made = owned(self, self.x, self.f, self.lower, self.upper, self.all, self.to_all)
        self._create_snes()

    def _create_vectors(self, count):
        """`count`: unknowns of so many nodes."""
        sizes = (count(self.local) + self.problem.load_is_local, count(self.n) + 1)
        self.x = PETSc.Vec().createMPI(sizes, comm=self.comm)
        self.f = self.x.duplicate()
        self.to_all, self.all = PETSc.Scatter.toAll(self.x)

    @property
    def bound(self):
        """Thinnest film that the contact model allows, in a^2/R."""
        return self.model.thinnest

    def _create_bounds(self):
        self.lower, self.upper = self.x.duplicate(), self.x.duplicate()
        self.lower.set(PETSc.NINFINITY)
        self.upper.set(PETSc.INFINITY)
        if not self.model.is_mixed:
            seconds(self.lower.array, self.local)[:] = self.model.bound

    def _create_snes(self):
        self.snes = self._snes_of_type("newtonls" if self.model.is_mixed else "vinewtonrsls")
        self.linear_limit = self.snes.ksp.max_it
        options = PETSc.Options()
        self.follows = not options.hasName("ksp_atol")
        self.bounded = self.snes.getType() == "vinewtonrsls"
        if self.jacobian is None:
            self._create_matrices()
            self._made += [self.operator, self.preconditioned]
        self.snes.setJacobian(weakly(self._jacobian), self.operator, self.preconditioned)
        self.free = None
        if self.bounded:
            self.snes.setVariableBounds(self.lower, self.upper)
            self.model.near = options.getReal("snes_vi_zero_tolerance", ZERO_TOLERANCE)
            if not (self.problem.dry or self.model.is_mixed or options.hasName("snes_type")):
                self.free = self._snes_of_type("newtonls")
                self.free.setJacobian(weakly(self._jacobian), self.operator, self.preconditioned)

    def _snes_of_type(self, kind):
        snes = snes_objects.create(self.comm, kind, self.f, self._function, self._limit_step)
        self._made.append(snes)
        return snes

    def _create_matrices(self):
        """The operator, and what preconditioners get: where that is enough, the operator itself."""
        sizes = (self.x.getSizes(),) * 2
        pc = self.snes.ksp.pc
        own = pc.getType() == "python" and isinstance(pc.getPythonContext(), FarFieldBand)
        self.factors = Factors(self.problem, self.comm.tompi4py()) if own else None
        self.jacobian = JacobianOperator(self.problem, self.exchange, self.factors)
        self.operator = PETSc.Mat().createPython(sizes, self.jacobian, comm=self.comm)
        self.operator.setUp()
        self.assembled, self.preconditioned = None, self.operator
        if not own:
            self.preconditioned = PETSc.Mat().createAIJ(sizes, comm=self.comm)
            self.assembled = NearFieldMatrix(self.problem, self.near_field, self.preconditioned)

    def gather(self, v):
        """The whole vector on every rank, as q, w (shape (nx,)) and h00."""
        self.to_all.scatter(v, self.all, mode=PETSc.ScatterMode.FORWARD)
        whole = self.all.array_r
        return firsts(whole, self.n).copy(), seconds(whole, self.n).copy(), whole[count(self.n)]

    def scatter(self, q, w, h00):
        """Fill the local part of the unknowns from whole arrays."""
        mine, x = slice(self.first, self.first + self.local), self.x.array
        firsts(x, self.local)[:], seconds(x, self.local)[:] = q[mine], w[mine]
        if self.problem.load_is_local:
            x[-1] = h00

    def _function(self, snes, x, f):
        evaluation = self._evaluation(x) if self.begins else self._evaluated(x)
        self.begins = False
        f.array[:] = np.nan if self.touched else evaluation.residual  # ends the solve on all ranks

    def _evaluation(self, x):
        """Residual and derivatives at x, where the function was asked for last more often than not."""
        if not everywhere(self.exchange.ranks, np.array_equal(x.array_r, self.place)):
            self._evaluated(x)
        return self.evaluation

    def _evaluated(self, x):
        self.place = x.array_r.copy()
        with events.RESIDUAL, np.errstate(over="ignore", invalid="ignore"):
            self.evaluation = self._evaluate(self.place)
        return self.evaluation

    def _evaluate(self, vector):
        nodes, h00, outside = self.exchange(vector, self._pressure)
        q, w = np.ascontiguousarray(nodes.T)
        return self.problem.evaluate(q, w, h00, self.inputs, outside)

    def _pressure(self, nodes):
        return self.model.relations(nodes[:, 0], nodes[:, 1]).pressure

    def _jacobian(self, snes, x, operator, preconditioner):
        self.jacobian.linearise(self._evaluation(x))
        left = LINEAR_WORK * snes.max_it - snes.getLinearSolveIterations()
        snes.ksp.setTolerances(max_it=min(self.linear_limit, max(left, 1)))
        if self.assembled:
            with events.ASSEMBLY:
                whole = self.exchange.whole(self.jacobian.relations)
                self.assembled.fill(whole, self.jacobian.reynolds_derivatives)
        operator.assemble()

    def _limit_step(self, x, y):
        if self.watch:
            self.watch()
        now, step = pairs(x.array_r, self.local), pairs(y.array, self.local)
        model, dry = self.model, self.problem.dry
        change = largest(self.exchange.ranks, step_limits.change(model, dry, now, step))
        if change > step_limits.STEP_LIMIT:
            y.scale(step_limits.STEP_LIMIT / change)
        step = pairs(y.array, self.local)
        step_limits.keep(model, dry, now, step, OPENED * self.problem.film_scale)
        if self.without_bound:
            self.touched = (now[:, 1] - step[:, 1]).min() <= model.bound + model.near
        return True

    def start_iterations(self, needed=None):
        """Iterations that a steady start may take: what is exponential falls by one exponent in each."""
        return self.snes.max_it if self.limited else needed or LONGER_START * self.snes.max_it

    def residual(self):
        """Rows of the last solution: deflection and Reynolds at every node, shape (nx,), and the load's."""
        if self.rows is None:
            self.f.array[:] = self._evaluation(self.x).residual
            self.rows = self.gather(self.f)
        return self.rows

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
        self.inputs = inputs
        spent = 0
        if self._clear_of_the_bound(w, inputs):
            try:
                return self._solve(self.free, q, w, h00, max_it)
            except SolveFailed as error:  # it comes to touch, or it would not do better with a bound
                spent = error.iterations
        try:
            *solution, iterations = self._solve(self.snes, q, w, h00, max_it)
        except SolveFailed as error:
            error.iterations += spent
            raise
        return *solution, iterations + spent

    def _clear_of_the_bound(self, w, inputs):
        """Whether a step can begin without the bound, which costs a tenth of an iteration."""
        away = self.free is not None and inputs.history is not None
        return away and w.min() > self.model.bound + CLEAR * self.problem.film_scale

    def _solve(self, snes, q, w, h00, max_it):
        self.place = self.rows = None
        self.without_bound, self.touched, self.begins = snes is self.free, False, True
        self.scatter(q, w, h00)
        usual = self.snes.max_it, self.snes.atol
        try:
            self._set_tolerances(snes, usual[0] if max_it is None else max_it)
            snes.solve(None, self.x)
            self.snes.setTolerances(max_it=usual[0], atol=usual[1])
        except PETSc.Error as error:
            raised = error.__cause__  # by what PETSc called: newer releases wrap it
            if raised and not isinstance(raised, PETSc.Error):
                raise raised from None
            self.snes.destroy()
            snes_objects.raise_refusal(error)
        return self._solution(snes)

    def _set_tolerances(self, snes, max_it):
        atol = self.snes.atol
        if self.follows:
            snes.ksp.setTolerances(atol=LINEAR_ATOL * atol)
        if self.factors:
            self.factors.of_a_new_solve()
        self.tolerance = min(max(atol, self._rounding()), LOOSEST * atol)
        snes.setTolerances(max_it=max_it, atol=self.tolerance)
        if snes.rtol > 0.0 or snes.stol > 0.0:  # the user's: obeyed; a solution is no worse than its guess
            snes.computeFunction(self.x, self.f)
            share = 1.0 if snes.stol > 0.0 else snes.rtol
            self.tolerance = max(self.tolerance, share * self.f.norm())

    def _rounding(self):
        """What rounding of the unknowns leaves of the residual at the first guess: nothing less can be asked.

        Slow surfaces over a wide inlet reach it: a pressure's last digit drives more oil than is drawn in.
        """
        evaluation = self._evaluated(self.x)
        oil, film = evaluation.relations.oil, evaluation.relations.film
        mine = reynolds_rounding(evaluation.reynolds_derivatives, oil, film, self.problem.own.start)
        return ROUNDING * np.sqrt(self.comm.tompi4py().allreduce(mine))

    def _solution(self, snes):
        reason, iterations = snes.getConvergedReason(), snes.getIterationNumber()
        if reason <= 0:
            if not (self.without_bound and reason == PETSc.SNES.ConvergedReason.DIVERGED_FNORM_NAN):
                # a failed factorisation stays failed in PETSc's solver objects; a film that touched does not
                self._renew()
            raise SolveFailed(snes_objects.REASONS.get(reason, str(reason)), iterations)
        q, w, h00 = self.gather(self.x)
        if not np.isfinite([q.sum(), w.sum(), h00]).all():
            raise SolveFailed("NOT_FINITE", iterations)
        if not (self.bounded or self.model.is_mixed) and w.min() < self.model.bound:
            raise SolveFailed("FILM_BELOW_ITS_BOUND", iterations)
        return q, w, h00, iterations

    def _renew(self):
        for snes in (self.snes, self.free):
            if snes is not None:
                self._made.remove(snes)
                snes.destroy()
        self._create_snes()
