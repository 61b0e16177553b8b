"""Heights of one surface, a profile or a map on a uniform grid; their spline; difference of two maps."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from ehlpetsc.base.counts import whole_up
from ehlpetsc.base.errors import ProfileError
from ehlpetsc.surfaces.filters import SPACING_TOLERANCE
from ehlpetsc.surfaces.parameters import areal_parameters, moments, rms_gradient

if TYPE_CHECKING:
    from scipy.interpolate import PPoly

Continuation = Literal["mirrored", "periodic", "zero"]

WAVE_NODES = 4  # nodes per wavelength below which a wave is not resolved
RIDGE_ROWS = 4  # of a map of ridges, for its parameters
BLOCK_COLUMNS = 256  # columns whose splines across are in memory at a time
MIN_CORRELATION = 0.5  # of two maps for a difference: less is chance
MIN_OVERLAP = 0.25  # of the points of the smaller map


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


def difference(before: Topography, after: Topography) -> Topography:
    """Heights of a map minus those of another one of the same place, on the points of the first.

    The second is moved in x and y to where both correlate best, by fractions of a spacing with cubic splines,
    and is not turned. The result has the points that both have.

    Raises
    ------
    ProfileError
        Profiles, other spacings, or maps that correlate nowhere.
    """
    if before.is_ridge or after.is_ridge:
        raise ProfileError("a profile; allowed for a difference: maps")
    if not np.allclose(after.spacings, before.spacings, rtol=SPACING_TOLERANCE, atol=0.0):
        found, asked = (" x ".join(f"{1e6 * step:.4g}" for step in of.spacings) for of in (after, before))
        raise ProfileError(
            f"points {found} um apart; allowed for a difference: {asked} um, as of the first map"
        )
    from scipy.ndimage import shift

    moved, correlation = displacement(before.z, after.z)
    if correlation < MIN_CORRELATION:
        raise ProfileError(
            f"correlates with the first map by {correlation:.2f} at most; allowed for a difference: "
            f"{MIN_CORRELATION:g} or more, of the same place, not turned"
        )
    whole = np.rint(moved).astype(int)
    begin = np.maximum(whole, 0)
    end = np.minimum(before.z.shape, after.z.shape + whole)
    own, other = (tuple(map(slice, begin - by, end - by)) for by in (0, whole))
    z = before.z[own] - shift(after.z, moved - whole, order=3, mode="mirror")[other]
    x, y = 1e6 * moved[1] * before.dx, 1e6 * moved[0] * before.dy
    note = (
        f"second map moved by {x:.2f} um along its rows and {y:.2f} um across, correlation {correlation:.3f}"
    )
    X, Y = before.X[own[1]] - before.X[begin[1]], before.Y[own[0]] - before.Y[begin[0]]
    notes = *before.notes, *after.notes, note
    return replace(before, X=X, Y=Y, z=z - z.mean(), middle=0.5 * float(Y[-1]), notes=notes)


def displacement(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, float]:
    """Rows and columns by which b is moved to fit a best, and the correlation of both on their overlap.

    Correlation of all displacements with enough overlap by FFT; between points its parabola.
    """
    from scipy.fft import irfft2, next_fast_len, rfft2

    shape = [next_fast_len(m + n - 1, real=True) for m, n in zip(a.shape, b.shape, strict=True)]

    def products(first: np.ndarray, second: np.ndarray) -> np.ndarray:
        return irfft2(rfft2(first, shape) * np.conj(rfft2(second, shape)), shape)

    scale = max(a.std(), b.std()) or 1.0
    a, b, in_a, in_b = a / scale, b / scale, np.ones(a.shape), np.ones(b.shape)
    count = np.rint(products(in_a, in_b))
    squares = products(a * a, in_b) * products(in_a, b * b)
    enough = count >= max(MIN_OVERLAP * min(a.size, b.size), 1.0)
    tiny = np.finfo(float).eps * squares.max() + np.finfo(float).tiny
    correlation = np.where(enough, products(a, b) / np.sqrt(np.maximum(squares, tiny)), -1.0)
    best = np.unravel_index(correlation.argmax(), correlation.shape)
    moved = np.array(best, float)
    for axis, (k, n) in enumerate(zip(best, shape, strict=True)):
        line = np.moveaxis(correlation, axis, 0)[:, best[1 - axis]]
        low, middle, high = line[[k - 1, k, (k + 1) % n]]
        curvature = low - 2.0 * middle + high
        moved[axis] += 0.5 * (low - high) / curvature if curvature < 0.0 and min(low, high) > -1.0 else 0.0
        moved[axis] -= n if k >= a.shape[axis] else 0
    return moved, float(correlation[best])


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
