r"""Table of operating conditions at points of time.

Between the points load, radius and speeds are monotone cubics (PCHIP, Fritsch & Carlson 1980): no overshoot,
continuous first derivatives. Distances travelled are their exact integrals.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from scipy.interpolate import PchipInterpolator


MIN_SAMPLES = 4096  # points at which a table is evaluated for time steps and extremes
END_TOLERANCE = 1e-9  # of the duration: times nearer to the end count as the end
MIN_ENTRAINMENT_RATIO = 1e-3  # of the faster surface's speed: smaller entrainment speeds are no scale


class ConditionsTable(NamedTuple):
    """Conditions at points of time.

    Attributes
    ----------
    time
        [s], increasing from 0 on, shape (n,).
    load, radius, u1, u2
        [N/m], [m], [m/s], [m/s], shape (n,).
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
        signs = [np.sign(u[np.abs(u) > END_TOLERANCE * self.speed.max()]) for u in (self.u1, self.u2)]
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
