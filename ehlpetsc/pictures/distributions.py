"""Statistics of damage: distributions over asperities, passes of one body, criteria beside D."""

from __future__ import annotations

from typing import TYPE_CHECKING

import matplotlib
import numpy as np
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator

from ehlpetsc.pictures import damage_panels as plots
from ehlpetsc.pictures import style
from ehlpetsc.post.fatigue.statistics import (
    CONFIDENCE,
    exceedance,
    fitted_exceedance,
    log_life,
    rank_correlation,
    weibull_bounds,
)
from ehlpetsc.post.passes import pass_statistics, same_points

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.contour import ContourSet

    from ehlpetsc.results.post_result import PostResult, WeibullFit


COLOUR_MAP = LinearSegmentedColormap.from_list(  # neighbours of eight differ in hue, all dark enough
    "distinct", ["#332288", "#4477aa", "#33bbaa", "#117733", "#999933", "#ee9922", "#cc3311", "#882255"]
)


def depth_picture(result: PostResult) -> Figure:
    """Distributions of damage at the asperities of one surface, by depth (figure 10).

    Bands: 90 % bootstrap confidence limits of the fit by median ranks.
    """
    figure = Figure(figsize=(6, 4), layout="constrained")
    axes = figure.subplots()
    for k, color in enumerate(_colours(len(result.z))):
        _curve(axes, result.under[k], result.fits[k], f"z/a = {result.z[k]:g}", color)
        _draw_confidence(axes, result.under[k], result.fits[k], color)
    _add_legend_entries(axes)
    counted = f"{result.height.size} asperities, surface {result.main}, slide/roll ratio {result.ratio:.3g}"
    _finish(axes, f"{counted}, {plots.strain_rule(result)}")
    return figure


def ratio_picture(results: list[PostResult], z: float) -> Figure:
    """Distributions at one depth, by slide/roll ratio (figures 11 and 12)."""
    figure = Figure(figsize=(6, 4), layout="constrained")
    axes = figure.subplots()
    for result, color in zip(results, _colours(len(results)), strict=True):
        k = int(np.argmin(np.abs(result.z - z)))
        _curve(axes, result.under[k], result.fits[k], f"slide/roll ratio {result.ratio:.3g}", color)
    _add_legend_entries(axes, with_limits=False)
    _finish(axes, f"z/a = {z:g}, surface {results[0].main}, {plots.strain_rule(results[0])}")
    return figure


def _colours(count: int) -> list[tuple[float, ...]]:
    return [COLOUR_MAP(k / max(count - 1, 1)) for k in range(count)]


def _curve(axes: Axes, under: np.ndarray, fit: WeibullFit, label: str, color: object) -> None:
    """Draw the fraction of asperities above a damage, with the Weibull fit."""
    damaged = under[under > 0]
    if not damaged.size:
        axes.plot([], [], color=color, label=f"{label}: no damage")
        return
    falling, fraction = exceedance(under)
    axes.plot(falling[falling > 0], fraction[falling > 0], ".", ms=3, color=color)
    low, high = np.log10(damaged.min()) - 0.5, min(0.0, np.log10(damaged.max()) + 0.5)
    values = np.logspace(low, max(high, low + 1), 300)
    axes.plot(values, fitted_exceedance(values, fit.alpha, fit.beta), color=color, lw=1.2, label=label)


