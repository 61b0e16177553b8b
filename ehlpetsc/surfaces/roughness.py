"""Roughness of both surfaces, fixed in the bodies and carried through the contact."""

from dataclasses import dataclass

import numpy as np

from ehlpetsc.surfaces.profile import Profile
from ehlpetsc.surfaces.samples import samples

MOVED = 1e-9  # half widths: ends of a domain nearer than this are the same
RAMP = 0.1  # half widths of profile over which its heights come in


@dataclass(frozen=True)
class Bodies:
    """Where both bodies are at the begin of a run.

    Attributes
    ----------
    travelled : (float, float)
        Ways of the fast and the slow body since their profiles began to enter [m], signed.
    entrances : (float, float)
        Inlet and outlet at which they entered [m].
    begins : (float, float)
        Abscissas in their profiles with which they began to enter [m].
    """

    travelled: tuple
    entrances: tuple
    begins: tuple = (0.0, 0.0)

    @classmethod
    def at_rest(cls, scales):
        """Those of a run that begins at time 0."""
        return cls((0.0, 0.0), (scales.x[0] * scales.a, scales.x[-1] * scales.a))

    def offsets(self, scales):
        """What body points are further on by `begins`, signed [m], as of `profile.Profile.moved`."""
        return tuple(
            -begin if speed > 0.0 else begin
            for begin, speed in zip(self.begins, (scales.u1, scales.u2), strict=True)
        )


@dataclass(frozen=True)
class Roughness:
    """Both profiles; a smooth side is None."""

    fast: Profile | None
    slow: Profile | None

    @classmethod
    def of(cls, case, scales, bodies=None):
        """Roughness of a case, None where both surfaces are smooth.

        Parameters
        ----------
        case : case.loading.Case
        scales : scales.Scales
        bodies : Bodies, optional
            Of a run that goes on; by default one that begins.

        Raises
        ------
        ProfileError
        """
        sides, bodies = {}, bodies or Bodies.at_rest(scales)
        speeds = (scales.u1, scales.u2)
        for k, side in enumerate(("fast", "slow")):
            spec = getattr(case.surface, side)
            sides[side] = spec and _profile(case, scales, spec, speeds[k], k, bodies)
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
        ways = [profile.speed * t if profile else 0.0 for profile in (self.fast, self.slow)]
        return self.phi_after(x, ways, cell)

    def phi_after(self, x, travelled, cell=None):
        """The same where both bodies have travelled so far (fast, slow) [m]."""
        phi = np.zeros_like(x)
        at = x if cell is None else np.append(x - 0.5 * cell, x[-1] + 0.5 * cell)
        for profile, way in zip((self.fast, self.slow), travelled, strict=True):
            if profile is not None:
                heights = profile.height if cell is None else profile.mean_height
                phi -= heights(at - way)
        return phi

    @property
    def rq(self):
        """Combined root mean square height [m]."""
        return float(np.hypot(*(p.rq if p else 0.0 for p in (self.fast, self.slow))))


def _profile(case, scales, spec, speed, side, bodies):
    (inlet, outlet), travelled = bodies.entrances, bodies.travelled[side]
    drawn_in = 0.0
    if case.time is not None:
        left = max(scales.duration * scales.u_max - max(map(abs, bodies.travelled)), 0.0)
        # under another load the domain may reach further out than where the profile entered
        wider = max(inlet - scales.x[0] * scales.a, scales.x[-1] * scales.a - outlet)
        drawn_in = abs(travelled) + left * abs(speed) / scales.u_max
        drawn_in += wider if wider > MOVED * scales.a else 0.0
    return Profile(
        samples(case.path.parent, spec),
        speed,
        case.time is not None,
        inlet,
        outlet,
        RAMP * scales.a,
        drawn_in,
        bodies.begins[side],
    )
