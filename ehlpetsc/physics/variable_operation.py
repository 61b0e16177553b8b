r"""Operating conditions that change with time: their table, displacements and time levels.

Between the points of the table load, radius and speeds are monotone cubics (PCHIP, Fritsch & Carlson 1980):
no overshoot, continuous first derivatives. Distances travelled are their exact integrals.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ehlpetsc.base.counts import COUNT_TOLERANCE, whole_down, whole_up
from ehlpetsc.physics.operation import Conditions

if TYPE_CHECKING:
    from scipy.interpolate import PchipInterpolator

MIN_SAMPLES = 4096  # points at which a table is evaluated for time steps and extremes
TIME_TOLERANCE = 1e-9  # of the duration: times nearer to the end count as the end
MIN_ENTRAINMENT_RATIO = 1e-3  # of the faster surface's speed: smaller entrainment speeds are no scale
SPEED_ROUNDING = 1e-12  # of the maximum speed: less is rest or rolling, where solids have no friction
MAX_SPEED_CHANGE = 0.02  # in a time step, of the maximum speed, for a Courant number of 1
MIN_STEPS = 50  # of a table in which nothing moves for some time, for a Courant number of 1


class ConditionsTable(NamedTuple):
    """Conditions at points of time.

    Attributes
    ----------
    time
        [s], increasing from 0 on, shape (n,).
    load, radius, u1, u2
        [N/m], of a point contact [N], [m] along the direction of motion, [m/s], [m/s], shape (n,).
    repeat
        Number of repetitions of the table.
    profile_offsets
        Abscissas of both profiles at x = 0 at time 0 [m]; the profiles then extend over the whole contact
        from the beginning, as tooth flanks do. None: profiles enter at the inlet.
    """

    time: np.ndarray
    load: np.ndarray
    radius: np.ndarray
    u1: np.ndarray
    u2: np.ndarray
    repeat: int = 1
    profile_offsets: tuple | None = None

    @property
    def varies(self) -> bool:
        """Whether a condition changes with time."""
        return any(np.ptp(column) > 0.0 for column in self[1:5])

    @property
    def speed(self) -> np.ndarray:
        """Speed of the faster surface [m/s]."""
        return np.maximum(np.abs(self.u1), np.abs(self.u2))

    @property
    def entrainment(self) -> np.ndarray:
        """Entrainment speed [m/s]."""
        return 0.5 * (self.u1 + self.u2)

    @property
    def step_speed(self) -> np.ndarray:
        """Speed by which time steps count [m/s], as :attr:`.operation.Conditions.step_speed`."""
        return np.maximum(np.abs(self.entrainment), 0.5 * np.abs(self.u1 - self.u2))

    def sampled(self) -> ConditionsTable:
        """Same conditions at `MIN_SAMPLES` points or more, including the points of the table."""
        per_interval = -(-MIN_SAMPLES // (len(self.time) - 1))
        fractions = np.arange(per_interval) / per_interval
        time = (self.time[:-1, None] + np.diff(self.time)[:, None] * fractions).ravel()
        time = np.append(time, self.time[-1])
        values = [cubic(time) for cubic in self.cubics()]
        return self._replace(time=time, load=values[0], radius=values[1], u1=values[2], u2=values[3])

    @property
    def is_periodic(self) -> bool:
        """Whether a repeated table has the same values at both ends; its cubics are then periodic."""
        return self.repeat > 1 and all(column[0] == column[-1] for column in self[1:5])

    def cubics(self) -> list[PchipInterpolator]:
        """Monotone cubics of load, radius, u1 and u2."""
        from scipy.interpolate import PchipInterpolator

        time, columns = self.time, list(self[1:5])
        if self.is_periodic:  # one interval more on either side
            time = np.concatenate([[time[-2] - time[-1]], time, [time[-1] + time[1]]])
            columns = [np.concatenate([v[-2:-1], v, v[1:2]]) for v in columns]
        return [PchipInterpolator(time, v) for v in columns]

    def integrals(self) -> list:
        """Integrals of u1 and u2 over time, 0 at time 0."""
        integrals = [cubic.antiderivative() for cubic in self.cubics()[2:]]
        for integral in integrals:
            integral.c[-1] -= integral(0.0)
        return integrals

    def extent(self) -> tuple[tuple[float, float], ...]:
        """Minimum and maximum displacement of each body over all repetitions [m]: two pairs."""
        extents = []
        for integral in self.integrals():
            displacement = integral(self.sampled().time)
            total = (self.repeat - 1) * displacement[-1]
            low, high = displacement.min() + min(total, 0.0), displacement.max() + max(total, 0.0)
            extents.append((float(low), float(high)))
        return tuple(extents)

    def directions(self) -> tuple[int, ...]:
        """Direction of each body's motion: 1, -1, or 0 if it reverses or rests."""
        signs = [np.sign(u[np.abs(u) > TIME_TOLERANCE * self.speed.max()]) for u in (self.u1, self.u2)]
        return tuple(int(s[0]) if len(s) and (s == s[0]).all() else 0 for s in signs)

    def swept_length(self) -> float:
        r"""Distance of the faster surface, :math:`\int\max(|u_1|,|u_2|)dt` [m], over all repetitions."""
        fine = self.sampled()
        return self.repeat * float(cumulative(fine.speed, fine.time)[-1])

    def reference(self) -> tuple[float, float, float, float]:
        """Conditions of the scales: load and radius of the widest contact, speeds of the fastest entrainment.

        Surfaces in counter-motion have no entrainment speed; the speed of the faster surface is then the
        scale.

        Returns
        -------
        load, radius, entrainment_speed, slide_roll_ratio : float
        """
        fine = self.sampled()
        widest = int(np.argmax(fine.load * fine.radius))
        fastest = int(np.argmax(np.abs(fine.entrainment)))
        u, sliding = fine.entrainment[fastest], fine.u1[fastest] - fine.u2[fastest]
        if abs(u) < MIN_ENTRAINMENT_RATIO * fine.speed.max():
            u, sliding = fine.speed.max(), 0.0
        return float(fine.load[widest]), float(fine.radius[widest]), float(abs(u)), float(sliding / u)


