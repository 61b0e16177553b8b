"""The Jacobian as PETSc's matrices: matrix-free with the whole deflection, and its near field assembled.

The Krylov method multiplies by the whole Jacobian (:class:`JacobianOperator`, a Python matrix), from which
the default preconditioner takes its coefficients (``pc.getOperators()``). Other preconditioners
(``-pc_type lu`` ...) get :class:`NearFieldMatrix`.
"""

import numpy as np

from ehlpetsc.discretisation.deflection import SECOND_DIFFERENCE
from ehlpetsc.discretisation.finite_volumes import STENCIL
from ehlpetsc.discretisation.interleaving import (
    n_dofs,
    nodes_of_w,
    q_columns,
    q_index,
    q_of,
    w_columns,
    w_index,
    w_of,
)
from ehlpetsc.nonlinear import events
from ehlpetsc.nonlinear.operators.jacobian_product import Linearisation, jacobian_product
from ehlpetsc.nonlinear.operators.python_matrix import python_matrix

PIVOT_REGULARISATION = 1e-3  # of dp/dq: at cavitated nodes, in preconditioners alone


def pivot_regularisation(*derivatives):
    """Addition to the diagonal of the deflection rows in preconditioners, where no entry depends on q.

    Parameters
    ----------
    derivatives : ndarray
        All derivatives of the rows with respect to q of their own node.
    """
    has_entry = np.any([d != 0.0 for d in derivatives], axis=0)
    return np.where(has_entry, 0.0, PIVOT_REGULARISATION)


class JacobianOperator:
    """Matrix-free Jacobian, context of PETSc's Python matrix.

    Parameters
    ----------
    problem : ehl_problem.EHLProblem
    halo : halo_exchange.Halo
    ranks : mpi4py communicator
    factors : preconditioner.far_field_band.Factors or None
        Of the default preconditioner, kept between solves.

    Attributes
    ----------
    model, state, reynolds_derivatives
        Of the linearisation, as in `ehl_problem.Evaluation`.
    size : int
        Local unknowns of the whole system.
    active : slice or ndarray of int
        Local indices of the unknowns in the system.
    inactive_nodes : ndarray of int
        Local nodes whose second unknown is not in the system.
    """

    def __init__(self, problem, halo, ranks, factors):
        self.problem, self.halo, self.ranks, self.factors = problem, halo, ranks, factors
        self.active, self.inactive_nodes = slice(None), np.arange(0)
        self.model = self.state = self.reynolds_derivatives = None
        self.size = n_dofs(problem.local) + problem.load_is_local
        self._room = np.empty(problem.local), np.empty((3, len(halo.window)))

    def linearise(self, evaluation):
        """Set the state whose derivatives the products have."""
        self.model, self.reynolds_derivatives = evaluation.model, evaluation.reynolds_derivatives
        self.state = self.model.linearised(evaluation.state, self.problem.owned, self._ranks_sum)
        self._derivatives = self.state.derivatives(), self.reynolds_derivatives

    def linearised(self, inactive_nodes):
        """`Linearisation` at that state."""
        return Linearisation((*self._derivatives, inactive_nodes, self.problem.deflection.form), self._room)

    @property
    def linearisation(self):
        """`Linearisation` of all unknowns."""
        return self.linearised(self.inactive_nodes)

    def _ranks_sum(self, numbers):
        return np.sum(self.ranks.allgather(numbers), axis=0)

    def mult(self, mat, v, out):
        """PETSc's product."""
        with events.PRODUCT:
            jacobian_product(*self.linearisation, tuple(self.halo), v.array_r.copy(), out.array)

    def createSubMatrix(self, mat, rows, columns, out=None):
        """Matrix of the unknowns that SNESVI keeps; rows and columns are the same."""
        return python_matrix(RestrictedOperator(self, rows, mat), rows.getSizes(), mat.comm)


class RestrictedOperator:
    """Jacobian of the unknowns that SNESVI keeps, context of a Python matrix."""

    def __init__(self, whole, rows, mat):
        self.whole, self.size, self.halo, self.factors = whole, whole.size, whole.halo, whole.factors
        self.active, self.inactive_nodes = slice(None), whole.inactive_nodes
        indices = rows.indices
        if len(indices) < self.size:
            self.active = indices - mat.getOwnershipRange()[0]
            is_inactive = np.ones(self.size, dtype=bool)
            is_inactive[self.active] = False
            self.inactive_nodes = nodes_of_w(np.flatnonzero(is_inactive))

    @property
    def model(self):
        return self.whole.model

    @property
    def state(self):
        return self.whole.state

    @property
    def reynolds_derivatives(self):
        return self.whole.reynolds_derivatives

    @property
    def linearisation(self):
        """`Linearisation` of the unknowns in the system."""
        return self.whole.linearised(self.inactive_nodes)

    def mult(self, mat, v, out):
        """PETSc's product."""
        full, rows = np.zeros(self.size), np.empty(self.size)
        full[self.active] = v.array_r
        jacobian_product(*self.linearisation, tuple(self.halo), full, rows)
        out.array[:] = rows[self.active]


