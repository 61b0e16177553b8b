r"""Deflection of half-planes by piecewise linear pressures on a uniform mesh.

With hat functions :math:`\Lambda` the deflection of a half-plane at node i is
:math:`\frac{4}{\pi E'}\Delta x\sum_k g_k\,p_{i+k}`,
:math:`g_k=-\int\Lambda(s)\ln|k-s|\,ds-\ln\Delta x`, and its second difference has the kernel
:math:`f_k=g_{k-1}-2g_k+g_{k+1}`, which decays as :math:`1/k^2` although the logarithm does not.
"""

from __future__ import annotations

import numpy as np

ASYMPTOTIC_DISTANCE = 40  # nodes: from here on the asymptotic series are exact to 1e-14


def deflection_kernel(n: int) -> np.ndarray:
    r"""Hat-function kernel :math:`g_k+\ln\Delta x`, k = 0 .. n-1 (dimensionless)."""
    near = np.arange(min(n, ASYMPTOTIC_DISTANCE), dtype=np.longdouble)  # differences of the primitive cancel

    def primitive(x: np.ndarray) -> np.ndarray:  # its second derivative is ln|x|
        x = np.abs(x)
        return x**2 * np.log(np.where(x == 0.0, 1.0, x)) / 2 - 3 * x**2 / 4

    far = np.arange(len(near), n, dtype=float)
    series = -np.log(far) + 1 / (12 * far**2) + 1 / (60 * far**4) + 1 / (168 * far**6)
    exact = -(primitive(near + 1) - 2 * primitive(near) + primitive(near - 1))
    return np.concatenate([exact.astype(float), series])


def curvature_kernel(n: int) -> np.ndarray:
    r"""Second-difference kernel :math:`f_k`, k = 0 .. n-1: -4 ln 2, 0.601422, 0.366900, 0.126091 ..."""
    k = np.arange(n, dtype=float)
    g = deflection_kernel(min(n, ASYMPTOTIC_DISTANCE) + 1)
    near = np.empty(len(g) - 1)
    near[0] = 2 * (g[1] - g[0])
    near[1:] = g[:-2] - 2 * g[1:-1] + g[2:]
    far = np.where(k < ASYMPTOTIC_DISTANCE, np.inf, k)
    f = 1 / far**2 + 1 / far**4 + 1.5 / far**6 + 17 / (6 * far**8)
    f[: len(near)] = near
    return f
