"""Heights of one surface: a spline that moves with the body."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from scipy.interpolate import PPoly

    from ehlpetsc.surfaces.samples import Samples

WAVE_NODES = 4  # nodes per wavelength below which a wave is not resolved
MAX_SAMPLES = 5_000_000  # of a stored profile


class Profile:
    r"""Heights of one surface.

    Body point s is at :math:`x=s+Ut`. Its abscissa in the profile is

    * U > 0: :math:`X=x_\mathrm{inlet}-s`, so that the profile enters at the inlet from time 0 on;
    * U < 0: :math:`X=s-x_\mathrm{outlet}`, so that it enters at the outlet;
    * U = 0, or a steady case: :math:`X=s-x_\mathrm{inlet}`, in the whole domain from the start.

    A moving surface is smooth where X < 0; its heights increase over the ramp as
    :math:`r^3(10-15r+6r^2)`, so that film and its rate of change have no jump. With `ahead` the profile has
    entered by this length at time 0.

    `speed`: U [m/s].
    `moving`: false in a steady case.
    `inlet`, `outlet`, `ramp`, `swept_length`: ends of the domain, length of the ramp and of the profile that
        enters during the run [m].
    `begin`: abscissa at which the profile begins, instead of 0 [m].
    `reach`: minimum and maximum displacement of a body whose profile is in the whole domain from the start
        [m].
    `is_flank`: whether this profile begins at x = 0 at time 0, :math:`X=-s`, as the arc length of a flank.

    `is_moving`: false if its abscissa is fixed to the domain at time 0, without a ramp.
    `enters`: whether it enters during the run; otherwise it is in the whole domain from the start.
    `ramp`, `travelled`: length of the ramp, and of the part of the profile that enters [m].
    `body_offset`: signed shift of the body points s by `begin` [m].
    `ra`, `rq`, `rsk`: parameters of the samples: m, m, 1.
    """

    def __init__(
        self,
        samples: Samples,
        speed: float,
        moving: bool,
        inlet: float,
        outlet: float,
        ramp: float,
        swept_length: float,
        begin: float = 0.0,
        reach: tuple[float, float] | None = None,
        is_flank: bool = False,
        ahead: float = 0.0,
    ) -> None:
        from scipy.interpolate import CubicSpline

        X, z, self.repeats, self.speed = samples.X, samples.z, samples.repeats, speed
        self.given, self.X, self.heights = samples, X, z
        self.is_moving = moving and speed != 0.0 and not is_flank
        self.enters = self.is_moving and not ahead
        self._origin, self._sign = (inlet + ahead, -1.0) if speed > 0 else (outlet - ahead, 1.0)
        if not self.is_moving:
            self._origin, self._sign = (0.0, -1.0) if is_flank else (inlet, 1.0)
        self._begin, self.body_offset = begin, self._sign * begin
        self.ramp = ramp
        self.travelled = swept_length + ahead if self.is_moving else outlet - inlet
        self._ends = None if self.is_moving or reach is None else (inlet - reach[1], outlet - reach[0])
        # level ends: mirrored end to end, the profile has no kink
        self._spline = CubicSpline(X, z, bc_type="clamped")
        deviation = z - z.mean()
        self.ra, self.rq = float(np.abs(deviation).mean()), float(np.sqrt((deviation**2).mean()))
        self.rsk = float(((deviation / self.rq) ** 3).mean()) if self.rq > 0 else 0.0

    def height(self, s: np.ndarray) -> np.ndarray:
        """Heights [m] at body points s [m]."""
        X = self._sign * (s - self._origin)
        if not self.is_moving:
            return self._at(X + self._begin)
        return self._entry_factor(X) * self._at(np.maximum(X, 0.0) + self._begin)

    def mean_height(self, faces: np.ndarray) -> np.ndarray:
        r"""Mean height [m] of each cell between faces at body points s [m].

        :math:`\frac{1}{s_{i+1}-s_i}\int_{s_i}^{s_{i+1}}z\,ds`, the integral of the spline, also across its
        mirrored continuation. The ramp is evaluated at the centre of the cell.

        `faces`: shape (n + 1,).
        """
        X = self._sign * (faces - self._origin)
        mean = self._level + np.diff(self._integral(X + self._begin)) / np.diff(X)
        return self._entry_factor(0.5 * (X[1:] + X[:-1])) * mean if self.is_moving else mean

    def entered(self, s: np.ndarray) -> np.ndarray:
        """Ramp factor of the heights at body points s [m]: 0 ahead of the profile."""
        return self._entry_factor(self._sign * (s - self._origin))

    def _entry_factor(self, X: np.ndarray) -> np.ndarray:
        """Factor on the heights, 0 where X < 0, 1 beyond the ramp."""
        r = np.clip(X / self.ramp, 0.0, 1.0)
        return r * r * r * (10.0 - r * (15.0 - 6.0 * r))

    def _at(self, X: np.ndarray) -> np.ndarray:
        first, last = self.X[0], self.X[-1]
        if self.repeats:
            length = last - first
            return self._spline(last - np.abs(length - np.mod(X - first, 2.0 * length)))
        inside = (X >= first) & (X <= last)
        return np.where(inside, self._spline(np.clip(X, first, last)), 0.0)

    def _integral(self, X: np.ndarray) -> np.ndarray:
        """Integral [m^2] of height minus `_level` up to X.

        Mirrored heights minus their mean have the integral 0 over a profile, so that the integral is periodic
        too and loses no digits over long distances.
        """
        first, last = self.X[0], self.X[-1]
        if not self.repeats:
            return self._antiderivative(np.clip(X, first, last))
        length = last - first
        beyond = length - np.mod(X - first, 2.0 * length)  # negative: on the way back
        return np.sign(beyond) * self._antiderivative(last - np.abs(beyond))

    @cached_property
    def _level(self) -> float:
        """Mean height of a mirrored profile [m]; 0 if the heights are 0 beyond the samples."""
        first, last = self.X[0], self.X[-1]
        return self._spline.integrate(first, last) / (last - first) if self.repeats else 0.0

    @cached_property
    def _antiderivative(self) -> PPoly:
        from scipy.interpolate import PPoly

        deviation = self._spline.c.copy()
        deviation[-1] -= self._level
        return PPoly(deviation, self._spline.x).antiderivative()

    @cached_property
    def s(self) -> np.ndarray:
        """Body points [m] that enter during the run, at least two, with the spacing of the samples."""
        step = np.diff(self.X).mean()
        length = self._ends[1] - self._ends[0] if self._ends else self.travelled * (1 + 1e-12)
        X = np.arange(min(max(int(length / step) + 1, 2), MAX_SAMPLES)) * step
        return self._ends[0] + X if self._ends else np.sort(self._origin + self._sign * X)

    @cached_property
    def z(self) -> np.ndarray:
        """Heights [m] at `s`, ramp included."""
        return self.height(self.s)

    def unresolved_variance(self, dx: float) -> float:
        """Fraction of the height variance in wavelengths below `WAVE_NODES` spacings dx [m]."""
        n = min(max(self.X.size, 16), 1 << 17)
        x = np.linspace(self.X[0], self.X[-1], n)
        z = self._spline(x)
        z = np.concatenate([z, z[-2:0:-1]])  # mirrored: no jump, hence no leakage in the spectrum
        power = np.abs(np.fft.rfft(z)) ** 2
        power[0] = 0.0
        total = power.sum()
        short = np.fft.rfftfreq(z.size, x[1] - x[0]) * WAVE_NODES * dx > 1.0
        return float(power[short].sum() / total) if total > 0 else 0.0
