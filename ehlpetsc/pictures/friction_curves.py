"""Stribeck and traction curves of series: friction over the entrainment speed, over the slide/roll ratio.

Means over the time in which both surfaces fill the contact, with the scatter over that time as a band.
"""

from __future__ import annotations

import argparse

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator

from ehlpetsc.base.errors import OutputError
from ehlpetsc.physics.scales import Scales
from ehlpetsc.physics.traction import benedict_kelley, xu_kahraman
from ehlpetsc.pictures import style
from ehlpetsc.results.index import groups
from ehlpetsc.results.means import filled_weights, mean, weighted_percentiles
from ehlpetsc.results.reader import Result

SPEED, RATIO = "motion.entrainment_speed", "motion.slide_roll_ratio"
STRIBECK_SIZE, TRACTION_SIZE = (9.5, 7.5), (8.5, 4.6)  # inches
BAND = (5.0, 95.0)  # percentiles over time
QUANTITIES = {
    "friction_coefficient": "friction coefficient",
    "contact_share": "share of the load\non the solids",
    "mean_gap_ratio": "mean gap over\nthe combined Rq",
}
MIN_SHOWN_SHARE = 1e-5  # of the solids, lower end of the axis
MIN_LOGARITHMIC_RATIO = 100.0  # of slide/roll ratios: a larger span is drawn on a logarithmic axis


def time_statistics(results: list[Result], name: str) -> np.ndarray:
    """Means and percentiles `BAND` of a scalar over time, shape (3, n); nan where unknown."""
    rows = np.full((len(results), 3), np.nan)
    for row, result in zip(rows, results, strict=True):
        weights = filled_weights(result)
        row[0] = mean(result, name, weights)
        if np.isfinite(row[0]):
            values = result.steps(name).astype(float)
            used = np.isfinite(values) & (weights > 0.0)
            row[1:] = weighted_percentiles(values[used], weights[used], BAND)
    return rows.T


def curves(results: list[Result], key: str) -> dict[str, tuple[np.ndarray, list[Result]]]:
    """Values of a key of [motion] and the results over it, by the other conditions; the longest curve first.

    Results that end before both surfaces fill the contact are left out.
    """
    found = {}
    lasting = [result for result in results if filled_weights(result).any()]
    for name, members in groups(lasting, key).items():
        values = np.array([getattr(result.case.motion, key.partition(".")[2], 0.0) for result in members])
        order = np.argsort(values)
        found[name] = values[order], [members[k] for k in order]
    longest_first = dict(sorted(found.items(), key=lambda item: -len(item[1][1])))
    if all(len(values) < 2 for values, _ in found.values()):
        raise OutputError(f"needs a series over {key}, runs that last until both surfaces fill the contact")
    return longest_first


def draw_stribeck(results: list[Result], _options: argparse.Namespace | None) -> Figure:
    """Friction, load on the solids and mean gap ratio over the speed.

    If results also differ in other keys, the longest curve is drawn with its scatter, the others as means.
    """
    (main, (speeds, members)), *others = curves(results, SPEED).items()
    figure, axes = style.new_figure(3, 1, STRIBECK_SIZE, sharex=True)
    for panel, (name, label) in zip(axes, QUANTITIES.items(), strict=True):
        average, low, high = time_statistics(members, name)
        band = dict(color=style.SINGLE, alpha=0.2, lw=0, label=f"{BAND[0]:g} to {BAND[1]:g} % of the time")
        panel.fill_between(np.abs(speeds), low, high, **band)
        line = dict(color=style.SINGLE, ms=3.5, lw=1.2, label=_lines(f"mean over time, {main}"))
        panel.plot(np.abs(speeds), average, "o-", **line)
        for number, (other, (at, compared)) in enumerate(others, 1):
            dashed = dict(color=f"C{number}", ms=3.0, lw=0.9, label=_lines(other))
            panel.plot(np.abs(at), time_statistics(compared, name)[0], "s--", **dashed)
        panel.set(ylabel=label, xscale="log")
        panel.grid(lw=0.3)
    boundary = [result.case.contact.boundary_friction for result in members]
    smooth = [result.steps("friction_coefficient")[0] for result in members]
    axes[0].plot(np.abs(speeds), boundary, "k-.", lw=0.9, label="solids alone\n(boundary_friction)")
    axes[0].plot(np.abs(speeds), smooth, ":", color="0.35", lw=0.9, label="smooth contact")
    axes[0].set_ylim(bottom=0.0)
    style.legend_beside(axes[0], axes[0].get_legend_handles_labels()[0][2:])
    style.legend_beside(axes[1], axes[1].get_legend_handles_labels()[0][:2])
    for panel in axes[1:]:
        panel.set_yscale("log" if panel.dataLim.y1 > 0.0 else "linear")
    axes[2].yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes[1].set_ylim(bottom=max(axes[1].get_ylim()[0], MIN_SHOWN_SHARE))
    loads = [Scales.of(r.case).load_per_length for r in results]
    conditions = {
        (r.case.fluid and r.case.fluid.viscosity, load) for r, load in zip(results, loads, strict=True)
    }
    if len(conditions) == 1 and results[0].case.fluid:
        [(viscosity, load)] = conditions
        hersey = "Hersey number: viscosity × speed over load per length"
        style.scale_above(axes[0], viscosity / load, hersey)
    axes[2].set_xlabel(style.LABELS[SPEED])
    early = ", ".join(result.path.name for result in results if not filled_weights(result).any())
    note = f"not shown, ended too early: {early}" if early else ""
    style.set_title(figure, str(results[0].attrs["title"]), style.conditions(results), note)
    for axis in (axes[2].xaxis, axes[1].yaxis, axes[2].yaxis):
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter("")
    return figure


