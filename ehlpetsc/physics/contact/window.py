r"""Window of a roller: part of its length on rows of its own, beside which the smooth roller is held.

The roughness of a whole roller does not fit a mesh: waves of 20 um on 12 mm are a million nodes. A window has
the rows of a part of the length, which ends at the end of the roller or inside. Pressures beside it are those
of the smooth roller on coarser rows: they deflect the window by a gap that does not change, and carry their
part of the load (:class:`.grid.Surroundings`, filled by :mod:`ehlpetsc.run.surroundings`). A window begins
and ends with a row of the coarser mesh, of which its rows are a whole number of parts.

Scales and formulas are those of the roller.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ehlpetsc.base.declarations import Values
from ehlpetsc.physics.contact.geometry import Dry, along
from ehlpetsc.physics.contact.grid import Grid
from ehlpetsc.physics.contact.roller import ROLLER, RollerGrid, roller_grid


@dataclass(frozen=True, kw_only=True)
class WindowGrid(Grid):
    """Nodes of a window; coordinates across are those of the roller.

    `whole`: nodes of the smooth roller.
    """

    whole: RollerGrid

    @cached_property
    def distance(self) -> np.ndarray:
        """See :class:`Grid`: of a line contact."""
        return np.abs(self.coordinates[-1])

    @property
    def widening(self) -> float:
        """See :class:`Grid`: of the roller."""
        return self.whole.widening

    @property
    def is_hertzian(self) -> bool:
        """See :class:`Grid`: of the roller."""
        return self.whole.is_hertzian

    @property
    def is_sharp(self) -> bool:
        """See :class:`RollerGrid`."""
        return self.whole.is_sharp

    @property
    def reached(self) -> list[float]:
        """Ends of the roller beside the window that the contact of the slices reaches."""
        step = self.increments[0]
        return [y for y in self.whole.reached if self.y[0] - step < y < self.y[-1] + step]

    @property
    def openings(self) -> list[float]:
        """See :class:`RollerGrid`, from row to row of the window."""
        finer = self.increments[0] / self.whole.increments[0]
        return [finer**1.5 * opening for opening in self.whole.openings]

    @property
    def y(self) -> np.ndarray:
        """Coordinates of the rows in half-widths."""
        return self.axes[0]

    def room(self, share: float, radius: float) -> np.ndarray:
        """See :class:`Grid`: of the slices of the roller."""
        rows = self.whole.rows(self.whole.room(share, radius) + self.whole.coordinates[-1] ** 2)[:, 0]
        return np.repeat(np.interp(self.y, self.whole.y, rows), self.shape[-1]) - self.coordinates[-1] ** 2

    def edges(self) -> dict[str, np.ndarray]:
        """See :class:`Grid`; pressure continues beyond the sides of a window."""
        return {key: nodes for key, nodes in super().edges().items() if key != "width"}

    def mean_inside(self, values: np.ndarray, radius: float, pressure: np.ndarray) -> float:
        """See :class:`Grid`: each row by its load."""
        inside = self.inside(radius)
        loads = np.repeat(self.rows(pressure).sum(axis=1), self.shape[-1])
        return float(np.average(values[inside], weights=loads[inside]))


def smooth_mesh(mesh: Values) -> Values:
    """Table `[mesh]` of the smooth roller of a window."""
    x, y = mesh.window.coarsening
    points = {"points_per_half_width": mesh.points_per_half_width // x}
    return mesh.copy(
        points | {"points_across": mesh.points_across and mesh.points_across // y, "window": None}
    )


def coarse_rows(contact: Values, mesh: Values, dry: Dry) -> tuple[RollerGrid, int, int]:
    """Nodes of the smooth roller, and its first row in the window and that behind it."""
    whole = roller_grid(contact, smooth_mesh(mesh), dry)
    n_y, step = len(whole.y), whole.increments[0] * dry.a
    places = [round(place / step + 0.5 * n_y) for place in (mesh.window.from_, mesh.window.to)]
    ends = [
        abs(place) >= 0.5 * contact.length * (1.0 - 1e-9) for place in (mesh.window.from_, mesh.window.to)
    ]
    first = 0 if ends[0] and mesh.window.from_ < 0.0 else min(max(places[0], 0), n_y - 1)
    behind = n_y if ends[1] and mesh.window.to > 0.0 else min(max(places[1], first + 1), n_y)
    return whole, first, behind


def window_rows(contact: Values, mesh: Values, dry: Dry) -> int:
    """Rows of a window."""
    _, first, behind = coarse_rows(contact, mesh, dry)
    return (behind - first) * mesh.window.coarsening[1]


def window_grid(contact: Values, mesh: Values, dry: Dry) -> WindowGrid:
    """Nodes of a window."""
    whole, first, behind = coarse_rows(contact, mesh, dry)
    finer, coarse_step = mesh.window.coarsening[1], whole.increments[0]
    step, n_y = coarse_step / finer, (behind - first) * finer
    low = (first - 0.5 * len(whole.y)) * coarse_step
    y = low + (np.arange(n_y) + 0.5) * step
    return WindowGrid(
        (y, along(mesh)),
        (step * dry.a, dry.a / mesh.points_per_half_width),
        (math.inf, 1.0),
        whole.shapes,
        whole.load,
        breadth=n_y * step,
        tilt=whole.tilt,
        origin=low + 0.5 * n_y * step,
        to_ends=(first * finer, (len(whole.y) - behind) * finer),
        whole=whole,
    )


WINDOW = ROLLER._replace(rows=window_rows, grid=window_grid)
