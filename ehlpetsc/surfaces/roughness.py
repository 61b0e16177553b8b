"""Roughness of both surfaces, fixed in the bodies and carried through the contact."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ehlpetsc.surfaces import synthetic
from ehlpetsc.surfaces.profile_files import high_pass, levelled, read_profile

RAMP = 0.1  # half widths of profile over which its heights come in
SHORT = 4  # nodes a wavelength below which the mesh does not carry it
SHARE = 0.01  # of the height variance in such wavelengths that calls for a warning
MAX_SAMPLES = 5_000_000  # of a profile as stored


class Profile:
    r"""Heights of one surface.

    Body point s is at :math:`x=s+Ut`. Its abscissa in the profile is

    * U > 0: :math:`X=x_\mathrm{inlet}-s`, so that the profile enters at the inlet from time 0 on;
    * U < 0: :math:`X=s-x_\mathrm{outlet}`, it enters at the outlet;
    * U = 0, or a steady case: :math:`X=s-x_\mathrm{inlet}`, it lies under the whole domain from the start.

    A moving surface is smooth where X < 0 and its heights come in over `RAMP` half widths by
    :math:`r^3(10-15r+6r^2)`: film and its rate of change have no jump.

    Parameters
    ----------
    X, z : ndarray, shape (n,)
        Samples, m.
    repeats : bool
        Mirrored end to end beyond the samples, else height 0 there.
    speed : float
        U [m/s].
    moving : bool
        False in a steady case.
    inlet, outlet, ramp, duration : float
        Ends of the domain and length of the ramp [m], time the run takes [s].

    Attributes
    ----------
    ra, rq, rsk : float
        Of the samples about their mean: m, m, 1.
    """

    def __init__(self, X, z, repeats, speed, moving, inlet, outlet, ramp, duration):
        from scipy.interpolate import CubicSpline

        self.X, self.heights, self.repeats, self.speed = X, z, repeats, speed
        self._enters = moving and speed != 0.0
        self._origin, self._sign = (inlet, -1.0) if self._enters and speed > 0 else (outlet, 1.0)
        if not self._enters:
            self._origin = inlet
        self._ramp = ramp
        self._travelled = abs(speed) * duration if self._enters else outlet - inlet
        # level ends: mirrored end to end, the profile has no kink
        self._spline = CubicSpline(X, z, bc_type="clamped")
        deviation = z - z.mean()
        self.ra, self.rq = float(np.abs(deviation).mean()), float(np.sqrt((deviation**2).mean()))
        self.rsk = float(((deviation / self.rq) ** 3).mean()) if self.rq > 0 else 0.0

    def height(self, s):
        """Heights [m] at body points s [m]."""
        X = self._sign * (s - self._origin)
        if not self._enters:
            return self._at(X)
        r = np.clip(X / self._ramp, 0.0, 1.0)
        return r * r * r * (10.0 - r * (15.0 - 6.0 * r)) * self._at(np.maximum(X, 0.0))

    def _at(self, X):
        first, last = self.X[0], self.X[-1]
        if self.repeats:
            length = last - first
            return self._spline(last - np.abs(length - np.mod(X - first, 2.0 * length)))
        inside = (X >= first) & (X <= last)
        return np.where(inside, self._spline(np.clip(X, first, last)), 0.0)

    @cached_property
    def s(self):
        """Body points [m], increasing, equally spaced as the profile's samples, that enter during the run."""
        step = np.diff(self.X).mean()
        X = np.arange(min(int(self._travelled / step * (1 + 1e-12)) + 1, MAX_SAMPLES)) * step
        return np.sort(self._origin + self._sign * X)

    @cached_property
    def z(self):
        """Heights [m] at `s`, ramp included."""
        return self.height(self.s)

    def short_share(self, dx):
        """Share of the height variance in wavelengths under `SHORT` spacings dx [m]."""
        n = min(max(self.X.size, 16), 1 << 17)
        x = np.linspace(self.X[0], self.X[-1], n)
        z = self._spline(x)
        z = np.concatenate([z, z[-2:0:-1]])  # mirrored: no jump to spill over the spectrum
        power = np.abs(np.fft.rfft(z)) ** 2
        power[0] = 0.0
        total = power.sum()
        short = np.fft.rfftfreq(z.size, x[1] - x[0]) * SHORT * dx > 1.0
        return float(power[short].sum() / total) if total > 0 else 0.0


@dataclass(frozen=True)
class Roughness:
    """Both profiles; a smooth side is None."""

    fast: Profile | None
    slow: Profile | None

    @classmethod
    def of(cls, case, scales):
        """Roughness of a case, None where both surfaces are smooth.

        Parameters
        ----------
        case : case.Case
        scales : scales.Scales

        Raises
        ------
        ProfileError
        """
        sides = {}
        for side, speed in (("fast", scales.u1), ("slow", scales.u2)):
            spec = getattr(case.surface, side)
            sides[side] = spec and _profile(case, scales, spec, speed)
        return cls(**sides) if any(sides.values()) else None

    def gap(self, x, t):
        """What both roughnesses add to the gap [m], minus both heights, at x [m] and time t [s]."""
        phi = np.zeros_like(x)
        for profile in (self.fast, self.slow):
            if profile is not None:
                phi -= profile.height(x - profile.speed * t)
        return phi

    @property
    def rq(self):
        """Combined root mean square height [m]."""
        return float(np.hypot(*(p.rq if p else 0.0 for p in (self.fast, self.slow))))


def samples(case, spec):
    """Samples of one surface: read or made, levelled, filtered, flipped, scaled, in this order.

    Returns
    -------
    X, z : ndarray
        m.
    repeats : bool
    """
    if spec.synthetic is not None:
        X, z, repeats = synthetic.sampled(spec.synthetic)
    else:
        X, z = read_profile(case.path.parent / spec.file)
        repeats = True
    if spec.level:
        z = levelled(X, z)
    if spec.cutoff is not None:
        z = high_pass(X, z, spec.cutoff)
    if spec.flip:
        X, z = X[-1] + X[0] - X[::-1], z[::-1]
    return X, spec.scale * z, repeats


def _profile(case, scales, spec, speed):
    X, z, repeats = samples(case, spec)
    return Profile(
        X,
        z,
        repeats,
        speed,
        case.time is not None,
        scales.x[0] * scales.a,
        scales.x[-1] * scales.a,
        RAMP * scales.a,
        scales.duration or 0.0,
    )


def mesh_warnings(case, scales):
    """One line for each surface whose profile the mesh is too coarse for, with the figure."""
    rough = Roughness.of(case, scales)
    notes = []
    for side in ("fast", "slow"):
        profile = rough and getattr(rough, side)
        share = profile.short_share(scales.dx) if profile else 0.0
        if share > SHARE:
            notes.append(
                f"surface.{side}: the mesh is too coarse for the profile: {100 * share:.1f} % of its height "
                f"variance lies in wavelengths under {SHORT} nodes ({SHORT * scales.dx * 1e6:.2f} um); "
                f"points_per_half_width = {_needed(profile, scales)} brings that under {100 * SHARE:.0f} %"
            )
    return notes


def _needed(profile, scales):
    points = scales.a / scales.dx
    while profile.short_share(scales.a / points) > SHARE:
        points *= 1.1
    return int(np.ceil(points))
