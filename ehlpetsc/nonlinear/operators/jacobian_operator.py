"""The Jacobian as PETSc's matrices: matrix-free with the exact deflection, and its near field assembled.

The Krylov method multiplies by the whole Jacobian (:class:`JacobianOperator`, a Python matrix); the
default preconditioner takes what it needs from that operator, by ``pc.getOperators()``. Other preconditioners
(``-pc_type lu`` ...) get :class:`NearFieldMatrix`.
"""

import numpy as np

from ehlpetsc.discretisation.deflection import SECOND_DIFFERENCE
from ehlpetsc.discretisation.finite_volumes import STENCIL
from ehlpetsc.discretisation.interleaving import (
    count,
    first_of,
    firsts,
    firsts_of_rows,
    nodes_of_seconds,
    second_of,
    seconds,
    seconds_of_rows,
)
from ehlpetsc.nonlinear import events
from ehlpetsc.nonlinear.operators.python_matrix import Restrictable

LEAK = 1e-3  # of dp/dq at cavitated nodes, in preconditioners alone: a pivot that is never zero


def leaks(*derivatives):
    """What preconditioners add to the diagonal of the deflection rows: where they do not know q, a little.

    Parameters
    ----------
    derivatives : ndarray
        Of all that the rows have of q at their own node.
    """
    known = np.any([d != 0.0 for d in derivatives], axis=0)
    return np.where(known, 0.0, LEAK)


class BandSystem:
    """What the default preconditioner asks of an operator on some of the pairs (q, w), h00 last.

    Attributes
    ----------
    kept : ndarray of int
        Local places, of the pairs alone, that are in the system.
    dropped : ndarray of int
        Local nodes whose second unknown is not.
    """

    def rows_for_band(self, b):
        """A right-hand side as the rows of `kept` and the load's, which the last rank has."""
        return b[: len(self.kept)], b[len(self.kept) :]

    def take_from_band(self, solution, approach, out):
        """Fill in the unknowns from the local pairs and h00."""
        count = len(self.kept)
        out[:count] = solution if count == len(solution) else solution[self.kept]
        out[count:] = approach  # on the last rank


class JacobianOperator(BandSystem, Restrictable):
    """Context of PETSc's Python matrix.

    Parameters
    ----------
    problem : ehl_problem.EHLProblem
    exchange : halo_exchange.HaloExchange
    factors : object
        Keeps the default preconditioner's factors between solves, see :mod:`.preconditioner`.

    Attributes
    ----------
    model, state, reynolds_derivatives
        Of the linearisation, as in `ehl_problem.Evaluation`.
    """

    def __init__(self, problem, exchange, factors):
        super().__init__(RestrictedOperator)
        self.problem, self.exchange, self.factors = problem, exchange, factors
        self.kept = np.arange(count(problem.local))
        self.dropped = np.arange(0)

    def linearise(self, evaluation):
        """Take the derivatives of a state."""
        self.model, self.reynolds_derivatives = evaluation.model, evaluation.reynolds_derivatives
        self.state = self.model.linearised(evaluation.state, self.problem.own, self._ranks_sum)

    def _ranks_sum(self, numbers):
        return np.sum(self.exchange.ranks.allgather(numbers), axis=0)

    def times(self, v):
        """Product with the local part of a vector, of all ranks together."""
        problem, state = self.problem, self.state
        nodes, h00, sums = self.exchange(v, lambda nodes: state.pressure_derivative(nodes, problem.own))
        return problem.jacobian_vector_product(state, self.reynolds_derivatives, nodes, h00, sums)

    def mult(self, mat, v, out):
        """PETSc's product."""
        with events.PRODUCT:
            out.array[:] = self.times(v.array_r)


class RestrictedOperator(BandSystem):
    """The Jacobian of the unknowns that SNESVI has kept; context of a Python matrix."""

    def __init__(self, whole, rows, mat):
        self.whole, self.problem, self.factors = whole, whole.problem, whole.factors
        local, load = self.problem.local, self.problem.load_is_local
        self.places = rows.indices - mat.getOwnershipRange()[0]
        self.kept = self.places[: len(self.places) - load]
        self.size = count(local) + load
        self.dropped = whole.dropped
        if len(self.places) < self.size:
            seconds_kept = np.zeros(local, dtype=bool)
            seconds_kept[nodes_of_seconds(self.kept)] = True
            self.dropped = np.flatnonzero(~seconds_kept)

    @property
    def model(self):
        return self.whole.model

    @property
    def state(self):
        return self.whole.state

    @property
    def reynolds_derivatives(self):
        return self.whole.reynolds_derivatives

    def mult(self, mat, v, out):
        """PETSc's product."""
        with events.PRODUCT:
            if len(self.places) == self.size:
                out.array[:] = self.whole.times(v.array_r)
                return
            full = np.zeros(self.size)
            full[self.places] = v.array_r
            out.array[:] = self.whole.times(full)[self.places]


