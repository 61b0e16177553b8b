"""Heights of one surface: a spline that moves with the body."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.surfaces.continued_spline import ContinuedSpline
from ehlpetsc.surfaces.moving_surface import MovingSurface, Passage

if TYPE_CHECKING:
    from ehlpetsc.surfaces.samples import Samples

WAVE_NODES = 4  # nodes per wavelength below which a wave is not resolved


class Profile(MovingSurface):
    """Heights of one surface along x.

    `ra`, `rq`, `rsk`: parameters of the samples: m, m, 1.
    """

    def __init__(self, samples: Samples, passage: Passage) -> None:
        super().__init__(passage)
        X, z, self.repeats = samples.X, samples.z, samples.repeats
        self.given, self.X, self.heights = samples, X, z
        self._spline = ContinuedSpline(X, z, "mirrored" if self.repeats else "zero")
        deviation = z - z.mean()
        self.ra, self.rq = float(np.abs(deviation).mean()), float(np.sqrt((deviation**2).mean()))
        self.rsk = float(((deviation / self.rq) ** 3).mean()) if self.rq > 0 else 0.0

    def height(self, s: np.ndarray) -> np.ndarray:
        """Heights [m] at body points s [m]."""
        X = self._sign * (s - self._origin)
        if not self.is_moving:
            return self._spline(X + self._begin)
        return self._entry_factor(X) * self._spline(np.maximum(X, 0.0) + self._begin)

    def mean_height(self, faces: np.ndarray) -> np.ndarray:
        r"""Mean height [m] of each cell between faces at body points s [m].

        :math:`\frac{1}{s_{i+1}-s_i}\int_{s_i}^{s_{i+1}}z\,ds`, the integral of the spline, also across its
        mirrored continuation. The ramp is evaluated at the centre of the cell.

        `faces`: shape (n + 1,).
        """
        X = self._sign * (faces - self._origin)
        mean = self._spline.means(X + self._begin)
        return self._entry_factor(0.5 * (X[1:] + X[:-1])) * mean if self.is_moving else mean

    @property
    def statistics(self) -> dict[str, float]:
        """Ra and Rq [m], Rsk of the samples."""
        return {"ra": self.ra, "rq": self.rq, "rsk": self.rsk}

    @cached_property
    def s(self) -> np.ndarray:
        """Body points [m] that enter during the run, at least two, with the spacing of the samples."""
        return self._points(np.diff(self.X).mean())

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
