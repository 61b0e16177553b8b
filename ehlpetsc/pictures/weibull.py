"""Damage at asperities: distributions with their fits; Weibull plots with confidence bounds, by depth."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator

from ehlpetsc.pictures import style
from ehlpetsc.post.fatigue.statistics import (
    CONFIDENCE,
    MIN_ASPERITIES,
    benard_ranks,
    exceedance,
    fitted_asperities,
    fitted_exceedance,
    log_life,
    weibull_likelihood,
)
from ehlpetsc.results.post_result import PostResult, WeibullFit

EXCEEDANCE_DECADES = 12  # of damage below the maximum in distributions
GOOD_FIT = 0.9  # r^2 of a Weibull line that needs no word
PANEL_COLUMNS = 3
FRACTIONS = (0.01, 0.05, 0.1, 0.2, 0.5, 0.8, 0.95)
STRETCH = 1.3  # of the lives shown


def draw_distributions(curves: list[tuple[str, np.ndarray, WeibullFit]], title: str) -> Figure:
    """Fractions of asperities above a damage with their Weibull fits; curves: label, damage, fit.

    Damage less than `EXCEEDANCE_DECADES` below the maximum; a poor fit is dashed, its r^2 in the legend.
    """
    figure, axes = style.new_figure(1, 1, (7.0, 4.0))
    highest = max((under.max(initial=0.0) for _, under, _ in curves), default=0.0)
    least = highest * 10.0**-EXCEEDANCE_DECADES
    for (label, under, fit), colour in zip(curves, style.shades(len(curves)), strict=True):
        falling, fraction = exceedance(under)
        shown = falling > least
        damaged, count = falling[shown], fitted_asperities(under)
        axes.plot(damaged, fraction[shown], ".", ms=3, color=colour)
        values = np.geomspace(damaged[-1] / 3.0, 3.0 * damaged[0], 300) if damaged.size else damaged
        is_fitted, dashes = np.isfinite(fit.alpha) and count >= MIN_ASPERITIES, "-"
        if not is_fitted:
            values, label = values[:0], f"{label}, {count} with damage: no fit"
        elif fit.r_squared < GOOD_FIT:
            dashes, label = "--", f"{label}, $r^2$ = {fit.r_squared:.2f}"
        line = dict(color=colour, lw=1.2, ls=dashes, label=label)
        axes.plot(values, fitted_exceedance(values, fit.alpha, fit.beta), **line)
    axes.set(xscale="log", ylim=(0.0, 1.0))
    if highest > 0.0:
        axes.set_xlim(left=max(axes.get_xlim()[0], least))
    axes.set(xlabel="damage D of one pass", ylabel="share of asperities above D")
    axes.grid(color="0.92")
    style.legend_beside(axes, title="dots: asperities\nlines: Weibull fit")
    style.set_title(figure, title)
    return figure


def weibull_picture(result: PostResult) -> Figure:
    """Fraction of asperities over -log10 D on Weibull's axes, one panel a depth."""
    rows = -(-result.z.size // PANEL_COLUMNS)
    size = (8.0, 0.8 + 2.4 * rows)
    figure, panels = style.new_figure(rows, PANEL_COLUMNS, size, sharex=True, sharey=True, squeeze=False)
    for axes, z, under, fit in zip(panels.flat, result.z, result.under, result.fits, strict=False):
        no_fit = "" if fit.beta > 0.0 else f", {fitted_asperities(under)} with damage: no fit"
        axes.set_title(f"z/a = {z:g}{no_fit}", fontsize="small", loc="left")
        draw_fits(axes, log_life(under), fit)
    style.leave_out(panels, result.z.size)
    first = panels[0, 0]
    first.set(xscale="log", ylim=_stretched(np.array([0.005, 0.99])))
    first.xaxis.set_major_formatter("{x:g}")
    first.xaxis.set_minor_locator(LogLocator(subs=(2, 4, 6, 8)))
    first.xaxis.set_minor_formatter("{x:g}")
    first.set_yticks(_stretched(np.array(FRACTIONS)), [f"{100 * share:g}" for share in FRACTIONS])
    figure.supxlabel(r"$-\log_{10} D$ of one pass", fontsize="medium")
    figure.supylabel("asperities of shorter life [%]", fontsize="medium")
    style.legend_beside(panels[0, -1])
    counted = f"{result.height.size} asperities, surface {result.main}"
    bounds = f"{counted}, bounds of {100 * CONFIDENCE:g} % confidence"
    style.set_title(figure, str(result.attrs["title"]), bounds)
    return figure


def draw_fits(axes: Axes, lives: np.ndarray, fit: WeibullFit) -> None:
    """Draw median ranks, the line through them, the fit by maximum likelihood and its bounds."""
    lives = np.sort(lives)
    used = (lives > 0) & np.isfinite(lives)
    if np.isnan(fit.beta):
        return
    axes.plot(lives[used], _stretched(benard_ranks(lives.size)[used]), ".", ms=3, color=style.DARK)
    x = np.geomspace(lives[used][0] / STRETCH, STRETCH * lives[used][-1], 100)
    ranked = -np.expm1(-((x / fit.alpha) ** fit.beta))
    axes.plot(x, _stretched(ranked), "--", lw=0.9, color=style.DARK, label="median ranks")
    estimate, low, high = weibull_likelihood(lives).fractions(x)
    axes.plot(x, _stretched(estimate), lw=1.2, color=style.SINGLE, label="maximum\nlikelihood")
    axes.fill_between(
        x, _stretched(low), _stretched(high), color=style.SINGLE, alpha=0.2, lw=0, label="bounds"
    )


def _stretched(fraction: np.ndarray) -> np.ndarray:
    """Ordinate on which a Weibull distribution over log x is a straight line."""
    return np.log(-np.log1p(-np.clip(fraction, 1e-12, 1 - 1e-12)))
