"""Roughness of both surfaces, fixed in the bodies and carried through the contact."""

from dataclasses import dataclass

import numpy as np

from ehlpetsc.surfaces.profile import Profile
from ehlpetsc.surfaces.samples import samples

RAMP = 0.1  # half widths of profile over which its heights come in


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
        case : case.loading.Case
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

    def phi(self, x, t, cell=None):
        """What both roughnesses add to the gap [m], minus both heights, at time t [s].

        Parameters
        ----------
        x : ndarray, shape (n,)
            Places [m], with `cell` equally spaced by it.
        t : float
        cell : float, optional
            Width of the cells of a mesh [m]: means over them. Waves shorter than that, which no mesh of this
            width carries, are then damped instead of taken for longer ones. Without it values at x.
        """
        phi = np.zeros_like(x)
        at = x if cell is None else np.append(x - 0.5 * cell, x[-1] + 0.5 * cell)
        for profile in (self.fast, self.slow):
            if profile is not None:
                heights = profile.height if cell is None else profile.mean_height
                phi -= heights(at - profile.speed * t)
        return phi

    @property
    def rq(self):
        """Combined root mean square height [m]."""
        return float(np.hypot(*(p.rq if p else 0.0 for p in (self.fast, self.slow))))


def _profile(case, scales, spec, speed):
    return Profile(
        samples(case.path.parent, spec),
        speed,
        case.time is not None,
        scales.x[0] * scales.a,
        scales.x[-1] * scales.a,
        RAMP * scales.a,
        scales.duration or 0.0,
    )
