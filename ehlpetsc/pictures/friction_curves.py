"""Stribeck and traction curves of series: friction over the entrainment speed, over the slide/roll ratio.

Means over the time in which both surfaces fill the contact, with the scatter over that time as a band.
"""

from __future__ import annotations

import argparse
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import LogLocator

from ehlpetsc.base.errors import OutputError
from ehlpetsc.physics.friction_correlations import benedict_kelley, xu_kahraman
from ehlpetsc.physics.scales import Scales
from ehlpetsc.pictures import style
from ehlpetsc.results.index import distinguishing_names, series_values
from ehlpetsc.results.means import filled_weights, mean, weighted_percentiles
from ehlpetsc.results.reader import Result

SPEED, RATIO = "motion.entrainment_speed", "motion.slide_roll_ratio"
STRIBECK_SIZE, TRACTION_SIZE = (8.5, 7.5), (8.5, 4.6)  # inches
BAND = (5.0, 95.0)  # percentiles over time
QUANTITIES = {
    "friction_coefficient": "friction coefficient",
    "contact_share": "share of the load\non the solids",
    "mean_gap_ratio": "mean gap over\nthe combined Rq",
}
MIN_LOAD_FRACTION = 1e-5  # of the solids, lower end of the axis
MIN_LOGARITHMIC_RATIO = 100.0  # of slide/roll ratios: a larger span is drawn on a logarithmic axis


@dataclass(frozen=True)
class OperatingPoint:
    """One member of a series: mean and percentiles `BAND` over time by `QUANTITIES`, nan where unknown."""

    at: float  # value of the abscissa
    scalars: dict[str, tuple[float, float, float]]
    smooth: float  # friction coefficient of the smooth contact, before roughness enters
    boundary: float  # friction coefficient of the solids


def operating_point(result: Result, at: float) -> OperatingPoint | None:
    """Means of one member; None if it ends before both surfaces fill the contact."""
    weights = filled_weights(result)
    if not weights.any():
        return None
    scalars = {name: time_statistics(result, name, weights) for name in QUANTITIES}
    smooth = float(result.steps("friction_coefficient")[0])
    return OperatingPoint(at, scalars, smooth, result.case.contact.boundary_friction)


def time_statistics(result: Result, name: str, weights: np.ndarray) -> tuple[float, float, float]:
    """Weighted mean and percentiles `BAND` of the finite values of a scalar; nan without any."""
    average = mean(result, name, weights)
    if not np.isfinite(average):
        return np.nan, np.nan, np.nan
    values = result.steps(name).astype(float)
    used = np.isfinite(values) & (weights > 0.0)
    low, high = weighted_percentiles(values[used], weights[used], BAND)
    return average, float(low), float(high)


def stribeck_points(results: list[Result]) -> tuple[list[OperatingPoint], list[str]]:
    """Points of a series sorted by speed, and names of the members that end too early."""
    if len(results) < 2:
        raise OutputError(f"one result alone: a Stribeck curve needs a series over {SPEED}")
    key, speeds = series_values(results)
    if key != SPEED:
        differs = key or "more than that"
        raise OutputError(f"a Stribeck curve needs a series over {SPEED}, these differ in {differs}")
    pairs = sorted(zip(speeds, results, strict=True), key=lambda pair: pair[0])
    found = [(operating_point(result, speed), result.path.name) for speed, result in pairs]
    points = [point for point, _ in found if point]
    if not points:
        raise OutputError(
            "no member lasts until both surfaces fill the contact: a longer time.travel is needed"
        )
    return points, [name for point, name in found if not point]


def curves_by_contact(results: list[Result]) -> dict[str, list[Result]]:
    """Results by contact law, mesh and [heat], with their label; the longest curve first."""
    groups: dict[tuple, list[Result]] = {}
    for result in results:
        case, contact = result.case, result.case.contact
        if contact.asperity_height:
            law = f"layer of {1e9 * contact.asperity_height:.3g} nm,\nbeta = {contact.asperity_stiffness:.2g}"
        else:
            film = contact.boundary_film
            law = f"rigid, boundary film {1e9 * film:g} nm" if film else "direct contact"
        heat = "isothermal" if case.heat is None else "with heat"
        groups.setdefault((law, f"a/{case.mesh.points_per_half_width}", heat), []).append(result)
    varied = [True, *(len({key[position] for key in groups}) > 1 for position in (1, 2))]
    ordered = sorted(groups.items(), key=lambda item: -len(item[1]))
    return {", ".join(np.array(key)[varied]): members for key, members in ordered}


