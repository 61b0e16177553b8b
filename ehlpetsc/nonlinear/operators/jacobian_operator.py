"""The Jacobian as PETSc's matrices: matrix-free with the whole deflection, and its near field assembled.

The Krylov method multiplies by the whole Jacobian (:class:`JacobianOperator`, a Python matrix), from which
the default preconditioner takes its coefficients (``pc.getOperators()``). Other preconditioners
(``-pc_type lu`` ...) get :class:`NearFieldMatrix`.
"""

import numpy as np

from ehlpetsc.discretisation.contact.node_state import directional_derivative
from ehlpetsc.discretisation.deflection import SECOND_DIFFERENCE
from ehlpetsc.discretisation.finite_volumes import STENCIL
from ehlpetsc.discretisation.interleaving import (
    n_dofs,
    nodes_of_w,
    pairs,
    q_columns,
    q_index,
    q_of,
    w_columns,
    w_index,
    w_of,
)
from ehlpetsc.nonlinear import events
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
    exchange : halo_exchange.HaloExchange
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

    def __init__(self, problem, exchange, factors):
        self.problem, self.exchange, self.factors = problem, exchange, factors
        self.active, self.inactive_nodes = slice(None), np.arange(0)
        self.model = self.state = self.reynolds_derivatives = self._by = None
        self.size, self._pressure = n_dofs(problem.local) + problem.load_is_local, np.empty(problem.local)

    def linearise(self, evaluation):
        """Set the state whose derivatives the products have."""
        self.model, self.reynolds_derivatives = evaluation.model, evaluation.reynolds_derivatives
        self.state = self.model.linearised(evaluation.state, self.problem.owned, self._ranks_sum)
        self._by = self.state.derivatives()

    def _ranks_sum(self, numbers):
        return np.sum(self.exchange.ranks.allgather(numbers), axis=0)

    def times(self, v, out):
        """Fill in the product with the local part of a vector; collective."""
        problem = self.problem
        with events.PRODUCT:
            directional_derivative(self._by[0], pairs(v, problem.local), problem.owned.start, self._pressure)
            at_nodes = self.exchange(v, self._pressure)
            problem.jacobian_vector_product(self._by, self.reynolds_derivatives, *at_nodes, out)

    def precondition(self, v, out):
        """Fill in the solution of the preconditioner for the local part of a vector; collective."""
        with events.BACK_SOLVE:
            self.factors.lu.solve(v, self.factors.unknowns, out)

    def mult(self, mat, v, out):
        """PETSc's product."""
        self.times(v.array_r, out.array)

    def createSubMatrix(self, mat, rows, columns, out=None):
        """Matrix of the unknowns that SNESVI keeps; rows and columns are the same."""
        return python_matrix(RestrictedOperator(self, rows, mat), rows.getSizes(), mat.comm)


class RestrictedOperator:
    """Jacobian of the unknowns that SNESVI keeps, context of a Python matrix."""

    def __init__(self, whole, rows, mat):
        self.whole, self.size = whole, whole.size
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
    def factors(self):
        return self.whole.factors

    def times(self, v, out):
        """Fill in the product with a vector of the whole system, zero outside of this one; collective."""
        self.whole.times(v, out)
        w_of(out, self.size // 2)[self.inactive_nodes] = 0.0

    def precondition(self, v, out):
        """As of :class:`JacobianOperator`."""
        self.whole.precondition(v, out)

    def mult(self, mat, v, out):
        """PETSc's product."""
        full, rows = np.zeros(self.size), np.empty(self.size)
        full[self.active] = v.array_r
        self.whole.times(full, rows)
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
