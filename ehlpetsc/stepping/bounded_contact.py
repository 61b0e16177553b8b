r"""Dry contact of yielding solids as a convex problem: initial guess of Newton's method.

.. math:: \min_p\ \tfrac12\,p\cdot Ap+p\cdot g,\qquad 0\le p\le p_y,\quad \sum p\,\Delta x=W,

A the deflection, g the gap of the undeformed shapes: the gradient is the deformed gap without the approach.
Projected gradients with Nesterov's momentum, restarted where a step turns back, converge from any guess;
where nearly all nodes in contact yield, Newton's method alone does not find the set of elastic nodes.
"""

import numpy as np

from ehlpetsc.stepping.first_guess import AMBIENT, load_of, smoothed, undeformed_gap

MAX_EIGENVALUE = 0.26  # of A over the length of the mesh, for pressures with zero mean
MAX_ITERATIONS = 1000  # of the projected gradient method
STEP_TOLERANCE = 1e-5  # of the yield pressure: smaller changes end the iteration
BISECTIONS = 60  # of an interval, down to rounding


def bounded_pressure(problem, inputs):
    """Pressure of the dry contact, 0 <= p <= p_y, and its gap without the approach.

    Parameters
    ----------
    problem : ehl_problem.EHLProblem
        Problem with a yield pressure.
    inputs : ehl_problem.StepInputs

    Returns
    -------
    p, gap : ndarray, shape (nx,)
        In p0; in a^2/R.
    """
    limit, load = problem.model.yield_pressure, load_of(problem, inputs)
    total, phi = 0.5 * np.pi * load / problem.dx, undeformed_gap(problem, inputs)
    rate = 1.0 / (MAX_EIGENVALUE * (problem.x[-1] - problem.x[0]))
    p = ahead = project(np.sqrt(np.maximum(load - problem.x**2, 0.0)), limit, total)
    momentum = 1.0
    for _ in range(MAX_ITERATIONS):
        new = project(ahead - rate * problem.film(ahead, 0.0, phi), limit, total)
        if np.abs(new - p).max() < STEP_TOLERANCE * limit:
            break
        if (ahead - new) @ (new - p) > 0.0:
            momentum = 1.0
        following = 0.5 * (1.0 + np.sqrt(1.0 + 4.0 * momentum**2))
        ahead, p, momentum = new + (momentum - 1.0) / following * (new - p), new, following
    return new, problem.film(new, 0.0, phi)


def project(p, limit, total):
    """Projection of p onto pressures between 0 and `limit` with the sum `total`: shifted and clipped."""
    low, high = -p.max(), limit - p.min()
    for _ in range(BISECTIONS):
        shift = 0.5 * (low + high)
        low, high = (shift, high) if np.clip(p + shift, 0.0, limit).sum() < total else (low, shift)
    return np.clip(p + high, 0.0, limit)


def bounded_start(problem, film, inputs, smoothing):
    """Unknowns q, w and approach h00 of the dry contact; with oil, the oil carries the load on an even film.

    Parameters
    ----------
    problem : ehl_problem.EHLProblem
    film : float
        Oil film in a^2/R.
    inputs : ehl_problem.StepInputs
    smoothing : float
        Width of the smoothing of the oil pressure in lengths of the inlet sweep, film^(2/3).

    Returns
    -------
    q, w : ndarray, shape (nx,)
    h00 : float
    """
    model, limit = problem.model, problem.model.yield_pressure
    p, gap = bounded_pressure(problem, inputs)
    lowest = model.minimum_film if problem.fluid is None else max(film, model.minimum_film)
    elastic = (p > 0.0) & (p < limit)
    h00 = lowest - gap[elastic if elastic.any() else p > 0.0].max()
    depth = np.where(p < limit, 0.0, np.maximum(lowest - gap - h00, 0.0))
    if problem.fluid is None:
        carried = p + depth / model.compliance
        return *model.dry_start(carried, gap + h00 + depth), h00
    edge = problem.x[p > 0.0].max()
    if smoothing:
        p = smoothed(p, smoothing * film ** (2.0 / 3.0) / problem.dx)
    depth[p < limit * (1.0 - 1e-9)] = 0.0
    h = np.maximum(problem.film(p, h00, undeformed_gap(problem, inputs)) + depth, lowest)
    behind = (problem.x > edge) & (p < AMBIENT)
    oil, w = model.oil_start(p + depth / model.compliance, h)
    return np.where(behind, np.minimum(lowest / h - 1.0, 0.0), np.maximum(oil, AMBIENT)), w, h00
