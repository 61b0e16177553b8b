"""Heights of one surface, a profile or a map on a uniform grid; their spline; difference of two maps."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from ehlpetsc.base.counts import whole_up
from ehlpetsc.surfaces.parameters import areal_parameters, moments, rms_gradient

if TYPE_CHECKING:
    from scipy.interpolate import PPoly

Continuation = Literal["mirrored", "periodic", "zero"]

WAVE_NODES = 4  # nodes per wavelength below which a wave is not resolved
RIDGE_ROWS = 4  # of a map of ridges, for its parameters
BLOCK_COLUMNS = 256  # columns whose splines across are in memory at a time


@dataclass(frozen=True)
class Topography:
    """Heights of one surface, measured or synthetic.

    `X`, `Y`: equally spaced, m, shape (nx,), (ny,); with one row the heights are a profile, in the plane
        ridges, independent of Y, whose X need not be equally spaced.
    `z`: heights [m], positive out of the metal, shape (ny, nx); the last row or column equals the first
        where they are periodic.
    `along`, `across`: continuation along X and Y.
    `middle`: Y that runs along y = 0 [m].
    `measured`: whether the heights are from a file.
    `notes`: notes on the processing of the numbers of a file.
    """

    X: np.ndarray
    Y: np.ndarray
    z: np.ndarray
    along: Continuation = "mirrored"
    across: Continuation = "mirrored"
    middle: float = 0.0
    measured: bool = False
    notes: tuple[str, ...] = ()

    @classmethod
    def profile(cls, X: np.ndarray, z: np.ndarray, repeats: bool = True, **measured: Any) -> Topography:
        """Profile, shape (nx,), continued by reflection at its ends or by height 0."""
        return cls(X, np.zeros(1), z[np.newaxis], "mirrored" if repeats else "zero", **measured)

    @property
    def is_ridge(self) -> bool:
        """Whether the heights do not depend on Y, as those of a profile."""
        return len(self.Y) == 1

    @property
    def repeats(self) -> bool:
        """Whether the surface is continued along X, otherwise by height 0."""
        return self.along != "zero"

    @property
    def length(self) -> float:
        """Distance from the first column to the last [m]."""
        return float(self.X[-1] - self.X[0])

    @property
    def dx(self) -> float:
        """Mean distance of the columns [m]."""
        return self.length / (len(self.X) - 1)

    @property
    def dy(self) -> float:
        """Distance of the rows [m]; of ridges that of the columns."""
        return self.dx if self.is_ridge else float(self.Y[-1] - self.Y[0]) / (len(self.Y) - 1)

    @property
    def spacings(self) -> tuple[float, ...]:
        """Distances of the points along X and, but for ridges, along Y [m]."""
        return (self.dx,) if self.is_ridge else (self.dx, self.dy)

    @property
    def rms_slope(self) -> float:
        """Root mean square slope between neighbouring points of a profile; of a map Sdq."""
        if self.is_ridge:
            return float(np.sqrt(np.mean((np.diff(self.z[0]) / np.diff(self.X)) ** 2)))
        return rms_gradient(self.z, self.dx, self.dy)

    @property
    def _once(self) -> np.ndarray:
        """Heights without the last row and column where they repeat the first."""
        across, along = (slice(-1 if way == "periodic" else None) for way in (self.across, self.along))
        return self.z[across, along]

    @cached_property
    def sq(self) -> float:
        """Root mean square height [m]."""
        return float(self._once.std())

    @property
    def extent_text(self) -> str:
        """Size and points for messages."""
        if self.is_ridge:
            return f"{1e3 * self.length:.4g} mm long, {len(self.X)} points {1e6 * self.dx:.4g} um apart"
        size = f"{1e3 * self.length:.4g} x {1e3 * float(self.Y[-1] - self.Y[0]):.4g} mm"
        steps = f"{1e6 * self.dx:.4g} um and {1e6 * self.dy:.4g} um apart"
        return f"{size}, {len(self.X)} x {len(self.Y)} points {steps}"

    @property
    def statistics(self) -> dict[str, float]:
        """Mean and root mean square height, "a" and "q" [m], and skewness, "sk"."""
        found = moments(self._once)
        return {name: float(np.nan_to_num(found[name])) for name in ("a", "q", "sk")}

    @cached_property
    def parameters(self) -> dict[str, float]:
        """Roughness parameters of the map by their names."""
        z = np.repeat(self._once, RIDGE_ROWS, axis=0) if self.is_ridge else self._once
        return areal_parameters(z, self.dx, self.dy)

    def row_means(self, faces: np.ndarray) -> np.ndarray:
        """Mean heights [m] between faces in Y, at the columns.

        `faces`: increasing or decreasing, shape (rows + 1,).

        Returns shape (nx, rows); of ridges (nx,).
        """
        if self.is_ridge:
            return self.z[0]
        return np.concatenate([spline.means(faces).T for spline in self._splines_across()])

    def _splines_across(self) -> Iterator[ContinuedSpline]:
        blocks = np.array_split(self.z, range(BLOCK_COLUMNS, len(self.X), BLOCK_COLUMNS), axis=1)
        return (ContinuedSpline(self.Y, z, self.across) for z in blocks)

    def periodic_over(self, width: float) -> Topography:
        r"""The same surface with a period across, for a strip: mirrored, hence without a seam.

        Its middle :math:`w/2m` of the width w, m the least number for which it is as wide, is reflected at
        both edges. A surface with this period, a ridge, or zero beyond its edges is left as it is.
        """
        if self.across != "mirrored" or self.is_ridge:
            return self
        extent = float(self.Y[-1] - self.Y[0])
        part = width / (2 * whole_up(width / (2 * extent)))
        begin = np.clip(self.middle - 0.5 * part, self.Y[0], max(self.Y[-1] - part, self.Y[0]))
        Y = np.linspace(begin, begin + part, max(round(part / self.dy), 3) + 1)
        z = np.concatenate([spline(Y) for spline in self._splines_across()], axis=1)
        return replace(self, Y=Y, z=z, middle=begin + 0.5 * part)

    def unresolved_variance(self, dx: float, dy: float = 0.0) -> float:
        """Fraction of the height variance in waves shorter than `WAVE_NODES` spacings of the mesh [m]."""
        power, in_y, in_x = self._spectrum
        short = np.logical_or.outer(in_y * WAVE_NODES * dy > 1.0, in_x * WAVE_NODES * dx > 1.0)
        total = power.sum()
        return float(power[short].sum() / total) if total > 0 else 0.0

    @cached_property
    def _spectrum(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Power of the heights and its wave numbers across and along [1/m]."""
        from scipy.fft import dctn

        z = self.z
        if self.is_ridge:
            z = ContinuedSpline(self.X, z.T, self.along)(np.linspace(self.X[0], self.X[-1], len(self.X))).T
        axes = [k for k, n in enumerate(z.shape) if n > 1]
        power = dctn(z, type=1, axes=axes) ** 2  # mirrored: no jump, hence no leakage in the spectrum
        power[0, 0] = 0.0
        lengths = (2 * max(n - 1, 1) * step for n, step in zip(z.shape, (self.dy, self.dx), strict=True))
        in_y, in_x = (np.arange(n) / length for n, length in zip(z.shape, lengths, strict=True))
        return power, in_y, in_x


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


def cell_faces(centres: np.ndarray, width: float) -> np.ndarray:
    """Faces of cells of one width around their centres, and of one cell more at each end, shape (n + 3,)."""
    first, last = centres[0] - 1.5 * width, centres[-1] + 0.5 * width
    return np.concatenate([[first], centres - 0.5 * width, [last, last + width]])


def centre_values(means: np.ndarray) -> np.ndarray:
    r"""Heights at the centres of cells of one width, by means over them.

    :math:`\bar z_i-(\bar z_{i+1}-2\bar z_i+\bar z_{i-1})/24`, of fourth order: eight cells to a wave keep
    99.8 % of its amplitude, their means alone 97.4 %. Waves shorter than a cell are damped and keep their
    volume; the heights at the centres would alias or miss them.

    `means`: one cell more at each end, along the first axis, shape (n + 2, ...).
    """
    return means[1:-1] - np.diff(means, 2, axis=0) / 24.0


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
