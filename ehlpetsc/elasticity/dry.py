r"""Dry contact of bodies of any shape and elasticity, as a convex problem of its pressures at the nodes,

.. math:: \min_p\ \tfrac12\,p\cdot Ap+p\cdot g,\qquad 0\le p\le p_y,\quad\sum p=W,

A the deflection by pressures, g the gap of the undeformed solids: the gradient is the deformed gap without
the approach. Shape and elasticity enter as g and A alone, so that lines, points, strips, rollers, profiles
and coatings have one solver, and yielding is the upper limit.

Projected gradients with Nesterov's momentum, restarted where a step turns back, converge from any guess. They
give up the speed of conjugate gradients, as they serve guesses: a thousandth of the pressure takes some ten
to a hundred products with A. `tests/unit/test_dry.py` holds exact contacts, coated ones and given profiles.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

MAX_ITERATIONS = 1000
BISECTIONS = 60  # of an interval, down to rounding


def dry_pressure(
    gap: np.ndarray,
    total: float,
    deflection: Callable[[np.ndarray], np.ndarray],
    largest_eigenvalue: float,
    guess: np.ndarray,
    tolerance: float,
    limit: float = np.inf,
) -> np.ndarray:
    """Pressures of the dry contact at the nodes, in the unit of `total`, their sum.

    Parameters
    ----------
    gap
        g, up to a constant.
    deflection, largest_eigenvalue
        A, in the unit of the gap, and a bound of its eigenvalues.
    guess
        Of any sum.
    tolerance
        Changes of the pressures that end the iteration.
    limit
        Of the pressures, p_y.
    """
    rate = 1.0 / largest_eigenvalue
    p = ahead = project(guess, limit, total)
    momentum = 1.0
    for _ in range(MAX_ITERATIONS):
        new = project(ahead - rate * (gap + deflection(ahead)), limit, total)
        if np.abs(new - p).max() < tolerance:
            break
        if (ahead - new) @ (new - p) > 0.0:
            momentum = 1.0
        following = 0.5 * (1.0 + np.sqrt(1.0 + 4.0 * momentum**2))
        ahead, p, momentum = new + (momentum - 1.0) / following * (new - p), new, following
    return new


def project(p: np.ndarray, limit: float, total: float) -> np.ndarray:
    """Projection of p onto pressures between 0 and `limit` with the sum `total`: shifted and clipped."""
    low, high = -p.max(), min(limit, total) - p.min()
    for _ in range(BISECTIONS):
        shift = 0.5 * (low + high)
        low, high = (shift, high) if np.clip(p + shift, 0.0, limit).sum() < total else (low, shift)
    return np.clip(p + high, 0.0, limit)
