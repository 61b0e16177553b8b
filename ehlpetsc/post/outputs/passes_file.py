"""Several results as passes of one surface: the points they share, and what is stored of them."""

import numpy as np

from ehlpetsc.errors import PostError
from ehlpetsc.post.fatigue.passes import pass_statistics
from ehlpetsc.post.outputs.result_file import check_output, fingerprint, write_result

SAME = 1e-3  # of a spacing of body points; of the profile's height


def same_points(results, surface):
    """s (m) of the points that passed in every result, and their damage (results, nz, points).

    Raises
    ------
    PostError
        Depths, points or profile of the surface differ: these are not passes of one body.
    """
    first = results[0]
    spacing = first.s[1] - first.s[0]
    for other in results[1:]:
        if other.z.shape != first.z.shape or not np.allclose(other.z, first.z):
            raise PostError("the results have different depths: give --depths")
        offset = (other.s[0] - first.s[0]) / spacing
        other_spacing = other.s[1] - other.s[0]
        if abs(other_spacing / spacing - 1) > 1e-6 or abs(offset - round(offset)) > SAME:
            raise PostError("the results have different body points: passes need one mesh")
        _check_profile(first, other, surface)
    kept = {}
    for result in results:
        places = np.rint((result.s - first.s[0]) / spacing).astype(int)[result.complete[surface]]
        for place in places:
            kept[place] = kept.get(place, 0) + 1
    places = np.array(sorted(place for place, count in kept.items() if count == len(results)), int)
    if not places.size:
        raise PostError(f"no point of the {surface} surface passed the whole contact in all of the results")
    rows = [r.damage[surface][:, places - int(np.rint((r.s[0] - first.s[0]) / spacing))] for r in results]
    return first.s[0] + spacing * places, np.stack(rows)


def _check_profile(first, other, surface):
    if (surface in first.profiles) != (surface in other.profiles):
        raise PostError(f"the {surface} surface is smooth in one result and rough in another")
    if surface not in first.profiles:
        return
    (s, z), (other_s, other_z) = first.profiles[surface], other.profiles[surface]
    inside = (s >= other_s[0]) & (s <= other_s[-1])
    apart = np.abs(np.interp(s[inside], other_s, other_z) - z[inside])
    if not inside.any() or apart.max() > SAME * np.ptp(z):
        raise PostError(f"the profiles of the {surface} surface differ: these are not passes of one body")


def store_passes(path, results, surface):
    """Write mean, scatter, largest and life of each point over the passes.

    Parameters
    ----------
    path : path-like
    results : sequence of PostResult
        Of passes of one body.
    surface : {"slow", "fast"}
        Of it.

    Returns
    -------
    ehlpetsc.post.fatigue.passes.Passes
        Arrays (nz, points).

    Raises
    ------
    PostError
        These are not passes of one body, or `path` is not ours to write.
    """
    check_output(path, [result.path for result in results])
    s, damages = same_points(results, surface)
    found = pass_statistics(damages)
    values = {"damage/s": s, "damage/z_over_a": results[0].z}
    values |= {f"damage/{surface}_{name}": value for name, value in found._asdict().items()}
    sources = [str(result.path) for result in results]
    attributes = {
        "a": results[0].a,
        "fingerprint": fingerprint(surface, [result.attrs["fingerprint"] for result in results]),
        "sources": "\n".join(sources),
        "passes": len(results),
    }
    write_result(path, values, attributes, {"damage": {"surface": surface}})
    return found
