r"""Table of operating conditions at points of time.

Between its points load, radius and speeds are monotone cubics (PCHIP, Fritsch & Carlson 1980): no overshoot,
continuous first derivatives. Distances travelled are their exact integrals.
"""

from typing import NamedTuple

import numpy as np

SAMPLES = 4096  # at least, of a table, for time steps and extremes
END_TOLERANCE = 1e-9  # of the duration: times nearer to its end are the end
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
        signs = [np.sign(u[np.abs(u) > END_TOLERANCE * self.speed.max()]) for u in (self.u1, self.u2)]
        return tuple(int(s[0]) if len(s) and (s == s[0]).all() else 0 for s in signs)

    def swept_length(self):
        r"""Distance covered by the faster surface, :math:`\int\max(|u_1|,|u_2|)dt` [m], repeats included."""
        fine = self.sampled()
        return self.repeat * float(cumulative(fine.speed, fine.time)[-1])

    def reference(self):
        """Conditions of the scales: load and radius of the widest contact, speeds of the fastest entrainment.

        Surfaces that move against each other all the time have no entrainment speed: that of the faster one
        is then the scale.

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


def cumulative(values, time):
    """Integral from the first point to each by the trapezoidal rule."""
    return np.append(0.0, np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(time)))
