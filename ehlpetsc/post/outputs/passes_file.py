"""Several results as passes of one surface: common points and statistics."""

import numpy as np

from ehlpetsc.case.loading import stored_case
from ehlpetsc.errors import PostError
from ehlpetsc.post.fatigue.passes import pass_statistics
from ehlpetsc.post.outputs.result_file import check_output, fingerprint, write_result

PROFILE_TOLERANCE = 1e-3  # of a spacing of body points; of the profile's height


def same_points(results, surface):
    """s (m) of the points that passed in every result, and their damage (results, nz, points).

    In passes shifted against each other (``time.pass_shift``) a point is matched with the nearest point, at
    most half a node spacing away.

    Raises
    ------
    PostError
        Depths, points or profile of the surface differ; the results are not passes of one body.
    """
    first = results[0]
    spacing = first.s[1] - first.s[0]
    offsets = []  # of the points of each result, in spacings from the first point of the first one
    for other in results:
        if other.z.shape != first.z.shape or not np.allclose(other.z, first.z):
            raise PostError("the results have different depths: give --depths")
        shift = _shift_of_profile(first, other, surface)
        offset = (other.s[0] - first.s[0] - shift) / spacing
        is_on_grid = shift or abs(offset - round(offset)) <= PROFILE_TOLERANCE
        if abs((other.s[1] - other.s[0]) / spacing - 1) > 1e-6 or not is_on_grid:
            raise PostError("the results have different body points: passes need one mesh")
        offsets.append(round(offset))
    passed = [
        set(start + np.flatnonzero(r.complete[surface])) for start, r in zip(offsets, results, strict=True)
    ]
    common = np.array(sorted(set.intersection(*passed)), int)
    if not common.size:
        raise PostError(f"no point of surface {surface} passed the whole contact in all of the results")
    rows = [r.damage[surface][:, common - start] for start, r in zip(offsets, results, strict=True)]
    return first.s[0] + spacing * common, np.stack(rows)


def _shift_of_profile(first, other, surface):
    """Distance in s (m) by which the profile of another pass is shifted; PostError for another profile."""
    if (surface in first.profiles) != (surface in other.profiles):
        raise PostError(f"surface {surface} is smooth in one result and rough in another")
    if surface not in first.profiles:
        return 0.0
    time = stored_case(first.attrs["case"]).time
    step, passes = (time.pass_shift, time.passes) if time else (0.0, 1)
    counts = sorted(range(1 - passes, passes), key=abs) if step else [0]
    for shift in (count * step for count in counts):
        if _is_same_profile(first.profiles[surface], other.profiles[surface], shift):
            return shift
    raise PostError(f"the profiles of surface {surface} differ: these are not passes of one body")


def _is_same_profile(one, other, shift):
    (s, z), (other_s, other_z) = one, other
    inside = (s + shift >= other_s[0]) & (s + shift <= other_s[-1])
    if np.count_nonzero(inside) < 2:
        return False
    deviation = np.abs(np.interp(s[inside] + shift, other_s, other_z) - z[inside])
    return deviation.max() <= PROFILE_TOLERANCE * np.ptp(z)


def store_passes(path, results, surface):
    """Write mean, scatter, largest and life of each point over the passes.

    Parameters
    ----------
    path : path-like
    results : sequence of PostResult
        Of passes of one body.
    surface : {"2", "1"}
        Surface of the body.

    Returns
    -------
    ehlpetsc.post.fatigue.passes.Passes
        Arrays (nz, points).

    Raises
    ------
    PostError
        The results are not passes of one body, or `path` must not be replaced.
    """
    check_output(path, [result.path for result in results])
    s, damages = same_points(results, surface)
    statistics = pass_statistics(damages)
    values = {"damage/s": s, "damage/z_over_a": results[0].z}
    values |= {f"damage/{surface}_{name}": value for name, value in statistics._asdict().items()}
    sources = [str(result.path) for result in results]
    attributes = {
        "a": results[0].a,
        "fingerprint": fingerprint(surface, [result.attrs["fingerprint"] for result in results]),
        "sources": "\n".join(sources),
        "passes": len(results),
    }
    write_result(path, values, attributes, {"damage": {"surface": surface}})
    return statistics
