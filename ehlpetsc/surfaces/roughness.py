"""Roughness of both surfaces, fixed to the bodies and moving through the contact."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ehlpetsc.case.tables import Case
    from ehlpetsc.physics.scales import Scales
    from ehlpetsc.surfaces.moving_surface import Passage
    from ehlpetsc.surfaces.profile import Profile

RAMP_LENGTH = 0.1  # half-widths at the beginning of a profile over which its heights increase from zero


@dataclass(frozen=True)
class SurfacePositions:
    """Positions of both surfaces at time 0: abscissas at which their profiles begin to enter [m]."""

    profile_offsets: tuple[float, float] = (0.0, 0.0)

    def offsets(self, speeds: Sequence[float]) -> tuple[float, ...]:
        """Signed shift of the body points by `profile_offsets` [m].

        `speeds`: see :func:`directed_speeds`.
        """
        return tuple(
            -begin if speed > 0.0 else begin
            for begin, speed in zip(self.profile_offsets, speeds, strict=True)
        )


def directed_speeds(case: Case, scales: Scales) -> tuple[float, ...]:
    """Speeds of both surfaces [m/s] at which their profiles enter; 0 if a surface reverses."""
    speeds = scales.u1, scales.u2
    if case.conditions is None:
        return speeds
    return tuple(
        direction * max(abs(speed), 1e-3 * scales.u_max)
        for direction, speed in zip(case.conditions.directions(), speeds, strict=True)
    )


@dataclass(frozen=True)
class Roughness:
    """Profiles of both surfaces; None for a smooth surface."""

    surface_1: Profile | None
    surface_2: Profile | None

    @property
    def sides(self) -> dict[str, Profile]:
        """Profiles of the rough surfaces, "1" and "2"."""
        sides = {"1": self.surface_1, "2": self.surface_2}
        return {name: profile for name, profile in sides.items() if profile}

    def side(self, name: str) -> Profile | None:
        """Profile of surface "1" or "2"."""
        return self.sides.get(name)

    @classmethod
    def of(cls, case: Case, scales: Scales, positions: SurfacePositions | None = None) -> Roughness | None:
        """Roughness of a case; None if both surfaces are smooth.

        `positions`: by default both profiles begin to enter with their first point.
        """
        specs, positions = [case.surface.side(side) for side in ("1", "2")], positions or SurfacePositions()
        if not any(specs):
            return None
        from ehlpetsc.surfaces.profile import (
            Profile,  # with the reading of files not needed by smooth surfaces
        )
        from ehlpetsc.surfaces.samples import samples

        sides = []
        speeds = directed_speeds(case, scales)
        for k, spec in enumerate(specs):
            given = passage(case, scales, speeds[k], k, positions)
            sides.append(spec and Profile(samples(case.path.parent, spec), given))
        return cls(*sides)

    def phi_after(self, x: np.ndarray, travelled: Sequence[float], cell: float | None = None) -> np.ndarray:
        """Contribution of both roughnesses to the gap [m] after distances travelled [m] (surfaces 1, 2).

        `x`: positions [m], with `cell` equally spaced by it, shape (n,).
        `cell`: cell width of the mesh [m] over which means are taken: waves shorter than a cell, which a mesh
            does not resolve, are damped instead of aliased. Without it values at x.
        """
        phi = np.zeros_like(x)
        at = x if cell is None else np.append(x - 0.5 * cell, x[-1] + 0.5 * cell)
        for profile, distance in zip((self.surface_1, self.surface_2), travelled, strict=True):
            if profile is not None:
                heights = profile.height if cell is None else profile.mean_height
                phi -= heights(at - distance)
        return phi

    @property
    def rq(self) -> float:
        """Combined root mean square height [m]."""
        return float(np.linalg.norm([profile.rq for profile in self.sides.values()]))


def passage(case: Case, scales: Scales, speed: float, side: int, positions: SurfacePositions) -> Passage:
    """Passage of surface `side`, 0 or 1, through the domain; `speed`: see :func:`directed_speeds`."""
    from ehlpetsc.surfaces.moving_surface import Passage

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
        positions.profile_offsets[side],
        reach,
        table is not None and table.profile_offsets is not None,
        ahead=outlet - inlet + RAMP_LENGTH * scales.a if starts_rough else 0.0,
    )
