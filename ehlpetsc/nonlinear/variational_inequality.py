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
from petsc4py import PETSc

from ehlpetsc.compiled import compiled
from ehlpetsc.discretisation.contact_model import Relations, full_of_oil
from ehlpetsc.discretisation.interleaving import count, firsts, seconds
from ehlpetsc.errors import UsageError
from ehlpetsc.nonlinear import step_limits
from ehlpetsc.nonlinear.exchange import largest
from ehlpetsc.nonlinear.newton import OPENED, NewtonSolver
from ehlpetsc.nonlinear.operators.three_field_operator import (
    UNKNOWNS,
    ThreeFieldOperator,
    put_rows,
    three,
    triples,
)
from ehlpetsc.nonlinear.preconditioner import FarFieldBand
from ehlpetsc.nonlinear.preconditioner.far_field_band import Factors


class VariationalInequalitySolver(NewtonSolver):
    """Newton's method with active sets on three unknowns a node; speaks in those of the contact model."""

    unknowns = UNKNOWNS

    def _create_vectors(self, _):
        super()._create_vectors(three)

    def _create_bounds(self):
        self.lower, self.upper = self.x.duplicate(), self.x.duplicate()
        self.lower.set(PETSc.NINFINITY)
        self.upper.set(PETSc.INFINITY)
        triples(self.lower.array, self.local)[:, 2] = 0.0

    def _create_matrices(self):
        sizes, pc = (self.x.getSizes(),) * 2, self.snes.ksp.pc
        if not (pc.getType() == "python" and isinstance(pc.getPythonContext(), FarFieldBand)):
            self.snes.destroy()
            raise UsageError(
                "-snes_type vinewtonrsls in mixed contact has the preconditioner of this program alone; "
                "leave -pc_type out"
            )
        self.factors, self.assembled = Factors(self.problem, self.comm.tompi4py()), None
        self.jacobian = ThreeFieldOperator(self.problem, self.exchange, self.factors)
        self.operator = PETSc.Mat().createPython(sizes, self.jacobian, comm=self.comm)
        self.operator.setUp()
        self.preconditioned = self.operator

    def gather(self, v):
        """The whole solution in the unknowns of the contact model."""
        self.to_all.scatter(v, self.all, mode=PETSc.ScatterMode.FORWARD)
        whole = self.all.array_r
        q, h, p_c = triples(whole, self.n).T.copy()
        return q, self.model.second_unknown(h, p_c), whole[three(self.n)]

    def scatter(self, q, w, h00):
        """Fill the local part of the unknowns from those of the contact model."""
        mine, rows = slice(self.first, self.first + self.local), triples(self.x.array, self.local)
        rows[:, 0], rows[:, 1] = q[mine], self.model.relations(q, w).film[mine]
        rows[:, 2] = self.model.contact_pressure(w)[mine]
        if self.problem.load_is_local:
            self.x.array[-1] = h00

    def residual(self):
        """Rows of the last solution in the unknowns of the contact model, as of `NewtonSolver`."""
        rows = self._evaluation(self.x).residual
        parts = firsts(rows, self.local).copy(), seconds(rows, self.local).copy(), rows[count(self.local) :]
        deflection, imbalance, load = zip(*self.comm.tompi4py().allgather(parts), strict=True)
        return np.concatenate(deflection), np.concatenate(imbalance), float(np.concatenate(load)[0])

    def _evaluate(self, vector):
        nodes, h00, outside = self.exchange(vector, self._pressure)
        q, h, p_c = np.ascontiguousarray(nodes.T)
        none, one, touching = np.zeros_like(q), np.ones_like(q), p_c > 0.0
        pressure = np.maximum(q, 0.0) + p_c
        relations = Relations(q, pressure, h, full_of_oil(q) * 1.0, none, one, touching)
        return self.problem.rows_of(relations, h00, self.inputs, outside)

    def _pressure(self, nodes):
        return np.maximum(nodes[:, 0], 0.0) + nodes[:, 2]

    def _function(self, snes, x, f):
        evaluation, p = self._evaluation(x) if self.begins else self._evaluated(x), self.problem
        self.begins = False
        film = evaluation.relations.film[p.own]
        put_rows(f.array, p, evaluation.residual, (film - self.model.boundary_film) / p.film_scale)

    def _limit_step(self, x, y):
        if self.watch:
            self.watch()
        now, step = triples(x.array_r, self.local), triples(y.array, self.local)
        change = largest(self.exchange.ranks, largest_change(now, step))
        if change > step_limits.STEP_LIMIT:
            y.scale(step_limits.STEP_LIMIT / change)
        cross_gently(now, step, self.model.boundary_film, OPENED * self.problem.film_scale)
        return True


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
