"""Operating conditions that change with time: conditions, displacements and time levels of a table."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ehlpetsc.physics.conditions_table import END_TOLERANCE, ConditionsTable, cumulative
from ehlpetsc.physics.operation import LEVEL_TOLERANCE, Conditions

MAX_SPEED_CHANGE = 0.04  # in a time step, of the largest speed, for a Courant number of 1
MIN_STEPS = 25  # of a table in which nothing moves for some time, for a Courant number of 1


@dataclass(frozen=True)
class VariableOperation:
    """Load, radius and speeds of a table, see :class:`ehlpetsc.physics.operation.ConstantOperation`.

    Attributes
    ----------
    courant
        Courant number of the time steps.
    dx
        Spacing of the nodes [m].
    modulus
        E' [Pa].
    travel
        Distance of the faster surface at the end of the run [m]; by default that of the whole table.
    """

    table: ConditionsTable
    courant: float
    dx: float
    modulus: float
    travel: float | None = None
    varies = True

    @cached_property
    def _cubics(self) -> list:
        return self.table.cubics()

    @cached_property
    def _integrals(self) -> list:
        return self.table.integrals()

    @property
    def period(self) -> float:
        """Length of the table [s]."""
        return float(self.table.time[-1])

    @property
    def is_reversing(self) -> bool:
        """Whether the entrainment speed changes its sign."""
        u = self.table.sampled().entrainment
        scale = END_TOLERANCE * np.abs(u).max()
        return bool(u.min() < -scale and u.max() > scale)

    def _local(self, time: float) -> tuple[int, float]:
        """Repetitions completed at a time, and the time since the last one [s]."""
        period = self.period
        done = min(max(int(time // period), 0), self.table.repeat - 1)
        local = min(max(time - done * period, 0.0), period)
        is_at_end = period - local < END_TOLERANCE * period
        if is_at_end and done < self.table.repeat - 1:  # the next repetition, except for rounding
            done, local = done + 1, 0.0
        return done, local

    def at(self, time: float) -> Conditions:
        """Conditions at a time [s]; before time 0 the conditions at time 0."""
        local = self._local(time)[1]
        return Conditions(*(float(cubic(local)) for cubic in self._cubics))

    def _position(self, time: float) -> tuple[float, ...]:
        """Distances that both surfaces have travelled since time 0 [m]; before it at the speeds of time 0."""
        if time < 0.0:
            now = self.at(0.0)
            return now.u1 * time, now.u2 * time
        done, local = self._local(time)
        return tuple(done * float(s(self.period)) + float(s(local)) for s in self._integrals)

    def displacement(self, time: float, dt: float) -> tuple[float, float]:
        """Distances that surfaces 1 and 2 travel from `time` to `time` + `dt` [m], signed."""
        before, after = self._position(time), self._position(time + dt)
        return after[0] - before[0], after[1] - before[1]

    def travelled(self, time: float) -> tuple[float, float]:
        """Distances that both surfaces have travelled since time 0 [m], signed."""
        first, second = self._position(time)
        return first, second

    def extent(self) -> tuple[tuple[float, float], ...] | None:
        """Minimum and maximum displacement of both surfaces over the run [m]: two pairs."""
        return self.table.extent()

    def remaining(self, time: float, travelled: tuple[float, float]) -> float:
        """Time to the end of the run [s]."""
        left = self.duration - time
        return left if left > END_TOLERANCE * self.duration else 0.0

    @cached_property
    def duration(self) -> float:
        """Length of the whole run [s]."""
        table_duration = self.table.repeat * self.period
        if self.travel is None or self.travel >= self.table.swept_length() * (1.0 - END_TOLERANCE):
            return table_duration
        fine = self.table.sampled()
        swept = cumulative(fine.speed, fine.time)
        repetitions, distance = divmod(self.travel, swept[-1])
        return min(repetitions * self.period + float(np.interp(distance, swept, fine.time)), table_duration)

    @cached_property
    def _levels(self) -> np.ndarray:
        """Time levels of one repetition of the table [s], 0 and its end included."""
        fine = self.table.sampled()
        slopes = [cubic(fine.time, 1) for cubic in self._cubics]
        half_width = np.sqrt(8.0 * fine.load * fine.radius / (np.pi * self.modulus))
        cell = self.courant * self.dx
        with np.errstate(over="ignore"):
            rates = [
                fine.speed / cell,  # steps per second: the faster surface moves by the Courant number a step
                # and so do the edges of the Hertz contact
                0.5 * half_width * np.abs(slopes[0] / fine.load + slopes[1] / fine.radius) / cell,
            ]
            rates += [np.abs(v) / (MAX_SPEED_CHANGE * self.courant * fine.speed.max()) for v in slopes[2:]]
        rate = np.maximum.reduce(rates)
        if (rate * self.period < 1.0).any():  # nothing moves for some time
            rate = np.maximum(rate, MIN_STEPS / (self.courant * self.period))
        steps = cumulative(rate, fine.time)
        multiple = 4 if self.is_reversing else 1  # equal time levels in both strokes
        count = multiple * max(int(np.ceil(steps[-1] * (1.0 - 1e-12) / multiple)), 1)
        return np.interp(np.linspace(0.0, steps[-1], count + 1), steps, fine.time)

    def step_count(self, nominal: float) -> int:
        """Number of time steps of the whole run."""
        return int(np.ceil(self.level(self.duration, nominal) - LEVEL_TOLERANCE))

    def level(self, time: float, nominal: float) -> float:
        """Number of time levels at a time [s], with a fraction between two levels."""
        done, local = self._local(time)
        levels = self._levels
        within = np.interp(local, levels, np.arange(len(levels)))
        return done * (len(levels) - 1) + float(within) + (time / levels[1] if time < 0.0 else 0.0)

    def time_step(self, time: float, nominal: float) -> float:
        """Length of the time step from the level before `time` to the next one [s]."""
        levels = self._levels
        k = max(int(np.floor(self.level(time, nominal) + LEVEL_TOLERANCE)), 0) % (len(levels) - 1)
        return float(levels[k + 1] - levels[k])

    def time_left(self, time: float, nominal: float) -> float:
        """Time to the next time level or to the end of the run, whichever is nearer [s]."""
        level, step = self.level(time, nominal), self.time_step(time, nominal)
        fraction = level - np.floor(level + LEVEL_TOLERANCE)
        left = (1.0 - fraction) * step if fraction > LEVEL_TOLERANCE else step
        end = self.duration - time
        return min(left, end) if end > END_TOLERANCE * self.duration else left
