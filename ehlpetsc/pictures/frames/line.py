"""Pressure, film or another field, and deformed surfaces of line contacts and sections at an instant."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ehlpetsc.physics.contact.hertz import hertz_pressure
from ehlpetsc.pictures import style
from ehlpetsc.pictures.frames.choice import Choice
from ehlpetsc.pictures.frames.data import MOSTLY, PRESSURE_LABEL, Frame, Limits, common, contact_word
from ehlpetsc.pictures.style import ACROSS
from ehlpetsc.results.reader import Result

LINE_SIZE = (8.4, 5.6)  # inches
HEIGHT_WITH_SURFACES = 7.6  # inches
FILL_DEPTH = 1e3  # µm, to which solids are filled


def draw_frame(figure: Figure, choice: Choice) -> None:
    """Draw pressure and film or another field into an empty figure, of one rough result the surfaces."""
    first, *others = choice.results
    rough = not (choice.field or others) and any(first.profile(side) for side in "12")
    figure.set_size_inches(LINE_SIZE[0], HEIGHT_WITH_SURFACES if rough else LINE_SIZE[1])
    axes = figure.subplots(3 if rough else 2, 1, sharex=True)
    fill(axes[:2], choice)
    if rough:
        deformed_surfaces(axes[2], first, choice.indices[0], choice.window)
        axes[1].set_xlabel("")


def movie_panels(figure: Figure, frame: Frame, limits: Limits) -> Sequence[Axes]:
    """Axes of a movie in an empty figure."""
    figure.set_size_inches(LINE_SIZE)
    return figure.subplots(2, 1, sharex=True)


def fill(axes: Sequence[Axes], choice: Choice, limits: Limits | None = None) -> None:
    """Draw pressure and film or another field into two axes, of one result the load on the solids."""
    (upper, lower), results, shown = axes, choice.results, choice.frames
    colours, names, key = style.series_colours(results)
    if len(results) == 1:
        draw_curves(axes, shown[0], contact_word(results[0]))
    else:
        for number, (frame, colour, name) in enumerate(zip(shown, colours, names, strict=True)):
            line = dict(color=colour, lw=1.1, ls="--" if number == 1 and len(results) == 2 else "-")
            upper.plot(frame.x, frame.pressure, label=name, **line)
            lower.plot(frame.x, frame.values, **line)
    dry = {(frame.half_widths[0], frame.p0): frame for frame in shown}
    for number, frame in enumerate(dry.values()):
        draw_hertz(upper, frame, choice.window, "_" * number + "Hertz")
    style.legend_beside(upper, title=style.LABELS.get(key, key))
    style.legend_beside(lower)
    limits = limits or common(frame.limits for frame in shown)
    label = next((frame.label for frame in shown if frame.word == "film"), shown[0].label)
    lower.set(xlabel=ACROSS, xlim=choice.window, ylim=limits[2:], ylabel=label)
    upper.set(ylabel=PRESSURE_LABEL, ylim=(0.0, limits.pressure))
    if len({float(result.attrs["a"]) for result in results}) == 1:
        style.scale_above(upper, 1e3 * results[0].attrs["a"], "x [mm]")
    if choice.flow:
        upper.text(0.02, 0.9, choice.flow, transform=upper.transAxes, fontsize="small", color="0.35")


def draw_curves(axes: Sequence[Axes], frame: Frame, contact: str) -> None:
    """Draw pressures and values along a line of nodes, nodes in contact marked on the film."""
    upper, lower = axes
    if frame.solids.any():
        solid_area = dict(color=style.SOLIDS, lw=0, zorder=1.5, label="of the solids")
        upper.fill_between(frame.x, 0.0, frame.solids, **solid_area)
    upper.plot(frame.x, frame.pressure, color=style.SINGLE, lw=1.1, label="pressure")
    lower.plot(frame.x, frame.values, color=style.SINGLE, lw=1.1, label=frame.word)
    if frame.is_film and (touching := frame.share > MOSTLY).any():
        marks = dict(color=style.CONTACTS, ms=4, clip_on=False, zorder=3, label=contact)
        lower.plot(frame.x[touching], frame.values[touching], "v", **marks)


def draw_hertz(axes: Axes, frame: Frame, window: Sequence[float], label: str = "Hertz") -> None:
    """Draw the pressure of the dry contact within limits of the abscissa."""
    x = np.linspace(window[0], window[1], 801)
    pressure = hertz_pressure(x / frame.half_widths[0], 1.0, frame.p0)
    axes.plot(x, pressure, ":", color="0.6", lw=0.9, zorder=1, label=label)


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
    x = result.x / result.attrs["a"]
    shown = (x >= window[0]) & (x <= window[1])
    inside = shown & (np.abs(result.x) <= style.hertz_at(result, index)[0])
    inside = inside if inside.any() else shown
    lower, upper = (1e6 * height for height in deformed_heights(result, index))
    bottom, top = lower[inside].min(), upper[inside].max()
    room = 0.15 * (top - bottom)
    for height, end, side in ((upper, FILL_DEPTH, "1"), (lower, -FILL_DEPTH, "2")):
        axes.fill_between(x, height, end, color="0.85", lw=0)
        axes.plot(x, height, color=style.SURFACES[side], lw=0.9, label=f"surface {side}")
    axes.set(xlabel=ACROSS, ylabel="surfaces [µm]", ylim=(bottom - room, top + room))
    style.legend_beside(axes)
