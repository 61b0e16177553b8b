"""Whether the mesh carries the waves of the profiles."""

import numpy as np

from ehlpetsc.surfaces.profile import SHORT

SPIKE = 4.0  # Rq beside its surroundings that make a point one of a spike
SHARE = 0.01  # of the height variance in such wavelengths that calls for a warning


def mesh_warnings(rough, scales):
    """What of both profiles the mesh does not carry, a line each with the figure.

    Parameters
    ----------
    rough : ehlpetsc.surfaces.roughness.Roughness or None
    scales : scales.Scales
    """
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
        notes += _spike_warning(side, profile.given, scales.dx) if profile else []
    return notes


def _spike_warning(side, given, dx):
    count, highest, place = spikes(given, dx)
    if not count:
        return []
    return [
        f"surface.{side}: spikes narrower than a cell of the mesh ({dx * 1e6:.2f} um), up to "
        f"{highest * 1e6:.3g} um beside their surroundings, {count} points, the first at "
        f"{place * 1e3:.4g} mm: they vanish between nodes; short_cutoff takes them off, "
        "a finer mesh carries them"
    ]


def spikes(given, dx):
    """Points of spikes and pits narrower than a cell, by a running median over twice its width.

    Parameters
    ----------
    given : ehlpetsc.surfaces.samples.Samples
    dx : float
        Spacing of the mesh [m].

    Returns
    -------
    count : int
    highest, place : float
        Greatest distance from the median, and abscissa of the first point [m].
    """
    from scipy.ndimage import median_filter

    window = 2 * round(dx / given.spacing) + 1
    if not given.measured or window < 3:  # the mesh is finer than the profile
        return 0, 0.0, 0.0
    beside = np.abs(given.z - median_filter(given.z, min(window, given.z.size), mode="mirror"))
    found = beside > SPIKE * given.z.std()
    if not found.any():
        return 0, 0.0, 0.0
    return int(found.sum()), float(beside.max()), float(given.X[found.argmax()])


def _needed(profile, scales):
    points = scales.a / scales.dx
    while profile.short_share(scales.a / points) > SHARE:
        points *= 1.1
    return int(np.ceil(points))
