"""Running-in: heights and pressure before and after, and the changes in each pass."""

import numpy as np

from ehlpetsc.errors import OutputError
from ehlpetsc.pictures import labels
from ehlpetsc.pictures.frames import frame_to_show
from ehlpetsc.results.post_result import damage_beside
from ehlpetsc.results.running_in import heights, pass_summary

SIZE, SIZE_WITH_DAMAGE = (11.0, 7.0), (15.0, 7.0)  # inches; with damage
PROFILE_WIDTH = 0.6  # half widths of profile around the deepest indentation
MARGIN_FACTOR = 1.15  # above the highest value
LENGTH_AXIS_FACTOR = 2.0  # separates the curve of the length from that of the load fraction
FIRST_COLOUR, LAST_COLOUR = "0.65", "C3"  # of the passes
MAX_SINGLE_PASSES = 30  # more passes are drawn as dots and means over several
PASSES_PER_MEAN = 10
MIN_ADDED = 1e-3  # of the area added by the first pass: smaller values are drawn at the edge


def draw_running_in(results, _options):
    """Figure of all passes of a run, in their order.

    Parameters
    ----------
    results : list of Result

    Raises
    ------
    OutputError
        Fewer than two passes, or solids that do not yield.
    """
    if len(results) < 2:
        raise OutputError("one pass alone; allowed: --running-in of two passes or more")
    if any("set_volume" not in result.scalars for result in results):
        raise OutputError("solids that do not yield: no plastic deformation; needs contact.yield_pressure")
    rows = [pass_summary(result) for result in results]
    post_results = [damage_beside(result) for result in results]
    has_damage = all(post_results)
    damages = [post_result.summary() for post_result in post_results] if has_damage else []
    figure, axes = labels.new_figure(2, 3 if has_damage else 2, SIZE_WITH_DAMAGE if has_damage else SIZE)
    draw_surface(axes[0, 0], results)
    draw_pressure(axes[1, 0], results)
    time = results[0].case.time
    draw_plastic_area(axes[0, 1], rows, time is not None and time.pass_shift != 0.0)
    draw_contact(axes[1, 1], rows)
    if has_damage:
        for row, side in zip(axes, ("1", "2"), strict=True):
            draw_fatigue(row[2], damages, side)
    figure.suptitle(labels.title(results), fontsize="medium")
    return figure


def draw_surface(axes, results):
    """Draw the surface with the deepest indentation: original, after the first and after the last pass."""
    sides = [side for side in ("1", "2") if heights(results[-1], side) is not None]
    side = max(sides, key=lambda name: np.subtract(*heights(results[-1], name)[1:]).max())
    s, original, last = heights(results[-1], side)
    first = heights(results[0], side)[2]
    a = results[0].attrs["a"]
    in_view = np.abs(s - s[np.argmax(original - last)]) <= 0.5 * PROFILE_WIDTH * a
    forward = results[0].attrs["u1" if side == "1" else "u2"] > 0.0
    abscissa = 1e3 * (s.max() - s if forward else s - s.min())
    for z, colour, name, style in (
        (original, "k", "before", ":"),
        (first, FIRST_COLOUR, "after pass 1", "-"),
        (last, LAST_COLOUR, f"after pass {len(results)}", "-"),
    ):
        axes.plot(abscissa[in_view], 1e6 * z[in_view], style, color=colour, label=name)
    axes.set(
        xlabel="abscissa of the profile, around the deepest indentation [mm]",
        ylabel=f"height of surface {side} [µm]",
    )
    legend_above(axes)


def draw_pressure(axes, results):
    """Draw the pressures of the first and the last pass at the maximum load on the solids of the first."""
    first, last = results[0], results[-1]
    common = min(len(first.time), len(last.time))
    frame = min(frame_to_show(first), common - 1)
    x = first.x / first.attrs["a"]
    for result, colour, name in (
        (first, FIRST_COLOUR, "pass 1"),
        (last, LAST_COLOUR, f"pass {len(results)}"),
    ):
        axes.plot(x, 1e-9 * result["pressure"][frame], color=colour, label=name)
    axes.set(xlabel="x/a", ylabel="pressure [GPa]", xlim=(-1.2, 1.2))
    at = f"at {1e6 * first.time[frame]:.1f} µs"
    legend_above(axes, title=at)


def legend_above(axes, *others, title=None):
    """Draw the legend of the axes and of others in a row above the axes."""
    handles = [handle for panel in (axes, *others) for handle in panel.get_legend_handles_labels()[0]]
    position = dict(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncol=3, frameon=False)
    if handles:
        axes.legend(handles=handles, title=title, fontsize="small", title_fontsize="small", **position)


