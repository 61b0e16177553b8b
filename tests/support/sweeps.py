r"""The paper's own iteration, a referee of Newton's method: sweeps that update pair by pair (p, h).

At every node the Reynolds and the deflection equation are put in the form (Holmes et al. 2005, eq. (8), (9))

.. math:: A_0p_0+B_0h_0=R,\qquad C_0p_0+D_0h_0=E,

R and E with the newest values of all other nodes, and solved for the pair (eq. (10)); where h is below its
bound, it is set to the bound and p follows from the deflection equation alone (eq. (11)). The contact nodes
need not be known in advance.

Residual and coefficients are those of :class:`ehlpetsc.discretisation.ehl_problem.EHLProblem`. A and
B are derivatives of the Reynolds rows at the state before the last sweeps, so that sweeps solve the linear
system of Newton's method; C and D are exact. Between two evaluations of A and B

* pressures further away than `NEAR_FIELD_NODES` act on E by FFT with their values of the last evaluation;
* the border changes with the load error, by `APPROACH_RELAXATION` times what Hertz' contact would need;
* in the open gap, wider than `OPEN_GAP_FILM_RATIO` expected films and below `OPEN_GAP_PRESSURE`, h is set to
  the integral of p, as at the two ends of the mesh. By second differences alone, a change of the border or
  of a distant pressure would need as many sweeps as the square of the number of nodes. There pressures
  hardly depend on the film, so that this is stable; in the film, or in valleys between asperities, it is not.

A node that changes between oil and cavity stops at the change, where its derivatives jump, until the next
evaluation. Over-relaxation halves the number of sweeps in the film and reduces it further in the open gap,
where pressures obey Poisson's equation. Advected quantities are not over-relaxed, because each node would
amplify them: void in cavities, and films in a steady contact. In a time step the storage of oil damps them.

The nodes are visited in the direction of flow, as in the paper, in compiled loops. Sweeps are not
distributed: every rank computes all nodes.
"""

from __future__ import annotations

from unittest import mock

import numpy as np

from ehlpetsc.base.case import Case
from ehlpetsc.base.compiled import compiled
from ehlpetsc.base.errors import SolveFailed
from ehlpetsc.discretisation.contact.node_state import MIN_OIL_FRACTION, PRESSURE_AFTER_REFILL
from ehlpetsc.discretisation.line.deflection import SymmetricToeplitz
from ehlpetsc.discretisation.step_inputs import StepInputs, Watch
from ehlpetsc.discretisation.unknowns import Rows, Unknowns, border_of, q_of, w_of
from ehlpetsc.nonlinear.line.system import line_problem
from ehlpetsc.nonlinear.step_limit import STEP_LIMIT
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.simulation import Simulation

# half-widths: the number of nodes in this length is the number of sweeps between two evaluations of A and B
STEP_SWEEPS_LENGTH, STEADY_SWEEPS_LENGTH = 0.6, 4.0
MAX_EVALUATIONS = 400  # of A and B in a solve
NEAR_FIELD_NODES = 100  # nodes on either side whose pressures act in the same sweep
OPEN_GAP_FILM_RATIO, OPEN_GAP_PRESSURE = 3.0, 0.1  # minimum of h in expected films, maximum of p in p0
OPEN_GAP_RELAXATION, FILM_RELAXATION = 1.85, 1.3  # over-relaxation in the open gap, in films of time steps
APPROACH_RELAXATION = 0.2  # of the change of the border that balances the load of Hertz' contact
HERTZ_STIFFNESS = np.pi / np.log(2.0)  # load per approach of Hertz' contact at W = pi/2, both dimensionless


