r"""The deflection rows: one linear form of separation, pressure and the border's gap.

Inside the mesh in second differences (Evans & Hughes 2000; Holmes et al. 2005, eq. (2)),

.. math:: \frac{\pi}{\Delta x}\,\delta^2 g-\sum_kf_kp_{i+k},

at the two end nodes the whole integral with the gap :math:`g_b` of the border,

.. math:: \frac{1}{\Delta x}\Big(g-g_b+\frac1\pi\int p\ln|x-s|\,ds\Big),

where g is the separation of the solids less that of their undeformed shapes. Residual, matrix-free product
and assembled matrices use the same coefficients.

The pressure is piecewise linear on the uniform mesh; kernel f: :mod:`ehlpetsc.elasticity.half_plane`. The
discrete equations in second differences equal the integral form exactly (differential deflection).

A rank stores a window of the mesh, its own nodes and `HALO` nodes on either side; the pressures of the whole
mesh enter as sums (`PressureSums`).
"""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.fft import irfft, rfft

from ehlpetsc.base.compiled import compiled
from ehlpetsc.discretisation.line.curvature_product import Blocks, product
from ehlpetsc.elasticity.half_plane import curvature_kernel, deflection_kernel

SECOND_DIFFERENCE = (1.0, -2.0, 1.0)
HALO = 8  # nodes on either side of a rank's own: the widest stencil of the preconditioner
MAX_EIGENVALUE = 0.26  # of the deflection over the length of the mesh, for pressures with zero mean


def fast_length(n: int) -> int:
    """Smallest length from n on without a prime factor above 5, for fast Fourier transforms.

    `scipy.fft.next_fast_len` would load 4 MB more than `numpy.fft`, which is as quick.
    """
    while True:
        cofactor = n
        for prime in (2, 3, 5):
            while cofactor % prime == 0:
                cofactor //= prime
        if cofactor == 1:
            return n
        n += 1


class SymmetricToeplitz:
    """Exact product with a symmetric Toeplitz kernel by FFT, O(n log n).

    `kernel`: value at distance 0 .. n-1 nodes, shape (n,).
    """

    def __init__(self, kernel: np.ndarray):
        self.count = n = len(kernel)
        self.length = fast_length(2 * n - 1)
        circulant = np.zeros(self.length)
        circulant[:n], circulant[self.length - n + 1 :] = kernel, kernel[:0:-1]
        self.spectrum = rfft(circulant)

    def __call__(self, p: np.ndarray) -> np.ndarray:
        """Return the product with `p` (n,)."""
        return irfft(self.spectrum * rfft(p, self.length), self.length)[: self.count]


class PressureSums(NamedTuple):
    r"""Sums over the pressures of the whole mesh.

    `curvature`: :math:`\sum_kf_kp_{i+k}` at the local nodes, shape (last - first,).
    `load`: pressure terms of the rows of the first and of the last node, and :math:`\sum p\,\Delta x`, shape
        (3,).
    """

    curvature: np.ndarray
    load: np.ndarray

    @property
    def forces(self) -> np.ndarray:
        """Sums in the rows of the border, see :mod:`ehlpetsc.discretisation.balance`."""
        return self.load[2:]


class Deflection:
    """Deflection rows of the nodes first .. last-1.

    `n`: number of nodes of the mesh.
    `dx`: spacing in half-widths.

    `window`: nodes on which the rows depend, first .. last-1 among them.
    `curvature`: kernel f_k, shape (n,).
    `curvature_coefficient`: coefficient of the second difference of the separation.
    `end_row_coefficient`: coefficient of the separation in the row of an end node; that of the border's
        gap is its negative.
    `ends`: end nodes of the mesh among the local nodes.
    `form`: constants of :func:`deflection_rows`.
    `load_weights`: coefficients of the local pressures in `PressureSums.load`, shape (3, last - first).
    """

    is_homogeneous = True

    def __init__(self, n: int, dx: float, first: int, last: int):
        self.n, self.dx, self.first, self.last = n, dx, first, last
        self.window = slice(max(first - HALO, 0), min(last + HALO, n))
        self.owned = slice(first - self.window.start, last - self.window.start)
        self.curvature = curvature_kernel(n)
        self.curvature_coefficient, self.end_row_coefficient = np.pi / dx, 1.0 / dx
        self.ends = [end for end in (0, n - 1) if first <= end < last]
        self.form = self.owned.start, self.curvature_coefficient, self.end_row_coefficient, last == n
        logarithm = self._logarithm()
        end_rows = (self.end_row(end, logarithm)[first:last] for end in (0, n - 1))
        self.load_weights = np.stack([*end_rows, np.full(last - first, dx)])

    @property
    def largest_eigenvalue(self) -> float:
        """Bound of the eigenvalues of `integral`, for pressures with zero mean."""
        return MAX_EIGENVALUE * ((self.n - 1) * self.dx)

    @cached_property
    def _blocks(self) -> Blocks:
        return Blocks.of(self.curvature)

    def _logarithm(self) -> np.ndarray:
        return deflection_kernel(self.n) - np.log(self.dx)

    def end_row(self, node: int, logarithm: np.ndarray | None = None) -> np.ndarray:
        """Coefficients of all pressures in the row of an end node, shape (n,)."""
        kernel = self._logarithm() if logarithm is None else logarithm
        return (-self.end_row_coefficient * self.dx / np.pi) * (kernel if node == 0 else kernel[::-1])

    def sums(self, pressure: np.ndarray) -> PressureSums:
        """`PressureSums` of the pressures (n,) of the mesh, on one rank."""
        return PressureSums(product(self._blocks, pressure), self.load_weights @ pressure)

    def residual(self, separation: np.ndarray, of_border: float, sums: PressureSums) -> np.ndarray:
        """Linear form in the local rows.

        `separation`: at the nodes of `window`.
        """
        rows = np.empty(self.last - self.first)
        deflection_rows(separation, of_border, *sums, self.form, rows)
        return rows

    def integral(self, pressure: np.ndarray) -> np.ndarray:
        r"""Elastic deflection :math:`-\frac1\pi\int p\ln|x-s|ds` at every node, in a^2/R."""
        return (self.dx / np.pi) * SymmetricToeplitz(self._logarithm())(pressure)


@compiled
def deflection_rows(
    g: np.ndarray, of_border: float, curvature: np.ndarray, load: np.ndarray, form: tuple, rows: np.ndarray
) -> None:
    """Fill in the deflection rows, shape (rows,).

    `g`, `of_border`: separation, and the gap of the border.
    `curvature`, `load`: see `PressureSums`.
    `form`: index in g of the first row's node, 0: the first node of the mesh; `curvature_coefficient` and
        `end_row_coefficient` of `Deflection`; whether the last row is that of the last node of the mesh.
    """
    start, coefficient, end_coefficient, has_last = form
    inner = len(rows) - has_last
    if start == 0:
        rows[0] = end_coefficient * (g[0] - of_border) + load[0]
    for row in range(1 if start == 0 else 0, inner):
        i = start + row
        rows[row] = coefficient * (g[i - 1] - 2.0 * g[i] + g[i + 1]) - curvature[row]
    if has_last:
        rows[inner] = end_coefficient * (g[start + inner] - of_border) + load[1]
