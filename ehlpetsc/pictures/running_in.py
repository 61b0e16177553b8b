"""Surfaces, pressure, contact and damage pass by pass, as the surfaces run in."""

from __future__ import annotations

import argparse

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ehlpetsc.base.case import KINDS
from ehlpetsc.base.errors import OutputError
from ehlpetsc.pictures import style
from ehlpetsc.pictures.frames.choice import frame_to_show
from ehlpetsc.results.means import heights, pass_summary
from ehlpetsc.results.post_result import PostResult, damage_beside
from ehlpetsc.results.reader import Result

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
