r"""Preconditioner of a contact in the plane: film and load eliminated, then a system of the pressures.

For a right-hand side (b_g, b_F, b_W) of the rows of deflection, Reynolds equation and border:

1. The separation by the row of the deflection, :math:`\delta s=D\,\delta p+\delta g_b+b_g/s_g`, is put
   into the Reynolds rows (:mod:`.reduction`).
2. The pressures follow from a coarse correction (:mod:`.coarse_space`) and from the sparse form
   (:mod:`.screened_poisson`) by its incomplete LU (:mod:`.factors`). The border adds rows and columns.
3. One convolution gives the separation and with it both unknowns of each node: the rows of the deflection are
   exact but where pressure and separation depend on each other.

Every time step begins with the matrices of the smooth contact (:meth:`Elimination.keep`), on which it depends
neither before nor after a restart. They are assembled anew, for the rest of the step, when GMRES takes more
than `MAX_KEPT` iterations, the sparse one also where a node changes its kind.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from ehlpetsc.discretisation.ehl_problem import EHLProblem
from ehlpetsc.discretisation.finite_volumes import STENCIL
from ehlpetsc.discretisation.unknowns import border_of, n_dofs
from ehlpetsc.nonlinear.options import BACK_SOLVE, FACTOR
from ehlpetsc.nonlinear.plane.coarse_space import CoarseCorrection, CoarseSpace
from ehlpetsc.nonlinear.plane.exchange import PlaneExchange
from ehlpetsc.nonlinear.plane.factors import OVERLAP, CompleteLU, IncompleteLU
from ehlpetsc.nonlinear.plane.jacobian import PlaneJacobian
from ehlpetsc.nonlinear.plane.reduction import PRESSURE, Reduction, reduction_of, unknowns_of
from ehlpetsc.nonlinear.plane.screened_poisson import fill, fill_right_side, fitted_term, taken
from ehlpetsc.nonlinear.ranks import global_sum

# relative tolerance of GMRES from which on its deflections and factors are of single precision, 1e-7; a stiff
# dry layer needs a lower one, and double precision
MIN_SINGLE = 1e-5
MAX_KEPT = 16  # iterations of GMRES up to which factors are kept


def precision_of(operator: PlaneJacobian) -> type:
    """Precision of the deflections and factors for the linear tolerance of an operator."""
    return np.float32 if operator.linear_rtol >= MIN_SINGLE else np.float64


class EliminatedFilm:
    """Context of PETSc's Python preconditioner.

    Use: ``-pc_type python -pc_python_type ehlpetsc.nonlinear.plane.preconditioner.EliminatedFilm`` (the
    default).
    """

    def setUp(self, pc: PETSc.PC) -> None:
        """Prepare the elimination for the state of the operator."""
        self.operator: PlaneJacobian = pc.getOperators()[0].getPythonContext()
        self.operator.elimination.prepare(self.operator)

    def apply(self, pc: PETSc.PC, x: PETSc.Vec, y: PETSc.Vec) -> None:
        """Solve for one right-hand side."""
        operator, full = self.operator, x.array_r
        if not isinstance(operator.active, slice):
            full = np.zeros(operator.size)
            full[operator.active] = x.array_r
        y.array[:] = operator.elimination.solve(operator, full)[operator.active]


class SparseForm:
    """Sparse form with its factors.

    `term`: of the deflection, see :func:`.screened_poisson.fitted_term`.
    `precision`: of incomplete factors.
    `is_complete`: whether the factors are complete: for oil so viscous that pivots of incomplete ones vanish.

    `kind`, `p_s`: of the local nodes, as of :class:`.reduction.Reduction`.
    `no_pressure`: mask of the nodes of the window not `PRESSURE`.
    `by`: derivatives of the local Reynolds rows by v and separation, as `EHLProblem.reynolds` multiplies by
        them, shape (local nodes, 12).
    """

    def __init__(
        self,
        problem: EHLProblem,
        exchange: PlaneExchange,
        term: tuple,
        comm: PETSc.Comm,
        precision: type,
        is_complete: bool,
    ):
        self.problem, self.exchange, self.term = problem, exchange, term
        self.precision, self.is_complete = precision, is_complete
        n_y, self.n_x = problem.grid.shape
        self.overlap = 1 if is_complete else min(OVERLAP, n_y)
        self.own, nodes = exchange.slab(self.overlap), len(self._at_hand(np.empty((1, problem.local)))[0])
        self.factors: CompleteLU | IncompleteLU
        if is_complete:
            self.rows, self.factors = self.own, CompleteLU(problem, comm)
        else:
            self.rows, self.factors = slice(0, nodes), IncompleteLU(self.n_x, nodes, precision)
        self.of_rows = np.empty((self.rows.stop - self.rows.start, 2 * STENCIL), dtype=precision)

    def _at_hand(self, local: Sequence[np.ndarray]) -> Sequence[np.ndarray]:
        """Arrays of the local nodes with the rows of neighbours that the factors need."""
        if self.problem.share.window_size == self.problem.local:
            return local
        return self.exchange.windows(local, self.overlap)

    def set_up(self, reduction: Reduction, derivatives: np.ndarray) -> None:
        """Factor for a state: reduction of the window, derivatives of the local Reynolds rows."""
        p, factors, rows = self.problem, self.factors, self.rows
        kind, *changes = self._at_hand([part[p.owned] for part in reduction[:6]])
        whole, scales = (kind.astype(np.uint8), *changes), (p.deflection.row_scale, *p.grid.increments)
        of_rows = rows.start, rows.stop, factors.pointers, factors.places
        derivatives = self.exchange.window(derivatives, self.overlap)
        fill(whole, derivatives, self.term, scales, self.n_x, of_rows, factors.blocks, self.of_rows)
        factors.factor()
        self.of_factors = whole[0][rows], whole[5][rows].copy()  # without the other changes
        self.kind, self.p_s = whole[0][self.own], self.of_factors[1][self.own.start - rows.start :][: p.local]
        first = self.own.start - rows.start
        self.by = self.of_rows[first : first + p.local]
        self.no_pressure = reduction.kind != PRESSURE

    def solve(self, reynolds: np.ndarray, separation: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Pressures and Reynolds unknowns of the local nodes.

        Parameters
        ----------
        reynolds
            Right-hand side of the Reynolds rows.
        separation
            Change of the separation besides the deflection.
        """
        deflection, factors = self.problem.deflection, self.factors
        scales, rows = (deflection.cell, deflection.row_scale), (reynolds, separation)
        if not self.is_complete:
            rows = tuple(self._at_hand(rows))
        fill_right_side(*self.of_factors, scales, rows, factors.b)
        u = self.exchange.window(factors.solve()) if self.is_complete else factors.solve()
        of_nodes, own = (self.kind, self.p_s, self.term), (self.n_x, self.own.start)
        return taken(*of_nodes, self.problem.grid.increments, separation, u, own)


