"""Stribeck curve of a series over the entrainment speed: friction, load on the solids, mean gap ratio.

Means over the time in which both surfaces fill the contact, with the scatter over that time as a band.
"""

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from matplotlib.ticker import FuncFormatter

from ehlpetsc.errors import OutputError
from ehlpetsc.pictures.labels import (
    SECOND_COLOUR,
    SINGLE_COLOUR,
    UNITS,
    conditions,
    legend_beside,
    new_figure,
)
from ehlpetsc.pictures.operating_points import BAND, QUANTITIES, operating_point
from ehlpetsc.results.index import series_values

SPEED = "motion.entrainment_speed"
SIZE = (8.5, 7.5)  # inches
MIN_LOAD_FRACTION = 1e-5  # of the solids, lower end of the axis
MAX_LABELLED_RATIO = 1e3  # of speeds: with more, labels between powers of ten would touch


def stribeck_points(results):
    """Points of a series sorted by speed, and names of the ignored members.

    Raises
    ------
    OutputError
        The results are not a series over the speed, or no member is long enough.
    """
    if not any(result.attrs["status"] == "done" for result in results):
        raise OutputError("no member is done yet: a Stribeck curve needs two or more")
    if len(results) < 2:
        raise OutputError(f"one result alone: a Stribeck curve needs a series over {SPEED}")
    key, speeds = series_values(results)
    if key != SPEED:
        raise OutputError(
            f"a Stribeck curve needs a series over {SPEED}, these differ in {key or 'more than that'}"
        )
    points, early = [], []
    for speed, result in sorted(zip(speeds, results, strict=True), key=lambda pair: pair[0]):
        point = operating_point(result, speed)
        points, early = (points + [point], early) if point else (points, [*early, result.path.name])
    if not points:
        raise OutputError(
            "no member lasts until both surfaces fill the contact: a longer time.travel is needed"
        )
    return points, early


def curves_by_contact(results):
    """Results by contact law, mesh and [heat], with their label; the longest curve first."""
    groups = {}
    for result in results:
        case = result.case
        law = case.contact.asperity_height, case.contact.boundary_film
        key = *law, case.mesh.points_per_half_width, case.heat is not None
        groups.setdefault(key, []).append(result)
    several, heated = (len({key[position] for key in groups}) > 1 for position in (2, 3))
    curves = sorted(groups.items(), key=lambda item: -len(item[1]))
    return {_label(*key, several, heated): members for key, members in curves}


def _label(height, film, mesh, heat, with_mesh, with_heat):
    law = f"layer of {1e9 * height:g} nm" if height else "direct contact"
    if film and not height:
        law = f"rigid, boundary film {1e9 * film:g} nm"
    heating = ("with heat" if heat else "isothermal") if with_heat else ""
    return ", ".join(filter(None, [law, with_mesh and f"a/{mesh}", heating]))