def draw_stribeck(results: list[Result], _options: argparse.Namespace | None) -> Figure:
    """Friction, load on the solids and mean gap ratio over the speed.

    With several contact laws or meshes the longest curve is drawn with its scatter, the others as means.
    """
    (main, members), *others = curves_by_contact(results).items()
    points, early = stribeck_points(members)
    figure, axes = style.new_figure(3, 1, STRIBECK_SIZE, sharex=True)
    speeds = np.array([abs(point.at) for point in points])
    for panel, (name, label) in zip(axes, QUANTITIES.items(), strict=True):
        average, low, high = np.transpose([point.scalars[name] for point in points])
        panel.fill_between(speeds, low, high, color=style.SINGLE, alpha=0.2, lw=0)
        panel.plot(speeds, average, "o-", color=style.SINGLE, ms=3.5, lw=1.2)
        panel.set(ylabel=label, xscale="log")
        panel.grid(lw=0.3)
    for number, (label, compared) in enumerate(others, 1):
        found = [operating_point(result, result.case.motion.entrainment_speed) for result in compared]
        shown = sorted(filter(None, found), key=lambda point: point.at)
        for panel, name in zip(axes, QUANTITIES, strict=True):
            means = [point.scalars[name][0] for point in shown]
            dashed = dict(color=f"C{number}", ms=3.0, lw=0.9, label=label)
            panel.plot([abs(point.at) for point in shown], means, "s--", **dashed)
    limits = dict(color="k", lw=0.9, ls="-.", label="solids alone\n(boundary_friction)")
    axes[0].plot(speeds, [point.boundary for point in points], **limits)
    smooth = [point.smooth for point in points]
    axes[0].plot(speeds, smooth, color="0.35", lw=0.9, ls=":", label="smooth contact")
    axes[0].set_ylim(bottom=0.0)
    style.legend_beside(axes[0])
    _share_axis(axes[1], points)
    _hersey_axis(axes[0], results)
    if np.isfinite([point.scalars["mean_gap_ratio"][0] for point in points]).any():
        axes[2].set_yscale("log")
        axes[2].yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes[2].set_xlabel(style.UNITS[SPEED])
    label = f"{main}:\nmean over time" if others else "mean over time"
    band = Patch(color=style.SINGLE, alpha=0.2, lw=0, label=f"{BAND[0]:g} to {BAND[1]:g} % of the time")
    line = Line2D([], [], color=style.SINGLE, marker="o", ms=3.5, lw=1.2, label=label)
    style.legend_beside(axes[1], [line, band])
    note = f"not shown, ended too early: {', '.join(early)}" if early else ""
    style.set_title(figure, str(results[0].attrs["title"]), style.conditions(results), note)
    for axis in (axes[2].xaxis, axes[1].yaxis, axes[2].yaxis):
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter("")
    return figure


def _share_axis(axes: Axes, points: list[OperatingPoint]) -> None:
    """Set a logarithmic axis down to `MIN_LOAD_FRACTION` if solids carry load."""
    means = np.array([point.scalars["contact_share"][0] for point in points])
    if (positive := means[means > 0.0]).size:
        axes.set(yscale="log", ylim=(max(MIN_LOAD_FRACTION, 0.5 * positive.min()), 1.3))
    else:
        axes.set_ylim(0.0, 1.02)


def _hersey_axis(axes: Axes, results: list[Result]) -> None:
    """Add an axis of the Hersey number eta0 u/w if all results have the same viscosity and load."""
    cases = [result.case for result in results]
    pairs = {(case.fluid and case.fluid.viscosity, case.contact.load) for case in cases}
    if len(pairs) == 1 and None not in (pair := pairs.pop()):
        ratio = pair[0] / pair[1]
        above = axes.secondary_xaxis("top", functions=(lambda u: u * ratio, lambda hersey: hersey / ratio))
        above.set_xlabel("Hersey number: viscosity × speed over load per length", fontsize="small")
        above.tick_params(labelsize="small")


