r"""The deflection rows in the plane: separation, pressure and approach in integral form.

.. math:: s_g\Big(g-h_{00}-C\sum_{kl}K_{|i-k|,|j-l|}\,p_{kl}\Big),

g the separation of the solids less that of their undeformed shapes, K of :mod:`.kernel`. The scale
:math:`s_g=\sqrt{\Delta x\Delta y}/h_s`, :math:`h_s` that of the films, makes the norm of the rows a relative
error of the film. The sum is a convolution by FFT: along x, and across for a point contact, over twice the
nodes, because the domain is free; across a strip over its period.

Points of a rank are whole rows along x. The transform along x is local; before the one across, a
:class:`Transposition` hands each rank all rows of some wave numbers.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np
from scipy.fft import fft, ifft, irfft, next_fast_len, rfft

from ehlpetsc.discretisation.plane.kernel import free_kernel, periodic_kernel


class Transposition(Protocol):
    """Exchange between rows along x and wave numbers along x, each in contiguous shares of the ranks."""

    def wave_numbers(self, count: int) -> slice:
        """Wave numbers of this rank, of `count`."""

    def to_waves(self, rows: np.ndarray, count: int) -> np.ndarray:
        """All rows of the wave numbers of this rank, from the own rows of all wave numbers."""

    def to_rows(self, waves: np.ndarray, count: int) -> np.ndarray:
        """Inverse of `to_waves`."""

    def local(self, nodes: int) -> slice:
        """Nodes of this rank, of all `nodes`."""

    def gathered(self, local: np.ndarray) -> np.ndarray:
        """Values of all nodes from those of each rank."""


class OneRank:
    """Transposition of one rank, which has everything."""

    def wave_numbers(self, count: int) -> slice:
        return slice(0, count)

    def to_waves(self, rows: np.ndarray, count: int) -> np.ndarray:
        return rows

    def to_rows(self, waves: np.ndarray, count: int) -> np.ndarray:
        return waves

    def local(self, nodes: int) -> slice:
        return slice(0, nodes)

    def gathered(self, local: np.ndarray) -> np.ndarray:
        return local


class PressureSums(NamedTuple):
    r"""Sums over the pressures of the whole mesh.

    `deflection`: :math:`C\sum K p` at the local nodes in a^2/R, shape (local nodes,).
    `load`: :math:`\sum p\,\Delta x\Delta y`, shape (1,).
    """

    deflection: np.ndarray
    load: np.ndarray


class Convolution:
    """Product with a kernel symmetric along and across, by FFT.

    `kernel`: at distances 0 .. n - 1 nodes, shape (n_y, n_x); over a period across if `periodic`.
    """

    def __init__(self, kernel: np.ndarray, periodic: bool, ranks: Transposition):
        (self.n_y, self.n_x), self.ranks = kernel.shape, ranks
        self.length_x = next_fast_len(2 * self.n_x - 1, real=True)
        self.length_y = self.n_y if periodic else next_fast_len(2 * self.n_y - 1)
        self.waves = self.length_x // 2 + 1
        self.waves_here = ranks.wave_numbers(self.waves)
        along = rfft(_even(kernel, self.length_x, axis=1), axis=1).real[:, self.waves_here]
        across = along if periodic else _even(along, self.length_y, axis=0)
        self.spectrum = np.ascontiguousarray(fft(across, axis=0).real)

    def __call__(self, values: np.ndarray) -> np.ndarray:
        """Product with values at the local nodes, shape (local rows n_x,)."""
        rows = rfft(values.reshape(-1, self.n_x), self.length_x, axis=1)
        waves = fft(self.ranks.to_waves(rows, self.waves), self.length_y, axis=0, overwrite_x=True)
        waves *= self.spectrum
        waves = ifft(waves, axis=0, overwrite_x=True)[: self.n_y]
        rows = self.ranks.to_rows(waves, self.waves)
        return np.ascontiguousarray(irfft(rows, self.length_x, axis=1)[:, : self.n_x]).ravel()


def _even(values: np.ndarray, length: int, axis: int) -> np.ndarray:
    """Even continuation of values at distances 0 .. n - 1 to a period of `length`."""
    values = np.moveaxis(values, axis, 0)
    out = np.zeros((length, *values.shape[1:]))
    out[: len(values)], out[length - len(values) + 1 :] = values, values[:0:-1]
    return np.moveaxis(out, 0, axis)


class Deflection:
    """Deflection rows of the local nodes.

    `shape`, `spacings`: (n_y, n_x); (dy, dx) in half-widths.
    `stiffness`: C of the module.
    `film_scale`: of the row scale, in a^2/R.
    `periodic`: across.
    `owned`: local nodes in the window.

    `kernel`: C K, shape (n_y, n_x).
    `row_scale`: coefficient of the separation in a row; that of h00 is its negative.
    `cell`: dx dy.
    """

    def __init__(
        self,
        shape: Sequence[int],
        spacings: Sequence[float],
        stiffness: float,
        film_scale: float,
        periodic: bool,
        owned: slice,
        ranks: Transposition | None = None,
    ):
        self.owned = owned
        (n_y, n_x), (dy, dx) = shape, spacings
        self.cell, self.periodic, self.stiffness = dx * dy, periodic, stiffness
        self.row_scale = np.sqrt(self.cell) / film_scale
        kernel = stiffness * (periodic_kernel if periodic else free_kernel)(n_x, n_y, dx, dy)
        self.kernel = kernel
        self.convolution = Convolution(kernel, periodic, ranks or OneRank())

    def sums(self, pressure: np.ndarray) -> PressureSums:
        """`PressureSums` of local pressures; the load is that of the local nodes. Collective."""
        return PressureSums(self.convolution(pressure), np.array([self.cell * pressure.sum()]))

    def residual(self, separation: np.ndarray, approach: float, sums: PressureSums) -> np.ndarray:
        """Local rows, from the separation at the nodes of the window."""
        return self.row_scale * (separation[self.owned] - approach - sums.deflection)

    @cached_property
    def largest_eigenvalue(self) -> float:
        """Bound of the eigenvalues of `integral`: the largest sum of a row."""
        return float(np.abs(self.integral(np.ones(self.convolution.n_y * self.convolution.n_x))).max())

    def integral(self, pressure: np.ndarray) -> np.ndarray:
        """Elastic deflection at every node of the mesh, in a^2/R, by the pressures there; collective."""
        ranks = self.convolution.ranks
        return ranks.gathered(self.convolution(pressure[ranks.local(len(pressure))]))
