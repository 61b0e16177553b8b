"""Roughness of both surfaces, fixed to the bodies and moving through the contact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ehlpetsc.base.case import KINDS
from ehlpetsc.base.counts import whole_down
from ehlpetsc.surfaces.topography import ContinuedSpline, cell_faces, centre_values

if TYPE_CHECKING:
    from ehlpetsc.base.case import Case
    from ehlpetsc.base.declarations import Values
    from ehlpetsc.physics.scales import Scales
    from ehlpetsc.surfaces.topography import Topography

RAMP_LENGTH = 0.1  # half-widths at the beginning of a profile over which its heights increase from zero
MAX_SAMPLES = 5_000_000  # of a stored profile


class Passage(NamedTuple):
    """Passage of one surface through the domain.

    `speed`: U [m/s].
    `moving`: false in a steady case.
    `inlet`, `outlet`, `ramp`, `swept_length`: ends of the domain, length of the ramp and of the profile that
        enters during the run [m].
    `begin`: abscissa at which the profile begins, instead of 0 [m].
    `reach`: minimum and maximum displacement of a body whose profile is in the whole domain from the start
        [m].
    `is_flank`: whether this profile begins at x = 0 at time 0, :math:`X=-s`, as the arc length of a flank.
    `ahead`: length by which the profile has entered at time 0 [m].
    """

    speed: float
    moving: bool
    inlet: float
    outlet: float
    ramp: float
    swept_length: float
    begin: float = 0.0
    reach: tuple[float, float] | None = None
    is_flank: bool = False
    ahead: float = 0.0


class RoughSurface:
    r"""Heights of one surface that moves with its body, along x or, in the plane, on rows of the mesh.

    Body point s is at :math:`x=s+Ut`. Its abscissa in the profile is

    * U > 0: :math:`X=x_\mathrm{inlet}-s`, so that the profile enters at the inlet from time 0 on;
    * U < 0: :math:`X=s-x_\mathrm{outlet}`, so that it enters at the outlet;
    * U = 0, or a steady case: :math:`X=s-x_\mathrm{inlet}`, in the whole domain from the start.

    A moving surface is smooth where X < 0; its heights increase over the ramp as
    :math:`r^3(10-15r+6r^2)`, so that film and its rate of change have no jump.

    Heights of a map are reduced across once to the rows of the mesh, which leaves one spline along x for each
    row. Abscissas that fall along x (U > 0) fall along y too: the map is turned, not mirrored.

    `given`: heights as read or generated.
    `faces`: in y, :func:`cell_faces` of the rows of this rank [m], shape (rows + 3,); None: a line contact.
    `is_moving`: false if its abscissa is fixed to the domain at time 0, without a ramp.
    `enters`: whether it enters during the run; otherwise it is in the whole domain from the start.
    `ramp`, `travelled`: length of the ramp, and of the part of the profile that enters [m].
    `body_offset`: signed shift of the body points s by the abscissa at which the profile begins [m].
    """

    def __init__(self, given: Topography, passage: Passage, faces: np.ndarray | None = None) -> None:
        speed, moving, inlet, outlet, ramp, swept_length, begin, reach, is_flank, ahead = passage
        self.speed = speed
        self.is_moving = moving and speed != 0.0 and not is_flank
        self.enters = self.is_moving and not ahead
        self._origin, self._sign = (inlet + ahead, -1.0) if speed > 0 else (outlet - ahead, 1.0)
        if not self.is_moving:
            self._origin, self._sign = (0.0, -1.0) if is_flank else (inlet, 1.0)
        self._begin, self.body_offset = begin, self._sign * begin
        self.ramp = ramp
        self.travelled = swept_length + ahead if self.is_moving else outlet - inlet
        self._ends = None if self.is_moving or reach is None else (inlet - reach[1], outlet - reach[0])
        self.given, self.X, self.repeats, self.rq = given, given.X, given.repeats, given.sq
        self._rows = None if faces is None else len(faces) - 3
        heights = given.z[0] if faces is None else given.row_means(given.middle + self._sign * faces)
        if heights.ndim > 1:
            heights = centre_values(heights.T).T
        self._spline = ContinuedSpline(given.X, heights, given.along)

    def entered(self, s: np.ndarray) -> np.ndarray:
        """Ramp factor of the heights at body points s [m]: 0 ahead of the profile."""
        return self._entry_factor(self._sign * (s - self._origin))

    def _entry_factor(self, X: np.ndarray) -> np.ndarray:
        """Factor on the heights, 0 where X < 0, 1 beyond the ramp."""
        r = np.clip(X / self.ramp, 0.0, 1.0)
        return r * r * r * (10.0 - r * (15.0 - 6.0 * r))

    def height(self, s: np.ndarray) -> np.ndarray:
        """Heights [m] at body points s [m], of a map by :func:`centre_values` across.

        Returns shape (len(s),), in the plane (rows, len(s)).
        """
        X = self._sign * (s - self._origin)
        return self._on_rows(X, self._spline((np.maximum(X, 0.0) if self.is_moving else X) + self._begin))

    def node_height(self, faces: np.ndarray) -> np.ndarray:
        """Heights [m] at the centres of cells of one width, by :func:`centre_values`, of each row.

        The means are integrals of the spline, also across its continuation. The ramp is evaluated at the
        centres.

        `faces`: body points s of the faces [m], one cell more at each end, shape (n + 3,).
        """
        X = self._sign * (faces - self._origin)
        return self._on_rows(0.5 * (X[2:-1] + X[1:-2]), centre_values(self._spline.means(X + self._begin)))

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
        length = self._ends[1] - self._ends[0] if self._ends else self.travelled * (1 + 1e-12)
        X = np.arange(min(max(whole_down(length / self.given.dx) + 1, 2), MAX_SAMPLES)) * self.given.dx
        return self._ends[0] + X if self._ends else np.sort(self._origin + self._sign * X)

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

    def phi_after(
        self,
        x: np.ndarray,
        travelled: Sequence[float],
        cell: float | None = None,
        columns: slice = slice(None),
    ) -> np.ndarray:
        """Contribution of both roughnesses to the gap [m] after distances travelled [m] (surfaces 1, 2).

        `x`: positions [m], with `cell` equally spaced by it, shape (nx,).
        `cell`: cell width of the mesh [m]: heights by :func:`centre_values`, which damps the waves that the
            mesh does not resolve. Without it values of the profiles at x.
        `columns`: of x, of which the heights are computed.

        Returns one value a node, x fastest.
        """
        phi = np.zeros(())
        at = x[columns]
        if cell is not None:
            begin, end, _ = columns.indices(len(x))
            at = cell_faces(x, cell)[begin : end + 3]
        for surface, distance in zip((self.surface_1, self.surface_2), travelled, strict=True):
            if surface is not None:
                heights = surface.height if cell is None else surface.node_height
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
    y, dy = scales.a * (grid.axes[0] - grid.origin), grid.spacings[0]
    surface = areal_samples(folder, spec, dy * len(y), grid.periodic)
    return RoughSurface(surface, given, cell_faces(y, dy))


def directed_speeds(case: Case, scales: Scales) -> tuple[float, ...]:
    """Speeds of both surfaces [m/s] at which their profiles enter; 0 if a surface reverses."""
    speeds = scales.u1, scales.u2
    if case.conditions is None:
        return speeds
    return tuple(
        direction * max(abs(speed), 1e-3 * scales.u_max)
        for direction, speed in zip(case.conditions.directions(), speeds, strict=True)
    )


def passage(case: Case, scales: Scales, speed: float, side: int, begin: float) -> Passage:
    """Passage of surface `side`, 0 or 1, from an abscissa on; `speed`: see :func:`directed_speeds`."""
    inlet, outlet = scales.x[0] * scales.a, scales.x[-1] * scales.a
    swept_length, table, reach = 0.0, case.conditions, None
    if table is not None and table.varies:
        reach = table.extent()[side]
        swept_length = max(map(abs, reach))
    elif case.time is not None:
        swept_length = scales.duration * abs(speed)
    starts_rough = case.time is not None and case.time.start == "rough"
    return Passage(
        speed,
        case.time is not None,
        inlet,
        outlet,
        RAMP_LENGTH * scales.a,
        swept_length,
        begin,
        reach,
        table is not None and table.profile_offsets is not None,
        ahead=outlet - inlet + RAMP_LENGTH * scales.a if starts_rough else 0.0,
    )