def draw_traction(results: list[Result], _options: argparse.Namespace | None) -> Figure:
    """Friction coefficient over the slide/roll ratio, maxima marked.

    Results that differ in other keys form separate curves; isothermal ones are dashed if others have heat.
    """
    by_heat = {
        heat: traction_curves([r for r in results if (r.case.heat is not None) == heat]) for heat in (0, 1)
    }
    if not any(len(curve[0]) > 1 for curves in by_heat.values() for curve in curves.values()):
        raise OutputError(f"a traction curve needs a series over {RATIO}")
    figure, axes = style.new_figure(1, 1, TRACTION_SIZE)
    names, compared = list(dict.fromkeys([*by_heat[0], *by_heat[1]])), all(by_heat.values())
    for heat, curves in by_heat.items():
        for name, (ratios, friction) in curves.items():
            dashes, colour = "--" if compared and not heat else "-", f"C{names.index(name)}"
            heating = ("with heat" if heat else "isothermal") if compared else ""
            label = ", ".join(filter(None, [name.replace("_", " "), heating])) or "friction"
            axes.plot(ratios, friction, dashes, color=colour, marker="o", ms=3, lw=1.2, label=label)
            _mark_maximum(axes, ratios, friction, colour)
    ratios = np.unique([result.case.motion.slide_roll_ratio for result in results if result.case.motion])
    ratios = ratios[ratios > 0.0]
    if len({name.partition(",")[0] for name in names}) == 1 and results[0].case.fluid and ratios.size:
        axes.set_ylim(top=1.6 * axes.get_ylim()[1])  # a correlation without bound is cut
        for (label, friction), dashes in zip(
            correlations(results[0], ratios).items(), (":", "-."), strict=True
        ):
            axes.plot(ratios, friction, dashes, color="0.35", lw=1.0, label=label)
    axes.set(xlabel=style.UNITS[RATIO], ylabel="friction coefficient", xlim=(0.0, None))
    if ratios.size and ratios[-1] > MIN_LOGARITHMIC_RATIO * ratios[0]:
        axes.set(xscale="log", xlim=(ratios[0], ratios[-1]))
    axes.set_ylim(bottom=0.0)
    axes.grid(lw=0.3)
    style.set_title(figure, str(results[0].attrs["title"]), style.conditions(results))
    style.legend_beside(axes)
    return figure


def correlations(result: Result, ratios: np.ndarray) -> dict[str, np.ndarray]:
    """Friction coefficients of smooth surfaces by published correlations, by their names."""
    case, scales = result.case, Scales.of(result.case)
    u, eta, load = abs(scales.u), case.fluid.viscosity, case.contact.load
    return {
        "Xu & Kahraman 2007": xu_kahraman(scales.p0, ratios, u, eta, case.contact.radius, 0.0),
        "Benedict & Kelley 1961": benedict_kelley(load, ratios * u, 2.0 * u, eta, 0.0),
    }


def traction_curves(results: list[Result]) -> dict[str, np.ndarray]:
    """Ratios and friction coefficients, shape (2, n), by the other conditions in which results differ."""
    by_ratio: dict = {}
    for result in results:
        by_ratio.setdefault(result.case.motion.slide_roll_ratio if result.case.motion else 0.0, []).append(
            result
        )
    rows: dict = {}
    for ratio, same in sorted(by_ratio.items()):
        names = (distinguishing_names(same) if len(same) > 1 else None) or [""]
        for name, result in zip(names, same, strict=False):
            curve, point = rows.setdefault(name, []), operating_point(result, ratio)
            if point:
                curve.append((ratio, point.scalars["friction_coefficient"][0]))
    return {name: np.array(curve).reshape(-1, 2).T for name, curve in rows.items()}


def _mark_maximum(axes: Axes, ratios: np.ndarray, friction: np.ndarray, colour: str) -> None:
    """Mark the maximum and its values unless it is at the end of a curve."""
    if friction.size < 3 or friction.argmax() in (0, friction.size - 1):
        return
    at = friction.argmax()
    axes.plot(ratios[at], friction[at], "o", ms=9, mfc="none", color=colour)
    above = dict(xytext=(0, 7), textcoords="offset points", ha="center", fontsize="small", color=colour)
    axes.annotate(f"{friction[at]:.4f} at {ratios[at]:g}", (ratios[at], friction[at]), **above)
