"""The equations of one scene as PETSc sees them: two unknowns a node, vectors, matrices, bounds, step limits.

Each rank holds the unknowns of its own nodes, (q_0, w_0, q_1, w_1, ..., h00), the last one on the last rank,
and works out its own rows (:mod:`ehlpetsc.discretisation.ehl_problem`); what it needs of other ranks comes by
:mod:`ehlpetsc.nonlinear.halo_exchange`. The Jacobian is matrix-free (:mod:`ehlpetsc.nonlinear.operators`), so
that Newton converges as with the full matrix; the preconditioner of this program takes what it needs from it,
others (``-pc_type lu`` ...) get the near field assembled.
"""

import numpy as np
from petsc4py import PETSc

from ehlpetsc.discretisation.curvature_product import BLOCK
from ehlpetsc.discretisation.deflection import PressureSums
from ehlpetsc.discretisation.ehl_problem import EHLProblem
from ehlpetsc.discretisation.finite_volumes import reynolds_rounding
from ehlpetsc.discretisation.interleaving import n_dofs, pairs, q_of, w_of
from ehlpetsc.errors import UsageError
from ehlpetsc.nonlinear import events
from ehlpetsc.nonlinear.collectives import all_ranks, gathered, global_max
from ehlpetsc.nonlinear.halo_exchange import LINEAR_TOLERANCE, Halo, exchange_unknowns
from ehlpetsc.nonlinear.operators.jacobian_operator import JacobianOperator, NearFieldMatrix
from ehlpetsc.nonlinear.operators.python_matrix import python_matrix
from ehlpetsc.nonlinear.preconditioner.far_field_band import Factors
from ehlpetsc.nonlinear.snes import owned

RESIDUAL_ROUNDING = 2.0  # times what a last digit of every unknown can make of the residual
ZERO_TOLERANCE = 1e-8  # PETSc's default of -snes_vi_zero_tolerance, in a^2/R
STEP_LIMIT = 0.3  # p0: largest change of pressure of one Newton step
FILM_AFTER_RELEASE = 1e-3  # of the expected film: film of a node in the iteration in which its solids part


