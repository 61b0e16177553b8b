"""Pictures of other criteria than the paper's: a map of each, and a comparison with the paper's damage."""

import numpy as np
from matplotlib.figure import Figure

from ehlpetsc.pictures import damage_panels as plots
from ehlpetsc.post.fatigue.statistics import rank_correlation

NAMES = {
    "fatemi-socie": "Fatemi-Socie",
    "shear": "shear strain",
    "swt": "Smith-Watson-Topper",
    "dang-van": "Dang Van",
}
SECTION_LENGTH = 2.0  # half widths
COLOUR_MAP = "viridis_r"
UTILISATION_TICKS = (0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10)  # of the fatigue limit


def criteria_picture(result, surface):
    """Maps below the profile on one scale of damage, each next to its values over the paper's damage."""
    names = [name for name in NAMES if name in result.criteria]
    figure = Figure(figsize=(10, 1.4 + 1.75 * (len(names) + 1)), layout="constrained")
    heights = (0.5, *[1] * (len(names) + 1))
    axes = figure.subplots(len(names) + 2, 2, height_ratios=heights, width_ratios=(2.6, 1))
    ends = plots.stretch(result, surface, SECTION_LENGTH)
    paper = result.damage[surface]
    levels = plots.decades(np.nanmax(paper))
    plots.profile(axes[0, 0], result, surface, ends)
    axes[0, 0].set_xlim(*ends)
    axes[0, 0].set_title(
        f"surface {surface}, slide/roll ratio {result.ratio:.3g}; profile and criteria",
        fontsize=9,
        loc="left",
    )
    for axis in (axes[0, 1], axes[1, 1]):
        axis.axis("off")
    contours = _map(axes[1, 0], result, surface, paper, ends, levels, "von Mises ranges")
    for row, name in zip(axes[2:], names, strict=True):
        values = result.criteria[name][surface]
        _row(figure, row, result, surface, name, values, ends, levels)
    if contours is not None:
        maps = [axes[1, 0], *(axes[k + 2, 0] for k, name in enumerate(names) if name != "dang-van")]
        bar = figure.colorbar(contours, ax=maps, label="damage D of one pass", pad=0.01, aspect=40)
        bar.ax.yaxis.set_major_formatter(lambda power, axis: f"$10^{{{power:.0f}}}$")
    axes[-1, 0].set_xlabel(plots.body_label(surface))
    axes[-1, 1].set_xlabel("D of von Mises ranges")
    _depth_colours(figure, axes[1, 1], result)
    return figure


def _map(axes, result, surface, values, ends, levels, title):
    shown = result.with_damage(surface, values)
    contours = plots.damage_contours(axes, shown, surface, ends, levels, gap=0.1)
    axes.set_title(title, fontsize=8, loc="left", pad=2)
    return contours


def _row(figure, row, result, surface, name, values, ends, levels):
    left, right = row
    complete = result.complete[surface]
    paper = result.damage[surface]
    if name == "dang-van":
        title = f"{NAMES[name]}: share of the fatigue limit; line: 1"
        plots.utilisation_contours(figure, left, result, surface, values, ends)
        left.set_title(title, fontsize=8, loc="left", pad=2)
        right.axhline(1, color="0.6", lw=0.7)
    else:
        _map(left, result, surface, values, ends, levels, NAMES[name])
    for k, colour in enumerate(_colours(result.z)):
        x, y = paper[k, complete], values[k, complete]
        positive = (x > 0) & (y > 0)
        right.plot(x[positive], y[positive], ".", ms=1.5, color=colour, rasterized=True)
    right.set_xscale("log")
    right.set_yscale("log")
    if name != "dang-van":
        ends = 10.0 ** np.array([levels[0] - 1, levels[-1]])
        right.plot(ends, ends, color="0.6", lw=0.7)
        right.set_xlim(*ends)
        right.set_ylim(ends[0] / 100, ends[1])
    else:
        low, high = right.get_ylim()
        shown = [utilisation for utilisation in UTILISATION_TICKS if low <= utilisation <= high]
        right.set_yticks(shown, [f"{utilisation:g}" for utilisation in shown])
        right.set_yticks([], minor=True)
    ranks = rank_correlation(paper[:, complete].ravel(), values[:, complete].ravel())
    top = rank_correlation(paper[0, complete], values[0, complete])
    right.set_title(f"rank correlation {ranks:.2f}, z/a = {result.z[0]:g}: {top:.2f}", fontsize=8, pad=2)
    right.grid(color="0.93")


def _colours(z):
    import matplotlib

    return matplotlib.colormaps[COLOUR_MAP](np.linspace(0.05, 1, len(z)))


def _depth_colours(figure, axes, result):
    """Draw the legend of depths in the empty axes next to the paper's map."""
    for z, colour in zip(result.z, _colours(result.z), strict=True):
        axes.plot([], [], "o", ms=4, color=colour, label=f"z/a = {z:g}")
    axes.legend(ncol=2, fontsize=8, frameon=False, loc="center", title="depths of the points below")
