"""The Jacobian as PETSc's matrices: matrix-free with the whole deflection, and its near field assembled.

The Krylov method multiplies by the whole Jacobian (:class:`JacobianOperator`, a Python matrix), from which
the default preconditioner reads its coefficients (``pc.getOperators()``). Other preconditioners
(``-pc_type lu`` ...) use :class:`NearFieldMatrix`.
"""

from __future__ import annotations

import numpy as np
from mpi4py import MPI
from petsc4py import PETSc

from ehlpetsc.base.compiled import ZERO, compiled
from ehlpetsc.discretisation.contact.node_state import NodeState, directional_derivative
from ehlpetsc.discretisation.ehl_problem import EHLProblem
from ehlpetsc.discretisation.finite_volumes import ALONG, reynolds_product
from ehlpetsc.discretisation.line.deflection import SECOND_DIFFERENCE, deflection_rows
from ehlpetsc.discretisation.unknowns import (
    dofs_of,
    n_dofs,
    q_columns,
    q_index,
    q_of,
    w_columns,
    w_index,
    w_of,
)
from ehlpetsc.nonlinear.line.exchange import Halo, exchange_unknowns
from ehlpetsc.nonlinear.two_fields import Jacobian

PIVOT_REGULARISATION = 1e-3  # in place of dp/dq at cavitated nodes, in preconditioners alone


def pivot_regularisation(*derivatives: np.ndarray) -> np.ndarray:
    """Addition to the diagonal of the deflection rows in preconditioners, where no entry depends on q.

    `derivatives`: derivatives of the quantities in the rows with respect to q of their own node.
    """
    has_entry = np.any([d != 0.0 for d in derivatives], axis=0)
    return np.where(has_entry, 0.0, PIVOT_REGULARISATION)


class JacobianOperator(Jacobian):
    """Jacobian of a line contact.

    `exchange`: halo.
    `factors`: factors of the default preconditioner, kept between solves.
    """

    def __init__(self, problem: EHLProblem, halo: Halo, ranks: MPI.Comm, factors: object):
        super().__init__(problem, halo, ranks)
        self.halo, self.factors = halo, factors
        window = len(halo.buffers[2])
        self._work = np.empty(problem.local), np.empty((window, 2)), np.empty(window)

    @property
    def linearisation(self) -> tuple[tuple, tuple]:
        """State and work arrays of :func:`jacobian_product`."""
        point = self.derivatives, self.reynolds_derivatives
        return (*point, self.inactive_nodes, self.problem.deflection.form), self._work

    def product(self, v: np.ndarray, out: np.ndarray) -> None:
        jacobian_product(*self.linearisation, tuple(self.halo), v, out)


