"""Maps of damage over the surfaces of a plane, one a depth."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from matplotlib.figure import Figure

from ehlpetsc.pictures import style
from ehlpetsc.results.post_result import PostResult

MAP_COLUMNS = 3
DECADES = 7  # of damage below the maximum


def map_picture(
    result: PostResult, surface: str, place: Callable[[np.ndarray], np.ndarray], title: str
) -> Figure:
    """Maps of log10 D of a plane over the surface, one a depth, and its heights.

    `place`: abscissa [mm] of body points s [m].
    """
    passed = result.complete[surface]
    x, y = place(result.s[passed]), 1e3 * result.y
    count = result.z.size + (surface in result.profiles)
    rows = -(-count // MAP_COLUMNS)
    figure, panels = style.new_figure(
        rows, MAP_COLUMNS, (8.0, 1.0 + 2.2 * rows), sharex=True, sharey=True, squeeze=False
    )
    shown = list(panels.flat[:count])
    for axes in panels.flat[count:]:
        axes.set_visible(False)
    if surface in result.profiles:
        s, heights = result.profiles[surface]
        axes = shown.pop(0)
        low, high = 1e6 * heights.min(), 1e6 * heights.max()
        axes.set_title(f"height, {low:.2g} to {high:.2g} µm", fontsize="small", loc="left")
        axes.pcolormesh(place(s), y, 1e6 * heights, cmap="gray", rasterized=True)
    values = result.damage[surface][..., passed]
    top = int(np.ceil(np.log10(values.max()))) if values.max() > 0.0 else 0
    for axes, z, layer in zip(shown, result.z, values, strict=True):
        axes.set_title(f"z/a = {z:g}", fontsize="small", loc="left")
        powers = np.log10(np.maximum(layer, 10.0 ** (top - DECADES - 1.0)))
        limits = {"vmin": top - DECADES, "vmax": top, "cmap": "inferno_r", "rasterized": True}
        colours = axes.pcolormesh(x, y, powers, **limits)
    figure.colorbar(colours, ax=panels, label=r"$\log_{10}$ D of one pass")
    panels[0, 0].set_xlim(x.min(), x.max())
    figure.supxlabel(f"along surface {surface} [mm]", fontsize="medium")
    figure.supylabel("y [mm]", fontsize="medium")
    style.set_title(figure, title)
    return figure
