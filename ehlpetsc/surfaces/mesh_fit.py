"""Whether the mesh carries the waves of the profiles."""

import numpy as np

from ehlpetsc.surfaces.profile import SHORT
from ehlpetsc.surfaces.roughness import Roughness

SHARE = 0.01  # of the height variance in such wavelengths that calls for a warning


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
