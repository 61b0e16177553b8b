r"""The deflection rows in the plane: separation, pressure and the border's gap in integral form.

.. math:: s_g\Big(g-g_b-C\sum_{kl}K_{|i-k|,|j-l|}\,p_{kl}\Big),

g the separation of the solids less that of their undeformed shapes, :math:`g_b` the gap of the border, K of
one cell as below. The scale :math:`s_g=\sqrt{\Delta x\Delta y}/h_s`, :math:`h_s` that of the films, makes the
norm of the rows a relative error of the film. The sum is a convolution by FFT: along x, and across for a
point contact, over twice the nodes, because the domain is free; across a strip over its period.

Points of a rank are whole rows along x. The transform along x is local; before the one across, a
:class:`Transposition` hands each rank all rows of some wave numbers.

Kernel K: :mod:`ehlpetsc.elasticity.kernel`. Its part by the pressures in reversed order of the rows costs no
further transform: with :math:`\hat p_k` the transform across over a length L, that of the reversed rows is
:math:`e^{-2\pi ik(n_y-1)/L}\,\hat p_{-k}`. Its part weighted by distances from an end face has transforms of
its own, of fewer rows for shorter waves along x (:class:`EndProducts`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cached_property, partial
from typing import NamedTuple

import numpy as np
from scipy.fft import fft, ifft, irfft, next_fast_len, rfft

from ehlpetsc.elasticity.kernel import End, Kernel

NEGLIGIBLE = 3e-6  # deflection of rows far from an end by a wave, over the largest


class Transposition:
    """Exchange between rows and wave numbers along x, in contiguous shares of the ranks; here of one."""

    def wave_numbers(self, count: int) -> slice:
        """Wave numbers of this rank, of `count`."""
        return slice(0, count)

    def to_waves(self, rows: np.ndarray, count: int) -> np.ndarray:
        """All rows of the wave numbers of this rank, from the own rows of all wave numbers."""
        return rows

    def to_rows(self, waves: np.ndarray, count: int) -> np.ndarray:
        """Inverse of `to_waves`."""
        return waves

    def local(self, nodes: int) -> slice:
        """Nodes of this rank, of all `nodes`."""
        return slice(0, nodes)

    def gathered(self, local: np.ndarray) -> np.ndarray:
        """Values of all nodes from those of each rank."""
        return local


class PressureSums(NamedTuple):
    r"""Sums over the pressures of the whole mesh.

    `deflection`: :math:`C\sum K p` at the local nodes in a^2/R, shape (local nodes,).
    `forces`: of the border, see :mod:`ehlpetsc.discretisation.balance`.
    """

    deflection: np.ndarray
    forces: np.ndarray


class Convolution:
    """Product with a kernel symmetric along and across, by FFT, in the precision of its argument.

    `kernel`: see :class:`.kernel.Kernel`; its `direct` part over a period across if `periodic`.
    """

    def __init__(self, kernel: Kernel, periodic: bool, ranks: Transposition):
        (self.n_y, self.n_x), self.ranks = kernel.direct.shape, ranks
        self.length_x = next_fast_len(2 * self.n_x - 1, real=True)
        self.length_y = self.n_y if periodic else next_fast_len(2 * self.n_y - 1)
        self.waves = self.length_x // 2 + 1
        self.waves_here = ranks.wave_numbers(self.waves)
        across = np.asarray if periodic else partial(_even, length=self.length_y, axis=0)
        spectrum = np.ascontiguousarray(self._spectrum(kernel.direct, across).real)
        self.spectra = {spectrum.dtype: spectrum, np.dtype(np.float32): spectrum.astype(np.float32)}
        self.of_reversed: dict[np.dtype, np.ndarray] = {}
        if kernel.mirrored is not None:
            turn = np.exp(-2j * np.pi * np.arange(self.length_y) * (self.n_y - 1) / self.length_y)
            both = partial(_of_both_signs, length=self.length_y)
            product = turn[:, None] * self._spectrum(kernel.mirrored, both)
            self.of_reversed = {spectrum.dtype: product, np.dtype(np.float32): product.astype(np.complex64)}
            self.opposite = -np.arange(self.length_y) % self.length_y
        self.ends = [EndProducts(end, self.n_y, self.length_x, self.waves_here) for end in kernel.ends]

    def _spectrum(self, kernel: np.ndarray, continued: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
        """Transform of a kernel at the wave numbers of this rank, shape (length_y, waves).

        `continued`: its rows continued to a period.
        """
        along = rfft(_even(kernel, self.length_x, axis=1), axis=1).real[:, self.waves_here]
        return fft(continued(along), axis=0)

    def __call__(self, values: np.ndarray) -> np.ndarray:
        """Product with values at the local nodes, shape (local rows n_x,)."""
        rows = rfft(values.reshape(-1, self.n_x), self.length_x, axis=1)
        pressures = self.ranks.to_waves(rows, self.waves)
        waves = fft(pressures, self.length_y, axis=0, overwrite_x=not self.ends)
        if self.of_reversed:
            images = waves[self.opposite] * self.of_reversed[values.dtype]
            waves *= self.spectra[values.dtype]
            waves += images
        else:
            waves *= self.spectra[values.dtype]
        waves = ifft(waves, axis=0, overwrite_x=True)[: self.n_y]
        for end in self.ends:
            end.add(pressures, waves)
        rows = self.ranks.to_rows(waves, self.waves)
        return np.ascontiguousarray(irfft(rows, self.length_x, axis=1)[:, : self.n_x]).ravel()


class EndRows(NamedTuple):
    """Rows that some waves along x deflect near an end.

    `rows`, `waves`: all rows from this end on, of which these are the first; waves.
    `distances`: from the end face, shape (rows, 1).
    `spectrum`: of the kernel across, shape (length, waves).
    """

    rows: slice
    waves: slice
    distances: np.ndarray
    spectrum: np.ndarray


class EndProducts:
    """Deflection weighted by distances from an end face, see :class:`.kernel.End`.

    A wave along x reaches as many rows as it is long, so that each octave of waves has rows of its own.
    Double precision: far from the end, weights of both rows multiply the rounding.
    """

    def __init__(self, end: End, n_y: int, length_x: int, here: slice):
        sums, n_x = end.kernel.shape
        level = np.pad(
            end.kernel, ((0, 0), (0, length_x // 2 + 1 - n_x)), mode="edge"
        )  # short waves: no step
        along = rfft(np.concatenate([level, level[:, (length_x - 1) // 2 : 0 : -1]], axis=1), axis=1).real
        sizes = np.abs(along) * np.arange(1.0, sums + 1.0)[:, None] ** 2
        distances = end.step * (end.beyond + 0.5 + np.arange(n_y))
        self.octaves: list[EndRows] = []
        begin, stop = 0, 2
        while begin < along.shape[1]:
            reached = np.flatnonzero(sizes[:, begin:stop].max(axis=1) > NEGLIGIBLE * sizes.max())
            near = min(n_y, int(reached.max(initial=0)) + 1 - end.beyond)
            waves = slice(max(begin, here.start), min(stop, here.stop, along.shape[1]))
            if waves.start < waves.stop and near > 0:
                rows = np.s_[:: -1 if end.is_last else 1]
                kernel = along[2 * end.beyond :][: 2 * near - 1, waves]
                spectrum = fft(_of_both_signs(kernel, next_fast_len(2 * near - 1)), axis=0)
                own = slice(waves.start - here.start, waves.stop - here.start)
                if self.octaves and len(self.octaves[-1].distances) == near:
                    last = self.octaves.pop()
                    own = slice(last.waves.start, own.stop)
                    spectrum = np.concatenate([last.spectrum, spectrum], axis=1)
                self.octaves.append(EndRows(rows, own, distances[:near, None], spectrum))
            begin, stop = stop, 2 * stop

    def add(self, pressures: np.ndarray, deflections: np.ndarray) -> None:
        """Add the deflection by pressures; both of all rows and the waves of this rank."""
        for rows, waves, distances, spectrum in self.octaves:
            near = len(distances)
            weighted = (distances * pressures[rows, waves][:near])[::-1]
            product = fft(weighted, len(spectrum), axis=0)
            product *= spectrum
            product = ifft(product, axis=0, overwrite_x=True)[:near]
            deflections[rows, waves][:near] += distances * product


def _even(values: np.ndarray, length: int, axis: int) -> np.ndarray:
    """Even continuation of values at distances 0 .. n - 1 to a period of `length`."""
    values = np.moveaxis(values, axis, 0)
    out = np.zeros((length, *values.shape[1:]))
    out[: len(values)], out[length - len(values) + 1 :] = values, values[:0:-1]
    return np.moveaxis(out, 0, axis)


def _of_both_signs(values: np.ndarray, length: int) -> np.ndarray:
    """Values at distances 1 - n .. n - 1 continued to a period of `length`, along the first axis."""
    n = (len(values) + 1) // 2
    out = np.zeros((length, *values.shape[1:]))
    out[:n], out[length - n + 1 :] = values[n - 1 :], values[: n - 1]
    return out


class Deflection:
    """Deflection rows of the local nodes.

    `spacings`: dy, dx in half-widths.
    `kernel`: K of the module; `stiffness`: C.
    `film_scale`: of the row scale, in a^2/R.
    `periodic`: across.
    `owned`: local nodes in the window.

    `row_scale`: coefficient of the separation in a row; that of the border's gap is its negative.
    `cell`: dx dy.
    """

    def __init__(
        self,
        spacings: Sequence[float],
        kernel: Kernel,
        stiffness: float,
        film_scale: float,
        periodic: bool,
        owned: slice,
        ranks: Transposition | None = None,
    ):
        self.owned = owned
        dy, dx = spacings
        self.cell, self.kernel, self.stiffness = dx * dy, kernel, stiffness
        self.row_scale = np.sqrt(self.cell) / film_scale
        self.convolution = Convolution(kernel.times(stiffness), periodic, ranks or Transposition())

    def residual(
        self, separation: np.ndarray, of_border: float | np.ndarray, sums: PressureSums
    ) -> np.ndarray:
        """Local rows, from the separation at the nodes of the window and the gap of the border."""
        return self.row_scale * (separation[self.owned] - of_border - sums.deflection)

    @property
    def is_homogeneous(self) -> bool:
        """Whether both bodies are homogeneous."""
        return self.kernel.is_homogeneous

    @cached_property
    def largest_eigenvalue(self) -> float:
        """Bound of the eigenvalues of `integral`: the largest sum of a row."""
        return float(np.abs(self.integral(np.ones(self.convolution.n_y * self.convolution.n_x))).max())

    def integral(self, pressure: np.ndarray) -> np.ndarray:
        """Elastic deflection at every node of the mesh, in a^2/R, by the pressures there; collective."""
        ranks = self.convolution.ranks
        return ranks.gathered(self.convolution(pressure[ranks.local(len(pressure))]))
