r"""The deflection rows: one linear form of separation, pressure and approach.

Inside the mesh in second differences (Evans & Hughes 2000; Holmes et al. 2005, eq. (2)),

.. math:: \frac{\pi}{\Delta x}\,\delta^2 g-\sum_kf_kp_{i+k},

at the two end nodes the whole integral with the approach h00,

.. math:: \frac{1}{\Delta x}\Big(g-h_{00}+\frac1\pi\int p\ln|x-s|\,ds\Big),

where g is the separation of the solids less what their undeformed shape gives it. Residual, matrix-free
product, assembled matrices and sweeps all take these coefficients.
"""

import numpy as np

from ehlpetsc.discretisation import elasticity

SECOND_DIFFERENCE = (1.0, -2.0, 1.0)


class Deflection:
    """Rows of the nodes first .. last-1.

    Parameters
    ----------
    n : int
        Nodes.
    dx : float
        Spacing in half widths.
    first, last : int

    Attributes
    ----------
    curvature : ndarray, shape (n,)
        Kernel f_k.
    stretch : float
        What the second difference of the separation counts.
    end_scale : float
        What the separation counts in an end node's row; h00 counts as much, negative.
    inside : ndarray of int
        Local nodes with rows in second differences.
    ends : list of int
        Local ones of the two end nodes.
    """

    def __init__(self, n, dx, first, last):
        self.n, self.dx, self.first, self.last = n, dx, first, last
        self.curvature = elasticity.curvature_kernel(n)
        self.stretch, self.end_scale = np.pi / dx, 1.0 / dx
        self.inside = np.arange(max(first, 1), min(last, n - 1))
        self.ends = [end for end in (0, n - 1) if first <= end < last]
        self._curvature_product = elasticity.SymmetricToeplitz(self.curvature, first, last)
        self._logarithm = elasticity.deflection_kernel(n) - np.log(dx)

    def end_row(self, node):
        """Under every pressure in the row of an end node, shape (n,)."""
        kernel = self._logarithm if node == 0 else self._logarithm[::-1]
        return (-self.end_scale * self.dx / np.pi) * kernel

    def rows(self, separation, pressure, approach):
        """The linear form in the local rows, shape (last - first,).

        Parameters
        ----------
        separation, pressure : ndarray, shape (n,)
        approach : float
        """
        g, i = separation, self.inside
        rows = -self._curvature_product(pressure)
        rows[i - self.first] += self.stretch * (g[i - 1] - 2.0 * g[i] + g[i + 1])
        for end in self.ends:
            rows[end - self.first] = self.end_scale * (g[end] - approach) + self.end_row(end) @ pressure
        return rows

    def integral(self, pressure):
        r"""Elastic deflection :math:`-\frac1\pi\int p\ln|x-s|ds` at every node, in a^2/R."""
        return (self.dx / np.pi) * elasticity.SymmetricToeplitz(self._logarithm)(pressure)
