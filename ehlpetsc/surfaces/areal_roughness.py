"""Areal roughness of both surfaces, fixed to the bodies and moving through the contact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.surfaces.continued_spline import ContinuedSpline
from ehlpetsc.surfaces.moving_surface import MovingSurface, Passage
from ehlpetsc.surfaces.roughness import SurfacePositions, directed_speeds, passage

if TYPE_CHECKING:
    from ehlpetsc.case.tables import Case
    from ehlpetsc.physics.scales import Scales
    from ehlpetsc.surfaces.topography import Topography


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
        """Share of the height variance in wavelengths that a mesh of these spacings [m] does not resolve."""
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


@dataclass(frozen=True)
class ArealRoughness:
    """Areal surfaces of both bodies on the same rows of the mesh; None for a smooth surface."""

    surface_1: MovingTopography | None
    surface_2: MovingTopography | None

    @property
    def sides(self) -> dict[str, MovingTopography]:
        """The rough surfaces, "1" and "2"."""
        sides = {"1": self.surface_1, "2": self.surface_2}
        return {name: surface for name, surface in sides.items() if surface}

    def side(self, name: str) -> MovingTopography | None:
        """Surface "1" or "2"."""
        return self.sides.get(name)

    @classmethod
    def of(
        cls,
        case: Case,
        scales: Scales,
        y: np.ndarray,
        dy: float,
        width: float,
        is_strip: bool,
        positions: SurfacePositions | None = None,
    ) -> ArealRoughness | None:
        """Roughness of a case on rows of the mesh; None if both surfaces are smooth.

        `y`, `dy`: rows of this rank, equally spaced, and their spacing [m].
        `width`: of the whole mesh across [m].
        `is_strip`: whether the contact is periodic over this width.
        `positions`: by default both maps begin to enter with their first column.
        """
        from ehlpetsc.surfaces.areal_samples import areal_samples  # which smooth surfaces do not need

        sides, positions = [], positions or SurfacePositions()
        for k, speed in enumerate(directed_speeds(case, scales)):
            spec = case.surface.side(str(k + 1))
            sides.append(
                spec
                and MovingTopography(
                    areal_samples(case.path.parent, spec, width, is_strip),
                    passage(case, scales, speed, k, positions),
                    y,
                    dy,
                )
            )
        return cls(*sides) if any(sides) else None

    def phi_after(self, x: np.ndarray, travelled: Sequence[float], dx: float) -> np.ndarray:
        """Contribution of both roughnesses to the gap [m] after distances travelled [m] (surfaces 1, 2).

        Means over the cells of the mesh: waves shorter than a cell, which a mesh does not resolve, are damped
        instead of aliased.

        `x`: equally spaced positions [m], shape (nx,).
        `dx`: their spacing [m].

        Returns one value a node, x fastest, shape (rows nx,).
        """
        faces = np.append(x - 0.5 * dx, x[-1] + 0.5 * dx)
        gaps = [
            -surface.mean_height(faces - distance).ravel()
            for surface, distance in zip((self.surface_1, self.surface_2), travelled, strict=True)
            if surface is not None
        ]
        return gaps[0] if len(gaps) == 1 else gaps[0] + gaps[1]

    @property
    def rq(self) -> float:
        """Combined root mean square height [m]."""
        return float(np.linalg.norm([surface.rq for surface in self.sides.values()]))