class TwoFields:
    """Pairs (q, w) at every node, w bounded below in direct contact.

    Parameters
    ----------
    case, scales, film_scale
        As in :class:`ehlpetsc.discretisation.ehl_problem.EHLProblem`.
    comm : petsc4py.PETSc.Comm
    bound_tolerance : float
        Films this close to their bound count as on it, ``-snes_vi_zero_tolerance`` of SNES; in a^2/R.

    Attributes
    ----------
    x, f : petsc4py.PETSc.Vec
        Unknowns and rows.
    lower, upper : petsc4py.PETSc.Vec
        Bounds of the unknowns.
    bound_reached : bool
        Whether the last step evaluated takes a film to its bound, on any rank.
    operator, preconditioned : petsc4py.PETSc.Mat
        The Jacobian, and what preconditioners get of it; there from :meth:`create_matrices` on.

    Raises
    ------
    UsageError
        More ranks than the mesh can be cut for.
    """

    def __init__(self, case, scales, film_scale, comm=PETSc.COMM_WORLD, bound_tolerance=ZERO_TOLERANCE):
        n, rank = scales.nx, comm.rank
        cuts = first_nodes(n, comm.size)
        first, last = cuts[rank], cuts[rank + 1]
        self.n, self.local, self.comm = n, last - first, comm
        self.near_field = case.mesh.near_field
        self.problem = EHLProblem(case, scales, film_scale, first, last, bound_tolerance)
        self.model = self.problem.model
        self.ranks = comm.tompi4py()
        self.halo = Halo.of(self.problem, cuts, self.ranks)
        self.linear_halo = Halo.of(self.problem, cuts, self.ranks, LINEAR_TOLERANCE)
        self._create_vectors()
        self.inputs = self.x_evaluated = self.rows = self.operator = None
        self.bound_reached = False

    def _create_vectors(self):
        sizes = (n_dofs(self.local) + self.problem.load_is_local, n_dofs(self.n) + 1)
        self.x = PETSc.Vec().createMPI(sizes, comm=self.comm)
        self.f, self.lower, self.upper = self.x.duplicate(), self.x.duplicate(), self.x.duplicate()
        self.lower.set(PETSc.NINFINITY)
        self.upper.set(PETSc.INFINITY)
        if self.model.lower_bound is not None:
            w_of(self.lower.array, self.local)[:] = self.model.lower_bound
        self.to_all, self.all = PETSc.Scatter.toAll(self.x)
        self._made = owned(self, self.x, self.f, self.lower, self.upper, self.all, self.to_all)

    def create_matrices(self, with_band):
        """Make the operator, and what preconditioners get.

        Parameters
        ----------
        with_band : bool
            Whether that is the operator itself, which has all that the band of
            :mod:`ehlpetsc.nonlinear.preconditioner` needs; else it is an assembled near field.
        """
        sizes = self.x.getSizes()
        self.factors = Factors(self.problem, self.ranks) if with_band else None
        self.jacobian = JacobianOperator(self.problem, self.linear_halo, self.ranks, self.factors)
        self.operator = python_matrix(self.jacobian, sizes, self.comm)
        self.assembled, self.preconditioned = None, self.operator
        self._made.append(self.operator)
        if not with_band:
            self.preconditioned = PETSc.Mat().createAIJ((sizes, sizes), comm=self.comm)
            self.assembled = NearFieldMatrix(self.problem, self.near_field, self.preconditioned)
            self._made.append(self.preconditioned)

    def set_initial_guess(self, q, w, h00, inputs):
        """Set the unknowns to a guess on the whole mesh, and the inputs of the solve.

        Parameters
        ----------
        q, w : ndarray, shape (nx,)
        h00 : float
        inputs : ehl_problem.StepInputs
        """
        self.inputs, self.x_evaluated, self.rows = inputs, None, None
        mine = slice(self.problem.first, self.problem.last)
        q_of(self.x.array, self.local)[:], w_of(self.x.array, self.local)[:] = q[mine], w[mine]
        if self.problem.load_is_local:
            self.x.array[-1] = h00

    def solution(self):
        """The whole solution on every rank: q, w (shape (nx,)) and h00."""
        return self._pairs_of(self.x)

    def _pairs_of(self, v):
        self.to_all.scatter(v, self.all, mode=PETSc.ScatterMode.FORWARD)
        whole = self.all.array_r
        return q_of(whole, self.n).copy(), w_of(whole, self.n).copy(), whole[-1]

    def residual(self):
        """Rows of the solution: deflection and Reynolds at every node, shape (nx,), and the load's."""
        if self.rows is None:
            self.f.array[:] = self.evaluation(self.x).residual
            self.rows = self._pairs_of(self.f)
        return self.rows

    def evaluation(self, x):
        """Residual and derivatives at x, which is the point last evaluated more often than not."""
        if not all_ranks(self.ranks, np.array_equal(x.array_r, self.x_evaluated)):
            self.evaluate(x)
        return self._evaluation

    def evaluate(self, x, reaches_bound=False):
        """Residual and derivatives at x, an :class:`ehlpetsc.discretisation.ehl_problem.Evaluation`.

        :attr:`bound_reached` then holds whether `reaches_bound` is true on any rank.
        """
        self.x_evaluated = x.array_r.copy()
        with events.RESIDUAL:
            pressure = self.contact.pressure(*pairs(self.x_evaluated, self.local).T)
            given = self.x_evaluated, np.ascontiguousarray(pressure), reaches_bound
            nodes, h00, curvature, load = exchange_unknowns(*self.halo, *given)
            (q, w), sums = np.ascontiguousarray(nodes.T), PressureSums(curvature, load[:3])
            self._evaluation = self.problem.evaluate(q, w, h00, self.inputs, sums)
            self.bound_reached = load[3] > 0.0
        return self._evaluation

    def linearise(self, x, is_evaluated=False):
        """Set the matrices for x, on every rank the point last evaluated where that is said."""
        self.jacobian.linearise(self._evaluation if is_evaluated else self.evaluation(x))
        if self.assembled:
            with events.ASSEMBLY:
                whole = gathered(self.ranks, self.jacobian.state, self.problem.owned)
                self.assembled.fill(whole, self.jacobian.reynolds_derivatives)

    @property
    def contact(self):
        """Contact model of the solve in hand."""
        return self.inputs.contact or self.model

    def limit_step(self, x, y):
        """Shorten a step y, to be subtracted from x, and limit single entries of it.

        The step is scaled as a whole, so that linear rows stay satisfied, to `STEP_LIMIT` p0 in any pressure,
        because the viscosity is exponential in p; single entries are limited by the contact model.
        """
        now, step = pairs(x.array_r, self.local), pairs(y.array, self.local)
        change = global_max(self.ranks, self.contact.pressure_change(now, step))
        if change > STEP_LIMIT:
            y.scale(STEP_LIMIT / change)
        step = pairs(y.array, self.local)
        self.contact.clip_step(now, step, FILM_AFTER_RELEASE * self.problem.film_scale)

    def reaches_bound(self, x, y):
        """Whether the step y takes a film of this rank to its bound."""
        film = w_of(x.array_r, self.local) - w_of(y.array_r, self.local)
        return not film.min() > self.model.lower_bound + self.model.bound_tolerance

    def rounding(self):
        """Residual at x that rounding of the unknowns leaves: no smaller tolerance can be met.

        Slow surfaces over a wide inlet reach it: a pressure's last digit drives more oil than is drawn in.
        """
        evaluation = self.evaluate(self.x)
        unknown, film = evaluation.state.reynolds_unknown, evaluation.state.film
        mine = reynolds_rounding(evaluation.reynolds_derivatives, unknown, film, self.problem.owned.start)
        return RESIDUAL_ROUNDING * np.sqrt(self.ranks.allreduce(mine))


def first_nodes(n, ranks):
    """First nodes of all ranks, multiples of `BLOCK`, and n.

    Raises
    ------
    UsageError
        A rank would have no block.
    """
    most = max(n // BLOCK, 1)
    if ranks > most:
        raise UsageError(f"{ranks} ranks for {n} nodes; allowed: at most {most}")
    return [n * k // ranks // BLOCK * BLOCK for k in range(ranks)] + [n]