def draw_traction(results: list[Result], _options: argparse.Namespace | None) -> Figure:
    """Friction coefficient over the slide/roll ratio by the other conditions, maxima marked."""
    found = curves(results, RATIO)
    figure, axes = style.new_figure(1, 1, TRACTION_SIZE)
    for number, (name, (ratios, members)) in enumerate(found.items()):
        friction, colour = time_statistics(members, "friction_coefficient")[0], f"C{number}"
        axes.plot(ratios, friction, "o-", color=colour, ms=3, lw=1.2, label=_lines(name or "friction"))
        _mark_maximum(axes, ratios, friction, colour)
    ratios = np.unique(np.concatenate([ratios[ratios > 0.0] for ratios, _ in found.values()]))
    if len(found) == 1 and results[0].case.fluid:
        axes.set_ylim(top=1.6 * axes.get_ylim()[1])  # a correlation without bound is cut
        published = correlations(results[0], ratios).items()
        for (label, friction), dashes in zip(published, (":", "-."), strict=True):
            axes.plot(ratios, friction, dashes, color="0.35", lw=1.0, label=label)
    axes.set(xlabel=style.LABELS[RATIO], ylabel="friction coefficient", xlim=(0.0, None))
    if ratios.size and ratios[-1] > MIN_LOGARITHMIC_RATIO * ratios[0]:
        axes.set(xscale="log", xlim=(ratios[0], ratios[-1]))
    axes.set_ylim(bottom=0.0)
    axes.grid(lw=0.3)
    style.set_title(figure, str(results[0].attrs["title"]), style.conditions(results))
    style.legend_beside(axes)
    return figure


def _lines(settings: str) -> str:
    """Label of a curve, a line for each setting."""
    return settings.replace("_", " ").removesuffix(", ").replace(", ", ",\n")


def correlations(result: Result, ratios: np.ndarray) -> dict[str, np.ndarray]:
    """Friction coefficients of smooth lines, of the middle row of points, by published correlations."""
    case, scales = result.case, Scales.of(result.case)
    u, eta, load = abs(scales.u), case.fluid.viscosity, scales.load_per_length
    return {
        "Xu & Kahraman 2007": xu_kahraman(scales.p0, ratios, u, eta, case.contact.radius, 0.0),
        "Benedict & Kelley 1961": benedict_kelley(load, ratios * u, 2.0 * u, eta, 0.0),
    }


def _mark_maximum(axes: Axes, ratios: np.ndarray, friction: np.ndarray, colour: str) -> None:
    """Mark the maximum and its values unless it is at the end of a curve."""
    if friction.size < 3 or friction.argmax() in (0, friction.size - 1):
        return
    at = friction.argmax()
    axes.plot(ratios[at], friction[at], "o", ms=9, mfc="none", color=colour)
    above = dict(xytext=(0, 7), textcoords="offset points", ha="center", fontsize="small", color=colour)
    axes.annotate(f"{friction[at]:.4f} at {ratios[at]:g}", (ratios[at], friction[at]), **above)
