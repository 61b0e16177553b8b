"""The nonlinear system of a case for PETSc: two unknowns a node, vectors, matrices, bounds.

Each rank stores the unknowns of its own nodes, (q_0, w_0, q_1, w_1, ...), the last rank the border behind,
and evaluates its own rows (:mod:`ehlpetsc.discretisation.ehl_problem`) with data of other ranks from
:mod:`ehlpetsc.nonlinear.ranks`. The Jacobian is matrix-free (:class:`Jacobian`), so
that Newton's method converges as with the full matrix; the default preconditioner reads its coefficients from
it, others (``-pc_type lu`` ...) get an assembled matrix with the deflection of the near field.
"""

from __future__ import annotations

import weakref
from collections.abc import Iterator
from copy import copy
from functools import cached_property, partial
from typing import Any

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from ehlpetsc.discretisation.contact.model import ContactModel
from ehlpetsc.discretisation.contact.node_state import NodeState
from ehlpetsc.discretisation.ehl_problem import EHLProblem, Evaluation
from ehlpetsc.discretisation.step_inputs import StepInputs
from ehlpetsc.discretisation.unknowns import Rows, Unknowns, border_of, n_dofs, nodes_of_w, pairs, q_of, w_of
from ehlpetsc.nonlinear.options import ASSEMBLY, PRODUCT, RESIDUAL
from ehlpetsc.nonlinear.ranks import Exchange, all_ranks, gathered, global_sum
from ehlpetsc.nonlinear.step_limit import StepLimit


class Jacobian:
    """Matrix-free Jacobian, context of PETSc's Python matrix; kinds of contact differ in the product.

    `exchange`: of vectors between ranks.

    `model`, `state`, `reynolds_derivatives`: point of linearisation, as in `ehl_problem.Evaluation`.
    `derivatives`: of the nodes, see `contact.node_state.NodeState.derivatives`.
    `size`: local unknowns of the whole system.
    `active`: local indices of the unknowns in the system.
    `inactive_nodes`: local nodes whose second unknown is not in the system.
    """

    def __init__(self, problem: EHLProblem, exchange: object, ranks: MPI.Comm):
        self.problem, self.exchange, self.ranks = problem, exchange, ranks
        self.active: slice | np.ndarray = slice(None)
        self.inactive_nodes = np.arange(0)
        self.model: ContactModel = None
        self.state: NodeState = None
        self.derivatives: np.ndarray = None
        self.reynolds_derivatives: np.ndarray = None
        self.size = problem.size

    def release(self) -> None:
        """Free the point of linearisation, which no one needs once a step has been taken."""
        self.state = self.derivatives = self.reynolds_derivatives = None

    def product(self, v: np.ndarray, out: np.ndarray) -> None:
        """Fill in the local rows of the product with a local vector, zero in inactive rows; collective."""
        raise NotImplementedError

    def linearise(self, evaluation: Evaluation) -> None:
        """Set the point of linearisation."""
        self.model, self.reynolds_derivatives = evaluation.model, evaluation.reynolds_derivatives
        self.state = self.model.linearised(
            evaluation.state, self.problem.owned, partial(global_sum, self.ranks)
        )
        self.derivatives = self.state.derivatives()

    def mult(self, mat: PETSc.Mat, v: PETSc.Vec, out: PETSc.Vec) -> None:
        """PETSc's product."""
        with PRODUCT:
            if isinstance(self.active, slice):
                self.product(v.array_r.copy(), out.array)  # loops of read-only arrays would be compiled anew
                return
            full, rows = np.zeros(self.size), np.empty(self.size)
            full[self.active] = v.array_r
            self.product(full, rows)
            out.array[:] = rows[self.active]

    def createSubMatrix(
        self, mat: PETSc.Mat, rows: PETSc.IS, columns: PETSc.IS, out: PETSc.Mat | None = None
    ) -> PETSc.Mat:
        """Matrix of the active unknowns of SNESVI; rows and columns are the same."""
        restricted = copy(self)
        restricted.restrict(rows.indices - mat.getOwnershipRange()[0])
        return python_matrix(restricted, rows.getSizes(), mat.comm)

    def restrict(self, active: np.ndarray) -> None:
        """Leave all unknowns out of the system but those of these local indices."""
        if len(active) < self.size:
            is_inactive = np.ones(self.size, dtype=bool)
            is_inactive[active] = False
            self.active, self.inactive_nodes = active, nodes_of_w(np.flatnonzero(is_inactive))


def python_matrix(context: object, sizes: tuple[int, int], comm: PETSc.Comm) -> PETSc.Mat:
    """Square matrix with a Python context, ready for products.

    `context`: with methods of PETSc's names: ``mult``, ``createSubMatrix``.
    `sizes`: rows on this rank, and of all ranks.
    """
    matrix = PETSc.Mat().createPython((sizes, sizes), context, comm=comm)
    matrix.setUp()
    return matrix


