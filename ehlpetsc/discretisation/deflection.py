r"""The deflection rows: one linear form of separation, pressure and approach.

Inside the mesh in second differences (Evans & Hughes 2000; Holmes et al. 2005, eq. (2)),

.. math:: \frac{\pi}{\Delta x}\,\delta^2 g-\sum_kf_kp_{i+k},

at the two end nodes the whole integral with the approach h00,

.. math:: \frac{1}{\Delta x}\Big(g-h_{00}+\frac1\pi\int p\ln|x-s|\,ds\Big),

where g is the separation of the solids less what their undeformed shape gives it. Residual, matrix-free
product, assembled matrices and Gauss-Seidel sweeps use the same coefficients.

A rank stores a window of the mesh, its own nodes and `HALO` nodes on either side; the pressures of the whole
mesh enter as sums (`PressureSums`).
"""

from functools import cached_property
from typing import NamedTuple

import numpy as np

from ehlpetsc.compiled import compiled
from ehlpetsc.discretisation import elasticity
from ehlpetsc.discretisation.curvature_product import Blocks, product

SECOND_DIFFERENCE = (1.0, -2.0, 1.0)
HALO = 8  # nodes on either side of a rank's own: the widest stencil of the preconditioner


class PressureSums(NamedTuple):
    r"""Sums over the pressures of the whole mesh.

    Attributes
    ----------
    curvature : ndarray, shape (last - first,)
        :math:`\sum_kf_kp_{i+k}` at the local nodes.
    load : ndarray, shape (3,)
        Pressure terms of the rows of the first and of the last node, and :math:`\sum p\,\Delta x`.
    """

    curvature: np.ndarray
    load: np.ndarray


class Deflection:
    """Deflection rows of the nodes first .. last-1.

    Parameters
    ----------
    n : int
        Number of nodes of the mesh.
    dx : float
        Spacing in half widths.
    first, last : int

    Attributes
    ----------
    window : slice
        Nodes on which the rows depend, first .. last-1 among them.
    curvature : ndarray, shape (n,)
        Kernel f_k.
    curvature_coefficient : float
        Coefficient of the second difference of the separation.
    end_row_coefficient : float
        Coefficient of the separation in the row of an end node; that of h00 is its negative.
    ends : list of int
        End nodes of the mesh among the local nodes.
    form : tuple
        Constants of :func:`deflection_rows`.
    load_weights : ndarray, shape (3, last - first)
        Coefficients of the local pressures in `PressureSums.load`.
    """

    def __init__(self, n, dx, first, last):
        self.n, self.dx, self.first, self.last = n, dx, first, last
        self.window = slice(max(first - HALO, 0), min(last + HALO, n))
        self.owned = slice(first - self.window.start, last - self.window.start)
        self.curvature = elasticity.curvature_kernel(n)
        self.curvature_coefficient, self.end_row_coefficient = np.pi / dx, 1.0 / dx
        self.ends = [end for end in (0, n - 1) if first <= end < last]
        self.form = self.owned.start, self.curvature_coefficient, self.end_row_coefficient, last == n
        logarithm = self._logarithm()
        end_rows = (self.end_row(end, logarithm)[first:last] for end in (0, n - 1))
        self.load_weights = np.stack([*end_rows, np.full(last - first, dx)])

    @cached_property
    def _blocks(self):
        return Blocks.of(self.curvature)

    def _logarithm(self):
        return elasticity.deflection_kernel(self.n) - np.log(self.dx)

    def end_row(self, node, logarithm=None):
        """Coefficients of all pressures in the row of an end node, shape (n,)."""
        kernel = self._logarithm() if logarithm is None else logarithm
        return (-self.end_row_coefficient * self.dx / np.pi) * (kernel if node == 0 else kernel[::-1])

    def sums(self, pressure):
        """`PressureSums` of the pressures (n,) of the mesh, on one rank."""
        return PressureSums(product(self._blocks, pressure), self.load_weights @ pressure)

    def residual(self, separation, approach, sums):
        """Linear form in the local rows.

        Parameters
        ----------
        separation : ndarray
            At the nodes of `window`.
        approach : float
        sums : PressureSums

        Returns
        -------
        ndarray, shape (last - first,)
        """
        rows = np.empty(self.last - self.first)
        deflection_rows(separation, approach, *sums, *self.form, rows)
        return rows

    def integral(self, pressure):
        r"""Elastic deflection :math:`-\frac1\pi\int p\ln|x-s|ds` at every node, in a^2/R."""
        return (self.dx / np.pi) * elasticity.SymmetricToeplitz(self._logarithm())(pressure)


@compiled
def deflection_rows(g, approach, curvature, load, start, coefficient, end_coefficient, has_last, rows):
    """Fill in the deflection rows.

    Parameters
    ----------
    g : ndarray
        Separation.
    approach : float
    curvature, load
        See `PressureSums`.
    start : int
        Index in g of the first row's node; 0: the first node of the mesh.
    coefficient, end_coefficient : float
        `curvature_coefficient` and `end_row_coefficient` of `Deflection`.
    has_last : bool
        Whether the last row belongs to the last node of the mesh.
    rows : ndarray, shape (rows,)
    """
    inner = len(rows) - has_last
    if start == 0:
        rows[0] = end_coefficient * (g[0] - approach) + load[0]
    for row in range(1 if start == 0 else 0, inner):
        i = start + row
        rows[row] = coefficient * (g[i - 1] - 2.0 * g[i] + g[i + 1]) - curvature[row]
    if has_last:
        rows[inner] = end_coefficient * (g[start + inner] - approach) + load[1]
