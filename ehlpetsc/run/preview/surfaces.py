"""What is told of both surfaces before a run."""

from ehlpetsc.run.preview.forecast import dowson_higginson
from ehlpetsc.surfaces.arrival import arrival


def surface_lines(case, s, rough):
    """Both surfaces: size, roughness and travel, a line each.

    Parameters
    ----------
    case : case.loading.Case
    s : physics.scales.Scales
    rough : surfaces.roughness.Roughness or None

    Returns
    -------
    list of str
    """
    lines = []
    for side in ("fast", "slow"):
        profile = rough and getattr(rough, side)
        told = _profile(case, s, profile) if profile else ["smooth"]
        lines += [f"Surface {side}: {line}" for line in told]
    return lines


def _profile(case, s, profile):
    """Size, roughness and travel of one profile, a line each."""
    given = profile.given
    film = dowson_higginson(s, case.fluid.pressure_viscosity) if case.fluid else None
    ratio = f", lambda ratio {film / profile.rq:.2g}" if film and profile.rq > 0.0 else ""
    lines = [
        f"Ra {profile.ra * 1e6:.4f} um, Rq {profile.rq * 1e6:.4f} um, Rsk {profile.rsk:.3f}{ratio}",
        *given.notes,
    ]
    if given.measured:
        file = given.source or given
        size = f"{1e3 * file.length:.4g} mm long, {file.X.size} points {1e6 * file.spacing:.4g} um apart"
        lines.insert(1, size)
        if profile.travelled > given.length:
            lines.append(f"continues mirrored: {1e3 * profile.travelled:.4g} mm of it are drawn in")
    arrives = arrival(profile, s)
    if arrives:
        reaches, fills = arrives
        then = "and fills it" if profile.repeats else "and stands with its middle at x = 0"
        lines.append(f"reaches the contact at travel {reaches:.2f} a {then} at {fills:.2f} a")
    return lines


def height_lines(rough, s):
    """Valleys and peaks of the profiles beside those of means over the cells of a mesh."""
    for side in ("fast", "slow"):
        profile = rough and getattr(rough, side)
        if profile:
            given = profile.heights.min(), profile.heights.max()
            given, seen = (
                " to ".join(f"{1e6 * round(z, 12):.3g}" for z in pair)
                for pair in (given, profile.extremes_of_cells(s.dx))
            )
            about = "means over cells, as the mesh has them"
            yield f"Surface {side}: heights from {given} um; {about}, {seen} um"
