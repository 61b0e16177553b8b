r"""The paper's own iteration: sweeps over the nodes that update each pair (p, h) by a 2 x 2 block.

At every node the Reynolds and the deflection equation are put in the form (Holmes et al. 2005, eq. (8), (9))

.. math:: A_0p_0+B_0h_0=R,\qquad C_0p_0+D_0h_0=E,

R and E with the newest values of all other nodes, and solved for the pair (eq. (10)); where h comes out
below its bound, it is put there and p follows from the deflection equation alone (eq. (11)). Nothing is
assumed about which nodes touch.

Residual and coefficients are those of :class:`ehlpetsc.discretisation.ehl_problem.EHLProblem`. A and
B are derivatives of the Reynolds rows at the state before the last sweeps, so that sweeps solve what
Newton's method linearises; C and D are exact. Between two evaluations of A and B

* pressures further away than `NEAR_FIELD_NODES` act on E by FFT with their values of the last evaluation;
* h00 moves with the load that is missing, by a part of what Hertz' contact would need;
* where the gap is open, wider than `OPEN` expected films and under less than `LOW` p0, h is put to the whole
  integral of p, as it is at the two ends in any case. Second differences alone tell a change of h00 or of a
  distant pressure from node to node, which takes the square of their number in sweeps. In the open
  gap pressures hardly answer to the film, so that this is safe; in the film, or in valleys between
  asperities, it is not.

A node that changes between oil and cavity stops at the change, where its derivatives jump, until the next
evaluation. Over-relaxation takes the sweeps to a half in the film and to less in the open gap, where
pressures obey Poisson's equation. What the flow carries from node to node bears none, for each node would
amplify it: void in cavities, and films in a steady contact. In a time step the storage of oil damps it.

The order of the nodes is the paper's, one after the other with the flow. That is no work for array
operations; the loops are compiled. Ranks do not share a sweep: each does the whole of it.
"""

import numpy as np

from ehlpetsc.discretisation import elasticity
from ehlpetsc.discretisation.ehl_problem import EHLProblem
from ehlpetsc.discretisation.interleaving import q_of, w_of
from ehlpetsc.errors import SolveFailed
from ehlpetsc.nonlinear.sweeps import DeflectionForm, Linearised, sweep

# half widths: between two evaluations of the coefficients as many sweeps as there are nodes in it
REACH, STEADY_REACH = 0.6, 4.0
EVALUATIONS = 400  # before a solve is given up
NEAR_FIELD_NODES = 100  # nodes on either side whose pressures act at once
OPEN, LOW = 3.0, 0.1  # gaps wider than so many expected films, at pressures below this in p0, are open
IN_OPEN_GAP, IN_FILM = 1.85, 1.3  # over-relaxation there, and in the film of a time step
APPROACH = 0.2  # of the change of h00 that the missing load asks for
STIFFNESS = np.pi / np.log(2.0)  # -dW/dh00 of Hertz' contact at W = pi/2, both dimensionless


class GaussSeidelSolver:
    """Solver of one scene by sweeps, with the interface of :class:`ehlpetsc.nonlinear.newton.NewtonSolver`.

    Parameters
    ----------
    case, scales, film_scale
        As in :class:`ehlpetsc.discretisation.ehl_problem.EHLProblem`.
    tolerance : float
        Of the residual, as ``-snes_atol``.

    Attributes
    ----------
    sweeps : int
        Of all solves so far.
    """

    def __init__(self, case, scales, film_scale, tolerance):
        self.problem = EHLProblem(case, scales, film_scale, 0, scales.nx)
        self.bound, self.deflection = self.problem.model.lower_bound, self.problem.deflection
        self.tolerance = tolerance
        curvature, near = self.deflection.curvature, min(NEAR_FIELD_NODES, scales.nx - 1)
        self.kernel = np.concatenate([curvature[near:0:-1], curvature[: near + 1]])
        distant = curvature.copy()
        distant[: near + 1] = 0.0
        self.distant = elasticity.SymmetricToeplitz(distant)
        self.sweeps = 0

    def start_iterations(self, needed=None):
        """Evaluations that a steady start may take."""
        return needed or EVALUATIONS

    def residual(self):
        """Rows of the last solution: deflection and Reynolds at every node, shape (nx,), and the load's."""
        return self.rows

    def solve(self, q, h, h00, inputs, max_it=None, watch=None):
        """Solve from a first guess.

        Parameters
        ----------
        q, h : ndarray, shape (nx,)
        h00 : float
        inputs : ehl_problem.StepInputs
        max_it : int, optional
            Limit of evaluations in place of the usual one.
        watch : callable, optional
            Called before every evaluation; an exception that it raises ends the solve.

        Returns
        -------
        q, h : ndarray, shape (nx,)
        h00 : float
        iterations : int
            Evaluations of the coefficients.

        Raises
        ------
        SolveFailed
        """
        q, h = q.copy(), np.maximum(h, self.bound)
        most = max_it or EVALUATIONS
        for iteration in range(most):
            if watch:
                watch()
            p = np.maximum(q, 0.0)
            h00, still_open = self._correct(p, h, h00, inputs.phi)
            norm = self._evaluate(q, h, h00, inputs)
            if norm < self.tolerance:
                return q, h, h00, iteration
            if not np.isfinite(norm):
                raise SolveFailed("sweeps", "NOT_FINITE", iteration)
            self._sweep(q, h, p, still_open, inputs)
        raise SolveFailed("sweeps", "MAX_IT", most)

    def _correct(self, p, h, h00, phi):
        """Balance the load by h00; put h of the open gap and the ends to the whole integral, in place."""
        h00 += APPROACH / STIFFNESS * (self.problem.dx * p.sum() - 0.5 * np.pi)
        gap_is_open = (h > OPEN * self.problem.film_scale) & (p < LOW)
        gap_is_open[[0, -1]] = True
        h[gap_is_open] = np.maximum(self.problem.film(p, h00, phi)[gap_is_open], self.bound)
        return h00, gap_is_open

    def _evaluate(self, q, h, h00, inputs):
        """Residual and coefficients at a state; the norm of what is not complementary."""
        with np.errstate(over="ignore", invalid="ignore"):
            evaluation = self.problem.evaluate(q, h, h00, inputs)
            rows, self.derivatives = evaluation.residual, evaluation.reynolds_derivatives
            reynolds = w_of(rows, self.problem.n)
            self.rows = q_of(rows, self.problem.n).copy(), reynolds.copy(), rows[-1]
            reynolds[(h <= self.bound) & (reynolds > 0.0)] = 0.0
            return np.linalg.norm(rows)

    def _sweep(self, q, h, p, gap_is_open, inputs):
        problem, steady, stretch = self.problem, inputs.history is None, self.deflection.curvature_coefficient
        sweeps = max(1, round((STEADY_REACH if steady else REACH) / problem.dx))
        shape = 0.5 * problem.x**2 + inputs.phi
        bend = self.distant(p)
        bend[1:-1] += stretch * (shape[:-2] - 2.0 * shape[1:-1] + shape[2:])
        relaxation = np.where(gap_is_open, IN_OPEN_GAP, 1.0 if steady else IN_FILM)
        relaxation[q <= 0.0] = 1.0
        then = Linearised(q.copy(), h.copy(), self.rows[1], self.derivatives)
        deflection = DeflectionForm(-bend, self.kernel, stretch)
        q[0] -= self.rows[1][0] / self.derivatives[0, 4]
        p[0] = max(q[0], 0.0)
        for _ in range(sweeps):
            sweep(q, h, p, then, deflection, self.bound, relaxation)
        self.sweeps += sweeps
