r"""Convergence check of a solution, independent of SNES; a step is accepted only if it passes.

Conditions on the rows of :mod:`ehlpetsc.discretisation.ehl_problem` at the solution:

* deflection and, with oil, Reynolds equation: :math:`\|F\|_2` at most the tolerance of the solve,
  ``-snes_atol`` (or the residual of rounding, up to ten times that; or ``-snes_rtol`` times the first
  residual);
* complementarity at the contact nodes of direct contact: :math:`F\ge0` and :math:`h\ge h_b`, F to the same
  tolerance, h to the thickness below which a film counts as closed; in mixed contact it follows from the
  definition of the unknowns;
* load: :math:`|\sum p\,\Delta x-\pi/2|` to the same tolerance;
* all values finite, void fractions at most 1, :math:`q\ge-1`.

A solution whose pressure or contact is cut off by an end of the domain is refused too.
"""

from dataclasses import replace
from typing import Protocol

import numpy as np

from ehlpetsc.base.errors import NotConverged, SolveFailed
from ehlpetsc.discretisation.ehl_problem import EHLProblem
from ehlpetsc.discretisation.step_inputs import StepInputs, Watch
from ehlpetsc.discretisation.unknowns import Rows, Unknowns
from ehlpetsc.physics.contact.grid import Grid

SUM_ROUNDING = 1.0 + 1e-6  # factor on tolerances: sums in another order differ by rounding
VOID_TOLERANCE = 1e-9  # excess of a void fraction over 1 that is rounding
MAX_END_PRESSURE = 0.01  # p0
END_NAMES = {"inlet": "inlet, x", "outlet": "outlet, x", "width": "side, y"}


class Solver(Protocol):
    """A nonlinear solver of one scene.

    `tolerance`: of the residual in the last solve. `linear_iterations`: of all solves so far.
    """

    problem: EHLProblem
    tolerance: float
    bounded: bool
    linear_iterations: int

    def prepare(self, state: Unknowns, inputs: StepInputs) -> None:
        """Prepare for time steps from states near this one."""

    def solve(
        self, guess: Unknowns, inputs: StepInputs, max_it: int | None = None, watch: Watch = None
    ) -> tuple[Unknowns, int]: ...

    def residual(self) -> Rows: ...

    def start_iterations(self, needed: int | None = None) -> int: ...


def solve_checked(
    solver: Solver, guess: Unknowns, inputs: StepInputs, max_it: int | None = None, watch: Watch = None
) -> tuple[Unknowns, int]:
    """Solution that passes the check, and the number of iterations; raise `SolveFailed` without one.

    Without flow any void fraction is steady: oil at rest is solved for as if flooded, and the gap beyond the
    oil film of the inlet then void.
    """
    oil = inputs.inlet_film if inputs.rests else None
    if oil is not None:
        guess, inputs = guess._replace(q=np.maximum(guess.q, 0.0)), replace(inputs, inlet_film=None)
    solution, iterations = solver.solve(guess, inputs, max_it=max_it, watch=watch)
    fault = find_fault(solver.problem, solution, solver.residual(), solver.tolerance)
    if fault:
        raise SolveFailed("solution check:", fault, iterations)
    if oil is not None:
        h = solver.problem.model.film(solution.q, solution.w)
        solution = solution._replace(q=np.where(h > oil, oil / np.maximum(h, oil) - 1.0, solution.q))
    return solution, iterations


def solve_step(
    solver: Solver, guess: Unknowns, inputs: StepInputs, watch: Watch = None, max_it: int | None = None
) -> tuple[Unknowns, int]:
    """Solution as of :func:`solve_checked`; of yielding solids, on failure, from that of elastic ones."""
    elastic = solver.problem.model.elastic()
    try:
        return solve_checked(solver, guess, inputs, max_it, watch)
    except SolveFailed as error:
        if elastic is None:
            raise
        spent = error.iterations
    try:
        begin, iterations = solve_checked(solver, guess, replace(inputs, contact=elastic), max_it, watch)
        spent += iterations
        solution, iterations = solve_checked(solver, begin, inputs, max_it, watch)
    except SolveFailed as error:
        raise error.after(spent) from error
    return solution, spent + iterations


def find_fault(problem: EHLProblem, unknowns: Unknowns, rows: Rows, tolerance: float) -> str | None:
    """Reason for which a solution with these rows is rejected; None where it is accepted."""
    (q, w, _), (deflection, reynolds, border) = unknowns, rows
    if not all(np.isfinite(part.sum()) for part in (*unknowns, *rows)):
        return "it is not finite"
    if problem.fluid is not None and q.min() < -1.0 - VOID_TOLERANCE:
        return f"a node has {q.min() + 1.0:.2g} of its gap full of oil"
    bound = SUM_ROUNDING * tolerance
    fault, reynolds = problem.model.check(w, reynolds, bound)
    if fault:
        return fault
    for equation, norm in (
        *zip(problem.balance.equations, np.abs(border), strict=True),
        ("deflection", np.linalg.norm(deflection)),
        ("open gap" if problem.fluid is None else "oil balance", np.linalg.norm(reynolds)),
    ):
        if not norm <= bound:
            return f"the residual of the {equation} is {norm:.2e}, allowed: {tolerance:.1e}"
    return None


def check_ends(grid: Grid, pressure: np.ndarray, touching: np.ndarray) -> None:
    """Raise `NotConverged` where a pressure in p0, or contact, reaches an end of the domain."""
    for key, nodes in grid.edges().items():
        place, cure = END_NAMES[key], f"put mesh.{key} further out"
        axis = grid.coordinates[0 if key == "width" else -1]
        worst = nodes[np.argmax(pressure[nodes])]
        at = f"at the {place} = {axis[worst]:g} a"
        if touching[nodes].any():
            raise NotConverged(f"solids touch {at}: the contact is wider than the domain; {cure}")
        if pressure[worst] > MAX_END_PRESSURE:
            raise NotConverged(f"{pressure[worst]:.2g} p0 {at}: the domain cuts the pressure off; {cure}")
