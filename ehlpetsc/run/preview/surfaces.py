"""Summary of both surfaces before a run."""

import math

from ehlpetsc.run.preview.forecast import FULL_FILM, lambda_ratio
from ehlpetsc.surfaces.entry_times import entry_times


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
    for side in ("1", "2"):
        profile = rough and rough.side(side)
        described = _profile(case, s, profile) if profile else ["smooth"]
        lines += [f"Surface {side}: {line}" for line in described]
    return lines


def lambda_line(case, s, rough):
    """Conventional lambda ratio: minimum smooth film by formula over the combined Rq; [] if smooth or dry."""
    if case.fluid is None or not rough or rough.rq <= 0.0:
        return []
    ratio = lambda_ratio(case, s, rough)
    return [
        f"Lambda ratio {ratio:.2g}: minimum smooth film {1e6 * ratio * rough.rq:.3g} um over the combined "
        f"Rq {1e6 * rough.rq:.3g} um, {_regime(ratio)}"
    ]


def _regime(ratio):
    """Lubrication regime by the lambda ratio, e.g. Johnson, Greenwood & Poon (1972)."""
    if ratio > FULL_FILM:
        return "full film"
    return "mixed lubrication, contact possible" if ratio > 1 else "mixed lubrication, contact likely"


def _profile(case, s, profile):
    """Size, roughness and travel of one profile, a line each."""
    samples = profile.given
    lines = [
        f"Ra {profile.ra * 1e6:.4f} um, Rq {profile.rq * 1e6:.4f} um, Rsk {profile.rsk:.3f}",
        *samples.notes,
    ]
    if samples.measured:
        file = samples.source or samples
        size = f"{1e3 * file.length:.4g} mm long, {file.X.size} points {1e6 * file.spacing:.4g} um apart"
        lines.insert(1, size)
        if profile.travelled > samples.length:
            lines.append(f"continued by reflection: {1e3 * profile.travelled:.4g} mm enter during the run")
        if case.time is not None and profile.is_moving:
            lines += _part_in_contact(case, s, profile)
    times = entry_times(profile, s)
    if times:
        reaches, fills = times
        end = "and fills it" if profile.repeats else "and has its middle at x = 0"
        lines.append(f"reaches the contact at travel {reaches:.2f} a {end} at {fills:.2f} a")
    return lines


def _part_in_contact(case, s, profile):
    """Part of a measured profile that passes the whole contact, and the travel at which all of it has."""
    reaches, length = entry_times(profile, s)[0], profile.given.length
    slower = s.u_max / abs(profile.speed)
    through = s.a * (case.time.travel - reaches - 2.0 * slower) / slower
    if through >= length:
        return []
    needed = reaches + (2.0 + length / s.a) * slower
    passing = (
        f"x = 0 to {1e3 * through:.3g} mm pass the contact" if through > 0.0 else "none passes the contact"
    )
    return [
        f"of {1e3 * length:.4g} mm {passing}, x = 0 enters first; time.travel = {math.ceil(needed)} for all"
    ]


def height_lines(rough, s):
    """Height ranges of the profiles, and of their means over the cells of the mesh."""
    for side in ("1", "2"):
        profile = rough and rough.side(side)
        if profile:
            heights = profile.heights.min(), profile.heights.max()
            heights, means = (
                " to ".join(f"{1e6 * round(z, 12):.3g}" for z in pair)
                for pair in (heights, profile.extremes_of_cells(s.dx))
            )
            note = "means over cells, as the mesh has them"
            yield f"Surface {side}: heights from {heights} um; {note}, {means} um"
