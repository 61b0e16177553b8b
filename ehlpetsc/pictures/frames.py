"""Pressure, film and deformed surfaces at an instant; x in half-widths, film in µm, pressure in GPa."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ehlpetsc.base.errors import OutputError
from ehlpetsc.physics.hertz import hertz_pressure
from ehlpetsc.pictures import style
from ehlpetsc.pictures.style import ACROSS
from ehlpetsc.results.means import both_fill
from ehlpetsc.results.reader import Result

PRESSURE = "pressure [GPa]"
FILM = "film thickness [µm]"
GAP = "gap [µm]"  # of a dry contact
WINDOW = (-1.6, 1.4)  # limits of x/a by default
SIZE = (8.4, 5.6)  # inches
HEIGHT_WITH_SURFACES = 7.6  # inches
FAR = 1e3  # µm, to which solids are filled
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
    first = results[0]
    if step is None and time is None:
        frame = frame_to_show(first, min(travel_of(result)[-1] for result in results))
    else:
        wanted, stored = (step, first.step) if time is None else (time, first.time)
        if not stored[0] <= wanted <= stored[-1] * (1.0 + 1e-9):
            allowed = f"{stored[0]:g} to {stored[-1]:g}"
            raise OutputError(f"{first.path}: no frame at {wanted:g}; allowed: {allowed}")
        frame = first.nearest_frame(step=step, time=time)
    travel = travel_of(first)[frame]
    return [frame, *(_frame_at(result, travel, first.time[frame]) for result in results[1:])]


def _frame_at(result: Result, travel: float, time: float) -> int:
    """Frame at a travel [half-widths], of several that nearest to a time [s]."""
    last = path_length(result)[-1] / result.attrs["a"]
    if travel > last * (1.0 + 1e-9) + 1e-12:
        raise OutputError(f"{result.path}: ends at travel {last:.4g} a, before travel {travel:.4g} a")
    return int(np.argmin(np.abs(travel_of(result) - travel) + np.abs(result.time - time)))


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


def view(results: list[Result], chosen: Sequence[float] | None = None) -> Sequence[float]:
    """Limits of x/a, by default around the contact, within the domains of all results."""
    low = max(result.x[0] / result.attrs["a"] for result in results)
    high = min(result.x[-1] / result.attrs["a"] for result in results)
    return chosen or (max(low, WINDOW[0]), min(high, WINDOW[1]))


def instant(results: list[Result], indices: Sequence[int]) -> str:
    """Text with the travel of stored frames, and step and time if they are equal; "" if steady."""
    first, index = results[0], indices[0]
    if len(first.time) == 1:
        return ""
    travel = f"travel {travel_of(first)[index]:.2f} a"
    if len({float(result.time[k]) for result, k in zip(results, indices, strict=True)}) > 1:
        return travel
    return f"step {first.step[index]}, {1e6 * first.time[index]:.4g} µs, {travel}"


def panel_title(results: list[Result], indices: Sequence[int]) -> list[str]:
    """Lines of a title: the common title of results with the instant, then the conditions there."""
    titles = {str(result.attrs["title"]) for result in results}
    texts = [titles.pop() if len(titles) == 1 else "", instant(results, indices)]
    return [": ".join(filter(None, texts)), style.conditions(results, indices)]


def fill_frame(
    axes: Sequence[Axes], results: list[Result], indices: Sequence[int], window: Sequence[float]
) -> None:
    """Draw pressure and film at an instant into two axes; of a single result also what the solids carry.

    The film axis ends above the maximum film inside the contact, or in view if there is none inside.
    """
    upper, lower = axes
    colours, names, key = style.series_colours(results)
    single, across, highest, thickest = len(results) == 1, np.linspace(*window, 801), 1e-3, 0.0
    for number, (result, index, colour) in enumerate(zip(results, indices, colours, strict=True)):
        line = dict(color=colour, lw=1.1, ls="--" if number == 1 and len(results) == 2 else "-")
        x, shown, inside = shown_nodes(result, index, window)
        pressure, film = 1e-9 * result.frame("pressure", index), 1e6 * result.frame("film_thickness", index)
        if single:
            draw_solids(axes, result, index, shown)
        upper.plot(x, pressure, label="pressure" if single else names[number], **line)
        gap = "film" if result.case.fluid else "gap"
        lower.plot(x, film, label=gap if single else None, **line)
        highest = max(highest, pressure[shown].max())
        thickest = max(thickest, film[inside].max() or film[shown].max())
    contacts = [style.hertz_at(result, index) for result, index in zip(results, indices, strict=True)]
    curves = {(a / r.attrs["a"], p0): None for r, (a, p0) in zip(results, contacts, strict=True)}
    for number, (width, p0) in enumerate(curves):
        pressure, label = 1e-9 * hertz_pressure(across / width, 1.0, p0), "_" * number + "Hertz"
        upper.plot(across, pressure, ":", color="0.6", lw=0.9, zorder=1, label=label)
        highest = max(highest, pressure.max())
    style.legend_beside(upper, title=style.UNITS.get(key, key))
    style.legend_beside(lower)
    lower.set(xlabel=ACROSS, xlim=window, ylim=(0.0, 1.15 * thickest or 1.0))
    upper.set(ylabel=PRESSURE, ylim=(0.0, 1.05 * highest))
    lower.set_ylabel(FILM if any(result.case.fluid for result in results) else GAP)
    if len({float(result.attrs["a"]) for result in results}) == 1:
        style.scale_above(upper, 1e3 * results[0].attrs["a"], "x [mm]")
    mark_flow(upper, results, indices)


def shown_nodes(
    result: Result, index: int, window: Sequence[float]
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """x/a, whether nodes are in view, and also inside the contact of a frame, if any is; shape (nx,)."""
    x = result.x / result.attrs["a"]
    shown = (x >= window[0]) & (x <= window[1])
    inside = shown & (np.abs(result.x) <= style.hertz_at(result, index)[0])
    return x, shown, inside if inside.any() else shown


def draw_solids(axes: Sequence[Axes], result: Result, index: int, shown: np.ndarray) -> None:
    """Fill the pressure of the solids and mark nodes in contact, of those `shown`."""
    x = result.x / result.attrs["a"]
    if "contact_pressure" in result:
        solids = np.where(shown, 1e-9 * result.frame("contact_pressure", index), 0.0)
        label = "of the solids" if solids.any() else None
        axes[0].fill_between(x, 0.0, solids, color=style.SOLIDS, lw=0, zorder=1.5, label=label)
    if "in_contact" in result and (touching := shown & result.contacts_at(index)).any():
        marks = dict(color=style.CONTACT, ms=4, clip_on=False, zorder=3, label="in contact")
        axes[1].plot(x[touching], 1e6 * result.frame("film_thickness", index)[touching], "v", **marks)


def mark_flow(axes: Axes, results: list[Result], indices: Sequence[int]) -> None:
    """Mark the direction of the entrainment, if there is oil and all results have the same."""
    signs = {np.sign(sum(style.speeds_at(result, k))) for result, k in zip(results, indices, strict=True)}
    if len(signs) == 1 and any(result.case.fluid for result in results):
        text = {1.0: "flow →", -1.0: "← flow"}.get(signs.pop())
        axes.text(0.02, 0.9, text, transform=axes.transAxes, fontsize="small", color="0.35")


def deformed_heights(result: Result, index: int) -> tuple[np.ndarray, np.ndarray]:
    """Heights [m] of surface 2, below, and of surface 1 about their mean plane, shape (nx,).

    Both solids are assumed to deform equally: the middle of the gap is that of the undeformed rough surfaces.
    """
    middle = np.zeros(len(result.x))
    for side, sign in (("2", 1.0), ("1", -1.0)):
        profile = result.profile(side)
        if profile is not None:
            s, z, speed = profile
            moved, name = speed * result.time[index], f"displacement_{side}"
            if name in result.scalars:
                moved = np.interp(result.time[index], result.steps("time"), result.steps(name))
            middle += 0.5 * sign * np.interp(result.x - moved, s, z, left=0.0, right=0.0)
    film = result.frame("film_thickness", index)
    return middle - 0.5 * film, middle + 0.5 * film


def deformed_surfaces(axes: Axes, result: Result, index: int, window: Sequence[float]) -> None:
    """Draw both deformed surfaces at an instant, solids in grey."""
    x, _, inside = shown_nodes(result, index, window)
    lower, upper = (1e6 * height for height in deformed_heights(result, index))
    bottom, top = lower[inside].min(), upper[inside].max()
    room = 0.15 * (top - bottom)
    for height, end, side in ((upper, FAR, "1"), (lower, -FAR, "2")):
        axes.fill_between(x, height, end, color="0.85", lw=0)
        axes.plot(x, height, color=style.SURFACES[side], lw=0.9, label=f"surface {side}")
    axes.set(xlabel=ACROSS, ylabel="surfaces [µm]", ylim=(bottom - room, top + room))
    style.legend_beside(axes)


def draw_frame(results: list[Result], options: argparse.Namespace) -> Figure:
    """Pressure and film at an instant; for one rough result also both deformed surfaces."""
    indices, window = choose_frames(results, options.step, options.time), view(results, options.window)
    rough = len(results) == 1 and any(results[0].profile(side) for side in "12")
    size = (SIZE[0], HEIGHT_WITH_SURFACES) if rough else SIZE
    figure, axes = style.new_figure(3 if rough else 2, 1, size, sharex=True)
    fill_frame(axes[:2], results, indices, window)
    if rough:
        deformed_surfaces(axes[2], results[0], indices[0], window)
        axes[1].set_xlabel("")
    style.set_title(figure, *panel_title(results, indices))
    return figure