BLOCK = 8192  # nodes whose derivatives are copied at a time
LAST_DIGIT = 1.1e-16  # relative rounding error of a number
RESIDUAL_ROUNDING = 2.0  # times the residual of a change of every unknown in its last digit
ZERO_TOLERANCE = 1e-8  # PETSc's default of -snes_vi_zero_tolerance, in a^2/R


class Matrices:
    """Jacobian and preconditioner of a kind of contact.

    `keeps_factors`: whether :meth:`keep` is of use.
    `linear_atol`: absolute tolerance of the linear residual over that of Newton's method.
    """

    keeps_factors = False
    linear_atol = 1e-2

    exchange: Exchange

    def __init__(self, problem: EHLProblem, exchange: Exchange, ranks: MPI.Comm):
        self.problem, self.exchange, self.ranks = problem, exchange, ranks

    def jacobian(self, ksp: PETSc.KSP) -> Jacobian:
        """Matrix-free Jacobian, context of a Python matrix, for a Krylov solver with its options."""
        raise NotImplementedError

    def assembled(self, ksp: PETSc.KSP, sizes: tuple) -> Any:
        """Matrix for preconditioners in place of the Jacobian itself; None: none."""

    def begin_solve(self) -> None:
        """Called at the start of each nonlinear solve."""

    def renew(self) -> None:
        """Free what a failed solve has left."""

    def keep(self, jacobian: Any) -> None:
        """Factor for the state of a Jacobian, as the first factors of all later solves."""


