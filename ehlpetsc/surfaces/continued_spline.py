"""Cubic spline of heights, continued beyond its ends."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy as np

if TYPE_CHECKING:
    from scipy.interpolate import PPoly

Continuation = Literal["mirrored", "periodic", "zero"]


class ContinuedSpline:
    """Cubic spline through heights, one or many side by side, and its means over cells.

    `x`: increasing abscissas, shape (n,).
    `z`: heights, shape (n,) or (n, rows); the first and the last are equal where they are periodic.
    `continuation`: beyond the ends the heights are reflected, periodic, or 0.
    """

    def __init__(self, x: np.ndarray, z: np.ndarray, continuation: Continuation) -> None:
        from scipy.interpolate import CubicSpline

        self.continuation, self.first, self.last = continuation, x[0], x[-1]
        # level ends: mirrored end to end, the heights have no kink
        self._spline = CubicSpline(x, z, bc_type="periodic" if continuation == "periodic" else "clamped")

    def __call__(self, x: np.ndarray) -> np.ndarray:
        """Heights at x, shape (m,) or (m, rows)."""
        if self.continuation == "zero":
            inside = (x >= self.first) & (x <= self.last)
            heights = self._spline(np.clip(x, self.first, self.last))
            return np.where(_columns(inside, heights), heights, 0.0)
        return self._spline(self._folded(x)[0])

    def means(self, faces: np.ndarray) -> np.ndarray:
        r"""Means of the heights over cells, :math:`\frac{1}{x_{i+1}-x_i}\int_{x_i}^{x_{i+1}}z\,dx`.

        The integral of the spline and of its continuation.

        `faces`: of cells side by side, increasing or decreasing, shape (m + 1,).

        Returns shape (m,) or (m, rows).
        """
        difference = np.diff(self._integral(faces), axis=0)
        return self._level + difference / _columns(np.diff(faces), difference)

    def _folded(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray | float]:
        """Abscissas between the ends with the heights at x, and the sign of the slope there."""
        length = self.last - self.first
        if self.continuation == "periodic":
            return self.first + np.mod(x - self.first, length), 1.0
        beyond = length - np.mod(x - self.first, 2.0 * length)  # negative: on the way back
        return self.last - np.abs(beyond), np.sign(beyond)

    def _integral(self, x: np.ndarray) -> np.ndarray:
        """Integral of height minus `_level` up to x.

        Heights minus their mean have the integral 0 over a period, so that the integral is periodic too and
        loses no digits over long distances.
        """
        if self.continuation == "zero":
            return self._antiderivative(np.clip(x, self.first, self.last))
        at, sign = self._folded(x)
        integral = self._antiderivative(at)
        return _columns(sign, integral) * integral

    @cached_property
    def _level(self) -> np.ndarray | float:
        """Mean height of a period; 0 if the heights are 0 beyond the ends."""
        if self.continuation == "zero":
            return 0.0
        return self._spline.integrate(self.first, self.last) / (self.last - self.first)

    @cached_property
    def _antiderivative(self) -> PPoly | PolynomialsOfRows:
        from scipy.interpolate import PPoly

        deviation = self._spline.c.copy()
        deviation[-1] -= self._level
        integral = PPoly(deviation, self._spline.x).antiderivative()
        return integral if deviation.ndim == 2 else PolynomialsOfRows(integral)


class PolynomialsOfRows:
    """Piecewise polynomials of many rows, one product for each point: a quarter of the time of scipy's."""

    def __init__(self, polynomials: PPoly) -> None:
        self._breaks = polynomials.x
        self._coefficients = np.ascontiguousarray(polynomials.c[::-1].transpose(1, 0, 2))

    def __call__(self, x: np.ndarray) -> np.ndarray:
        """Values at x, shape (m, rows)."""
        last = len(self._coefficients) - 1
        piece = np.clip(np.searchsorted(self._breaks, x, side="right") - 1, 0, last)
        powers = np.vander(x - self._breaks[piece], self._coefficients.shape[1], increasing=True)
        return (powers[:, np.newaxis] @ self._coefficients[piece])[:, 0]


def _columns(values: np.ndarray | float, beside: np.ndarray) -> np.ndarray:
    """Values along the first axis of an array of one or two dimensions, to be multiplied by it."""
    return np.reshape(values, (-1,) + (1,) * (beside.ndim - 1))
