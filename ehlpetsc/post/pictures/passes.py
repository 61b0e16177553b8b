"""Several results as passes of one body: damage a pass with its scatter, and how many passes it stands."""

import numpy as np
from matplotlib.figure import Figure

from ehlpetsc.errors import PostError
from ehlpetsc.post.fatigue.passes import pass_statistics
from ehlpetsc.post.pictures import plots

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


def passes_picture(results, surface):
    """Damage a pass along the surface at the worst depth, and the share of points that have failed."""
    s, damages = same_points(results, surface)
    found = pass_statistics(damages)
    worst = int(found.mean.max(axis=1).argmax())
    figure = Figure(figsize=(8, 5.4), layout="constrained")
    top, bottom = figure.subplots(2, 1, height_ratios=(1.3, 1))
    x = s / results[0].a
    top.fill_between(
        x,
        damages[:, worst].min(axis=0),
        found.largest[worst],
        color="#4477aa",
        alpha=0.3,
        lw=0,
        label="least to largest of the passes",
    )
    top.plot(x, found.mean[worst], color=plots.DARK, lw=0.8, label="mean D of a pass")
    top.set_yscale("log")
    top.set_xlabel("s/a")
    top.set_ylabel("D of a pass")
    first = found.life[worst].min()
    top.set_title(
        f"{surface} surface, z/a = {results[0].z[worst]:g}, {len(results)} passes: first failure expected "
        f"after {first:.3g} passes",
        fontsize=9,
    )
    top.legend(fontsize=8, frameon=False)
    share = np.arange(1, x.size + 1) / x.size
    with np.errstate(divide="ignore"):
        for row in damages[:, worst]:
            bottom.plot(np.sort(1 / row), share, color="0.7", lw=0.7)
    bottom.plot([], [], color="0.7", lw=0.7, label="each pass alone, again and again")
    bottom.plot(np.sort(found.life[worst]), share, color="#cc3311", lw=1.3, label="Miner's sum of all passes")
    bottom.set_xscale("log")
    bottom.set_xlabel("passes")
    bottom.set_ylabel("share of points failed")
    bottom.grid(color="0.92")
    bottom.legend(fontsize=8, frameon=False)
    return figure
