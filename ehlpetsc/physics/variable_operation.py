"""Operating conditions that change with time: conditions, displacements and time levels of a table."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ehlpetsc.physics.conditions_table import END_TOLERANCE, ConditionsTable, cumulative
from ehlpetsc.physics.operation import LEVEL, Conditions, ConstantOperation

SPEED_CHANGE = 0.04  # of the largest speed, for a Courant number of 1: largest change in a time step
FEWEST_STEPS = 25  # over a table in which nothing moves for a while, for a Courant number of 1


@dataclass(frozen=True)
class VariableOperation:
    """Load, radius and speeds of a table, see :class:`ehlpetsc.physics.operation.ConstantOperation`.

    Attributes
    ----------
    table : ConditionsTable
    courant : float
        Courant number of the time steps.
    dx : float
        Spacing of the nodes [m].
    modulus : float
        E' [Pa].
    travel : float, optional
        Distance of the faster surface after which the run ends [m]; by default all of the table.
    """

    table: ConditionsTable
    courant: float
    dx: float
    modulus: float
    travel: float | None = None
    varies = True

    @cached_property
    def _cubics(self):
        return self.table.cubics()

    @cached_property
    def _integrals(self):
        return self.table.integrals()

    @property
    def period(self):
        """Length of the table [s]."""
        return float(self.table.time[-1])

    @property
    def is_reversing(self):
        """Whether the entrainment speed changes its sign."""
        u = self.table.sampled().entrainment
        scale = END_TOLERANCE * np.abs(u).max()
        return bool(u.min() < -scale and u.max() > scale)

    def _local(self, time):
        """Repeats completed at a time, and the time since the last one [s]."""
        period = self.period
        done = min(max(int(time // period), 0), self.table.repeat - 1)
        local = min(max(time - done * period, 0.0), period)
        is_at_end = period - local < END_TOLERANCE * period
        if is_at_end and done < self.table.repeat - 1:  # but for rounding the next repeat
            done, local = done + 1, 0.0
        return done, local

    def at(self, time):
        """Conditions at a time [s]; before time 0 those of time 0."""
        local = self._local(time)[1]
        return Conditions(*(float(cubic(local)) for cubic in self._cubics))

    def _position(self, time):
        """Distances that both surfaces have travelled since time 0 [m]; before it at the speeds of time 0."""
        if time < 0.0:
            now = self.at(0.0)
            return now.u1 * time, now.u2 * time
        done, local = self._local(time)
        return tuple(done * float(s(self.period)) + float(s(local)) for s in self._integrals)

    def displacement(self, time, dt):
        """Distances that surfaces 1 and 2 travel from `time` to `time` + `dt` [m], signed."""
        before, after = self._position(time), self._position(time + dt)
        return after[0] - before[0], after[1] - before[1]

    def travelled(self, time):
        """Distances that both surfaces have travelled since time 0 [m], signed."""
        return self._position(time)

    def extent(self):
        """Least and largest displacement of both surfaces over the run [m]: two pairs."""
        return self.table.extent()

    def remaining(self, time, travelled):
        """Time left to the end of the run [s]."""
        left = self.duration - time
        return left if left > END_TOLERANCE * self.duration else 0.0

    @cached_property
    def duration(self):
        """Length of the whole run [s]."""
        whole = self.table.repeat * self.period
        if self.travel is None or self.travel >= self.table.swept_length() * (1.0 - END_TOLERANCE):
            return whole
        fine = self.table.sampled()
        swept = cumulative(fine.speed, fine.time)
        done, left = divmod(self.travel, swept[-1])
        return min(done * self.period + float(np.interp(left, swept, fine.time)), whole)

    @cached_property
    def _levels(self):
        """Time levels of one table [s], 0 and its end among them."""
        fine = self.table.sampled()
        slopes = [cubic(fine.time, 1) for cubic in self._cubics]
        half_width = np.sqrt(8.0 * fine.load * fine.radius / (np.pi * self.modulus))
        cell = self.courant * self.dx
        with np.errstate(over="ignore"):
            rates = [
                fine.speed / cell,  # of steps [1/s]: the faster surface moves by the Courant number
                # so do the edges of the Hertz contact
                0.5 * half_width * np.abs(slopes[0] / fine.load + slopes[1] / fine.radius) / cell,
            ]
            rates += [np.abs(v) / (SPEED_CHANGE * self.courant * fine.speed.max()) for v in slopes[2:]]
        rate = np.maximum.reduce(rates)
        if (rate * self.period < 1.0).any():  # nothing moves for a while
            rate = np.maximum(rate, FEWEST_STEPS / (self.courant * self.period))
        steps = cumulative(rate, fine.time)
        multiple = 4 if self.is_reversing else 1  # strokes alike then have time levels alike
        count = multiple * max(int(np.ceil(steps[-1] * (1.0 - 1e-12) / multiple)), 1)
        return np.interp(np.linspace(0.0, steps[-1], count + 1), steps, fine.time)

    def step_count(self, nominal):
        """Number of time steps of the whole run."""
        return int(np.ceil(self.level(self.duration, nominal) - LEVEL))

    def level(self, time, nominal):
        """Number of time levels passed at a time [s], with its fraction."""
        done, local = self._local(time)
        levels = self._levels
        within = np.interp(local, levels, np.arange(len(levels)))
        return done * (len(levels) - 1) + float(within) + (time / levels[1] if time < 0.0 else 0.0)

    def time_step(self, time, nominal):
        """Length of the time step from the level before `time` to the next one [s]."""
        levels = self._levels
        k = max(int(np.floor(self.level(time, nominal) + LEVEL)), 0) % (len(levels) - 1)
        return float(levels[k + 1] - levels[k])

    def time_left(self, time, nominal):
        """Time to the next level [s], to the end of the run at most."""
        level, step = self.level(time, nominal), self.time_step(time, nominal)
        part = level - np.floor(level + LEVEL)
        left = (1.0 - part) * step if part > LEVEL else step
        end = self.duration - time
        return min(left, end) if end > END_TOLERANCE * self.duration else left


def operation_of(case, scales):
    """Operation of a case: constant, or of its table of conditions.

    Parameters
    ----------
    case : case.loading.Case
    scales : physics.scales.Scales

    Returns
    -------
    ConstantOperation or VariableOperation
    """
    table = case.conditions
    if table is None:
        return ConstantOperation.of(case, scales)
    travel = case.time.travel * scales.a
    if not table.varies:
        conditions = Conditions(*(float(column[0]) for column in table[1:5]))
        return ConstantOperation(conditions, min(travel, table.swept_length()))
    return VariableOperation(table, case.time.courant, scales.dx, scales.E, travel)
