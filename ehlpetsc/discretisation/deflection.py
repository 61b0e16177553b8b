r"""The deflection rows: one linear form of separation, pressure and approach.

Inside the mesh in second differences (Evans & Hughes 2000; Holmes et al. 2005, eq. (2)),

.. math:: \frac{\pi}{\Delta x}\,\delta^2 g-\sum_kf_kp_{i+k},

at the two end nodes the whole integral with the approach h00,

.. math:: \frac{1}{\Delta x}\Big(g-h_{00}+\frac1\pi\int p\ln|x-s|\,ds\Big),

where g is the separation of the solids less what their undeformed shape gives it. Residual, matrix-free
product, assembled matrices and sweeps all take these coefficients.

A part of the mesh knows its window alone: its own nodes and `HALO` on either side. What the pressures
beyond do to its rows is handed over, as `Outside`.
"""

from typing import NamedTuple

import numpy as np

from ehlpetsc.compiled import compiled
from ehlpetsc.discretisation import elasticity
from ehlpetsc.discretisation.curvature_product import CurvatureProduct

SECOND_DIFFERENCE = (1.0, -2.0, 1.0)
HALO = 8  # nodes beside its own that a part of the mesh knows; the widest stencil that is taken exactly


class Outside(NamedTuple):
    r"""What pressures of other parts of the mesh do to the rows of one.

    Attributes
    ----------
    curvature : ndarray, shape (last - first,)
        :math:`\sum_kf_kp_{i+k}` over the nodes beyond the window.
    sums : ndarray, shape (3,)
        Those of :meth:`Deflection.sums`, over all other parts.
    """

    curvature: np.ndarray
    sums: np.ndarray


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
    window : slice
        Nodes that the rows are given, first .. last-1 among them.
    curvature : ndarray, shape (n,)
        Kernel f_k.
    stretch : float
        What the second difference of the separation counts.
    end_scale : float
        What the separation counts in an end node's row; h00 counts as much, negative.
    ends : list of int
        Local ones of the two end nodes.
    under_sums : ndarray, shape (3, last - first)
        What the local pressures count in :meth:`sums`.
    """

    def __init__(self, n, dx, first, last):
        self.n, self.dx, self.first, self.last = n, dx, first, last
        self.window = slice(max(first - HALO, 0), min(last + HALO, n))
        self.own = slice(first - self.window.start, last - self.window.start)
        self.curvature = elasticity.curvature_kernel(n)
        self.stretch, self.end_scale = np.pi / dx, 1.0 / dx
        self.ends = [end for end in (0, n - 1) if first <= end < last]
        self._curvature_product = CurvatureProduct(self.curvature[: self.window.stop - self.window.start])
        logarithm = self._logarithm()
        mine = (self.end_row(end, logarithm)[first:last] for end in (0, n - 1))
        self.under_sums = np.stack([*mine, np.full(last - first, dx)])

    def _logarithm(self):
        return elasticity.deflection_kernel(self.n) - np.log(self.dx)

    def end_row(self, node, logarithm=None):
        """Under every pressure in the row of an end node, shape (n,)."""
        kernel = self._logarithm() if logarithm is None else logarithm
        return (-self.end_scale * self.dx / np.pi) * (kernel if node == 0 else kernel[::-1])

    def sums(self, pressure):
        """Over the local pressures, shape (last - first,): in both end nodes' rows, and in the load's."""
        return self.under_sums @ pressure

    def rows(self, separation, pressure, approach, outside=None):
        """The linear form in the local rows, and the load that the pressures carry.

        Parameters
        ----------
        separation, pressure : ndarray
            At the nodes of `window`.
        approach : float
        outside : Outside, optional
            Needed unless the window is the whole mesh.

        Returns
        -------
        rows : ndarray, shape (last - first,)
        load : float
        """
        rows, sums = self._curvature_product(pressure)[self.own], self.sums(pressure[self.own])
        if outside is not None:
            rows += outside.curvature
            sums = sums + outside.sums
        second_differences(separation, self.own.start, self.stretch, rows)
        for end in self.ends:
            k = 0 if end == 0 else -1
            rows[k] = self.end_scale * (separation[k] - approach) + sums[k and 1]
        return rows, sums[2]

    def integral(self, pressure):
        r"""Elastic deflection :math:`-\frac1\pi\int p\ln|x-s|ds` at every node, in a^2/R."""
        return (self.dx / np.pi) * elasticity.SymmetricToeplitz(self._logarithm())(pressure)


@compiled
def second_differences(g, start, stretch, rows):
    """Replace `rows`, sums over pressures, by stretch times the second differences of g less these sums.

    Parameters
    ----------
    g : ndarray
    start : int
        Place in g of the first row's node.
    stretch : float
    rows : ndarray
        Left as they are where g ends.
    """
    for row in range(len(rows)):
        i = start + row
        if 0 < i < len(g) - 1:
            rows[row] = stretch * (g[i - 1] - 2.0 * g[i] + g[i + 1]) - rows[row]
