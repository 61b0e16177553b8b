"""Motion of surfaces through the domain: positions at time 0, abscissas of heights at points of the body."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from ehlpetsc.base.case import Case
    from ehlpetsc.physics.scales import Scales

RAMP_LENGTH = 0.1  # half-widths at the beginning of a profile over which its heights increase from zero
WAVE_NODES = 4  # nodes per wavelength below which a wave is not resolved
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


class MovingSurface:
    r"""Surface that moves with its body.

    Body point s is at :math:`x=s+Ut`. Its abscissa in the profile is

    * U > 0: :math:`X=x_\mathrm{inlet}-s`, so that the profile enters at the inlet from time 0 on;
    * U < 0: :math:`X=s-x_\mathrm{outlet}`, so that it enters at the outlet;
    * U = 0, or a steady case: :math:`X=s-x_\mathrm{inlet}`, in the whole domain from the start.

    A moving surface is smooth where X < 0; its heights increase over the ramp as
    :math:`r^3(10-15r+6r^2)`, so that film and its rate of change have no jump.

    `is_moving`: false if its abscissa is fixed to the domain at time 0, without a ramp.
    `enters`: whether it enters during the run; otherwise it is in the whole domain from the start.
    `ramp`, `travelled`: length of the ramp, and of the part of the profile that enters [m].
    `body_offset`: signed shift of the body points s by the abscissa at which the profile begins [m].
    """

    def __init__(self, passage: Passage) -> None:
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

    def entered(self, s: np.ndarray) -> np.ndarray:
        """Ramp factor of the heights at body points s [m]: 0 ahead of the profile."""
        return self._entry_factor(self._sign * (s - self._origin))

    def _entry_factor(self, X: np.ndarray) -> np.ndarray:
        """Factor on the heights, 0 where X < 0, 1 beyond the ramp."""
        r = np.clip(X / self.ramp, 0.0, 1.0)
        return r * r * r * (10.0 - r * (15.0 - 6.0 * r))

    def _points(self, step: float) -> np.ndarray:
        """Body points [m] that enter during the run, at least two, `step` [m] apart."""
        length = self._ends[1] - self._ends[0] if self._ends else self.travelled * (1 + 1e-12)
        X = np.arange(min(max(int(length / step) + 1, 2), MAX_SAMPLES)) * step
        return self._ends[0] + X if self._ends else np.sort(self._origin + self._sign * X)


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
