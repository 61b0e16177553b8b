"""Checks of profiles: resolution by the mesh, times at which they reach and fill the contact."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.surfaces.profile import WAVE_NODES

if TYPE_CHECKING:
    from ehlpetsc.case.tables import Case
    from ehlpetsc.physics.scales import Scales
    from ehlpetsc.surfaces.profile import Profile
    from ehlpetsc.surfaces.roughness import Roughness
    from ehlpetsc.surfaces.samples import Samples

SPIKE_RQ_RATIO = 4.0  # distance of a spike from its surroundings over Rq
MAX_WINDOW = 129  # points of a window whose median is exact: the work grows as points times window
MAX_UNRESOLVED = 0.01  # of the height variance: more in unresolved wavelengths causes a warning


def mesh_warnings(rough: Roughness | None, scales: Scales) -> list[str]:
    """Warnings of height variance and spikes that the mesh does not resolve, with values."""
    notes = []
    for side in ("1", "2"):
        profile = rough.side(side) if rough else None
        if profile is None:
            continue
        fraction = profile.unresolved_variance(scales.dx)
        if fraction > MAX_UNRESOLVED:
            shortest = 1e6 * WAVE_NODES * scales.dx
            notes.append(
                f"surface.{side}: the mesh is too coarse for the profile: {100 * fraction:.1f} % of its "
                f"height variance lies in wavelengths under {WAVE_NODES} nodes ({shortest:.2f} um); "
                f"points_per_half_width = {needed_points(profile, scales, MAX_UNRESOLVED)} brings that under "
                f"{100 * MAX_UNRESOLVED:.0f} %"
            )
        if profile.given.measured:
            notes += _spike_warning(side, profile.given, scales.dx)
    return notes


def _spike_warning(side: str, samples: Samples, dx: float) -> list[str]:
    count, highest, abscissa = spikes(samples, dx)
    if not count:
        return []
    return [
        f"surface.{side}: spikes narrower than a cell of the mesh ({dx * 1e6:.2f} um), up to "
        f"{highest * 1e6:.3g} um beside their surroundings, {count} points, the first at "
        f"{abscissa * 1e3:.4g} mm: they vanish between nodes; short_cutoff takes them off, "
        "a finer mesh carries them"
    ]


def spikes(samples: Samples, dx: float) -> tuple[int, float, float]:
    """Points of spikes and pits narrower than a cell, by a running median over twice its width.

    Parameters
    ----------
    dx
        Spacing of the mesh [m].

    Returns
    -------
    highest, abscissa
        Maximum distance from the median; abscissa of its first point [m].
    """
    window = 2 * round(dx / samples.spacing) + 1
    if not samples.measured or window < 3:  # the mesh is finer than the profile
        return 0, 0.0, 0.0
    rq, samples = samples.z.std(), samples.source or samples
    window = 2 * round(dx / samples.spacing) + 1
    deviation = np.abs(samples.z - _running_median(samples.z, min(window, samples.z.size)))
    in_spike = deviation > SPIKE_RQ_RATIO * rq
    if not in_spike.any():
        return 0, 0.0, 0.0
    return int(in_spike.sum()), float(deviation.max()), float(samples.X[in_spike.argmax()])


def _running_median(z: np.ndarray, window: int) -> np.ndarray:
    """Medians over a window around each point; for wide windows medians of medians of parts.

    Parameters
    ----------
    z
        Shape (n,).
    window
        Number of points.
    """
    from scipy.ndimage import median_filter

    size = window // MAX_WINDOW + 1
    if size == 1:
        return median_filter(z, window, mode="mirror")
    block_count = z.size // size
    block_medians = np.median(z[: block_count * size].reshape(block_count, size), axis=1)
    return median_filter(block_medians, window // size | 1, mode="mirror")[
        np.minimum(np.arange(z.size) // size, block_count - 1)
    ]


def needed_points(profile: Profile, scales: Scales, unresolved: float) -> int:
    """Nodes per half-width that leave at most a share `unresolved` of the height variance unresolved."""
    points = scales.a / scales.dx
    while profile.unresolved_variance(scales.a / points) > unresolved:
        points *= 1.1
    return int(np.ceil(points))


def entry_times(profile: Profile, scales: Scales) -> tuple[float, float] | None:
    """Travel of the faster surface [half widths] when a profile reaches and fills the contact.

    Returns
    -------
    reaches, fills
        Its first point at the near edge of the Hertz contact; its full heights, ramp included, at the far
        one. Of a lone ridge or dent `fills` is for its middle at x = 0. None where the profile lies
        under the domain from the start.
    """
    if not profile.enters:
        return None
    edge = -1.0 - scales.x[0] if profile.speed > 0 else scales.x[-1] - 1.0
    first, last = profile.X[0] / scales.a, profile.X[-1] / scales.a
    slower = scales.u_max / abs(profile.speed)
    if not profile.repeats:
        return (edge + first) * slower, (edge + 1.0 + 0.5 * (first + last)) * slower
    return edge * slower, (edge + 2.0 + profile.ramp / scales.a) * slower


def entry_warnings(case: Case, scales: Scales, rough: Roughness | None) -> list[str]:
    """Warnings of profiles that do not fill the contact before the end of the run, one line each."""
    notes = []
    for side in ("1", "2"):
        profile = rough.side(side) if rough else None
        arrives = entry_times(profile, scales) if profile else None
        if not profile or not arrives or case.time.travel >= arrives[1]:
            continue
        reaches, fills = arrives
        ends = f"surface.{side}: the run ends at time.travel = {case.time.travel:g}, before"
        if case.time.travel < reaches:
            notes.append(f"{ends} the profile reaches the contact ({reaches:.2f}): it stays smooth there")
        elif profile.repeats:
            notes.append(f"{ends} the profile fills the contact ({fills:.2f})")
        else:
            notes.append(f"{ends} the middle of the profile is at x = 0 ({fills:.2f})")
    return notes
