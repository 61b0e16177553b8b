"""One sweep of :mod:`.gauss_seidel`, compiled: each pair is updated with the newest values of all others."""

from typing import NamedTuple

import numpy as np

from ehlpetsc.compiled import compiled
from ehlpetsc.discretisation.contact.node_state import MIN_OIL_FRACTION, PRESSURE_AFTER_REFILL
from ehlpetsc.nonlinear.two_fields import STEP_LIMIT


class Linearised(NamedTuple):
    """Reynolds rows at the state of the last evaluation.

    Attributes
    ----------
    q, h : ndarray, shape (n,)
        State of the last evaluation.
    residual, derivatives : ndarray, shape (n,), (n, 8)
        Rows, and their derivatives with respect to (q, h) at the nodes i-2 .. i+1.
    """

    q: np.ndarray
    h: np.ndarray
    residual: np.ndarray
    derivatives: np.ndarray


class DeflectionForm(NamedTuple):
    r"""Constants of the deflection rows inside the mesh.

    Attributes
    ----------
    far_field : ndarray, shape (n,)
        Contribution of the undeformed gap and of distant pressures to E.
    kernel : ndarray, shape (2 near + 1,)
        Curvature kernel at -near .. near nodes.
    curvature_coefficient : float
        :math:`\pi/\Delta x`, coefficient of the second difference of h.
    """

    far_field: np.ndarray
    kernel: np.ndarray
    curvature_coefficient: float


@compiled(fastmath=True)
def sweep(q, h, p, linearised, deflection, bound, relaxation):
    """Update every pair once, in the direction of flow, in place.

    Parameters
    ----------
    q, h, p : ndarray, shape (n,)
        Newest values; the first and the last h, and the first q, do not change.
    linearised : Linearised
    deflection : DeflectionForm
    bound : float
        Minimum of h.
    relaxation : ndarray, shape (n,)
        Relaxation factor of each node.
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
def limit_update(q, q_old):
    """New q, limited to the range in which the coefficients of the last evaluation, at `q_old`, hold."""
    if q_old > 0.0:
        return min(max(q, -PRESSURE_AFTER_REFILL, q_old - STEP_LIMIT), q_old + STEP_LIMIT)
    return min(max(q, MIN_OIL_FRACTION * (1.0 + q_old) - 1.0), PRESSURE_AFTER_REFILL)
