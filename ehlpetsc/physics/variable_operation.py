r"""Operating conditions that change with time, from a table.

Between the points of the table load, radius and speeds are monotone cubics (PCHIP, Fritsch & Carlson 1980):
no overshoot, continuous first derivatives. Distances travelled are their exact integrals.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from ehlpetsc.physics.operation import LEVEL, Conditions, ConstantOperation

SPEED_CHANGE = 0.04  # of the largest speed, for a Courant number of 1: largest change in a time step
FEWEST_STEPS = 25  # over a table in which nothing moves for a while, for a Courant number of 1
SAMPLES = 4096  # at least, of a table, for time steps and extremes
END = 1e-9  # of the duration: times nearer to its end are the end
COUNTERMOTION = 1e-3  # of the surface speeds: an entrainment speed that is nowhere larger is no scale


class ConditionsTable(NamedTuple):
    """Conditions at points of time.

    Attributes
    ----------
    time : ndarray, shape (n,)
        [s], increasing from 0 on.
    load, radius, u1, u2 : ndarray, shape (n,)
        [N/m], [m], [m/s], [m/s].
    repeat : int
        Number of times that the table is run through.
    profile_offsets : (float, float), optional
        Abscissas of both profiles that are at x = 0 at time 0 [m]: they lie under the whole contact from then
        on, as flanks of teeth do. None: they enter at the inlet.
    """

    time: np.ndarray
    load: np.ndarray
    radius: np.ndarray
    u1: np.ndarray
    u2: np.ndarray
    repeat: int = 1
    profile_offsets: tuple | None = None

    @property
    def varies(self):
        """Whether a condition changes with time."""
        return any(np.ptp(column) > 0.0 for column in self[1:5])

    @property
    def speed(self):
        """Speed of the faster surface [m/s]."""
        return np.maximum(np.abs(self.u1), np.abs(self.u2))

    @property
    def entrainment(self):
        """Mean speed [m/s]."""
        return 0.5 * (self.u1 + self.u2)

    def sampled(self):
        """The same conditions at `SAMPLES` points or more, those of the table among them."""
        per_interval = -(-SAMPLES // (len(self.time) - 1))
        parts = np.arange(per_interval) / per_interval
        time = (self.time[:-1, None] + np.diff(self.time)[:, None] * parts).ravel()
        time = np.append(time, self.time[-1])
        values = [cubic(time) for cubic in self.cubics()]
        return self._replace(time=time, load=values[0], radius=values[1], u1=values[2], u2=values[3])

    @property
    def is_periodic(self):
        """Whether a repeated table ends as it begins: its slopes then are those of a periodic one."""
        return self.repeat > 1 and all(column[0] == column[-1] for column in self[1:5])

    def cubics(self):
        """Monotone cubics of load, radius, u1 and u2."""
        from scipy.interpolate import PchipInterpolator

        time, columns = self.time, self[1:5]
        if self.is_periodic:  # one interval more on either side
            time = np.concatenate([[time[-2] - time[-1]], time, [time[-1] + time[1]]])
            columns = [np.concatenate([v[-2:-1], v, v[1:2]]) for v in columns]
        return [PchipInterpolator(time, v) for v in columns]

    def integrals(self):
        """Integrals of u1 and u2 over time, 0 at time 0."""
        found = [cubic.antiderivative() for cubic in self.cubics()[2:]]
        for integral in found:
            integral.c[-1] -= integral(0.0)
        return found

    def extent(self):
        """Least and largest displacement of each body over all repeats [m]: two pairs."""
        found = []
        for integral in self.integrals():
            way = integral(self.sampled().time)
            total = (self.repeat - 1) * way[-1]
            found.append((float(way.min() + min(total, 0.0)), float(way.max() + max(total, 0.0))))
        return tuple(found)

    def directions(self):
        """Direction of each body's motion: 1, -1, or 0 where it reverses or rests."""
        signs = [np.sign(u[np.abs(u) > END * self.speed.max()]) for u in (self.u1, self.u2)]
        return tuple(int(s[0]) if len(s) and (s == s[0]).all() else 0 for s in signs)

    def swept_length(self):
        r"""Distance covered by the faster surface, :math:`\int\max(|u_1|,|u_2|)dt` [m], repeats included."""
        fine = self.sampled()
        return self.repeat * float(_cumulative(fine.speed, fine.time)[-1])

    def reference(self):
        """Conditions of the scales: load and radius of the widest contact, speeds of the fastest entrainment.

        Surfaces that move against each other all the time have no entrainment speed: the faster one's stands
        for it.

        Returns
        -------
        load, radius, entrainment_speed, slide_roll_ratio : float
        """
        fine = self.sampled()
        widest = int(np.argmax(fine.load * fine.radius))
        fastest = int(np.argmax(np.abs(fine.entrainment)))
        u, sliding = fine.entrainment[fastest], fine.u1[fastest] - fine.u2[fastest]
        if abs(u) < COUNTERMOTION * fine.speed.max():
            u, sliding = fine.speed.max(), 0.0
        return float(fine.load[widest]), float(fine.radius[widest]), float(abs(u)), float(sliding / u)


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
        scale = END * np.abs(u).max()
        return bool(u.min() < -scale and u.max() > scale)

    def _local(self, time):
        """Repeats completed at a time, and the time since the last one [s]."""
        period = self.period
        done = min(max(int(time // period), 0), self.table.repeat - 1)
        local = min(max(time - done * period, 0.0), period)
        if period - local < END * period and done < self.table.repeat - 1:  # but for rounding the next one
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
        return left if left > END * self.duration else 0.0

    @cached_property
    def duration(self):
        """Length of the whole run [s]."""
        whole = self.table.repeat * self.period
        if self.travel is None or self.travel >= self.table.swept_length() * (1.0 - END):
            return whole
        fine = self.table.sampled()
        swept = _cumulative(fine.speed, fine.time)
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
        steps = _cumulative(rate, fine.time)
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
        return min(left, end) if end > END * self.duration else left


def _cumulative(values, time):
    """Integral from the first point to each by the trapezoidal rule."""
    return np.append(0.0, np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(time)))


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
