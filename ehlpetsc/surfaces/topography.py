"""Heights of one surface: a profile, or a map on a uniform grid."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from ehlpetsc.surfaces.continued_spline import Continuation, ContinuedSpline
from ehlpetsc.surfaces.moving_surface import WAVE_NODES
from ehlpetsc.surfaces.parameters import areal_parameters, rms_gradient

RIDGE_ROWS = 4  # of a map of ridges, for its parameters
BLOCK = 256  # columns whose splines across are in memory at a time


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
        width, steps = 1e3 * float(self.Y[-1] - self.Y[0]), f"{1e6 * self.dx:.4g} x {1e6 * self.dy:.4g}"
        return (
            f"{1e3 * self.length:.4g} x {width:.4g} mm, {len(self.X)} x {len(self.Y)} points {steps} um apart"
        )

    @property
    def statistics(self) -> dict[str, float]:
        """Mean and root mean square height, "a" and "q" [m], and skewness, "sk"."""
        z, sq = self._once - self._once.mean(), self.sq
        skewness = float(((z / sq) ** 3).mean()) if sq > 0 else 0.0
        return {"a": float(np.abs(z).mean()), "q": sq, "sk": skewness}

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
        blocks = np.array_split(self.z, range(BLOCK, len(self.X), BLOCK), axis=1)
        return np.concatenate([ContinuedSpline(self.Y, z, self.across).means(faces).T for z in blocks])

    def periodic_over(self, width: float) -> Topography:
        r"""The same surface with a period across, for a strip: mirrored, hence without a seam.

        Its middle :math:`w/2m` of the width w, m the least number for which it is as wide, is reflected at
        both edges. A surface with this period, a ridge, or zero beyond its edges is left as it is.
        """
        if self.across != "mirrored" or self.is_ridge:
            return self
        extent = float(self.Y[-1] - self.Y[0])
        part = width / (2 * np.ceil(width / (2 * extent) * (1 - 1e-9)))
        begin = np.clip(self.middle - 0.5 * part, self.Y[0], max(self.Y[-1] - part, self.Y[0]))
        Y = np.linspace(begin, begin + part, max(round(part / self.dy), 3) + 1)
        blocks = np.array_split(self.z, range(BLOCK, len(self.X), BLOCK), axis=1)
        z = np.concatenate([ContinuedSpline(self.Y, block, "mirrored")(Y) for block in blocks], axis=1)
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
