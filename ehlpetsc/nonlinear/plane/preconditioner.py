r"""Preconditioner of a contact in the plane: film and load eliminated, the pressures by PETSc.

For a right-hand side (b_g, b_F, b_W) of the rows of deflection, Reynolds equation and load:

1. The separation by the row of the deflection, :math:`\delta s=D\,\delta p+\delta h_{00}+b_g/s_g`, is put into the
   Reynolds rows (:mod:`.reduction`).
2. The pressures follow from a coarse correction (:mod:`.coarse_space`) and PETSc's preconditioner of the user's
   options, ``-pc_type``, by default incomplete LU, of the sparse matrix of :mod:`.screened_poisson`. The load is an
   additional row and column.
3. One convolution gives the separation and with it both unknowns of each node: the rows of the deflection are exact.

The matrix is kept for later iterations and time steps until GMRES takes more than `MAX_KEPT` iterations, or a node
changes its kind and with it the number of unknowns.
"""

from __future__ import annotations

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc
from scipy.sparse import csr_matrix

from ehlpetsc.discretisation.ehl_problem import EHLProblem
from ehlpetsc.discretisation.unknowns import n_dofs
from ehlpetsc.nonlinear import events
from ehlpetsc.nonlinear.plane.coarse_space import CoarseCorrection, CoarseSpace
from ehlpetsc.nonlinear.plane.jacobian import PlaneJacobian
from ehlpetsc.nonlinear.plane.reduction import BOUND, CONTACT, PRESSURE, VOID, reduction_of
from ehlpetsc.nonlinear.plane.screened_poisson import MAX_ROW, TERMS, fill, fitted_terms

PREFIX = "pressure_"  # of the options of PETSc's preconditioner; -pc_type means -pressure_pc_type
MAX_KEPT = 14  # iterations of GMRES up to which the matrix is kept


class EliminatedFilm:
    """Context of PETSc's Python preconditioner.

    Use: ``-pc_type python -pc_python_type ehlpetsc.nonlinear.plane.preconditioner.EliminatedFilm`` (the default).
    """

    def setUp(self, pc: PETSc.PC) -> None:
        """Prepare the elimination for the state of the operator."""
        self.operator: PlaneJacobian = pc.getOperators()[0].getPythonContext()
        self.operator.elimination.prepare(self.operator)

    def apply(self, pc: PETSc.PC, x: PETSc.Vec, y: PETSc.Vec) -> None:
        """Solve for one right-hand side."""
        operator, full = self.operator, np.zeros(self.operator.size)
        full[operator.active] = x.array_r
        y.array[:] = operator.elimination.solve(full)[operator.active]


