"""The Jacobian of mixed contact on three unknowns a node (q, h, p_c), whole and as SNESVI restricts it."""

import numpy as np

from ehlpetsc.discretisation.interleaving import count, firsts, seconds
from ehlpetsc.nonlinear import events
from ehlpetsc.nonlinear.operators.jacobian_operator import BandSystem
from ehlpetsc.nonlinear.operators.python_matrix import Restrictable

UNKNOWNS = 3  # of a node


def three(nodes):
    """Unknowns of so many nodes, h00 left out."""
    return UNKNOWNS * nodes


def triples(vector, nodes):
    """View of the unknowns, or rows, of so many nodes, shape (nodes, 3)."""
    return vector[: three(nodes)].reshape(nodes, UNKNOWNS)


class ThreeFieldOperator(Restrictable):
    """The whole Jacobian; context of PETSc's Python matrix.

    Parameters
    ----------
    problem : ehl_problem.EHLProblem
    exchange : nonlinear.exchange.Exchange
    factors : preconditioner.far_field_band.Factors
    """

    def __init__(self, problem, exchange, factors):
        super().__init__(RestrictedThreeFields)
        self.problem, self.exchange, self.factors = problem, exchange, factors

    def linearise(self, evaluation):
        """Take the derivatives of a state."""
        self.relations, self.derivatives = evaluation.relations, evaluation.reynolds_derivatives

    def rows(self, v):
        """Deflection, Reynolds and load of changes of the local unknowns, and the window's films."""
        nodes, h00, outside = self.exchange(v, self._pressure)
        q, h, p_c = np.ascontiguousarray(nodes.T)
        changes = q, self.relations.p_q * q + p_c, h, h
        return self.problem.changes_of_rows(changes, self.derivatives, h00, outside), h

    def _pressure(self, nodes):
        return self.relations.p_q[self.problem.own] * nodes[:, 0] + nodes[:, 2]

    def mult(self, mat, v, out):
        """PETSc's product."""
        p = self.problem
        with events.PRODUCT:
            rows, film = self.rows(v.array_r)
            put_rows(out.array, p, rows, film[p.own] / p.film_scale)


def put_rows(out, problem, pairs, gap):
    """Fill in local rows from the pairs (deflection, Reynolds) with the load's, and the gap's."""
    local = problem.local
    rows = triples(out, local)
    rows[:, 0], rows[:, 1], rows[:, 2] = firsts(pairs, local), seconds(pairs, local), gap
    if problem.load_is_local:
        out[-1] = pairs[-1]


class RestrictedThreeFields(BandSystem):
    """The Jacobian where p_c and its row are left out of the nodes whose solids do not carry.

    The preconditioner's band has two unknowns a node. Where solids carry, the row of the gap alone gives the
    change of the film; what that does to the other rows goes to their right-hand sides, and p_c takes the
    film's place.
    """

    def __init__(self, whole, rows, mat):
        self.whole, self.problem, self.factors = whole, whole.problem, whole.factors
        p, local = self.problem, self.problem.local
        self.places = rows.indices - mat.getOwnershipRange()[0]
        inner = self.places[: len(self.places) - p.load_is_local]
        self.solid = inner[inner % UNKNOWNS == 2] // UNKNOWNS
        self.kept, self.dropped = np.arange(count(local)), np.arange(0)
        self.full, self.product = mat.createVecs()
        self.comm = mat.comm.tompi4py()
        mine = np.zeros(len(self.full.array_r))
        triples(mine, local)[self.solid, 2] = 1.0
        nodes, _, _ = whole.exchange(mine, lambda nodes: nodes[:, 2])
        self.touching = nodes[:, 2] > 0.0

    @property
    def relations(self):
        """As of the semismooth system with these nodes in contact."""
        r, model = self.whole.relations, self.problem.model
        p_w, h_w = np.where(self.touching, -model.stiffness, 0.0), np.where(self.touching, 0.0, 1.0)
        return r._replace(p_w=p_w, h_w=h_w, touching=self.touching)

    @property
    def reynolds_derivatives(self):
        return self.whole.derivatives

    def mult(self, mat, v, out):
        """PETSc's product."""
        self.full.set(0.0)
        self.full.array[self.places] = v.array_r
        self.whole.mult(None, self.full, self.product)
        out.array[:] = self.product.array_r[self.places]

    def rows_for_band(self, b):
        p = self.problem
        self.full.set(0.0)
        self.full.array[self.places] = b
        rows = triples(self.full.array, p.local)
        self.film = np.zeros(p.local)
        self.film[self.solid] = p.film_scale * rows[self.solid, 2]
        pairs, load = rows[:, :2].reshape(-1).copy(), self.full.array[three(p.local) :].copy()
        if self.comm.allreduce(bool(self.film.any()), max):
            films = np.zeros(len(self.full.array_r))
            triples(films, p.local)[:, 1] = self.film
            pairs -= self.whole.rows(films)[0][: count(p.local)]
        return pairs, load

    def take_from_band(self, solution, approach, out):
        p, q, w = self.problem, solution[::2], solution[1::2]
        rows = triples(self.full.array, p.local)
        rows[:, 0], rows[:, 1] = q, w
        rows[self.solid, 1] = self.film[self.solid]
        rows[self.solid, 2] = -p.model.stiffness * w[self.solid]
        self.full.array[three(p.local) :] = approach
        out[:] = self.full.array[self.places]