def draw_plastic_area(axes, rows, is_shifted):
    """Draw the plastic area added by each pass, relative to the first, and Ra of both surfaces."""
    numbers = np.arange(1, len(rows) + 1)
    volumes = np.array([row["set_volume"] for row in rows])
    added = np.diff(volumes, prepend=0.0) / volumes[0]
    axes.set_yscale("log")
    draw_course(axes, numbers, added, LAST_COLOUR, "o-", MIN_ADDED)
    axes.axhline(0.01, color="0.5", lw=0.8, ls=":")
    axes.set(xlabel="pass", ylabel="plastic area added / that of pass 1", xticks=ticks(numbers))
    axes.set_ylim(bottom=0.8 * MIN_ADDED)
    ra_axes = axes.twinx()
    names = {"1": "Ra 1", "2": "Ra 2, its stretch moves on" if is_shifted else "Ra 2"}
    for side, style in (("1", "^--"), ("2", "v:")):
        if all(row[side] for row in rows) and rows[0][side]["ra"] > 0.0:
            ra = [1e6 * row[side]["ra"] for row in rows]
            ms = 4 if len(rows) <= MAX_SINGLE_PASSES else 0
            ra_axes.plot(numbers, ra, style, color="C0", ms=ms, alpha=0.6, label=names[side])
    ra_axes.set_ylabel("Ra [µm]", color="C0")
    legend_above(ra_axes, axes)


def draw_course(axes, numbers, values, colour, style, least=-np.inf):
    """Draw a quantity over the passes, at least `least`; as dots and means above `MAX_SINGLE_PASSES`."""
    shown = np.maximum(values, least)
    if len(numbers) <= MAX_SINGLE_PASSES:
        axes.plot(numbers, shown, style, color=colour, ms=4)
        return
    axes.plot(numbers, shown, style[0], color=colour, ms=3, alpha=0.4, mew=0)
    begins = range(0, len(numbers), PASSES_PER_MEAN)
    means = [np.mean(values[begin : begin + PASSES_PER_MEAN]) for begin in begins]
    edges = [0.5, *(min(begin + PASSES_PER_MEAN, len(numbers)) + 0.5 for begin in begins)]
    axes.stairs(means, edges, baseline=None, color=colour, lw=2.0, label=f"means of {PASSES_PER_MEAN} passes")


def draw_contact(axes, rows):
    """Draw the means of the load fraction of the solids and of the contact length."""
    numbers = np.arange(1, len(rows) + 1)
    share, length = (
        np.array([np.nan if row.get(name) is None else row[name] for row in rows])
        for name in ("contact_share", "contact_length")
    )
    draw_course(axes, numbers, share, LAST_COLOUR, "o-")
    axes.set(xlabel="pass", ylabel="share of the load on solids", xticks=ticks(numbers))
    axes.set_ylim(0.0, _top(share, MARGIN_FACTOR))
    length_axes = axes.twinx()
    draw_course(length_axes, numbers, 1e6 * length, "C0", "s--")
    legend_above(axes)
    length_axes.set_ylabel("length in contact [µm]", color="C0")
    length_axes.set_ylim(0.0, _top(1e6 * length, LENGTH_AXIS_FACTOR * MARGIN_FACTOR))
    if not np.isfinite(share).any():
        note = "the run ends before both surfaces\nfill the contact: no means over time"
        axes.text(0.5, 0.5, note, transform=axes.transAxes, ha="center", va="center")


def _top(values, margin):
    """Upper limit of an axis above the largest value; 1 if all values are 0 or unknown."""
    largest = np.nanmax(values, initial=0.0)
    return margin * largest if largest > 0.0 else 1.0


def draw_fatigue(axes, damages, side):
    """Draw the maximum damage of a surface at each depth over the passes."""
    numbers = np.arange(1, len(damages) + 1)
    depths = damages[0]["z_over_a"]
    if any(side not in damage or damage["z_over_a"] != depths for damage in damages):
        axes.set_axis_off()
        return
    for k, depth in enumerate(depths):
        colour = labels.mpl.colormaps["viridis"](0.9 * k / max(len(depths) - 1, 1))
        largest = [damage[side]["largest"][k] for damage in damages]
        axes.semilogy(numbers, largest, "o-", ms=4, color=colour, label=f"{depth:g} a")
    axes.set(xlabel="pass", ylabel=f"largest damage D of surface {side}", xticks=ticks(numbers))
    labels.legend_beside(axes, title="depth")


def ticks(numbers):
    """At most ten of the numbers of passes, for ticks."""
    return numbers[:: -(-len(numbers) // 10)]
