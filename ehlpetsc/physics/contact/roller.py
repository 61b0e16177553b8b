r"""Rollers of finite length: a line contact of the mean load, a profile across, and slices for its shape.

Scales and formulas are those of the line contact of load over length; b is half of the length. Rows of nodes
are cells with edges at the ends of the roller: beyond a sharp end there is no row, because the flow through a
face with a step is that of a linear gap, some 80 times too much. Round ends have rows as far as they reach.

Slices that do not feel each other, :math:`s=\max(0,d-z-\varphi y)/2` in :math:`a^2/R`, share the load: of a
row :math:`p=\sqrt{s-x^2}\,p_0`, :math:`\sqrt s\,a` its half-width and s its load over the mean. They give the
first guess, the widest part for which inlet and outlet are checked, and where the contact ends.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ehlpetsc.base.counts import whole_near, whole_up
from ehlpetsc.base.declarations import Values
from ehlpetsc.physics.contact.geometry import LINE, Dry, along, shape_along
from ehlpetsc.physics.contact.grid import Grid
from ehlpetsc.physics.contact.hertz import hertz_line
from ehlpetsc.physics.contact.profiles import MAX_GAP, Design, drop_of
from ehlpetsc.physics.contact.shape import Shape

SLICE = 2.0  # approach of a slice over its load: a^2/R over the mean load
PROFILE_POINTS = 4001  # across, of the end of the contact of slices
OPENING = 2.0 * math.sqrt(2.0) / 3.0  # of Hertz' gap beside the contact, see `inlet_opening`
BISECTIONS = 60  # of an interval, down to rounding
COARSENESS = 8.0  # spacing across over that along, unless given
MIN_ROWS = 4  # on half of the length
ROUND_DROP = 20e-6  # m: of a round end, beyond which no contact reaches


@dataclass(frozen=True, kw_only=True)
class RollerGrid(Grid):
    """Nodes of a roller.

    Attributes
    ----------
    drop
        Gap of the rows in a^2/R, with the tilt.
    is_sharp
        Whether the mesh ends with the roller.
    """

    drop: np.ndarray
    is_sharp: bool

    @property
    def y(self) -> np.ndarray:
        """Coordinates of the rows in half-widths."""
        return self.axes[0]

    @cached_property
    def distance(self) -> np.ndarray:
        """See :class:`Grid`: of a rectangle."""
        (y, x), (b, a) = self.coordinates, self.half_widths
        return np.maximum(np.abs(y) / b, np.abs(x) / a)

    @property
    def is_hertzian(self) -> bool:
        """See :class:`Grid`: slices know the profile across."""
        return self.shapes[-1].profile is None

    @cached_property
    def widening(self) -> float:
        """See :class:`Grid`: half-width of the slice with the highest load."""
        return math.sqrt(self._loads(1.0).max())

    def _loads(self, share: float) -> np.ndarray:
        """Load of each slice over the mean."""
        approach = slice_approach(self.drop, share, self.breadth / self.increments[0])
        return np.maximum(approach - self.drop, 0.0) / SLICE

    @cached_property
    def _profile(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Coordinates across closer than rows, the gap there and where it is within the slices' approach."""
        y = np.linspace(self.y[0], self.y[-1], PROFILE_POINTS)
        gap = self.shapes[0].beside(y) + self.tilt * y
        return y, gap, gap < slice_approach(self.drop, 1.0, self.breadth / self.increments[0])

    @property
    def loaded(self) -> tuple[float, float]:
        """Ends across of the contact of the slices."""
        y, _, touching = self._profile
        return y[touching][0], y[touching][-1]

    @property
    def reached(self) -> list[float]:
        """Ends of the roller that the contact of the slices reaches."""
        _, _, touching = self._profile
        b = self.half_widths[0]
        return [end for end, row in ((-b, 0), (b, -1)) if touching[row]]

    @property
    def openings(self) -> list[float]:
        r"""Opening of the gap from row to row beyond each end of the contact within the mesh, in a^2/R.

        That of Hertz' contact of half-width c and radius r across,
        :math:`\frac{2\sqrt2}{3}(\Delta y/c)^{3/2}c^2/r`; of an arc from its start to the approach d of the
        slices :math:`c=2d/z'` and :math:`r=c/z'`, z' the slope of the gap at the end.
        """
        y, gap, touching = self._profile
        slopes, step, found = np.abs(np.gradient(gap, y)), self.increments[0], []
        for end in (np.argmax(touching), len(y) - 1 - np.argmax(touching[::-1])):
            if 0 < end < len(y) - 1:
                c = 2.0 * (gap[end] - gap.min()) / slopes[end]
                found.append(OPENING * (step / c) ** 1.5 * c * slopes[end])
        return found

    def room(self, share: float, radius: float) -> np.ndarray:
        """See :class:`Grid`: of slices."""
        return radius * np.repeat(self._loads(share), self.shape[-1]) - self.coordinates[-1] ** 2

    def edges(self) -> dict[str, np.ndarray]:
        """See :class:`Grid`; where the mesh ends with the roller, pressure may reach its sides."""
        ends = super().edges()
        return {key: nodes for key, nodes in ends.items() if key != "width" or not self.is_sharp}

    def mean_inside(self, values: np.ndarray, radius: float, pressure: np.ndarray) -> float:
        """See :class:`Grid`: each row by its load."""
        inside = self.inside(radius)
        loads = np.repeat(self.rows(pressure).sum(axis=1), self.shape[-1])
        return float(np.average(values[inside], weights=loads[inside]))