class NearFieldMatrix:
    """The Jacobian with the deflection of `near_field` nodes on either side, in an AIJ matrix.

    Parameters
    ----------
    problem : ehl_problem.EHLProblem
    near_field : int
    matrix : petsc4py.PETSc.Mat
        AIJ, created with its sizes.
    """

    def __init__(self, problem, near_field, matrix):
        self.problem, self.matrix, self.near_field = problem, matrix, min(near_field, problem.n - 1)
        self._deflection_columns()
        rows, columns = self._pattern()
        matrix.setPreallocationCSR((rows, columns, np.zeros(len(columns))))
        matrix.setOption(matrix.Option.NEW_NONZERO_LOCATION_ERR, True)
        matrix.setOption(matrix.Option.NO_OFF_PROC_ENTRIES, True)  # nothing to exchange at assembly

    def _deflection_columns(self):
        """Columns of the local deflection rows; -1: no entry."""
        p, n = self.problem, self.problem.n
        nodes = np.arange(p.first, p.last)[:, None] + np.arange(-self.near_field, self.near_field + 1)
        self.there = (nodes >= 0) & (nodes < n)
        self.nodes = np.clip(nodes, 0, n - 1)
        by_q = np.where(self.there, q_index(self.nodes), -1)
        by_w = np.where(self.there, w_index(self.nodes), -1)
        approach = np.full((p.local, 1), -1)
        for end in p.deflection.ends:
            approach[end - p.first] = n_dofs(n)
        self.columns = np.hstack([by_q, by_w, approach]).astype(np.int32)

    def _pattern(self):
        p, rows = self.problem, []
        for deflection, reynolds in zip(self.columns, p.reynolds_columns, strict=True):
            rows += [deflection[deflection >= 0], reynolds[reynolds >= 0]]
        if p.load_is_local:
            rows.append(np.arange(n_dofs(p.n) + 1))
        return np.cumsum([0] + [len(r) for r in rows]).astype(np.int32), np.concatenate(rows).astype(np.int32)

    def fill(self, state, derivatives):
        """Assemble the matrix of a state, which is that of the whole mesh, on every rank."""
        p, d, near_field = self.problem, self.problem.deflection, self.near_field
        kernel = np.tile(-d.curvature[np.abs(np.arange(-near_field, near_field + 1))], (p.local, 1))
        bend = np.zeros_like(kernel)
        bend[:, near_field - 1 : near_field + 2] = d.curvature_coefficient * np.array(SECOND_DIFFERENCE)
        for end in d.ends:
            row = end - p.first
            kernel[row], bend[row] = d.end_row(end)[self.nodes[row]], 0.0
            bend[row, near_field] = d.end_row_coefficient
        by_q = kernel * state.p_q[self.nodes] + bend * state.separation_q[self.nodes]
        owned = slice(p.first, p.last)
        by_q[:, near_field] += pivot_regularisation(state.p_q[owned], state.separation_q[owned])
        by_w = kernel * state.p_w[self.nodes] + bend * state.separation_w[self.nodes]
        approach = np.full((p.local, 1), -d.end_row_coefficient)
        nodes = np.arange(p.first, p.last, dtype=np.int32)
        set_rows(self.matrix, q_index(nodes), self.columns, np.hstack([by_q, by_w, approach]))
        set_rows(self.matrix, w_index(nodes), p.reynolds_columns, self._by_unknowns(state, derivatives))
        if p.load_is_local:
            load = np.zeros(n_dofs(p.n))
            q_of(load, p.n)[:], w_of(load, p.n)[:] = p.dx * state.p_q, p.dx * state.p_w
            self.matrix.setValues([n_dofs(p.n)], np.arange(n_dofs(p.n), dtype=np.int32), load)
        self.matrix.assemble()

    def _by_unknowns(self, state, derivatives):
        """Derivatives of the Reynolds rows with respect to q and w."""
        p, values = self.problem, derivatives.copy()
        nodes = np.arange(p.first, p.last)[:, None] + np.arange(-2, STENCIL - 2)
        nodes = np.clip(nodes, 0, p.n - 1)
        by_unknown, by_film = q_columns(derivatives), w_columns(derivatives)
        w_columns(values)[:] = by_film * state.h_w[nodes]
        if state.plastic is not None:
            q_columns(values)[:] = by_unknown * state.plastic.reynolds_q[nodes]
            w_columns(values)[:] += by_unknown * state.plastic.reynolds_w[nodes]
        return values


def set_rows(matrix, rows, columns, values):
    """Insert a block of rows of equal width; negative columns are left out by PETSc."""
    for_row = np.arange(len(rows) + 1, dtype=np.int32) * columns.shape[1]
    matrix.setValuesIJV(for_row, columns.ravel(), np.ascontiguousarray(values).ravel(), rowmap=rows)
