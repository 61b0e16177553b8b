"""Distributions of damage at the asperities: fraction above a damage, with the Weibull fit."""

import numpy as np
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullLocator

from ehlpetsc.pictures import damage_panels as plots
from ehlpetsc.post.fatigue.statistics import (
    CONFIDENCE,
    exceedance,
    fitted_exceedance,
    log_life,
    weibull_bounds,
)

COLOUR_MAP = LinearSegmentedColormap.from_list(  # neighbours of eight differ in hue, all dark enough
    "distinct", ["#332288", "#4477aa", "#33bbaa", "#117733", "#999933", "#ee9922", "#cc3311", "#882255"]
)


def depth_picture(result):
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


def ratio_picture(results, z):
    """Distributions at one depth, by slide/roll ratio (figures 11 and 12)."""
    figure = Figure(figsize=(6, 4), layout="constrained")
    axes = figure.subplots()
    for result, color in zip(results, _colours(len(results)), strict=True):
        k = int(np.argmin(np.abs(result.z - z)))
        _curve(axes, result.under[k], result.fits[k], f"slide/roll ratio {result.ratio:.3g}", color)
    _add_legend_entries(axes, with_limits=False)
    _finish(axes, f"z/a = {z:g}, surface {results[0].main}, {plots.strain_rule(results[0])}")
    return figure


def _colours(count):
    return [COLOUR_MAP(k / max(count - 1, 1)) for k in range(count)]


def _curve(axes, under, fit, label, color):
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


def _draw_confidence(axes, under, fit, color):
    """Draw the confidence band of the fit by resampling."""
    bounds = weibull_bounds(log_life(under))
    if not (bounds.draws.size and np.isfinite(fit.beta)):
        return
    damaged = under[under > 0]
    values = np.logspace(np.log10(damaged.min()) - 0.5, min(0.0, np.log10(damaged.max()) + 0.5), 120)
    drawn = [fitted_exceedance(values, *row) for row in bounds.draws]
    low, high = np.quantile(drawn, [(1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2], axis=0)
    axes.fill_between(values, low, high, color=color, alpha=0.15, lw=0)


def _add_legend_entries(axes, with_limits=True):
    """Add legend entries for dots, lines and bands."""
    marks = [(dict(marker=".", ls=""), "asperities"), (dict(lw=1.2), "Weibull, median ranks")]
    for style, words in marks:
        axes.plot([], [], color="0.3", label=words, **style)
    if not with_limits:
        return
    axes.fill_between([], [], color="0.3", alpha=0.15, lw=0, label=f"{100 * CONFIDENCE:g} % bootstrap limits")


def _finish(axes, title):
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
    plots.legend_beside(axes)