class TwoFields:
    """System of the pairs (q, w) at every node, w bounded below in direct contact.

    `problem`: of the nodes of this rank.
    `exchange`: of unknowns and pressures between ranks.
    `matrices`: Jacobian and preconditioner of the kind of contact.
    `limit`: of its steps.

    `x`, `f`: unknowns and residual.
    `bound_reached`: whether a film is at its bound after the last evaluated step, on any rank.
    `operator`, `preconditioned`: the Jacobian, and the matrix for preconditioners; set by
        :meth:`create_matrices`.
    """

    def __init__(
        self,
        problem: EHLProblem,
        exchange: Exchange,
        matrices: Matrices,
        limit: StepLimit,
        comm: PETSc.Comm = PETSc.COMM_WORLD,
    ):
        self.problem, self.exchange, self.matrices, self.comm = problem, exchange, matrices, comm
        self.limit = limit
        self.n, self.local, self.model = problem.n, problem.local, problem.model
        self.ranks = comm.tompi4py()
        self._create_vectors()
        self.inputs: StepInputs = None
        self.rows: Rows = None
        self.x_evaluated = self.operator = None
        self._evaluation: Evaluation = None
        self.bound_reached = False

    def _create_vectors(self) -> None:
        sizes = self.problem.size, n_dofs(self.n) + self.problem.balance.unknowns
        self.x = PETSc.Vec().createMPI(sizes, comm=self.comm)
        self.f = self.x.duplicate()
        self._petsc_objects = owned(self, self.x, self.f)
        if self.ranks.size > 1:
            self.to_all, self.all = PETSc.Scatter.toAll(self.x)
            self._petsc_objects += [self.all, self.to_all]

    @cached_property
    def bounds(self) -> tuple[PETSc.Vec, PETSc.Vec]:
        """Lower and upper bounds of the unknowns, of which only some types of SNES ask for vectors."""
        lower, upper = self.x.duplicate(), self.x.duplicate()
        self._petsc_objects += [lower, upper]
        lower.set(PETSc.NINFINITY)
        upper.set(PETSc.INFINITY)
        if self.model.lower_bound is not None:
            w_of(lower.array, self.local)[:] = self.model.lower_bound
        return lower, upper

    def create_matrices(self, ksp: PETSc.KSP) -> None:
        """Create the Jacobian, and the matrix for the preconditioner of a Krylov solver."""
        sizes = self.x.getSizes()
        self.jacobian = self.matrices.jacobian(ksp)
        self.operator = python_matrix(self.jacobian, sizes, self.comm)
        self._petsc_objects.append(self.operator)
        self.assembled, self.preconditioned = self.matrices.assembled(ksp, sizes), self.operator
        if self.assembled:
            self.preconditioned = self.assembled.matrix
            self._petsc_objects.append(self.preconditioned)

    def set_initial_guess(self, guess: Unknowns, inputs: StepInputs) -> None:
        """Set the unknowns to an initial guess on the whole mesh, and the inputs of the solve."""
        self.limit.begin()
        self._given, self.inputs, self.x_evaluated, self.rows = inputs, inputs.begin(), None, None
        local = slice(self.problem.first, self.problem.last)
        q_of(self.x.array, self.local)[:], w_of(self.x.array, self.local)[:] = guess.q[local], guess.w[local]
        if self.problem.owns_border:
            border_of(self.x.array, self.local)[:] = guess.border

    def continue_from(self, local: np.ndarray) -> None:
        """Set the unknowns of this rank, and the inputs as at the begin of the solve."""
        self.x.array[:] = local
        self.inputs, self.x_evaluated = self._given.begin(), None

    def solution(self) -> Unknowns:
        """The whole solution on every rank."""
        return Unknowns(*self._parts_of(self.x))

    def _parts_of(self, v: PETSc.Vec) -> Iterator[np.ndarray]:
        if self.ranks.size > 1:
            self.to_all.scatter(v, self.all, mode=PETSc.ScatterMode.FORWARD)
        values = (self.all if self.ranks.size > 1 else v).array_r
        return (part(values, self.n).copy() for part in (q_of, w_of, border_of))

    def residual(self) -> Rows:
        """Residual of the solution, on every rank."""
        if self.rows is None:
            self.f.array[:] = self.evaluation(self.x).residual
            self.rows = Rows(*self._parts_of(self.f))
            self._evaluation = self.x_evaluated = None
        return self.rows

    def evaluation(self, x: PETSc.Vec) -> Evaluation:
        """Residual and derivatives at x, evaluated unless x is the point evaluated last."""
        if not all_ranks(self.ranks, np.array_equal(x.array_r, self.x_evaluated)):
            self.evaluate(x)
        return self._evaluation

    def evaluate(self, x: PETSc.Vec, reaches_bound: bool = False) -> Evaluation:
        """Residual and derivatives at x, an :class:`ehlpetsc.discretisation.ehl_problem.Evaluation`.

        :attr:`bound_reached` then holds whether `reaches_bound` is true on any rank.
        """
        self._evaluation, self.x_evaluated = None, x.array_r.copy()
        with RESIDUAL:
            pressure = self.contact.pressure(*pairs(self.x_evaluated, self.local).T)
            local_data = self.x_evaluated, np.ascontiguousarray(pressure), reaches_bound
            unknowns, sums, self.bound_reached = self.exchange.unknowns(*local_data)
            self._evaluation = self.problem.evaluate(unknowns, self.inputs, sums)
        return self._evaluation

    def linearise(self, x: PETSc.Vec, is_evaluated: bool = False) -> None:
        """Set the matrices for x; `is_evaluated` states that x is the point evaluated last, on every rank.

        The record of the evaluation is the Jacobian's from then on.
        """
        self.jacobian.linearise(self._evaluation if is_evaluated else self.evaluation(x))
        self._evaluation = self.x_evaluated = None
        if self.assembled:
            with ASSEMBLY:
                state = gathered(self.ranks, self.jacobian.state, self.problem.owned)
                self.assembled.fill(state, self.jacobian.reynolds_derivatives)

    @property
    def contact(self) -> ContactModel:
        """Contact model of the current solve."""
        return self.inputs.contact or self.model

    def limit_step(self, x: PETSc.Vec, y: PETSc.Vec) -> None:
        """Limit a step y, to be subtracted from x."""
        self.limit(self.inputs, self.contact, x.array_r, y.array)

    def reaches_bound(self, x: PETSc.Vec, y: PETSc.Vec) -> bool:
        """Whether the step y brings a film of this rank to its bound."""
        film = w_of(x.array_r, self.local) - w_of(y.array_r, self.local)
        return not film.min() > self.model.lower_bound + self.model.bound_tolerance

    def rounding(self) -> float:
        """Residual at x from rounding of the unknowns, a lower limit of the tolerance.

        Slow surfaces with a long inlet reach it: a pressure's last digit drives more oil than they entrain.
        """
        evaluation = self.evaluate(self.x)
        unknown, film = evaluation.state.reynolds_unknown, evaluation.state.film
        state, derivatives = np.abs(np.stack([unknown, film], 1)), evaluation.reynolds_derivatives
        product, first = self.problem.reynolds.product, self.problem.owned.start
        changes = np.empty(self.local)
        for begin in range(0, self.local, BLOCK):
            block = slice(begin, begin + BLOCK)
            changes[block] = product(np.abs(derivatives[block]), state, first + begin)
        changes *= LAST_DIGIT
        return float(RESIDUAL_ROUNDING * np.sqrt(global_sum(self.ranks, float(changes @ changes))))

    def oil_in_contact(self) -> float:
        """Mean oil per area in the Hertz contact one step ago over the expected film, at least 1; steady: 1.

        Oil that roughness encloses is far more than the film that the inlet supplies.
        """
        if self.inputs.history is None:
            return 1.0
        oil = self.inputs.history.before[self.problem.grid.inside(1.0)].mean()
        return max(float(oil) / self.problem.film_scale, 1.0)


def owned(owner: object, *objects: object) -> list:
    """List of PETSc's objects, destroyed with their owner or before Python ends, in reverse order.

    Destroyed by PetscFinalize they would call Python objects that no longer exist.
    """
    petsc_objects = list(objects)
    weakref.finalize(owner, _destroy, petsc_objects)
    return petsc_objects


def _destroy(petsc_objects: list) -> None:
    while petsc_objects:
        petsc_objects.pop().destroy()