def _draw_confidence(axes: Axes, under: np.ndarray, fit: WeibullFit, color: object) -> None:
    """Draw the confidence band of the fit by resampling."""
    bounds = weibull_bounds(log_life(under))
    if not (bounds.draws.size and np.isfinite(fit.beta)):
        return
    damaged = under[under > 0]
    values = np.logspace(np.log10(damaged.min()) - 0.5, min(0.0, np.log10(damaged.max()) + 0.5), 120)
    drawn = [fitted_exceedance(values, *row) for row in bounds.draws]
    low, high = np.quantile(drawn, [(1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2], axis=0)
    axes.fill_between(values, low, high, color=color, alpha=0.15, lw=0)


def _add_legend_entries(axes: Axes, with_limits: bool = True) -> None:
    """Add legend entries for dots, lines and bands."""
    marks: list[tuple[dict, str]] = [
        (dict(marker=".", ls=""), "asperities"),
        (dict(lw=1.2), "Weibull, median ranks"),
    ]
    for mark, words in marks:
        axes.plot([], [], color="0.3", label=words, **mark)
    if not with_limits:
        return
    axes.fill_between([], [], color="0.3", alpha=0.15, lw=0, label=f"{100 * CONFIDENCE:g} % bootstrap limits")


def _finish(axes: Axes, title: str) -> None:
    """Set scales, labels and title of the distributions."""
    axes.set_xscale("log")
    axes.margins(x=0.0)
    low, high = np.log10(axes.get_xlim())
    axes.set_xlim(10 ** np.floor(low), 10 ** np.ceil(high))
    axes.xaxis.set_major_locator(LogLocator(10, numticks=12))
    few = np.ceil(high) - np.floor(low) <= 3
    axes.xaxis.set_minor_locator(LogLocator(10, subs=range(2, 10)) if few else NullLocator())
    axes.set_ylim(0, 1)
    axes.set_xlabel("damage D of one pass")
    axes.set_ylabel("share of asperities above D")
    axes.grid(color="0.92", which="both")
    axes.set_title(title, fontsize=9)
    style.legend_beside(axes)


def passes_picture(results: list[PostResult], surface: str) -> Figure:
    """Damage per pass along the surface at the worst depth, and fraction of points with Miner's sum 1."""
    s, damages = same_points(results, surface)
    statistics = pass_statistics(damages)
    worst = int(statistics.mean.max(axis=1).argmax())
    figure = Figure(figsize=(8, 5.4), layout="constrained")
    top, bottom = figure.subplots(2, 1, height_ratios=(1.3, 1))
    x = plots.along_body(results[0], surface, s)
    top.fill_between(
        x,
        damages[:, worst].min(axis=0),
        statistics.largest[worst],
        color="#4477aa",
        alpha=0.3,
        lw=0,
        label="least to largest of the passes",
    )
    top.plot(x, statistics.mean[worst], color=plots.DARK, lw=0.8, label="mean D of a pass")
    top.set_yscale("log")
    top.set_xlabel(plots.body_label(surface))
    top.set_ylabel("D of a pass")
    first, scatter = statistics.life[worst].min(), np.median((statistics.deviation / statistics.mean)[worst])
    top.set_title(
        f"surface {surface}, z/a = {results[0].z[worst]:g}, {len(results)} passes, "
        f"{plots.strain_rule(results[0])}: Miner's sum 1 from {first:.3g} passes on\n"
        f"median scatter of D from pass to pass {scatter:.2g} of its mean",
        fontsize=9,
    )
    style.legend_beside(top)
    fraction = np.arange(1, x.size + 1) / x.size
    with np.errstate(divide="ignore"):
        for row in damages[:, worst]:
            bottom.plot(np.sort(1 / row), fraction, color="0.7", lw=0.7)
    bottom.plot([], [], color="0.7", lw=0.7, label="each pass alone, again and again")
    bottom.plot(
        np.sort(statistics.life[worst]), fraction, color="#cc3311", lw=1.3, label="Miner's sum of all passes"
    )
    bottom.set_xscale("log")
    bottom.set_xlabel("passes: compares points, is no life")
    bottom.set_ylabel("share of points with\nMiner's sum 1 or more")
    bottom.grid(color="0.92")
    style.legend_beside(bottom)
    return figure


NAMES = {
    "fatemi-socie": "Fatemi-Socie",
    "shear": "shear strain",
    "swt": "Smith-Watson-Topper",
    "dang-van": "Dang Van",
}
SECTION_LENGTH = 2.0  # half widths
UTILISATION_TICKS = (0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10)  # of the fatigue limit


def criteria_picture(result: PostResult, surface: str) -> Figure:
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


def _map(
    axes: Axes,
    result: PostResult,
    surface: str,
    values: np.ndarray,
    ends: tuple[float, float],
    levels: np.ndarray,
    title: str,
) -> ContourSet | None:
    shown = result.with_damage(surface, values)
    contours = plots.damage_contours(axes, shown, surface, ends, levels, gap=0.1)
    axes.set_title(title, fontsize=8, loc="left", pad=2)
    return contours


def _row(
    figure: Figure,
    row: np.ndarray,
    result: PostResult,
    surface: str,
    name: str,
    values: np.ndarray,
    ends: tuple[float, float],
    levels: np.ndarray,
) -> None:
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
    for k, colour in enumerate(_depth_shades(result.z)):
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


def _depth_shades(z: np.ndarray) -> np.ndarray:
    """objects of depths, the deepest dark."""
    return matplotlib.colormaps["viridis_r"](np.linspace(0.05, 1, len(z)))


def _depth_colours(figure: Figure, axes: Axes, result: PostResult) -> None:
    """Draw the legend of depths in the empty axes next to the paper's map."""
    for z, colour in zip(result.z, _depth_shades(result.z), strict=True):
        axes.plot([], [], "o", ms=4, color=colour, label=f"z/a = {z:g}")
    axes.legend(ncol=2, fontsize=8, frameon=False, loc="center", title="depths of the points below")
