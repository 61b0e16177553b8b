r"""Mixed contact as a variational inequality: ``-snes_type vinewtonrsls``.

The solids' pressure is a third unknown of each node, bounded below, and the film over the boundary film its
row,

.. math:: p_c\ge0,\quad h-h_b\ge0,\quad p_c(h-h_b)=0;

SNESVI drops both wherever solids do not carry. Deflection and Reynolds' equation are those of
:mod:`ehlpetsc.discretisation.ehl_problem`, the answers those of the semismooth system (``newtonls``), whose
two unknowns a node carry the complementarity in their sign, to Newton's tolerance.

Unknowns (q_0, h_0, p_c0, q_1, ..., h00), rows (deflection, Reynolds, gap) in the same places.
"""

import numpy as np

from ehlpetsc.compiled import compiled
from ehlpetsc.discretisation.contact_model import Relations, full_of_oil
from ehlpetsc.discretisation.interleaving import count, firsts, seconds
from ehlpetsc.errors import UsageError
from ehlpetsc.nonlinear.operators.three_field_operator import UNKNOWNS, ThreeFieldOperator, put_rows, triples
from ehlpetsc.nonlinear.systems import step_limits
from ehlpetsc.nonlinear.systems.two_fields import OPENED, TwoFields


class ThreeFields(TwoFields):
    """Triples (q, h, p_c) at every node; guess, solution and residual are in the contact model's pairs."""

    unknowns = UNKNOWNS

    def _put_bounds(self, lower):
        triples(lower, self.local)[:, 2] = 0.0

    def create_matrices(self, with_band):
        """As of `TwoFields`.

        Raises
        ------
        UsageError
            The user asks for another preconditioner.
        """
        if not with_band:
            raise UsageError(
                "-snes_type vinewtonrsls in mixed contact has the preconditioner of this program alone; "
                "leave -pc_type out"
            )
        super().create_matrices(with_band)

    def _jacobian(self):
        return ThreeFieldOperator(self.problem, self.exchange, self.factors)

    def _put_unknowns(self, x, q, w):
        rows = triples(x, self.local)
        rows[:, 0], rows[:, 1] = q, self.model.relations(q, w).film
        rows[:, 2] = self.model.contact_pressure(w)

    def solution(self):
        """As of `TwoFields`, in the unknowns of the contact model."""
        whole = self._whole(self.x)
        q, h, p_c = triples(whole, self.n).T.copy()
        return q, self.model.second_unknown(h, p_c), whole[-1]

    def residual(self):
        """As of `TwoFields`; the gap's rows are left out."""
        rows = self.evaluation(self.x).residual
        parts = firsts(rows, self.local).copy(), seconds(rows, self.local).copy(), rows[count(self.local) :]
        deflection, imbalance, load = zip(*self.comm.tompi4py().allgather(parts), strict=True)
        return np.concatenate(deflection), np.concatenate(imbalance), float(np.concatenate(load)[0])

    def put_rows(self, evaluation, out):
        """As of `TwoFields`, the film over the boundary film beside them."""
        p = self.problem
        film = evaluation.relations.film[p.own]
        put_rows(out, p, evaluation.residual, (film - self.model.boundary_film) / p.film_scale)

    def _evaluated(self, nodes, h00, outside):
        q, h, p_c = np.ascontiguousarray(nodes.T)
        none, one, touching = np.zeros_like(q), np.ones_like(q), p_c > 0.0
        pressure = np.maximum(q, 0.0) + p_c
        relations = Relations(q, pressure, h, full_of_oil(q) * 1.0, none, one, touching)
        return self.problem.rows_of(relations, h00, self.inputs, outside)

    def _pressure(self, nodes):
        return np.maximum(nodes[:, 0], 0.0) + nodes[:, 2]

    def limit_step(self, x, y):
        """As of `TwoFields`."""
        now = triples(x.array_r, self.local)
        self._shorten(largest_change(now, triples(y.array, self.local)), y)
        opened = OPENED * self.problem.film_scale
        cross_gently(now, triples(y.array, self.local), self.model.boundary_film, opened)


@compiled
def largest_change(now, step):
    """Largest change of total pressure; solids that do not carry yet do not count."""
    largest = 0.0
    for i in range(len(now)):
        q, p_c = now[i, 0], now[i, 2]
        solids = max(p_c - step[i, 2], 0.0) - p_c if p_c > 0.0 else 0.0
        largest = max(largest, abs(max(q - step[i, 0], 0.0) - max(q, 0.0) + solids))
    return largest


@compiled
def cross_gently(now, step, boundary_film, opened):
    """Change steps in place where solids come to touch or part, cavities fill or empty.

    Solids that touch have the boundary film between them and next to no pressure; those that part get
    the film `opened` over it, which tells SNESVI that they do not carry.
    """
    for i in range(len(now)):
        q, dq, h, p_c = now[i, 0], step[i, 0], now[i, 1], now[i, 2]
        if q < 0.0 and q - dq > step_limits.REFILLED:
            step[i, 0] = q - step_limits.REFILLED
        elif q - dq < 0.0:
            step[i, 0] = min(dq, q + 1.0 - step_limits.OIL_KEPT * (1.0 + min(q, 0.0)))
        if p_c > 0.0 and p_c - step[i, 2] <= 0.0:
            step[i, 2], step[i, 1] = p_c, h - boundary_film - opened
        elif p_c > 0.0 or h - step[i, 1] <= boundary_film:
            step[i, 1] = h - boundary_film
            if p_c <= 0.0:
                step[i, 2] = p_c - step_limits.REFILLED
