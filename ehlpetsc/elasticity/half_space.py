r"""Deflection of half-spaces by the pressure of one cell of a mesh in the plane.

The pressure of a cell is linear along x (hat) and constant across. With lengths in half-widths a, pressure in
p0 and deflection in a^2/R, that of node (0, 0) deflects node (i, j) by

.. math:: C K_{ij},\qquad K_{ij}=\int\!\!\int\frac{\Lambda(s/\Delta x)}{|(x_i-s,\,y_j-t)|}\,ds\,dt,\qquad
   C=\frac{2p_0R}{\pi E'a},

the second difference in x (over :math:`\Delta x`) and the first difference in y of

.. math::
   G(x,y)=\frac{x^2}{2}\operatorname{asinh}\frac{y}{|x|}+|x|y\operatorname{asinh}\frac{|x|}{y}-\frac{yr}{2},
   \qquad\partial_x^2\partial_yG=\frac1r .

Its sum over y is the kernel of a line contact, :math:`-2\Delta x\,g_k` with the hat functions of
:mod:`.half_plane`: pressures that do not depend on y deflect as in the line contact.
"""

from __future__ import annotations

import numpy as np

from ehlpetsc.elasticity.half_plane import deflection_kernel

NEAR = 60  # larger spacings: up to here the differences of G, beyond it the expansion in moments of the cell
IMAGES = 12  # periods on either side that are summed one by one
NEGLIGIBLE_WAVES = 5.0  # periods along x beyond which waves across the strip, exp(-2 pi x/L), are below 1e-13


def free_kernel(n_x: int, n_y: int, dx: float, dy: float) -> np.ndarray:
    """K of the distances 0 .. n - 1 nodes along and across, shape (n_y, n_x), in half-widths."""
    x, y = np.arange(n_x) * dx, np.arange(n_y) * dy
    kernel = cell_potential(x, y, dx, dy)
    reach = NEAR * max(dx, dy)
    near_x, near_y = min(n_x, int(reach / dx) + 1), min(n_y, int(reach / dy) + 1)
    kernel[:near_y, :near_x] = differences_of_primitive(near_x, near_y, dx, dy)
    return kernel


def differences_of_primitive(n_x: int, n_y: int, dx: float, dy: float) -> np.ndarray:
    """Exact K of the nearest nodes: in extended precision, because the differences cancel."""
    x = np.arange(-1, n_x + 1, dtype=np.longdouble) * np.longdouble(dx)
    y = (np.arange(n_y + 1, dtype=np.longdouble) - np.longdouble(0.5)) * np.longdouble(dy)
    g = primitive(x[None, :], y[:, None])
    along = (g[:, 2:] - 2.0 * g[:, 1:-1] + g[:, :-2]) / np.longdouble(dx)
    return (along[1:] - along[:-1]).astype(float)


def primitive(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    r"""Primitive G of the deflection, :math:`\partial_x^2\partial_yG=1/r`, odd in y."""
    x, side, y = np.abs(x), np.sign(y), np.abs(y)
    r = np.sqrt(x * x + y * y)
    safe_x, safe_y = np.where(x > 0.0, x, 1.0), np.where(y > 0.0, y, 1.0)
    by_x = np.where(x > 0.0, 0.5 * x * x * np.arcsinh(y / safe_x), 0.0)
    return side * (by_x + np.where(y > 0.0, x * y * np.arcsinh(x / safe_y), 0.0) - 0.5 * y * r)


def cell_potential(x: np.ndarray, y: np.ndarray, dx: float, dy: float) -> np.ndarray:
    r"""K at a distance by the moments of a cell, shape (len(y), len(x)); relative error (cell/r)^6/500.

    :math:`K=\Delta x\Delta y\,(1+\frac{\Delta x^2}{12}\partial_x^2+\frac{\Delta y^2}{24}\partial_y^2+
    \frac{\Delta x^4}{360}\partial_x^4+\frac{\Delta x^2\Delta y^2}{288}\partial_x^2\partial_y^2+
    \frac{\Delta y^4}{1920}\partial_y^4)\frac1r`.
    """
    x2, y2 = (x * x)[None, :], (y * y)[:, None]
    r2 = x2 + y2
    r2 = np.where(r2 > 0.0, r2, 1.0)
    inverse = 1.0 / np.sqrt(r2)
    x2, y2 = x2 / r2, y2 / r2  # squares of the cosine and of the sine
    second_x, second_y = 3.0 * x2 - 1.0, 3.0 * y2 - 1.0
    fourth_x, fourth_y = (9.0 + z * (105.0 * z - 90.0) for z in (x2, y2))
    fourth_xy = 105.0 * x2 * y2 - 15.0 * (x2 + y2) + 3.0
    ax, ay = dx * dx / r2, dy * dy / r2
    correction = ax * second_x / 12.0 + ay * second_y / 24.0
    correction += ax * ax * fourth_x / 360.0 + ax * ay * fourth_xy / 288.0 + ay * ay * fourth_y / 1920.0
    return dx * dy * inverse * (1.0 + correction)


def periodic_kernel(n_x: int, n_y: int, dx: float, dy: float) -> np.ndarray:
    r"""K of a strip, summed over all periods n_y dy across, shape (n_y, n_x).

    The mean across is the kernel of the line contact, :math:`-2\ln|x|` instead of the diverging sum. The
    rest is the sum over the nearest periods; the others, seen from afar, are the integral of 1/r over all
    distances beyond them (midpoint rule with its first correction).
    """
    period, kernel = n_y * dy, np.zeros((n_y, n_x))
    near = min(n_x, int(NEGLIGIBLE_WAVES * period / dx) + 2)
    y = np.arange(n_y) * dy
    one_side = free_kernel(near, (IMAGES + 1) * n_y + 1, dx, dy)
    for k in range(-IMAGES, IMAGES + 1):
        kernel[:, :near] += one_side[np.abs(np.arange(n_y) + k * n_y)]
    kernel[:, :near] += dx * dy * distant_periods(np.arange(near) * dx, y, period, IMAGES)
    kernel[:, :near] = 0.5 * (
        kernel[:, :near] + kernel[-np.arange(n_y), :near]
    )  # symmetric to the last digit
    kernel[:, :near] -= kernel[:, :near].mean(axis=0)
    kernel += 2.0 * dx / n_y * (deflection_kernel(n_x) - np.log(dx))
    return kernel


def distant_periods(x: np.ndarray, y: np.ndarray, period: float, images: int) -> np.ndarray:
    """Sum of 1/r over the periods beyond `images`, except for a constant over y; shape (len(y), len(x))."""
    total = np.zeros((len(y), len(x)))
    for side in (-1.0, 1.0):
        t = (images + 0.5) * period + side * y[:, None]
        r = np.hypot(x[None, :], t)
        total += -np.log(t + r) / period + period / 24.0 * (-t / r**3)
    return total