class Elimination:
    """Elimination of film and load with its factors, kept from one matrix to the next.

    PETSc creates a new preconditioner whenever the set of active unknowns changes.
    """

    def __init__(self, problem: EHLProblem, ranks: MPI.Comm, comm: PETSc.Comm):
        self.problem, self.ranks, self.comm = problem, ranks, comm
        self.periodic, self.n_x = problem.grid.periodic, problem.grid.shape[-1]
        self.spacings = problem.grid.steps
        self.coarse_space = CoarseSpace(problem.deflection.kernel, self.periodic)
        self.terms = fitted_terms(problem.deflection.stiffness, self.spacings)
        self._nothing = np.zeros(len(problem.window))
        self.builds = 0
        self.applications = 0  # since the last set-up: iterations of GMRES
        self.pc: PETSc.PC | None = None
        self.kind: np.ndarray | None = None

    def prepare(self, operator: PlaneJacobian) -> None:
        """Assemble and factor anew where the kept matrix no longer serves."""
        self.operator = operator
        inactive = np.zeros(len(self.problem.window), dtype=bool)
        inactive[self.problem.owned.start + self.operator.inactive_nodes] = True
        self.reduction = reduction_of(self.operator.state, inactive)
        kind = self.reduction.kind[self.problem.owned]
        same = self.kind is not None and np.array_equal(kind, self.kind)
        keeps = same and self.applications <= MAX_KEPT
        if self.ranks.size > 1:
            keeps = self.ranks.allreduce(int(keeps), op=MPI.MIN) == 1
        if not keeps:
            with events.FACTOR:
                self.build()
            self.kind = kind
        self.applications = 0

    def _gathered(self, local: np.ndarray) -> np.ndarray:
        """Values of all nodes from those of the local ones, first axis."""
        if self.ranks.size == 1:
            return local
        return np.concatenate(self.ranks.allgather(local))

    def build(self) -> None:
        """Assemble the sparse form and set up PETSc's preconditioner."""
        p, self.builds = self.problem, self.builds + 1
        owned, derivatives = p.owned, self.operator.reynolds_derivatives
        whole = [self._gathered(np.ascontiguousarray(v[owned])) for v in self.reduction[:6]]
        block = self.block = TERMS + 1 + int((whole[0] == CONTACT).any())
        rows = block * p.local
        entries = p.local * (TERMS * 6 + TERMS + 2 + MAX_ROW + 1)
        pointers = np.zeros(rows + 1, dtype=np.int32)
        columns, values = np.empty(entries, dtype=np.int32), np.empty(entries)
        self.by_pressure, self.by_separation, border = (
            np.zeros((p.local, 6)),
            np.zeros((p.local, 6)),
            np.zeros(rows),
        )
        mesh = self.n_x, p.n, p.first, p.last, self.periodic, block
        scales = p.deflection.row_scale, *self.spacings
        count = fill(
            tuple(whole),
            derivatives,
            self.terms,
            scales,
            mesh,
            (pointers, columns, values),
            self.by_pressure,
            self.by_separation,
            border,
        )
        if self.pc is not None:
            for thing in (self.pc, self.matrix, self.b, self.u):
                thing.destroy()
        sizes = (rows, block * p.n)
        self._entries = pointers, columns[:count].copy(), values[:count].copy()  # PETSc does not copy them
        self.matrix = PETSc.Mat().createAIJWithArrays((sizes, sizes), self._entries, comm=self.comm)
        self.pc = PETSc.PC().create(self.comm)
        self.pc.setOperators(self.matrix)
        self.pc.setOptionsPrefix(PREFIX)
        self.pc.setFromOptions()
        self.pc.setUp()
        self.b, self.u = self.matrix.createVecs()
        self._transport = np.zeros_like(derivatives)
        self._transport[:, ::2] = self.by_separation
        mine, nodes = self.reduction.kind[owned], block * np.arange(p.local)
        self.row_of_r = nodes + TERMS + (mine == CONTACT)
        self.row_of_g = np.flatnonzero((mine == CONTACT) | (mine == BOUND))
        self.has_reynolds, self.has_pressure = mine != BOUND, mine != VOID
        self.coarse = self._coarse_correction()
        self.of_h00, self.r_of_h00, self.load_of_h00 = self._solve(-border)

    def _coarse_correction(self) -> CoarseCorrection:
        """Coarse correction for the matrix of all ranks."""
        n, n_x = self.problem.n, self.n_x
        full = self._gathered(self.reduction.kind[self.problem.owned]) == PRESSURE
        full[::n_x] = False  # the inlet has no balance
        i = np.arange(n)
        near = np.stack([i - 2, i - 1, i, i + 1, i - n_x, i + n_x], axis=1) % n
        index = np.repeat(i, near.shape[1]), near.ravel()
        flow, transport = (
            csr_matrix((self._gathered(values).ravel(), index), (n, n))
            for values in (self.by_pressure, self.by_separation)
        )
        return CoarseCorrection(self.coarse_space, flow, transport, full)

    def _solve(self, b: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
        """Local pressures and Reynolds unknowns, and the load, by coarse correction and sparse form."""
        p, rows = self.problem, self.row_of_r
        with events.BACK_SOLVE:
            coarse, left = self.coarse(self._gathered(np.where(self.has_reynolds, b[rows], 0.0)))
            local = slice(p.first, p.last)
            self.b.array[:] = b
            self.b.array[rows[self.has_reynolds]] = left[local][self.has_reynolds]
            self.pc.apply(self.b, self.u)
        u = self.u.array_r
        pressure = np.where(self.has_pressure, u[TERMS :: self.block], 0.0) + coarse[local]
        load = p.deflection.cell * pressure.sum()
        if self.ranks.size > 1:
            load = self.ranks.allreduce(load)
        return pressure, u[rows], float(load)

    def solve(self, full: np.ndarray) -> np.ndarray:
        """Unknowns for a local right-hand side, both of the whole system."""
        p, operator, exchange = self.problem, self.operator, self.operator.exchange
        self.applications += 1
        local = n_dofs(p.local)
        b_g, b_r = full[0:local:2] / p.deflection.row_scale, full[1:local:2]
        b_load = full[-1] if operator.size > local else 0.0
        if self.ranks.size > 1:
            b_load = self.ranks.bcast(b_load, root=self.ranks.size - 1)
        b_r = b_r - p.reynolds.product(self._transport, exchange.window(b_g), self._nothing, p.owned.start)
        b = np.zeros(self.b.getLocalSize())
        b[self.row_of_r[self.has_reynolds]] = b_r[self.has_reynolds]
        b[self.block * self.row_of_g + TERMS] = full[0:local:2][self.row_of_g]
        pressure, r, load = self._solve(b)
        approach = (b_load - load) / self.load_of_h00
        pressure, r = pressure + approach * self.of_h00, r + approach * self.r_of_h00
        sums = exchange.sums(pressure)
        separation = sums.deflection + approach + b_g
        kind, back = self.reduction.kind[p.owned], self.reduction.back[:, p.owned]
        first = np.where(kind == VOID, r, pressure)
        second = np.where(kind == CONTACT, r, separation)
        out = np.empty(operator.size)
        out[0:local:2] = back[0] * first + back[1] * second
        out[1:local:2] = back[2] * first + back[3] * second
        out[2 * operator.inactive_nodes + 1] = 0.0
        if operator.size > local:
            out[-1] = approach
        operator.remember(out, pressure, sums)
        return out