class GaussSeidelSolver:
    """Solver of one scene by sweeps, with the interface of :class:`ehlpetsc.nonlinear.newton.NewtonSolver`.

    `case`, `scales`, `film_scale`: as in :class:`ehlpetsc.discretisation.ehl_problem.EHLProblem`.
    `tolerance`: tolerance of the residual, as ``-snes_atol``.

    `sweeps`: number of sweeps of all solves so far.
    """

    linear_iterations = 0

    def __init__(self, case: Case, scales: Scales, film_scale: float, tolerance: float):
        self.problem = line_problem(case, scales, film_scale, 0, scales.grid.n)
        self.bound, self.deflection = self.problem.model.lower_bound, self.problem.deflection
        self.tolerance = tolerance
        curvature, near = self.deflection.curvature, min(NEAR_FIELD_NODES, scales.grid.n - 1)
        self.kernel = np.concatenate([curvature[near:0:-1], curvature[: near + 1]])
        distant = curvature.copy()
        distant[: near + 1] = 0.0
        self.distant = SymmetricToeplitz(distant)
        self.sweeps = 0

    def start_iterations(self, needed: int | None = None) -> int:
        """Limit of the evaluations of a steady start."""
        return needed or MAX_EVALUATIONS

    def prepare(self, state: Unknowns, inputs: StepInputs) -> None:
        """There is nothing to factor."""

    def residual(self) -> Rows:
        """Residual of the last solution."""
        return self.rows

    def solve(
        self, guess: Unknowns, inputs: StepInputs, max_it: int | None = None, watch: Watch = None
    ) -> tuple[Unknowns, int]:
        """As :meth:`.newton.NewtonSolver.solve`; iterations are evaluations of the coefficients."""
        q, h, border = guess.q.copy(), np.maximum(guess.w, self.bound), guess.border
        max_sweeps = max_it or MAX_EVALUATIONS
        for iteration in range(max_sweeps):
            if watch:
                watch()
            p = np.maximum(q, 0.0)
            border, gap_is_open = self._correct(p, h, border, inputs)
            norm = self._evaluate(q, h, border, inputs)
            if norm < self.tolerance:
                return Unknowns(q, h, border), iteration
            if not np.isfinite(norm):
                raise SolveFailed("sweeps", "NOT_FINITE", iteration)
            self._sweep(q, h, p, gap_is_open, inputs)
        raise SolveFailed("sweeps", "MAX_IT", max_sweeps)

    def _correct(
        self, p: np.ndarray, h: np.ndarray, border: np.ndarray, inputs: StepInputs
    ) -> tuple[np.ndarray, np.ndarray]:
        """Balance the load; set h of the open gap and of the ends to the integral of p, in place."""
        balance = self.problem.balance
        error = balance.residual(border, balance.forces(p), inputs)
        border = border + APPROACH_RELAXATION / HERTZ_STIFFNESS * error
        gap_is_open = (h > OPEN_GAP_FILM_RATIO * self.problem.film_scale) & (p < OPEN_GAP_PRESSURE)
        gap_is_open[[0, -1]] = True
        h[gap_is_open] = np.maximum(self.problem.film(p, border, inputs.phi)[gap_is_open], self.bound)
        return border, gap_is_open

    def _evaluate(self, q: np.ndarray, h: np.ndarray, border: np.ndarray, inputs: StepInputs) -> float:
        """Store residual and coefficients at a state; return the norm of the rows off the bound."""
        with np.errstate(over="ignore", invalid="ignore"):
            sums = self.deflection.sums(self.problem.model.state(q, h).pressure)
            evaluation = self.problem.evaluate(Unknowns(q, h, border), inputs, sums)
            rows, self.derivatives = evaluation.residual, evaluation.reynolds_derivatives
            reynolds = w_of(rows, self.problem.n)
            self.rows = Rows(
                q_of(rows, self.problem.n).copy(), reynolds.copy(), border_of(rows, self.problem.n)
            )
            reynolds[(h <= self.bound) & (reynolds > 0.0)] = 0.0
            return float(np.linalg.norm(rows))

    def _sweep(
        self, q: np.ndarray, h: np.ndarray, p: np.ndarray, gap_is_open: np.ndarray, inputs: StepInputs
    ) -> None:
        problem, steady = self.problem, inputs.history is None
        curvature_coefficient = self.deflection.curvature_coefficient
        sweeps = max(1, round((STEADY_SWEEPS_LENGTH if steady else STEP_SWEEPS_LENGTH) / problem.dx))
        shape = 0.5 * problem.x**2 + inputs.phi
        far_field = self.distant(p)
        far_field[1:-1] += curvature_coefficient * (shape[:-2] - 2.0 * shape[1:-1] + shape[2:])
        relaxation = np.where(gap_is_open, OPEN_GAP_RELAXATION, 1.0 if steady else FILM_RELAXATION)
        relaxation[q <= 0.0] = 1.0
        linearised = q.copy(), h.copy(), self.rows.reynolds, self.derivatives
        deflection = -far_field, self.kernel, curvature_coefficient
        q[0] -= self.rows.reynolds[0] / self.derivatives[0, 4]
        p[0] = max(q[0], 0.0)
        for _ in range(sweeps):
            sweep(q, h, p, linearised, deflection, self.bound, relaxation)
        self.sweeps += sweeps


