"""Roughness of both surfaces, fixed to the bodies and moving through the contact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.base.case import KINDS
from ehlpetsc.surfaces.continued_spline import ContinuedSpline
from ehlpetsc.surfaces.moving_surface import (
    WAVE_NODES,
    MovingSurface,
    Passage,
    SurfacePositions,
    directed_speeds,
    passage,
)

if TYPE_CHECKING:
    from ehlpetsc.base.case import Case
    from ehlpetsc.base.declarations import Values
    from ehlpetsc.physics.scales import Scales
    from ehlpetsc.surfaces.samples import Samples
    from ehlpetsc.surfaces.topography import Topography


class Profile(MovingSurface):
    """Heights of one surface along x.

    `ra`, `rq`, `rsk`: parameters of the samples: m, m, 1.
    """

    def __init__(self, samples: Samples, passage: Passage) -> None:
        super().__init__(passage)
        X, z, self.repeats = samples.X, samples.z, samples.repeats
        self.given, self.X, self.heights = samples, X, z
        self._spline = ContinuedSpline(X, z, "mirrored" if self.repeats else "zero")
        deviation = z - z.mean()
        self.ra, self.rq = float(np.abs(deviation).mean()), float(np.sqrt((deviation**2).mean()))
        self.rsk = float(((deviation / self.rq) ** 3).mean()) if self.rq > 0 else 0.0

    def height(self, s: np.ndarray) -> np.ndarray:
        """Heights [m] at body points s [m]."""
        X = self._sign * (s - self._origin)
        if not self.is_moving:
            return self._spline(X + self._begin)
        return self._entry_factor(X) * self._spline(np.maximum(X, 0.0) + self._begin)

    def mean_height(self, faces: np.ndarray) -> np.ndarray:
        r"""Mean height [m] of each cell between faces at body points s [m].

        :math:`\frac{1}{s_{i+1}-s_i}\int_{s_i}^{s_{i+1}}z\,ds`, the integral of the spline, also across its
        mirrored continuation. The ramp is evaluated at the centre of the cell.

        `faces`: shape (n + 1,).
        """
        X = self._sign * (faces - self._origin)
        mean = self._spline.means(X + self._begin)
        return self._entry_factor(0.5 * (X[1:] + X[:-1])) * mean if self.is_moving else mean

    @property
    def statistics(self) -> dict[str, float]:
        """Ra and Rq [m], Rsk of the samples."""
        return {"ra": self.ra, "rq": self.rq, "rsk": self.rsk}

    @cached_property
    def s(self) -> np.ndarray:
        """Body points [m] that enter during the run, at least two, with the spacing of the samples."""
        return self._points(np.diff(self.X).mean())

    @cached_property
    def z(self) -> np.ndarray:
        """Heights [m] at `s`, ramp included."""
        return self.height(self.s)

    def unresolved_variance(self, dx: float) -> float:
        """Fraction of the height variance in wavelengths below `WAVE_NODES` spacings dx [m]."""
        n = min(max(self.X.size, 16), 1 << 17)
        x = np.linspace(self.X[0], self.X[-1], n)
        z = self._spline(x)
        z = np.concatenate([z, z[-2:0:-1]])  # mirrored: no jump, hence no leakage in the spectrum
        power = np.abs(np.fft.rfft(z)) ** 2
        power[0] = 0.0
        total = power.sum()
        short = np.fft.rfftfreq(z.size, x[1] - x[0]) * WAVE_NODES * dx > 1.0
        return float(power[short].sum() / total) if total > 0 else 0.0


class MovingTopography(MovingSurface):
    """Areal surface that moves along x with its body, on rows of the mesh.

    The heights are integrated across once, over the cells of the rows, which leaves one spline along x for
    each row. Abscissas that fall along x (U > 0) fall along y too: the map is turned, not mirrored.

    `y`: equally spaced rows of this rank [m], shape (rows,).
    `dy`: their spacing [m].
    """

    def __init__(self, topography: Topography, passage: Passage, y: np.ndarray, dy: float) -> None:
        super().__init__(passage)
        self.given, self.X, self.repeats = topography, topography.X, topography.repeats
        self.rq = topography.sq
        faces = np.append(y - 0.5 * dy, y[-1] + 0.5 * dy)
        rows = topography.row_means(topography.middle + self._sign * faces)
        self._rows, self._spline = len(y), ContinuedSpline(topography.X, rows, topography.along)

    def mean_height(self, faces: np.ndarray) -> np.ndarray:
        """Mean height [m] of each cell of each row between faces at body points s [m].

        The ramp is evaluated at the centre of the cell.

        `faces`: shape (nx + 1,).

        Returns shape (rows, nx).
        """
        X = self._sign * (faces - self._origin)
        means = self._spline.means(X + self._begin).T
        if self.is_moving:
            means = self._entry_factor(0.5 * (X[1:] + X[:-1])) * means
        return np.broadcast_to(means, (self._rows, means.shape[1]))

    def height(self, s: np.ndarray) -> np.ndarray:
        """Mean heights [m] of the cells across at body points s [m], shape (rows, len(s))."""
        X = self._sign * (s - self._origin)
        heights = self._spline((np.maximum(X, 0.0) if self.is_moving else X) + self._begin).T
        if self.is_moving:
            heights = self._entry_factor(X) * heights
        return np.broadcast_to(heights, (self._rows, len(s)))

    def unresolved_variance(self, dx: float, dy: float) -> float:
        """Fraction of the height variance in waves below `WAVE_NODES` spacings of the mesh [m]."""
        return self.given.unresolved_variance(dx, dy)

    @property
    def statistics(self) -> dict[str, float]:
        """Sa and Sq [m], Ssk of the whole map."""
        return self.given.statistics

    @cached_property
    def s(self) -> np.ndarray:
        """Body points [m] that enter during the run, at least two, with the spacing of the columns."""
        return self._points(self.given.dx)

    @cached_property
    def z(self) -> np.ndarray:
        """Heights [m] at `s`, ramp included, shape (rows, len(s))."""
        return self.height(self.s)


RoughSurface = Profile | MovingTopography


@dataclass(frozen=True)
class Roughness:
    """Profiles of both surfaces, or areal surfaces on the rows of the mesh; None for a smooth surface."""

    surface_1: RoughSurface | None
    surface_2: RoughSurface | None

    @property
    def sides(self) -> dict[str, RoughSurface]:
        """The rough surfaces, "1" and "2"."""
        sides = {"1": self.surface_1, "2": self.surface_2}
        return {name: surface for name, surface in sides.items() if surface}

    def side(self, name: str) -> RoughSurface | None:
        """Surface "1" or "2"."""
        return self.sides.get(name)

    @classmethod
    def of(cls, case: Case, scales: Scales, positions: SurfacePositions | None = None) -> Roughness | None:
        """Roughness of a case of any kind of contact; None if both surfaces are smooth.

        `positions`: by default both surfaces begin to enter with their first point.
        """
        specs, positions = [case.surface.side(side) for side in ("1", "2")], positions or SurfacePositions()
        if not any(specs):
            return None
        sides, speeds = [], directed_speeds(case, scales)
        for k, spec in enumerate(specs):
            given = passage(case, scales, speeds[k], k, positions)
            sides.append(spec and KINDS[case.kind].part("surface")(case, scales, spec, given))
        return cls(*sides)

    def phi_after(self, x: np.ndarray, travelled: Sequence[float], cell: float | None = None) -> np.ndarray:
        """Contribution of both roughnesses to the gap [m] after distances travelled [m] (surfaces 1, 2).

        `x`: positions [m], with `cell` equally spaced by it, shape (nx,).
        `cell`: cell width of the mesh [m] over which means are taken: waves shorter than a cell, which a mesh
            does not resolve, are damped instead of aliased. Without it values at x.

        Returns one value a node, x fastest.
        """
        phi = np.zeros(())
        at = x if cell is None else np.append(x - 0.5 * cell, x[-1] + 0.5 * cell)
        for surface, distance in zip((self.surface_1, self.surface_2), travelled, strict=True):
            if surface is not None:
                heights = surface.height if cell is None else surface.mean_height
                phi = phi - heights(at - distance).ravel()
        return phi

    @property
    def rq(self) -> float:
        """Combined root mean square height [m]."""
        return float(np.linalg.norm([surface.rq for surface in self.sides.values()]))


def moving_profile(case: Case, scales: Scales, spec: Values, given: Passage) -> Profile:
    """Profile of a line contact."""
    from ehlpetsc.surfaces.samples import samples

    return Profile(samples(case.path.parent, spec), given)


def moving_map(case: Case, scales: Scales, spec: Values, given: Passage) -> MovingTopography:
    """Areal surface of a strip or a point contact."""
    from ehlpetsc.surfaces.areal_samples import areal_samples

    y, dy, is_strip = scales.a * scales.grid.axes[0], scales.grid.spacings[0], scales.grid.periodic
    return MovingTopography(areal_samples(case.path.parent, spec, dy * len(y), is_strip), given, y, dy)
