"""Series: Stribeck and traction curves, friction over the speed or the slide/roll ratio; running-in.

Means over the time in which both surfaces fill the contact, with the scatter over that time as a band. Of
passes surfaces, pressure, contact and damage, as the surfaces run in.
"""

from __future__ import annotations

import argparse

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator

from ehlpetsc.base.case import KINDS
from ehlpetsc.base.errors import OutputError
from ehlpetsc.physics.scales import Scales
from ehlpetsc.physics.traction import benedict_kelley, xu_kahraman
from ehlpetsc.pictures import style
from ehlpetsc.pictures.frames.choice import frame_to_show
from ehlpetsc.results.index import groups
from ehlpetsc.results.means import filled_weights, heights, mean, pass_summary, weighted_percentiles
from ehlpetsc.results.post_result import PostResult, damage_beside
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
            row[1:] = weighted_percentiles(result.steps(name).astype(float), weights, BAND)
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
    """Friction over the speed, and load on the solids and mean gap ratio where the results have them.

    If results also differ in other keys, the longest curve is drawn with its scatter, the others as means.
    """
    (main, (speeds, members)), *others = curves(results, SPEED).items()
    known = {name: time_statistics(members, name) for name in QUANTITIES}
    known = {
        n: found for n, found in known.items() if n == "friction_coefficient" or np.isfinite(found[0]).any()
    }
    width, height = STRIBECK_SIZE
    size = width, height * (1 + len(known)) / (1 + len(QUANTITIES))
    figure, axes = style.new_figure(len(known), 1, size, sharex=True, squeeze=False)
    panels = dict(zip(known, axes[:, 0], strict=True))
    for name, panel in panels.items():
        _curve(panel, np.abs(speeds), known[name], main)
        for number, (other, (at, compared)) in enumerate(others, 1):
            dashed = dict(color=f"C{number}", ms=3.0, lw=0.9, label=_lines(other))
            panel.plot(np.abs(at), time_statistics(compared, name)[0], "s--", **dashed)
        panel.set(ylabel=QUANTITIES[name], xscale="log")
        panel.grid(lw=0.3)
    first, *below = panels.values()
    _references(first, np.abs(speeds), members)
    first.set_ylim(bottom=0.0)
    handles = first.get_legend_handles_labels()[0]
    of_curve = len(handles) - len(first.lines) + 1  # its line, and its band if any
    style.legend_beside(first, handles[of_curve if below else 0 :])
    if below:
        style.legend_beside(below[0], handles[:of_curve])
    for panel in (panel for panel in below if panel.dataLim.y1 > 0.0):
        panel.set_yscale("log")
    if gap := panels.get("mean_gap_ratio"):
        gap.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    if (share := panels.get("contact_share")) and share.get_yscale() == "log":
        share.set_ylim(bottom=max(share.get_ylim()[0], MIN_SHOWN_SHARE))
    _hersey_numbers(first, results)
    last = axes[-1, 0]
    last.set_xlabel(style.LABELS[SPEED])
    early = ", ".join(result.path.name for result in results if not filled_weights(result).any())
    note = f"not shown, ended too early: {early}" if early else ""
    style.set_title(figure, str(results[0].attrs["title"]), style.conditions(results), note)
    for axis in (last.xaxis, *(panel.yaxis for panel in below)):
        axis.set_major_formatter("{x:g}")
        axis.set_minor_formatter("")
    return figure


def _curve(panel: Axes, speeds: np.ndarray, statistics: np.ndarray, name: str) -> None:
    """Curve of the means, with the scatter over time as a band, if there is any."""
    average, low, high = statistics
    varies = bool((high > low).any())
    if varies:
        band = dict(color=style.SINGLE, alpha=0.2, lw=0, label=f"{BAND[0]:g} to {BAND[1]:g} % of the time")
        panel.fill_between(speeds, low, high, **band)
    label = _lines(f"{'mean over time' if varies else 'steady'}, {name}")
    panel.plot(speeds, average, "o-", color=style.SINGLE, ms=3.5, lw=1.2, label=label)