def slice_approach(drop: np.ndarray, share: float, rows: float) -> float:
    """Approach in a^2/R of slices that carry a share of the load, the mean on a length of so many rows."""
    whole = SLICE * share * rows
    low, high = float(drop.min()), float(drop.min()) + whole
    for _ in range(BISECTIONS):
        approach = 0.5 * (low + high)
        is_more = np.maximum(approach - drop, 0.0).sum() > whole
        low, high = (low, approach) if is_more else (approach, high)
    return high


def slice_tilt(drop: np.ndarray, y: np.ndarray, rows: float) -> float:
    """Slope of the gap across with which slices have no moment about the middle."""
    high = 2.0 * (np.ptp(drop) + SLICE) / np.abs(y).max()
    low = -high
    for _ in range(BISECTIONS):
        tilt = 0.5 * (low + high)
        tilted = drop + tilt * y
        moment = np.maximum(slice_approach(tilted, 1.0, rows) - tilted, 0.0) @ y
        low, high = (tilt, high) if moment > 0.0 else (low, tilt)
    return 0.5 * (low + high)


def length_of(contact: Values) -> float:
    """Extent of a roller: its length [m]."""
    return contact.length


def roller(contact: Values, modulus: float) -> Dry:
    """Dry line contact of the mean load per length; b is half of the length."""
    a, p0 = hertz_line(contact.load / contact.length, contact.radius, modulus)
    return Dry(a, 0.5 * contact.length, p0)


def rows_across(contact: Values, mesh: Values, dry: Dry) -> tuple[int, int]:
    """Rows on half of the length and beyond each end."""
    points = mesh.points_across or whole_near(mesh.points_per_half_width * dry.b / dry.a / COARSENESS)
    inside = max(points, MIN_ROWS)
    if not contact.end_radius:
        return inside, 0
    reach = min(math.sqrt(2.0 * contact.end_radius * ROUND_DROP), contact.end_radius) / dry.b
    if mesh.width:
        reach = 0.5 * mesh.width - 1.0
    return inside, whole_up(reach * inside)


def roller_rows(contact: Values, mesh: Values, dry: Dry) -> int:
    """Rows of a roller, an even number."""
    return 2 * sum(rows_across(contact, mesh, dry))


def gap_across(y: np.ndarray, contact: Values, design: Design) -> np.ndarray:
    """Gap [m] of a roller at distances y [m] from its middle: profile, and round beyond its ends."""
    b, r = 0.5 * contact.length, contact.end_radius or 0.0
    beyond = np.clip(np.abs(y) - b, 0.0, r)
    round_end = r - np.sqrt(r * r - beyond**2)
    return np.minimum(drop_of(np.clip(y, -b, b), contact.profile, design) + round_end, MAX_GAP)


def roller_grid(contact: Values, mesh: Values, dry: Dry) -> RollerGrid:
    """Nodes of a roller."""
    inside, beyond = rows_across(contact, mesh, dry)
    ratio, unit, n_y = dry.b / dry.a, dry.a**2 / contact.radius, 2 * (inside + beyond)
    step = ratio / inside
    y = (np.arange(n_y) - 0.5 * (n_y - 1)) * step
    modulus = 4.0 * contact.radius * dry.p0 / dry.a  # Hertz
    design = Design(contact.length, contact.load, contact.radius, modulus)

    def profile(y: np.ndarray) -> np.ndarray:
        return gap_across(y * dry.a, contact, design) / unit

    tilt = (contact.tilt or 0.0) * dry.a / unit
    if contact.self_aligning:
        tilt = slice_tilt(profile(y), y, 2.0 * inside)
    return RollerGrid(
        (y, along(mesh)),
        (step * dry.a, dry.a / mesh.points_per_half_width),
        (ratio, 1.0),
        (Shape(profile=profile), shape_along(contact, dry)),
        np.pi * ratio,
        breadth=2.0 * ratio,
        drop=profile(y) + tilt * y,
        tilt=tilt,
        is_sharp=not contact.end_radius,
    )


ROLLER = LINE._replace(extent=length_of, dry=roller, rows=roller_rows, grid=roller_grid)
