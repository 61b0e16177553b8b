"""The nonlinear system of a case for PETSc: two unknowns a node, vectors, matrices, bounds, step limits.

Each rank stores the unknowns of its own nodes, (q_0, w_0, q_1, w_1, ..., h00), h00 on the last rank, and
evaluates its own rows (:mod:`ehlpetsc.discretisation.ehl_problem`) with data of other ranks from
:mod:`ehlpetsc.nonlinear.ranks`. The Jacobian is matrix-free (:mod:`ehlpetsc.nonlinear.jacobian`), so
that Newton's method converges as with the full matrix; the default preconditioner reads its coefficients from
it, others (``-pc_type lu`` ...) get an assembled matrix with the deflection of the near field.
"""

from __future__ import annotations

import weakref
from typing import Any

import numpy as np
from petsc4py import PETSc

from ehlpetsc.base.errors import UsageError
from ehlpetsc.discretisation.contact.model import ContactModel
from ehlpetsc.discretisation.curvature_product import BLOCK
from ehlpetsc.discretisation.deflection import PressureSums
from ehlpetsc.discretisation.ehl_problem import EHLProblem, Evaluation
from ehlpetsc.discretisation.finite_volumes import reynolds_rounding
from ehlpetsc.discretisation.step_inputs import StepInputs
from ehlpetsc.discretisation.unknowns import Rows, Unknowns, n_dofs, pairs, q_of, w_of
from ehlpetsc.nonlinear import events
from ehlpetsc.nonlinear.jacobian import JacobianOperator, NearFieldMatrix, python_matrix
from ehlpetsc.nonlinear.preconditioner import Factors
from ehlpetsc.nonlinear.ranks import (
    LINEAR_TOLERANCE,
    Halo,
    all_ranks,
    exchange_unknowns,
    gathered,
    global_max,
    global_sum,
)
from ehlpetsc.physics.scales import Scales

RESIDUAL_ROUNDING = 2.0  # times the residual of a change of every unknown in its last digit
ZERO_TOLERANCE = 1e-8  # PETSc's default of -snes_vi_zero_tolerance, in a^2/R
STEP_LIMIT = 0.3  # p0: largest change of pressure in one Newton step
FILM_AFTER_RELEASE = 1e-3  # film given to a node that leaves contact, over the expected film