def swept(case: Case, tolerance: float) -> Simulation:
    """Simulation of a line contact, in oil and in direct contact, by sweeps."""

    def solver(case: Case, scales: Scales, film_scale: float, *others: object) -> GaussSeidelSolver:
        return GaussSeidelSolver(case, scales, film_scale, tolerance)

    with mock.patch("ehlpetsc.run.simulation.solver_of", solver):
        return Simulation(case)


@compiled(fastmath=True)
def sweep(
    q: np.ndarray,
    h: np.ndarray,
    p: np.ndarray,
    linearised: tuple,
    deflection: tuple,
    bound: float,
    relaxation: np.ndarray,
) -> None:
    r"""Update every pair once, in the direction of flow, in place.

    `q`, `h`, `p`: newest values; the first and the last h, and the first q, do not change, shape (n,).
    `linearised`: (q, h) of the last evaluation, Reynolds rows there, and their derivatives, shape (n, 8).
    `deflection`: share of the undeformed gap and of distant pressures in E, shape (n,); curvature kernel at
    -near .. near nodes; coefficient :math:`\pi/\Delta x` of the second difference of h.
    `bound`: minimum of h.
    `relaxation`: relaxation factor of each node, shape (n,).
    """
    q_old, h_old, residual, derivatives = linearised
    far_field, kernel, curvature_coefficient = deflection
    n, near = len(q), len(kernel) // 2
    c, d = kernel[near], 2.0 * curvature_coefficient
    for i in range(1, n):
        a, b = derivatives[i, 4], derivatives[i, 5]
        r = a * q_old[i] + b * h_old[i] - residual[i]
        for k in range(4):
            j = i + k - 2
            if k != 2 and 0 <= j < n:
                by_q, by_h = derivatives[i, 2 * k], derivatives[i, 2 * k + 1]
                r -= by_q * (q[j] - q_old[j]) + by_h * (h[j] - h_old[j])
        if i == n - 1:
            q[i] = limit_update((r - b * h[i]) / a, q_old[i])
            p[i] = max(q[i], 0.0)
            break
        low, high = max(i - near, 0), min(i + near + 1, n)
        e = far_field[i] + curvature_coefficient * (h[i - 1] + h[i + 1]) + c * p[i]
        for j in range(low, high):
            e -= kernel[j - i + near] * p[j]
        if q_old[i] > 0.0:
            determinant = a * d - b * c
            new_q, new_h = (r * d - b * e) / determinant, (a * e - c * r) / determinant
        else:
            new_h = e / d
            new_q = (r - b * new_h) / a
        if new_h < bound:
            new_h = bound
            new_q = max((e - d * bound) / c, PRESSURE_AFTER_REFILL)
        else:
            new_q = q[i] + relaxation[i] * (new_q - q[i])
            new_h = max(h[i] + relaxation[i] * (new_h - h[i]), bound)
        q[i] = limit_update(new_q, q_old[i])
        h[i] = new_h
        p[i] = max(q[i], 0.0)


@compiled
def limit_update(q: float, q_old: float) -> float:
    """New q, limited to the range in which the coefficients of the last evaluation, at `q_old`, hold."""
    if q_old > 0.0:
        return min(max(q, -PRESSURE_AFTER_REFILL, q_old - STEP_LIMIT), q_old + STEP_LIMIT)
    return min(max(q, MIN_OIL_FRACTION * (1.0 + q_old) - 1.0), PRESSURE_AFTER_REFILL)
