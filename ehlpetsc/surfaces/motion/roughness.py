"""Roughness of both surfaces, fixed to the bodies and moving through the contact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.base.case import KINDS
from ehlpetsc.surfaces.continued_spline import ContinuedSpline
from ehlpetsc.surfaces.motion.moving_surface import (
    MovingSurface,
    Passage,
    directed_speeds,
    passage,
)

if TYPE_CHECKING:
    from ehlpetsc.base.case import Case
    from ehlpetsc.base.declarations import Values
    from ehlpetsc.physics.scales import Scales
    from ehlpetsc.surfaces.topography import Topography


class RoughSurface(MovingSurface):
    """Heights of one surface that moves with its body, along x or, in the plane, on rows of the mesh.

    Heights of a map are integrated across once, over the cells of the rows, which leaves one spline along x
    for each row. Abscissas that fall along x (U > 0) fall along y too: the map is turned, not mirrored.

    `given`: heights as read or generated.
    `faces`: in y, of the cells around the rows of this rank [m], shape (rows + 1,); None: a line contact.
    """

    def __init__(self, given: Topography, passage: Passage, faces: np.ndarray | None = None) -> None:
        super().__init__(passage)
        self.given, self.X, self.repeats, self.rq = given, given.X, given.repeats, given.sq
        self._rows = None if faces is None else len(faces) - 1
        heights = given.z[0] if faces is None else given.row_means(given.middle + self._sign * faces)
        self._spline = ContinuedSpline(given.X, heights, given.along)

    def height(self, s: np.ndarray) -> np.ndarray:
        """Heights [m] at body points s [m], of a map means of the cells across.

        Returns shape (len(s),), in the plane (rows, len(s)).
        """
        X = self._sign * (s - self._origin)
        return self._on_rows(X, self._spline((np.maximum(X, 0.0) if self.is_moving else X) + self._begin))

    def mean_height(self, faces: np.ndarray) -> np.ndarray:
        r"""Mean height [m] of each cell between faces at body points s [m], of each row.

        :math:`\frac{1}{s_{i+1}-s_i}\int_{s_i}^{s_{i+1}}z\,ds`, the integral of the spline, also across its
        continuation. The ramp is evaluated at the centre of the cell.

        `faces`: shape (n + 1,).
        """
        X = self._sign * (faces - self._origin)
        return self._on_rows(0.5 * (X[1:] + X[:-1]), self._spline.means(X + self._begin))

    def _on_rows(self, X: np.ndarray, heights: np.ndarray) -> np.ndarray:
        """Heights (n,) or (n, rows) at X, times the ramp, as (n,) of a line contact or (rows, n)."""
        heights = self._entry_factor(X) * heights.T if self.is_moving else heights.T
        return heights if self._rows is None else np.broadcast_to(heights, (self._rows, len(X)))

    @property
    def statistics(self) -> dict[str, float]:
        """Ra and Rq [m], Rsk of a profile; of a surface in the plane Sa, Sq, Ssk."""
        letter = "r" if self._rows is None else "s"
        return {letter + name: value for name, value in self.given.statistics.items()}

    @cached_property
    def s(self) -> np.ndarray:
        """Body points [m] that enter during the run, at least two, with the spacing of the columns."""
        return self._points(self.given.dx)

    @cached_property
    def z(self) -> np.ndarray:
        """Heights [m] at `s`, ramp included."""
        return self.height(self.s)


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
    def of(cls, case: Case, scales: Scales, begin: Sequence[float] = (0.0, 0.0)) -> Roughness | None:
        """Roughness of a case of any kind of contact; None if both surfaces are smooth.

        `begin`: abscissas at which both profiles begin to enter [m].
        """
        specs = [case.surface.side(side) for side in ("1", "2")]
        if not any(specs):
            return None
        sides, speeds = [], directed_speeds(case, scales)
        for k, spec in enumerate(specs):
            given = passage(case, scales, speeds[k], k, begin[k])
            sides.append(spec and rough_surface(case, scales, spec, given))
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


def rough_surface(case: Case, scales: Scales, spec: Values, given: Passage) -> RoughSurface:
    """Surface of a body by its table: a profile in a line contact, else areal, on the rows of the mesh."""
    from ehlpetsc.surfaces.samples import areal_samples, samples

    folder, grid = case.path.parent, scales.grid
    if not KINDS[case.kind].is_areal:
        return RoughSurface(samples(folder, spec), given)
    y, dy = scales.a * grid.axes[0], grid.spacings[0]
    surface = areal_samples(folder, spec, dy * len(y), grid.periodic)
    return RoughSurface(surface, given, np.append(y - 0.5 * dy, y[-1] + 0.5 * dy))