class NearFieldMatrix:
    """The Jacobian with the deflection of `near` nodes on either side, in an AIJ matrix.

    Parameters
    ----------
    problem : ehl_problem.EHLProblem
    near : int
    matrix : petsc4py.PETSc.Mat
        AIJ, created with its sizes.
    """

    def __init__(self, problem, near, matrix):
        self.problem, self.matrix, self.near = problem, matrix, min(near, problem.n - 1)
        self._deflection_columns()
        rows, columns = self._pattern()
        matrix.setPreallocationCSR((rows, columns, np.zeros(len(columns))))
        matrix.setOption(matrix.Option.NEW_NONZERO_LOCATION_ERR, True)
        matrix.setOption(matrix.Option.NO_OFF_PROC_ENTRIES, True)  # nothing to exchange at assembly

    def _deflection_columns(self):
        """Columns of the local deflection rows; -1: no entry."""
        p, n = self.problem, self.problem.n
        nodes = np.arange(p.first, p.last)[:, None] + np.arange(-self.near, self.near + 1)
        self.there = (nodes >= 0) & (nodes < n)
        self.nodes = np.clip(nodes, 0, n - 1)
        by_q = np.where(self.there, first_of(self.nodes), -1)
        by_w = np.where(self.there, second_of(self.nodes), -1)
        approach = np.full((p.local, 1), -1)
        for end in p.deflection.ends:
            approach[end - p.first] = count(n)
        self.columns = np.hstack([by_q, by_w, approach]).astype(np.int32)

    def _pattern(self):
        p, rows = self.problem, []
        for deflection, reynolds in zip(self.columns, p.reynolds_columns, strict=True):
            rows += [deflection[deflection >= 0], reynolds[reynolds >= 0]]
        if p.load_is_local:
            rows.append(np.arange(count(p.n) + 1))
        return np.cumsum([0] + [len(r) for r in rows]).astype(np.int32), np.concatenate(rows).astype(np.int32)

    def fill(self, state, derivatives):
        """Assemble the matrix of a state, which is that of the whole mesh, on every rank."""
        p, d, near = self.problem, self.problem.deflection, self.near
        kernel = np.tile(-d.curvature[np.abs(np.arange(-near, near + 1))], (p.local, 1))
        bend = np.zeros_like(kernel)
        bend[:, near - 1 : near + 2] = d.curvature_coefficient * np.array(SECOND_DIFFERENCE)
        for end in d.ends:
            row = end - p.first
            kernel[row], bend[row] = d.end_row(end)[self.nodes[row]], 0.0
            bend[row, near] = d.end_row_coefficient
        by_q = kernel * state.p_q[self.nodes] + bend * state.separation_q[self.nodes]
        own = slice(p.first, p.last)
        by_q[:, near] += leaks(state.p_q[own], state.separation_q[own])
        by_w = kernel * state.p_w[self.nodes] + bend * state.separation_w[self.nodes]
        approach = np.full((p.local, 1), -d.end_row_coefficient)
        nodes = np.arange(p.first, p.last, dtype=np.int32)
        set_rows(self.matrix, first_of(nodes), self.columns, np.hstack([by_q, by_w, approach]))
        set_rows(self.matrix, second_of(nodes), p.reynolds_columns, self._by_unknowns(state, derivatives))
        if p.load_is_local:
            load = np.zeros(count(p.n))
            firsts(load, p.n)[:], seconds(load, p.n)[:] = p.dx * state.p_q, p.dx * state.p_w
            self.matrix.setValues([count(p.n)], np.arange(count(p.n), dtype=np.int32), load)
        self.matrix.assemble()

    def _by_unknowns(self, state, derivatives):
        """Reynolds' rows by q and w."""
        p, values = self.problem, derivatives.copy()
        nodes = np.arange(p.first, p.last)[:, None] + np.arange(-2, STENCIL - 2)
        nodes = np.clip(nodes, 0, p.n - 1)
        by_unknown, by_film = firsts_of_rows(derivatives), seconds_of_rows(derivatives)
        seconds_of_rows(values)[:] = by_film * state.h_w[nodes]
        if state.plastic is not None:
            firsts_of_rows(values)[:] = by_unknown * state.plastic.reynolds_q[nodes]
            seconds_of_rows(values)[:] += by_unknown * state.plastic.reynolds_w[nodes]
        return values


def set_rows(matrix, rows, columns, values):
    """Insert a block of rows of equal width; negative columns are left out by PETSc."""
    for_row = np.arange(len(rows) + 1, dtype=np.int32) * columns.shape[1]
    matrix.setValuesIJV(for_row, columns.ravel(), np.ascontiguousarray(values).ravel(), rowmap=rows)