def cumulative(values: np.ndarray, time: np.ndarray) -> np.ndarray:
    """Integral from the first point to each point by the trapezoidal rule."""
    return np.append(0.0, np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(time)))


@dataclass(frozen=True)
class VariableOperation:
    """Load, radius and speeds of a table, see :class:`ehlpetsc.physics.operation.ConstantOperation`.

    Attributes
    ----------
    courant
        Courant number of a step between two time levels.
    dx
        Spacing of the nodes [m].
    half_width
        Half-width of the dry contact [m] of arrays of load and radius.
    growth
        Exponent of load times radius in its square.
    travel
        Distance of the faster surface at the end of the run [m]; by default that of the whole table.
    """

    table: ConditionsTable
    courant: float
    dx: float
    half_width: Callable[[np.ndarray, np.ndarray], np.ndarray]
    growth: float
    travel: float | None = None
    varies = True

    @cached_property
    def _cubics(self) -> list:
        return self.table.cubics()

    @cached_property
    def _integrals(self) -> list:
        return self.table.integrals()

    @cached_property
    def _fastest(self) -> float:
        """Maximum speed of either surface [m/s]."""
        return float(self.table.speed.max())

    @property
    def period(self) -> float:
        """Length of the table [s]."""
        return float(self.table.time[-1])

    @property
    def is_reversing(self) -> bool:
        """Whether the entrainment speed changes its sign."""
        u = self.table.sampled().entrainment
        scale = TIME_TOLERANCE * np.abs(u).max()
        return bool(u.min() < -scale and u.max() > scale)

    def _local(self, time: float) -> tuple[int, float]:
        """Repetitions completed at a time, and the time since the last one [s]."""
        period = self.period
        done = min(max(int(time // period), 0), self.table.repeat - 1)
        local = min(max(time - done * period, 0.0), period)
        is_at_end = period - local < TIME_TOLERANCE * period
        if is_at_end and done < self.table.repeat - 1:  # the next repetition, except for rounding
            done, local = done + 1, 0.0
        return done, local

    def at(self, time: float) -> Conditions:
        """Conditions at a time [s]; before time 0 the conditions at time 0."""
        local = self._local(time)[1]
        load, radius, u1, u2 = (float(cubic(local)) for cubic in self._cubics)
        rounding = SPEED_ROUNDING * self._fastest
        u1, u2 = (0.0 if abs(u) < rounding else u for u in (u1, u2))
        return Conditions(load, radius, u1, u1 if abs(u1 - u2) < rounding else u2)

    def travelled(self, time: float) -> tuple[float, ...]:
        """Distances that both surfaces have travelled since time 0 [m]; before it at the speeds of time 0."""
        if time < 0.0:
            now = self.at(0.0)
            return now.u1 * time, now.u2 * time
        done, local = self._local(time)
        return tuple(done * float(s(self.period)) + float(s(local)) for s in self._integrals)

    def displacement(self, time: float, dt: float) -> tuple[float, float]:
        """Distances that surfaces 1 and 2 travel from `time` to `time` + `dt` [m], signed."""
        before, after = self.travelled(time), self.travelled(time + dt)
        return after[0] - before[0], after[1] - before[1]

    def extent(self) -> tuple[tuple[float, float], ...] | None:
        """Minimum and maximum displacement of both surfaces over the run [m]: two pairs."""
        return self.table.extent()

    def remaining(self, time: float, travelled: tuple[float, float]) -> float:
        """Time to the end of the run [s]."""
        left = self.duration - time
        return left if left > TIME_TOLERANCE * self.duration else 0.0

    @cached_property
    def duration(self) -> float:
        """Length of the whole run [s]."""
        table_duration = self.table.repeat * self.period
        if self.travel is None or self.travel >= self.table.swept_length() * (1.0 - TIME_TOLERANCE):
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
        half_width = self.half_width(fine.load, fine.radius)
        cell = self.courant * self.dx
        with np.errstate(over="ignore"):
            widening = np.abs(slopes[0] / fine.load + slopes[1] / fine.radius)
            # steps per second: film and edges of the Hertz contact move by the Courant number a step
            rates = [fine.step_speed / cell, 0.5 * self.growth * half_width * widening / cell]
            rates += [np.abs(v) / (MAX_SPEED_CHANGE * self.courant * fine.speed.max()) for v in slopes[2:]]
        rate = np.maximum.reduce(rates)
        if (rate * self.period < 1.0).any():  # nothing moves for some time
            rate = np.maximum(rate, MIN_STEPS / (self.courant * self.period))
        steps = cumulative(rate, fine.time)
        multiple = 4 if self.is_reversing else 1  # equal time levels in both strokes
        count = multiple * max(whole_up(steps[-1] / multiple), 1)
        if self.is_reversing or self.table.repeat > 1:
            return np.interp(np.linspace(0.0, steps[-1], count + 1), steps, fine.time)
        # whole nodes a step, except for the last one
        return np.interp(np.append(np.arange(count), steps[-1]), steps, fine.time)

    def step_count(self, nominal: float) -> int:
        """Number of time steps of the whole run."""
        return whole_up(self.level(self.duration, nominal))

    def level(self, time: float, nominal: float) -> float:
        """Number of time levels at a time [s], with a fraction between two levels."""
        done, local = self._local(time)
        levels = self._levels
        within = np.interp(local, levels, np.arange(len(levels)))
        return done * (len(levels) - 1) + float(within) + (time / levels[1] if time < 0.0 else 0.0)

    def time_step(self, time: float, nominal: float) -> float:
        """Length of the time step from the level before `time` to the next one [s]."""
        levels = self._levels
        k = max(whole_down(self.level(time, nominal)), 0) % (len(levels) - 1)
        return float(levels[k + 1] - levels[k])

    def time_over(self, time: float, levels: int) -> float:
        """Time over some time levels, at most to the level behind the next line of the table [s]."""
        done, local = self._local(time)
        begin = self.level(time, 0.0) - done * (len(self._levels) - 1)
        next_line = self.table.time[
            np.searchsorted(self.table.time, local * (1.0 + TIME_TOLERANCE), "right") :
        ]
        line = (
            np.interp(next_line[0], self._levels, np.arange(len(self._levels))) if len(next_line) else np.inf
        )
        end = min(whole_down(begin) + levels, whole_up(line), len(self._levels) - 1)
        return min(float(self._levels[end]) - local, self.duration - time)

    def time_left(self, time: float, nominal: float) -> float:
        """Time to the next time level or to the end of the run, whichever is nearer [s]."""
        level, step = self.level(time, nominal), self.time_step(time, nominal)
        fraction = level - whole_down(level)
        left = (1.0 - fraction) * step if fraction > COUNT_TOLERANCE else step
        end = self.duration - time
        return min(left, end) if end > TIME_TOLERANCE * self.duration else left