class NearFieldMatrix:
    """The Jacobian with the deflection of `near_field` nodes on either side, in an AIJ matrix.

    `matrix`: AIJ matrix whose sizes are set.
    """

    def __init__(self, problem: EHLProblem, near_field: int, matrix: PETSc.Mat):
        self.problem, self.matrix, self.near_field = problem, matrix, min(near_field, problem.n - 1)
        self._deflection_columns()
        matrix.setUp()
        matrix.setOption(matrix.Option.NEW_NONZERO_ALLOCATION_ERR, False)
        matrix.setOption(matrix.Option.NO_OFF_PROC_ENTRIES, True)  # nothing to exchange at assembly

    def _deflection_columns(self) -> None:
        """Columns of the local deflection rows; -1: no entry."""
        p, n = self.problem, self.problem.n
        nodes = np.arange(p.first, p.last)[:, None] + np.arange(-self.near_field, self.near_field + 1)
        self.on_mesh = (nodes >= 0) & (nodes < n)
        self.nodes = np.clip(nodes, 0, n - 1)
        by_q = np.where(self.on_mesh, q_index(self.nodes), -1)
        by_w = np.where(self.on_mesh, w_index(self.nodes), -1)
        approach = np.full((p.local, 1), -1)
        for end in p.deflection.ends:
            approach[end - p.first] = n_dofs(n)
        self.columns = np.hstack([by_q, by_w, approach]).astype(np.int32)

    def fill(self, state: NodeState, derivatives: np.ndarray) -> None:
        """Assemble the matrix at a state of the whole mesh, which every rank passes."""
        p, d, near_field = self.problem, self.problem.deflection, self.near_field
        by_pressure = np.tile(-d.curvature[np.abs(np.arange(-near_field, near_field + 1))], (p.local, 1))
        by_separation = np.zeros_like(by_pressure)
        second_difference = d.curvature_coefficient * np.array(SECOND_DIFFERENCE)
        by_separation[:, near_field - 1 : near_field + 2] = second_difference
        for end in d.ends:
            row = end - p.first
            by_pressure[row], by_separation[row] = d.end_row(end)[self.nodes[row]], 0.0
            by_separation[row, near_field] = d.end_row_coefficient
        by_q = by_pressure * state.p_q[self.nodes] + by_separation * state.separation_q[self.nodes]
        owned = slice(p.first, p.last)
        by_q[:, near_field] += pivot_regularisation(state.p_q[owned], state.separation_q[owned])
        by_w = by_pressure * state.p_w[self.nodes] + by_separation * state.separation_w[self.nodes]
        approach = np.full((p.local, 1), -d.end_row_coefficient)
        nodes = np.arange(p.first, p.last, dtype=np.int32)
        set_rows(self.matrix, q_index(nodes), self.columns, np.hstack([by_q, by_w, approach]))
        columns = reynolds_columns(p.first, p.last, p.n)
        set_rows(self.matrix, w_index(nodes), columns, self._by_unknowns(state, derivatives))
        if p.owns_border:
            row, weight = np.zeros(n_dofs(p.n) + 1), p.dx * p.balance.by_forces
            q_of(row, p.n)[:], w_of(row, p.n)[:] = weight * state.p_q, weight * state.p_w
            row[-1:] = p.balance.by_border  # stored also where it is zero, as LU needs it
            self.matrix.setValues([n_dofs(p.n)], np.arange(len(row), dtype=np.int32), row)
        self.matrix.assemble()

    def _by_unknowns(self, state: NodeState, derivatives: np.ndarray) -> np.ndarray:
        """Derivatives of the Reynolds rows with respect to q and w."""
        p, values = self.problem, derivatives.copy()
        nodes = np.arange(p.first, p.last)[:, None] + np.arange(-2, ALONG - 2)
        nodes = np.clip(nodes, 0, p.n - 1)
        by_unknown, by_film = q_columns(derivatives), w_columns(derivatives)
        w_columns(values)[:] = by_film * state.h_w[nodes]
        if state.plastic is not None:
            q_columns(values)[:] = by_unknown * state.plastic.reynolds_q[nodes]
            w_columns(values)[:] += by_unknown * state.plastic.reynolds_w[nodes]
        return values


def reynolds_columns(first: int, last: int, n: int) -> np.ndarray:
    """Indices of the unknowns of the Reynolds rows first .. last-1 of n; -1: no unknown, shape (rows, 8)."""
    rows = np.arange(first, last)[:, None]
    node = rows + np.arange(-2, ALONG - 2)
    columns = dofs_of(node)
    columns[(node < 0) | (node >= n) | ((rows == 0) & (node != 0))] = -1
    return columns.reshape(len(node), -1).astype(np.int32)


def set_rows(matrix: PETSc.Mat, rows: np.ndarray, columns: np.ndarray, values: np.ndarray) -> None:
    """Insert rows of equal width; PETSc ignores negative columns."""
    for_row = np.arange(len(rows) + 1, dtype=np.int32) * columns.shape[1]
    matrix.setValuesIJV(for_row, columns.ravel(), np.ascontiguousarray(values).ravel(), rowmap=rows)


@compiled
def jacobian_product(state: tuple, work: tuple, halo: tuple, v: np.ndarray, out: np.ndarray) -> None:
    """Fill in the local rows of the product with a vector, zero in inactive rows; collective.

    `state`: :meth:`.contact.node_state.NodeState.derivatives`, shape (4, 2, window); derivatives of the
        Reynolds rows, (local nodes, 8); local nodes whose second unknown is not in the system; constants of
        :func:`.deflection.deflection_rows`.
    `work`: work arrays: changes of pressure (local nodes,); of Reynolds unknown and film (window, 2); of the
        separation (window,).
    `halo`: a `ranks.Halo` as a plain tuple.
    """
    (by, derivatives, inactive_nodes, form), (pressure, change, separation) = state, work
    local = 2 * len(derivatives)
    directional_derivative(by[0], v[:local].reshape(len(pressure), 2), form[0], pressure)
    nodes, border, curvature, load = exchange_unknowns(*halo, (v, pressure, False))
    for k in range(2):
        directional_derivative(by[k + 1], nodes, ZERO, change[:, k])
    directional_derivative(by[3], nodes, ZERO, separation)
    deflection_rows(separation, border[0], curvature, load, form, out[0:local:2])
    reynolds_product(derivatives, change, 0, form[0], out[1:local:2])
    if len(out) > local:
        out[local] = load[2]  # the border of a line is the balance of the load
    for i in inactive_nodes:
        out[2 * i + 1] = 0.0
