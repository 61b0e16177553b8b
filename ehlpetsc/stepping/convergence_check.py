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
"""

from dataclasses import replace

import numpy as np

from ehlpetsc.errors import SolveFailed

SUM_ROUNDING = 1.0 + 1e-6  # factor on tolerances: sums in another order differ by rounding
VOID_TOLERANCE = 1e-9  # excess of a void fraction over 1 that is rounding


def solve_checked(solver, q, w, h00, inputs, max_it=None, watch=None):
    """Solve, and check the solution.

    Parameters and returned values are those of `nonlinear.newton.NewtonSolver.solve`.

    Raises
    ------
    SolveFailed
        The solver does not converge, or its solution does not pass the check.
    """
    *solution, iterations = solver.solve(q, w, h00, inputs, max_it=max_it, watch=watch)
    fault = find_fault(solver.problem, *solution, solver.residual(), solver.tolerance)
    if fault:
        raise SolveFailed("solution check:", fault, iterations)
    return *solution, iterations


def solve_step(solver, q, w, h00, inputs, watch=None):
    """Checked solution of a time step; with yielding solids, on failure, from the solution of elastic ones.

    Parameters, returned values and errors are those of :func:`solve_checked`.
    """
    elastic = solver.problem.model.elastic()
    try:
        return solve_checked(solver, q, w, h00, inputs, watch=watch)
    except SolveFailed as error:
        if elastic is None:
            raise
        spent = error.iterations
    try:
        *begin, iterations = solve_checked(solver, q, w, h00, replace(inputs, contact=elastic), watch=watch)
        spent += iterations
        *state, iterations = solve_checked(solver, *begin, inputs, watch=watch)
    except SolveFailed as error:
        raise error.after(spent) from error
    return *state, spent + iterations


def find_fault(problem, q, w, h00, rows, tolerance):
    """Reason for which a solution is rejected; None where it is accepted.

    Parameters
    ----------
    problem : discretisation.ehl_problem.EHLProblem
    q, w : ndarray, shape (nx,)
    h00 : float
    rows : (ndarray, ndarray, float)
        Residual: deflection and Reynolds rows, load row.
    tolerance : float
    """
    deflection, reynolds, load = rows
    if not np.isfinite([q.sum(), w.sum(), h00, deflection.sum(), reynolds.sum(), load]).all():
        return "it is not finite"
    if problem.fluid is not None and q.min() < -1.0 - VOID_TOLERANCE:
        return f"a node has {q.min() + 1.0:.2g} of its gap full of oil"
    bound = SUM_ROUNDING * tolerance
    fault, reynolds = problem.model.check(w, reynolds, bound)
    if fault:
        return fault
    for equation, norm in (
        ("load", abs(load)),
        ("deflection", np.linalg.norm(deflection)),
        ("open gap" if problem.fluid is None else "oil balance", np.linalg.norm(reynolds)),
    ):
        if not norm <= bound:
            return f"the residual of the {equation} is {norm:.2e}, allowed: {tolerance:.1e}"
    return None