class TwoFields:
    """System of the pairs (q, w) at every node, w bounded below in direct contact.

    `case`, `scales`, `film_scale`: as in :class:`ehlpetsc.discretisation.ehl_problem.EHLProblem`.
    `bound_tolerance`: tolerance of the active set in a^2/R, ``-snes_vi_zero_tolerance`` of SNES: films this
        close to their bound count as on it.

    `x`, `f`: unknowns and residual.
    `lower`, `upper`: bounds of the unknowns.
    `bound_reached`: whether a film is at its bound after the last evaluated step, on any rank.
    `operator`, `preconditioned`: the Jacobian, and the matrix for preconditioners; set by
        :meth:`create_matrices`.
    """

    def __init__(
        self,
        case: Any,
        scales: Scales,
        film_scale: float,
        comm: PETSc.Comm = PETSc.COMM_WORLD,
        bound_tolerance: float = ZERO_TOLERANCE,
    ):
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
        self.inputs: StepInputs = None
        self.rows: Rows = None
        self.x_evaluated = self.operator = None
        self.bound_reached = False

    def _create_vectors(self) -> None:
        sizes = (n_dofs(self.local) + self.problem.load_is_local, n_dofs(self.n) + 1)
        self.x = PETSc.Vec().createMPI(sizes, comm=self.comm)
        self.f, self.lower, self.upper = self.x.duplicate(), self.x.duplicate(), self.x.duplicate()
        self.lower.set(PETSc.NINFINITY)
        self.upper.set(PETSc.INFINITY)
        if self.model.lower_bound is not None:
            w_of(self.lower.array, self.local)[:] = self.model.lower_bound
        self.to_all, self.all = PETSc.Scatter.toAll(self.x)
        self._petsc_objects = owned(self, self.x, self.f, self.lower, self.upper, self.all, self.to_all)

    def create_matrices(self, with_band: bool) -> None:
        """Create the Jacobian and the matrix for preconditioners.

        `with_band`: whether preconditioners get the Jacobian itself, as
            :mod:`ehlpetsc.nonlinear.preconditioner` needs it; otherwise an assembled matrix with the
            deflection of the near field.
        """
        sizes = self.x.getSizes()
        self.factors = Factors(self.problem, self.ranks) if with_band else None
        self.jacobian = JacobianOperator(self.problem, self.linear_halo, self.ranks, self.factors)
        self.operator = python_matrix(self.jacobian, sizes, self.comm)
        self.assembled, self.preconditioned = None, self.operator
        self._petsc_objects.append(self.operator)
        if not with_band:
            self.preconditioned = PETSc.Mat().createAIJ((sizes, sizes), comm=self.comm)
            self.assembled = NearFieldMatrix(self.problem, self.near_field, self.preconditioned)
            self._petsc_objects.append(self.preconditioned)

    def set_initial_guess(self, guess: Unknowns, inputs: StepInputs) -> None:
        """Set the unknowns to an initial guess on the whole mesh, and the inputs of the solve."""
        self.inputs, self.x_evaluated, self.rows = inputs.begin(), None, None
        local = slice(self.problem.first, self.problem.last)
        q_of(self.x.array, self.local)[:], w_of(self.x.array, self.local)[:] = guess.q[local], guess.w[local]
        if self.problem.load_is_local:
            self.x.array[-1] = guess.h00

    def solution(self) -> Unknowns:
        """The whole solution on every rank."""
        return Unknowns(*self._parts_of(self.x))

    def _parts_of(self, v: PETSc.Vec) -> tuple[np.ndarray, np.ndarray, float]:
        self.to_all.scatter(v, self.all, mode=PETSc.ScatterMode.FORWARD)
        values = self.all.array_r
        return q_of(values, self.n).copy(), w_of(values, self.n).copy(), values[-1]

    def residual(self) -> Rows:
        """Residual of the solution, on every rank."""
        if self.rows is None:
            self.f.array[:] = self.evaluation(self.x).residual
            self.rows = Rows(*self._parts_of(self.f))
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
        self.x_evaluated = x.array_r.copy()
        with events.RESIDUAL:
            pressure = self.contact.pressure(*pairs(self.x_evaluated, self.local).T)
            local_data = self.x_evaluated, np.ascontiguousarray(pressure), reaches_bound
            nodes, h00, curvature, load = exchange_unknowns(*self.halo, local_data)
            (q, w), sums = np.ascontiguousarray(nodes.T), PressureSums(curvature, load[:3])
            self._evaluation = self.problem.evaluate(Unknowns(q, w, h00), self.inputs, sums)
            self.bound_reached = load[3] > 0.0
        return self._evaluation

    def linearise(self, x: PETSc.Vec, is_evaluated: bool = False) -> None:
        """Set the matrices for x; `is_evaluated` states that x is the point evaluated last, on every rank."""
        self.jacobian.linearise(self._evaluation if is_evaluated else self.evaluation(x))
        if self.assembled:
            with events.ASSEMBLY:
                state = gathered(self.ranks, self.jacobian.state, self.problem.owned)
                self.assembled.fill(state, self.jacobian.reynolds_derivatives)

    @property
    def contact(self) -> ContactModel:
        """Contact model of the current solve."""
        return self.inputs.contact or self.model

    def limit_step(self, x: PETSc.Vec, y: PETSc.Vec) -> None:
        """Shorten a step y, to be subtracted from x, and limit single entries of it.

        All of y is scaled by one factor, so that linear rows remain satisfied, to `STEP_LIMIT` p0 in any
        pressure, because the viscosity is exponential in p; the contact model limits single entries.
        """
        now, step = pairs(x.array_r, self.local), pairs(y.array, self.local)
        change = global_max(self.ranks, self.contact.pressure_change(now, step))
        if change > STEP_LIMIT:
            y.scale(STEP_LIMIT / change)
        step = pairs(y.array, self.local)
        self.contact.clip_step(now, step, FILM_AFTER_RELEASE * self.problem.film_scale)

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
        local = reynolds_rounding(evaluation.reynolds_derivatives, unknown, film, self.problem.owned.start)
        return float(RESIDUAL_ROUNDING * np.sqrt(global_sum(self.ranks, local)))


def first_nodes(n: int, ranks: int) -> list[int]:
    """First nodes of all ranks, multiples of `BLOCK`, and n."""
    max_ranks = max(n // BLOCK, 1)
    if ranks > max_ranks:
        raise UsageError(f"{ranks} ranks for {n} nodes; allowed: at most {max_ranks}")
    return [n * k // ranks // BLOCK * BLOCK for k in range(ranks)] + [n]


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
