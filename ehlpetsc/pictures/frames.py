"""Pressure, film and deformed surfaces at an instant; x in half-widths, film in µm, pressure in GPa."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from ehlpetsc.base.errors import OutputError
from ehlpetsc.physics.exact_solutions import hertz_pressure
from ehlpetsc.pictures import style
from ehlpetsc.pictures.style import ACROSS
from ehlpetsc.results.contacts import in_contact
from ehlpetsc.results.means import both_fill
from ehlpetsc.results.reader import Result

SIDES = {"1": "surface 1", "2": "surface 2"}
PRESSURE = "pressure [GPa]"
FILM = "film thickness [µm]"
GAP = "gap [µm]"  # without oil
WINDOW = (-1.6, 1.4)  # limits of x/a by default
SIZE = (8.4, 5.6)  # inches
HEIGHT_WITH_SURFACES = 7.6  # inches
AROUND_WIDTH = 0.5  # half-widths, of a view around a point
HERTZ = dict(color="0.6", lw=0.9, ls=":", zorder=1)
MIN_LOAD_ON_SOLIDS = 0.005  # of the load: with less the pressure determines the instant


def path_length(result: Result) -> np.ndarray:
    """Length of the path of the faster surface at the end of each step [m], shape (nsteps,).

    It increases where speeds reverse, unlike the displacement.
    """
    if "displacement_1" in result.scalars:
        moved = [np.diff(result.steps(f"displacement_{side}"), prepend=0.0) for side in "12"]
        return np.cumsum(np.abs(moved), axis=1).max(axis=0)
    return max(abs(result.attrs["u1"]), abs(result.attrs["u2"])) * result.steps("time")


def travel_of(result: Result) -> np.ndarray:
    """Path of the faster surface at the stored frames [half-widths], shape (nt,)."""
    return np.interp(result.time, result.steps("time"), path_length(result)) / result.attrs["a"]


def choose_frames(results: list[Result], step: int | None = None, time: float | None = None) -> list[int]:
    """Stored frame of every result nearest to a step or time [s] of the first; both None: `frame_to_show`.

    Results with different speeds are compared at equal travel of the faster surface, at which asperities are
    in the same position.
    """
    first, shown = results[0], results[0]
    if step is not None:
        last = int(first.steps("step")[-1])
        if not first.step[0] <= step <= last:
            raise OutputError(f"{first.path}: --step {step}; allowed: {first.step[0]} to {last}")
        frame = first.nearest_frame(step=step)
    elif time is not None:
        last = first.steps("time")[-1]
        if not first.time[0] <= time <= last * (1.0 + 1e-9):
            raise OutputError(f"{first.path}: --time {time:g}; allowed: {first.time[0]:g} to {last:.9g} s")
        frame = first.nearest_frame(time=time)
    else:
        shown = max(results, key=_load_on_solids)
        frame = frame_to_show(shown, min(travel_of(result)[-1] for result in results))
    travel, at = travel_of(shown)[frame], shown.time[frame]
    return [frame if result is shown else _frame_at(result, travel, at) for result in results]


def _frame_at(result: Result, travel: float, time: float) -> int:
    """Frame at a time [s], if the travel [half-widths] is that by then, otherwise at this travel."""
    travels = travel_of(result)
    last = path_length(result)[-1] / result.attrs["a"]
    if travel > last * (1.0 + 1e-9) + 1e-12:
        raise OutputError(f"{result.path}: ends at travel {last:.4g} a, before travel {travel:.4g} a")
    if np.isclose(np.interp(time, result.time, travels), travel, rtol=1e-6, atol=1e-6):
        return result.nearest_frame(time=time)
    return int(np.argmin(np.abs(travels - travel)))


def _load_on_solids(result: Result) -> tuple[float, float]:
    """Sort key of results: maximum fraction of the load on the solids, then maximum pressure."""
    share = np.nanmax(result.steps("contact_share")) if "contact_share" in result.scalars else 0.0
    return (share if share > MIN_LOAD_ON_SOLIDS else 0.0), np.nanmax(result.steps("p_max"))


def frame_to_show(result: Result, reached: float = np.inf) -> int:
    """Stored frame with the maximum load on the solids or, if they carry hardly any, the maximum pressure.

    Frames before both surfaces fill the contact are used only if there are no others, because the leading
    edge of a profile is not typical; frames beyond a travel of `reached` [half-widths] never.
    """
    allowed = travel_of(result) <= reached * (1.0 + 1e-9)
    if (filled := allowed & both_fill(result, result.time)).any():
        allowed = filled
    rows = np.searchsorted(result.steps("step"), result.step)
    values = result.steps("p_max")[rows]
    if "contact_share" in result.scalars:
        share = np.nan_to_num(result.steps("contact_share")[rows])
        if share[allowed].max() > MIN_LOAD_ON_SOLIDS:
            values = share * result.steps("load")[rows]
    return int(np.argmax(np.where(allowed, np.nan_to_num(values), -1.0)))


def default_window(results: list[Result]) -> tuple[float, float]:
    """Limits of x/a around the contact, within the domains of all results."""
    low = max(result.x[0] / result.attrs["a"] for result in results)
    high = min(result.x[-1] / result.attrs["a"] for result in results)
    return max(low, WINDOW[0]), min(high, WINDOW[1])


def window(results: list[Result], options: argparse.Namespace) -> tuple[float, float]:
    """Limits of x/a of the options `around` and `width`."""
    if options.around is None:
        return default_window(results)
    half = 0.5 * (options.width or AROUND_WIDTH)
    return options.around - half, options.around + half


def instant(results: list[Result], indices: Sequence[int]) -> str:
    """Text with the travel of stored frames, and step and time if they are equal; "" if steady."""
    first, index = results[0], indices[0]
    if len(first.time) == 1:
        return ""
    travel = f"travel {travel_of(first)[index]:.2f} a"
    times = np.array([result.time[k] for result, k in zip(results, indices, strict=True)])
    if np.ptp(times) > 0.5 * np.nanmax(first.steps("dt")):
        return travel
    return f"step {first.step[index]}, {style.digits(1e6 * times[0])} µs, {travel}"


def panel_title(results: list[Result], indices: Sequence[int]) -> list[str]:
    """Lines of a title: the common title of results with the instant, then the conditions there."""
    titles = {str(result.attrs["title"]) for result in results}
    texts = [titles.pop() if len(titles) == 1 else "", instant(results, indices)]
    return [": ".join(filter(None, texts)), style.conditions(results, indices)]


def pressure_and_film(
    axes: Sequence[Axes],
    results: list[Result],
    indices: Sequence[int],
    colours: Sequence,
    window: tuple[float, float],
) -> None:
    """Draw pressure and film into two axes; for a single result also contacts and the pressure of the solids.

    The film axis ends above the maximum film inside the contact, or in view if there is none inside.
    """
    upper, lower = axes
    highest, thickest = _hertz(upper, results, indices, colours, window), 0.0
    for number, (result, index, colour) in enumerate(zip(results, indices, colours, strict=True)):
        line = dict(color=colour, lw=1.1, ls="--" if number == 1 and len(results) == 2 else "-")
        x = result.x / result.attrs["a"]
        pressure, film = 1e-9 * result.frame("pressure", index), 1e6 * result.frame("film_thickness", index)
        upper.plot(x, pressure, **line)
        lower.plot(x, film, **line)
        shown = (x >= window[0]) & (x <= window[1])
        inside = shown & (np.abs(x) <= 1.0)
        highest = max(highest, pressure[shown].max())
        thickest = max(thickest, film[inside].max(initial=0.0) or film[shown].max())
        if len(results) == 1:
            if "contact_pressure" in result:
                solids = 1e-9 * result.frame("contact_pressure", index)
                upper.fill_between(x, 0.0, solids, color=style.SOLIDS, lw=0, zorder=1.5)
            touching = shown & in_contact(result, index)
            if touching.any():  # an empty line would affect the layout
                marks = dict(color=style.CONTACT, ms=4, clip_on=False, zorder=3)
                lower.plot(x[touching], film[touching], "v", **marks)
    upper.set_ylabel(PRESSURE)
    upper.set_ylim(0.0, 1.05 * highest or 1.0)
    lower.set_ylabel(FILM if any(map(style.is_lubricated, results)) else GAP)
    lower.set_ylim(0.0, 1.15 * thickest or 1.0)
    lower.set_xlabel(ACROSS)
    lower.set_xlim(*window)


def _hertz(
    axes: Axes, results: list[Result], indices: Sequence[int], colours: Sequence, window: tuple[float, float]
) -> float:
    """Draw the Hertz pressure at the instants, once if equal for all; returns its maximum [GPa]."""
    x = np.linspace(*window, 801)
    contacts = [style.hertz_at(result, index) for result, index in zip(results, indices, strict=True)]
    curves = [
        1e-9 * hertz_pressure(x * result.attrs["a"] / a, 1.0, p0)
        for result, (a, p0) in zip(results, contacts, strict=True)
    ]
    if np.allclose(curves, curves[0], rtol=1e-9):
        axes.plot(x, curves[0], **HERTZ)
    else:
        for curve, colour in zip(curves, colours, strict=True):
            axes.plot(x, curve, **HERTZ | {"color": colour})
    return float(np.max(curves))


def mark_flow(axes: Axes, results: list[Result], indices: Sequence[int]) -> None:
    """Draw an arrow in the direction of the entrainment, if there is oil and all results have the same."""
    signs = {np.sign(sum(style.speeds_at(result, k))) for result, k in zip(results, indices, strict=True)}
    if len(signs) > 1 or signs == {0.0} or not any(map(style.is_lubricated, results)):
        return
    ends = dict(xy=(0.13, 0.9), xytext=(0.02, 0.9), xycoords="axes fraction", textcoords="axes fraction")
    if signs == {-1.0}:
        ends |= dict(xy=ends["xytext"], xytext=ends["xy"])
    axes.annotate("", **ends, arrowprops=dict(arrowstyle="->", color="0.35"))
    axes.text(0.14, 0.9, "flow", transform=axes.transAxes, va="center", fontsize="small", color="0.35")


def x_in_mm(axes: Axes, results: list[Result]) -> None:
    """Add an axis in mm if all results have the same a."""
    a = {float(result.attrs["a"]) for result in results}
    if len(a) == 1:
        scale = 1e3 * a.pop()
        above = axes.secondary_xaxis("top", functions=(lambda x: x * scale, lambda x: x / scale))
        above.tick_params(labelsize="small")
        above.set_xlabel("x [mm]", fontsize="small")


def deformed_heights(result: Result, index: int) -> tuple[np.ndarray, np.ndarray]:
    """Heights [m] of surface 2, below, and of surface 1 about their mean plane, shape (nx,).

    Both solids are assumed to deform equally: the middle of the gap is that of the undeformed rough surfaces.
    """
    middle = np.zeros(len(result.x))
    for side, sign in (("2", 1.0), ("1", -1.0)):
        profile = result.profile(side)
        if profile is not None:
            s, z, speed = profile
            moved = speed * result.time[index]
            if f"displacement_{side}" in result.scalars:
                moved = np.interp(
                    result.time[index], result.steps("time"), result.steps(f"displacement_{side}")
                )
            middle += 0.5 * sign * np.interp(result.x - moved, s, z, left=0.0, right=0.0)
    film = result.frame("film_thickness", index)
    return middle - 0.5 * film, middle + 0.5 * film


def deformed_surfaces(axes: Axes, result: Result, index: int, window: tuple[float, float]) -> None:
    """Draw both deformed surfaces at an instant, solids in grey."""
    x = result.x / result.attrs["a"]
    in_view = (x >= window[0]) & (x <= window[1])
    lower, upper = (1e6 * height for height in deformed_heights(result, index))
    inside = in_view & (np.abs(x) <= 1.0)
    shown = inside if inside.any() else in_view
    bottom, top = lower[shown].min(), upper[shown].max()
    room = 0.15 * (top - bottom)
    for height, end, side in ((upper, top + room, "1"), (lower, bottom - room, "2")):
        axes.fill_between(x, height, end, color="0.85", lw=0)
        axes.plot(x, height, color=style.SURFACES[side], lw=0.9, label=SIDES[side])
    axes.set_ylim(bottom - room, top + room)
    axes.set_ylabel("surfaces [µm]")
    style.legend_beside(axes)


def frame_legend(axes: Sequence[Axes], result: Result, index: int, colour: object) -> None:
    """Draw the legends of `pressure_and_film`, of the curves in view."""
    x, (low, high) = result.x / result.attrs["a"], axes[1].get_xlim()
    in_view = (x >= low) & (x <= high)
    solids = "contact_pressure" in result and result.frame("contact_pressure", index)[in_view].any()
    handles = [Line2D([], [], color=colour, lw=1.1, label="total pressure" if solids else "pressure")]
    if solids:
        handles.append(Patch(color=style.SOLIDS, label="of the solids"))
    handles.append(Line2D([], [], label="Hertz", **HERTZ))
    style.legend_beside(axes[0], handles)
    films = [Line2D([], [], color=colour, lw=1.1, label="film" if style.is_lubricated(result) else "gap")]
    if in_contact(result, index)[in_view].any():
        films.append(Line2D([], [], color=style.CONTACT, marker="v", ls="", ms=4, label="in contact"))
    style.legend_beside(axes[1], films)


def fill_frame(
    axes: Sequence[Axes], results: list[Result], indices: Sequence[int], window: tuple[float, float]
) -> None:
    """Draw pressure, film and their legends at an instant into two axes."""
    colours, names, key = style.series_colours(results)
    pressure_and_film(axes, results, indices, colours, window)
    if len(results) > 1:
        same = style.share_hertz_contact(results)
        handles = [Line2D([], [], label="Hertz", **HERTZ)] if same else []
        names = style.labels_with_hertz(names, results)
        style.series_legend(axes[0], colours, names, style.UNITS.get(key, key), handles)
    else:
        frame_legend(axes, results[0], indices[0], colours[0])
    x_in_mm(axes[0], results)
    mark_flow(axes[0], results, indices)


def draw_frame(results: list[Result], options: argparse.Namespace) -> Figure:
    """Pressure and film at an instant; for one rough result also both deformed surfaces."""
    indices, view = choose_frames(results, options.step, options.time), window(results, options)
    rough = len(results) == 1 and any(results[0].profile(side) for side in SIDES)
    size = (SIZE[0], HEIGHT_WITH_SURFACES) if rough else SIZE
    figure, axes = style.new_figure(3 if rough else 2, 1, size, sharex=True)
    fill_frame(axes[:2], results, indices, view)
    if rough:
        deformed_surfaces(axes[2], results[0], indices[0], view)
        axes[1].set_xlabel("")
        axes[2].set_xlabel(ACROSS)
    style.set_title(figure, *panel_title(results, indices))
    return figure