class PlaneFactors(NamedTuple):
    """Sparse form and coarse correction (None: no use) of one state; solutions for units of the border."""

    sparse: SparseForm
    coarse: CoarseCorrection | None
    of_border: Sequence[tuple[np.ndarray, np.ndarray, np.ndarray]] = ()


class Elimination:
    """Elimination of film and load with its matrices, kept from one linear system to the next.

    PETSc creates a new preconditioner whenever the set of active unknowns changes.

    `builds`: number of sparse forms so far. `back`: of the local nodes, as of :class:`.reduction.Reduction`.
    """

    def __init__(self, problem: EHLProblem, ranks: MPI.Comm, comm: PETSc.Comm):
        self.problem, self.ranks, self.comm = problem, ranks, comm
        deflection = problem.deflection
        compliances = deflection.stiffness * deflection.kernel.direct
        self.coarse_space = CoarseSpace(compliances, problem.grid.periodic)
        self.term = fitted_term(deflection.stiffness, problem.grid.increments, deflection.kernel)
        self.builds, self.back = 0, np.empty((4, 0))
        self.applications = MAX_KEPT + 1  # since the last linear solve began: iterations of GMRES
        self.form: SparseForm | None = None  # filled in again and again
        self.factors: PlaneFactors | None = None
        self.kept: PlaneFactors | None = None

    def begin_solve(self) -> None:
        """Return to the kept factors, or to none."""
        if self.form is not None and self.form.is_complete:
            self.form = None
        self.factors, self.applications = self.kept, 0 if self.kept else MAX_KEPT + 1

    def renew(self) -> None:
        """Free what a failed solve has left: PETSc's preconditioner keeps a failed factorisation."""
        self.form, self.factors, self.applications = None, self.kept, MAX_KEPT + 1

    def keep(self, operator: PlaneJacobian) -> None:
        """Factor for the state of an operator, as the first factors of all later solves."""
        self.applications = MAX_KEPT + 1
        self.prepare(operator)
        self.kept, self.form = self.factors, None

    def prepare(self, operator: PlaneJacobian) -> None:
        """Assemble and factor anew where the kept matrices no longer serve."""
        owned = self.problem.owned
        inactive = np.zeros(self.problem.share.window_size, dtype=bool)
        inactive[owned.start + operator.inactive_nodes] = True
        reduction = reduction_of(operator.derivatives, inactive)
        self.back = np.ascontiguousarray(reduction.back[:, owned])
        slow = self._any(self.applications > MAX_KEPT)
        if slow or self._any(not np.array_equal(reduction.kind[owned], self.factors.sparse.kind)):
            with FACTOR:
                self._build(operator, reduction, slow or self.factors is self.kept)
        self.applications = 0

    def _any(self, condition: bool) -> bool:
        """Whether a condition holds on any rank."""
        return condition if self.ranks.size == 1 else self.ranks.allreduce(int(condition), op=MPI.MAX) == 1

    def _gathered(self, local: np.ndarray) -> np.ndarray:
        """Values of all nodes from those of the local ones, first axis."""
        return local if self.ranks.size == 1 else np.concatenate(self.ranks.allgather(local))

    def _build(
        self, operator: PlaneJacobian, reduction: Reduction, with_coarse: bool, is_complete: bool = False
    ) -> None:
        """Factor for the state of an operator; completely where incomplete factors break down."""
        p, self.builds = self.problem, self.builds + 1
        coarse = None if with_coarse or self.factors is None else self.factors.coarse
        is_complete |= self.form is not None and self.form.is_complete
        if self.form is None or self.form.is_complete != is_complete:
            self.form = self.factors = None  # freed before the next one
            self.form = SparseForm(
                p, operator.exchange, self.term, self.comm, precision_of(operator), is_complete
            )
        sparse = self.form
        sparse.set_up(reduction, operator.reynolds_derivatives)
        mask = self._gathered(sparse.kind == PRESSURE)
        mask[:: p.grid.shape[-1]] = False  # the inlet has no balance
        if coarse is None and p.fluid is not None and self.coarse_space.reaches(mask):
            coarse = CoarseCorrection(self.coarse_space, sparse.by, mask, p.share, self.ranks)
        self.factors = PlaneFactors(sparse, coarse)
        gaps = (np.full(p.local, p.balance.gap(unit, p.share.local)) for unit in np.eye(p.balance.unknowns))
        of_border = [self._pressures(operator, np.zeros(p.local), gap) for gap in gaps]
        of_border = [(by_p, by_r, global_sum(self.ranks, forces)) for by_p, by_r, forces in of_border]
        self.factors = PlaneFactors(sparse, coarse, of_border)
        is_broken = self._any(not np.isfinite([part.sum() for parts in of_border for part in parts]).all())
        if is_broken and not is_complete:
            self._build(operator, reduction, with_coarse, is_complete=True)

    def _pressures(
        self, operator: PlaneJacobian, reynolds: np.ndarray, separation: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Pressures, Reynolds unknowns and forces of the local nodes; see :meth:`SparseForm.solve`."""
        p, (sparse, coarse, _) = self.problem, self.factors
        changes = np.zeros((p.local, 2), dtype=sparse.precision)
        changes[:, 1] = separation
        given = operator.exchange.window(changes)
        reynolds = reynolds - p.reynolds.product(sparse.by, given, p.owned.start)
        with BACK_SOLVE:
            coarsely = 0.0
            if coarse:
                coarsely, change, reynolds = self._coarsely(reynolds)
                separation = separation + change
            pressure, r = sparse.solve(reynolds, separation)
        pressure = pressure + coarsely
        return pressure, r, operator.exchange.local_forces(pressure)

    def _coarsely(self, reynolds: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Local pressures and separation of the coarse correction, the Reynolds rows that they leave."""
        p, (sparse, coarse, _) = self.problem, self.factors
        changes = coarse(reynolds.astype(np.float32))
        changes[sparse.no_pressure, 0] = 0.0
        left = reynolds - p.reynolds.product(sparse.by, changes, p.owned.start)
        return changes[p.owned, 0], changes[p.owned, 1], left

    def solve(self, operator: PlaneJacobian, full: np.ndarray) -> np.ndarray:
        """Local unknowns for a local right-hand side, with those of the border: films, pressures, border."""
        p, exchange = self.problem, operator.exchange
        self.applications += 1
        of_deflection, of_reynolds = full[: n_dofs(p.local)].reshape(-1, 2).T
        given = of_deflection / p.deflection.row_scale  # separation besides the deflection
        pressure, r, forces = self._pressures(operator, of_reynolds, given)
        forces, of_border = exchange.with_border(forces, full)
        pressure, r, border = self._with_border(pressure, r, forces, of_border)
        deflection = exchange.deflection(pressure, precision_of(operator))
        separation = deflection + p.balance.gap(border, p.share.local) + given
        out = self._whole(operator, (pressure, r, separation), border)
        operator.remember(out, pressure, deflection)
        return out

    def _with_border(
        self, pressure: np.ndarray, r: np.ndarray, forces: np.ndarray, of_border: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Pressures and Reynolds unknowns with the border's change, and that change.

        `forces`: by the pressures without it. `of_border`: right-hand side of its rows.
        """
        units = self.factors.of_border
        by_unit = np.array([forces_of_unit for _, _, forces_of_unit in units])
        border = self.problem.balance.change(of_border, forces, by_unit)
        for change, (by_pressure, by_r, _) in zip(border, units, strict=True):
            pressure, r = pressure + change * by_pressure, r + change * by_r
        return pressure, r, border

    def _whole(self, operator: PlaneJacobian, of_nodes: tuple, border: np.ndarray) -> np.ndarray:
        """Local unknowns of the whole system from pressure, Reynolds unknown and separation of the nodes."""
        p, out = self.problem, np.empty(operator.size)
        out[: n_dofs(p.local)] = unknowns_of(self.factors.sparse.kind, self.back, *of_nodes).ravel()
        out[2 * operator.inactive_nodes + 1] = 0.0
        if p.owns_border:
            border_of(out, p.local)[:] = border
        return out