def _references(panel: Axes, speeds: np.ndarray, results: list[Result]) -> None:
    """Friction of the solids alone and, of runs that begin with it, of the smooth contact."""
    boundary = [result.case.contact.boundary_friction for result in results]
    panel.plot(speeds, boundary, "k-.", lw=0.9, label="solids alone\n(boundary_friction)")
    if all(result.case.time and result.case.time.start == "smooth" for result in results):
        smooth = [result.steps("friction_coefficient")[0] for result in results]
        panel.plot(speeds, smooth, ":", color="0.35", lw=0.9, label="smooth contact")


def _hersey_numbers(panel: Axes, results: list[Result]) -> None:
    """Axis of Hersey numbers above, if all results have the same load and viscosity."""
    loads = {Scales.of(result.case).load_per_length for result in results}
    fluids = {result.case.fluid and result.case.fluid.viscosity for result in results}
    if len(loads) == len(fluids) == 1 and results[0].case.fluid:
        where = " in the middle of the dry contact" if KINDS[results[0].case.kind].is_whole else ""
        hersey = f"Hersey number: viscosity × speed over load per length{where}"
        style.scale_above(panel, fluids.pop() / loads.pop(), hersey)


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


RUNNING_IN_SIZE, SIZE_WITH_DAMAGE = (11.0, 7.0), (15.0, 7.0)  # inches
PROFILE_WIDTH = 0.6  # half-widths of profile around the deepest indentation
SPAN, AREA, VOLUME = (1e6, "length", "µm"), (1e12, "area", "µm²"), (1e18, "volume", "µm³")
MEASURES = (SPAN, AREA), (AREA, VOLUME)  # of contact and of its depths, per width and of the whole contact
FIRST, LAST = style.FAINT, style.SECOND  # colours of the passes


def draw_running_in(results: list[Result], _options: argparse.Namespace | None) -> Figure:
    """Heights and pressure before and after all passes of a run, and the changes in each pass."""
    if len(results) < 2:
        raise OutputError("one pass alone; allowed: --running-in of two passes or more")
    if any("set_volume" not in result.scalars for result in results):
        raise OutputError("solids that do not yield: no plastic deformation; needs contact.yield_pressure")
    rows = [pass_summary(result) for result in results]
    posts = [damage_beside(result) for result in results]
    damages = posts if all(posts) else []
    size = SIZE_WITH_DAMAGE if damages else RUNNING_IN_SIZE
    figure, axes = style.new_figure(2, 3 if damages else 2, size)
    draw_surface(axes[0, 0], results)
    draw_pressure(axes[1, 0], results)
    draw_plastic_deformation(axes[0, 1], rows, results[0])
    draw_contact(axes[1, 1], rows, results[0])
    for row, side in zip(axes if damages else (), ("1", "2"), strict=False):
        draw_fatigue(row[2], damages, side)
    style.set_title(figure, str(results[0].attrs["title"]), style.conditions(results))
    return figure


def draw_surface(axes: Axes, results: list[Result]) -> None:
    """Draw the surface with the deepest indentation: original, after the first and after the last pass."""
    sides = [side for side in "12" if heights(results[-1], side) is not None]
    side = max(sides, key=lambda name: np.subtract(*heights(results[-1], name)[1:]).max())
    s, original, last = heights(results[-1], side)
    first, a = heights(results[0], side)[2], results[0].attrs["a"]
    shown = np.abs(s - s[np.argmax(original - last)]) <= 0.5 * PROFILE_WIDTH * a
    abscissa = 1e3 * (s.max() - s if results[0].attrs[f"u{side}"] > 0.0 else s - s.min())
    for z, colour, name, dashes in (
        (original, "k", "before", ":"),
        (first, FIRST, "after pass 1", "-"),
        (last, LAST, f"after pass {len(results)}", "-"),
    ):
        axes.plot(abscissa[shown], 1e6 * z[shown], dashes, color=colour, label=name)
    around = "abscissa of the profile, around the deepest indentation [mm]"
    axes.set(xlabel=around, ylabel=f"height of surface {side} [µm]")
    style.legend_above(axes)