def draw_stribeck(results, _options):
    """Figure of friction, load on the solids and mean gap ratio over the speed.

    With several contact laws or meshes the longest curve is drawn with its scatter, the others as means.
    """
    (main, members), *others = curves_by_contact(results).items()
    points, early = stribeck_points(members)
    figure, axes = new_figure(3, 1, SIZE, sharex=True)
    speeds = np.array([abs(point.speed) for point in points])
    for panel, (name, label) in zip(axes, QUANTITIES.items(), strict=True):
        statistics = [point.scalars[name] for point in points]
        mean, low, high = np.transpose([(s.mean, s.low, s.high) for s in statistics])
        panel.fill_between(speeds, low, high, color=SINGLE_COLOUR, alpha=0.2, lw=0)
        panel.plot(speeds, mean, "o-", color=SINGLE_COLOUR, ms=3.5, lw=1.2)
        panel.set_ylabel(label)
        panel.set_xscale("log")
        panel.grid(lw=0.3)
        if not np.isfinite(mean).any():
            panel.text(0.5, 0.5, "not in these results", transform=panel.transAxes, ha="center", va="center")
    for number, (label, compared) in enumerate(others):
        _draw_means(axes, compared, label, f"C{number + 1}")
    _references(axes[0], points, speeds)
    _share_axis(axes[1], points)
    _hersey_axis(axes[0], results)
    if np.isfinite([p.scalars["mean_gap_ratio"].mean for p in points]).any():
        axes[2].set_yscale("log")
    axes[2].set_xlabel(UNITS[SPEED])
    band = f"{BAND[0]:g} to {BAND[1]:g} % of the time"
    label = f"{main}:\nmean over time" if others else "mean over time"
    handles = [Line2D([], [], color=SINGLE_COLOUR, marker="o", ms=3.5, lw=1.2, label=label)]
    legend_beside(axes[1], [*handles, Patch(color=SINGLE_COLOUR, alpha=0.2, lw=0, label=band)])
    title = results[0].attrs["title"]
    note = f"\nnot shown, ended too early: {', '.join(early)}" if early else ""
    common = conditions(results)
    axes[0].set_title("\n".join(filter(None, [title, common])) + note, fontsize="medium")
    for panel in axes:
        panel.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
        panel.xaxis.set_minor_formatter(
            FuncFormatter(_minor_label) if speeds.max() < MAX_LABELLED_RATIO * speeds.min() else ""
        )
        panel.yaxis.set_major_formatter(FuncFormatter(lambda y, _: f"{y:g}"))
    axes[2].yaxis.set_minor_formatter(FuncFormatter(_minor_label))
    return figure


def _share_axis(axes, points):
    """Set a logarithmic axis down to `MIN_LOAD_FRACTION` if solids carry load."""
    means = np.array([point.scalars["contact_share"].mean for point in points])
    if (positive := means[means > 0.0]).size:
        axes.set_yscale("log")
        axes.set_ylim(max(MIN_LOAD_FRACTION, 0.5 * positive.min()), 1.3)
    else:
        axes.set_ylim(0.0, 1.02)


def _hersey_axis(axes, results):
    """Add an axis of the Hersey number eta0 u/w if all results have the same viscosity and load."""
    cases = [result.case for result in results]
    pairs = {(case.fluid and case.fluid.viscosity, case.contact.load) for case in cases}
    if len(pairs) == 1 and None not in (pair := pairs.pop()):
        ratio = pair[0] / pair[1]
        above = axes.secondary_xaxis("top", functions=(lambda u: u * ratio, lambda hersey: hersey / ratio))
        above.set_xlabel("Hersey number: viscosity × speed over load per length", fontsize="small")
        above.tick_params(labelsize="small")


def _minor_label(value, _):
    """Label of a minor tick: at 2 and 5 times powers of ten."""
    return f"{value:g}" if f"{value:e}"[0] in "25" else ""


def _draw_means(axes, results, label, colour):
    case_speeds = [result.case.motion.entrainment_speed for result in results]
    operating_points = [operating_point(*pair) for pair in zip(results, case_speeds, strict=True)]
    points = sorted(filter(None, operating_points), key=lambda point: point.speed)
    speeds = [abs(point.speed) for point in points]
    for panel, name in zip(axes, QUANTITIES, strict=True):
        means = [point.scalars[name].mean for point in points]
        panel.plot(speeds, means, "s--", color=colour, ms=3.0, lw=0.9, label=label)


def _references(axes, points, speeds):
    """Draw the limits of the coefficient: of the solids at low speed, of the smooth contact at high speed."""
    solids, smooth = [p.boundary for p in points], [p.smooth for p in points]
    axes.plot(speeds, solids, color=SECOND_COLOUR, lw=0.9, ls="--", label="solids alone\n(boundary_friction)")
    axes.plot(speeds, smooth, color="0.35", lw=0.9, ls=":", label="smooth contact")
    axes.set_ylim(bottom=0.0)
    legend_beside(axes)
