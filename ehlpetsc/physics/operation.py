r"""Operating conditions as functions of time: load, radius of relative curvature and both surface speeds.

:class:`~ehlpetsc.physics.scales.Scales` makes the problem dimensionless with the conditions of a reference
state; the conditions at an instant are defined here.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from ehlpetsc.base.counts import COUNT_TOLERANCE, whole_up


class Conditions(NamedTuple):
    """Operating conditions at one instant.

    Attributes
    ----------
    load
        [N/m], of a point contact [N].
    radius
        Radius of relative curvature R along the direction of motion [m]; that across is in proportion.
    u1, u2
        Speeds of surfaces 1 and 2 [m/s], signed.
    """

    load: float
    radius: float
    u1: float
    u2: float

    @property
    def entrainment(self) -> float:
        """Entrainment speed (u1 + u2)/2 [m/s]."""
        return 0.5 * (self.u1 + self.u2)

    @property
    def sliding(self) -> float:
        """Sliding speed u1 - u2 [m/s]."""
        return self.u1 - self.u2

    @property
    def step_speed(self) -> float:
        """Speed by which time steps count [m/s]: of the film, or of either surface past it."""
        return max(abs(self.entrainment), 0.5 * abs(self.sliding))


@dataclass(frozen=True)
class ConstantOperation:
    """Constant conditions until the faster surface has covered the travel of the case.

    Attributes
    ----------
    travel
        Distance covered by the faster surface over the run [m]; None: steady.
    """

    conditions: Conditions
    travel: float | None = None
    varies = False

    def at(self, time: float) -> Conditions:
        """Conditions at a time [s]."""
        return self.conditions

    def displacement(self, time: float, dt: float) -> tuple[float, float]:
        """Distances that surfaces 1 and 2 travel from `time` to `time` + `dt` [m], signed."""
        return self.conditions.u1 * dt, self.conditions.u2 * dt

    def travelled(self, time: float) -> tuple[float, float]:
        """Distances that both surfaces have travelled since time 0 [m], signed."""
        return self.displacement(0.0, time)

    def remaining(self, time: float, travelled: tuple[float, float]) -> float:
        """Time to the end of the run [s].

        Parameters
        ----------
        time
            Current time [s].
        travelled
            Distances travelled by both surfaces [m]; after a restart at other speeds they differ from
            :meth:`travelled`.
        """
        fastest = max(abs(self.conditions.u1), abs(self.conditions.u2))
        distance = self.travel - max(map(abs, travelled))
        return max(distance, 0.0) / fastest if distance > 1e-9 * self.travel else 0.0

    def extent(self) -> tuple[tuple[float, float], ...] | None:
        """Minimum and maximum displacement of both surfaces over the run [m]: two pairs."""
        duration = 0.0 if self.travel is None else self.duration
        ends = self.conditions.u1 * duration, self.conditions.u2 * duration
        return tuple((min(end, 0.0), max(end, 0.0)) for end in ends)

    @property
    def duration(self) -> float:
        """Length of the whole run [s]; None: steady."""
        fastest = max(abs(self.conditions.u1), abs(self.conditions.u2))
        return None if self.travel is None else self.travel / fastest

    def time_step(self, time: float, nominal: float) -> float:
        """Length of the time step that contains `time` [s]; `nominal`: of the reference state."""
        return nominal

    def time_left(self, time: float, nominal: float) -> float:
        """Time to the next time level [s]."""
        left = nominal - time % nominal
        return left + nominal if left < COUNT_TOLERANCE * nominal else left

    def level(self, time: float, nominal: float) -> float:
        """Number of time levels at a time [s], with a fraction between two levels."""
        return time / nominal

    def step_count(self, nominal: float) -> int:
        """Number of time steps of the whole run."""
        return whole_up(self.duration / nominal)