def draw_pressure(axes: Axes, results: list[Result]) -> None:
    """Draw the pressures of the first and the last pass at the maximum load on the solids of the first."""
    first, last = results[0], results[-1]
    frame = min(frame_to_show(first), len(first.time) - 1, len(last.time) - 1)
    x = first.x / first.attrs["a"]
    for result, colour, name in ((first, FIRST, "pass 1"), (last, LAST, f"pass {len(results)}")):
        axes.plot(x, 1e-9 * result["pressure"][frame], color=colour, label=name)
    axes.set(xlabel=style.ACROSS, ylabel="pressure [GPa]", xlim=(-1.2, 1.2))
    style.legend_above(axes, title=f"at {1e6 * first.time[frame]:.4g} µs")


def draw_plastic_deformation(axes: Axes, rows: list[dict], result: Result) -> None:
    """Draw the area or volume set plastically by the end of each pass, and Ra or Sa of both surfaces."""
    kind = KINDS[result.case.kind]
    (factor, word, unit), name = MEASURES[kind.is_whole][1], kind.mean_height
    values = factor * np.array([row["set_volume"] for row in rows])
    axes.plot(*_over_passes(axes, values), ".-", color=LAST, label=f"plastic {word}")
    axes.set(ylabel=f"plastic {word} of both surfaces [{unit}]", ylim=(0.0, 1.1 * values.max() or 1.0))
    ra_axes = axes.twinx()
    for side, dashes in (("1", "--"), ("2", ":")):
        if all(row[side] for row in rows) and rows[0][side]["ra"] > 0.0:
            ra = 1e6 * np.array([row[side]["ra"] for row in rows])
            line = dict(color=style.SURFACES[side], label=f"{name} of surface {side}")
            ra_axes.plot(*_over_passes(axes, ra), dashes, **line)
    ra_axes.set_ylabel(f"{name} [µm]")
    style.legend_above(axes, ra_axes)


def draw_contact(axes: Axes, rows: list[dict], result: Result) -> None:
    """Draw the means of the load fraction of the solids and of the contact length or area."""
    is_whole = KINDS[result.case.kind].is_whole
    factor, word, unit = MEASURES[is_whole][0]
    names = "contact_share", "contact_area" if is_whole else "contact_length"
    share, length = (np.array([row.get(name) for row in rows], float) for name in names)
    axes.plot(*_over_passes(axes, share), ".-", color=LAST)
    axes.set_ylabel("share of the load on solids", color=LAST)
    length_axes = axes.twinx()
    length_axes.plot(*_over_passes(axes, factor * length), ".--", color=style.SINGLE)
    length_axes.set_ylabel(f"{word} in contact [{unit}]", color=style.SINGLE)
    axes.set_ylim(0.0, 1.1 * np.nanmax(share, initial=0.0) or 1.0)
    # twice the room above, so that both curves stay apart
    length_axes.set_ylim(0.0, 2.3 * factor * np.nanmax(length, initial=0.0) or 1.0)


def draw_fatigue(axes: Axes, damages: list[PostResult], side: str) -> None:
    """Draw the maximum damage of a surface at each depth over the passes."""
    depths = damages[0].z
    if not all(
        side in post.damage and post.complete[side].any() and np.array_equal(post.z, depths)
        for post in damages
    ):
        axes.set_axis_off()
        return
    maxima = np.transpose([post.passed(side).max(axis=1) for post in damages])
    for maximum, depth, colour in zip(maxima, depths, style.shades(len(depths)), strict=True):
        axes.semilogy(*_over_passes(axes, maximum), ".-", color=colour, label=f"{depth:g} a")
    axes.set_ylabel(f"maximum damage D of surface {side}")
    style.legend_beside(axes, title="depth")


def _over_passes(axes: Axes, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Numbers of the passes beside their values; labels the axis."""
    axes.set_xlabel("pass")
    axes.xaxis.get_major_locator().set_params(integer=True)
    return np.arange(1, len(values) + 1), values
