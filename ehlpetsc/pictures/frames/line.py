"""Line contacts and sections: pressure, film or another field, surfaces at an instant and over time.

Over time: maps over x, temperatures, the course of all steps.
"""

from __future__ import annotations

import argparse
import textwrap
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.image import AxesImage

from ehlpetsc.base.errors import OutputError
from ehlpetsc.physics.contact.hertz import hertz_pressure
from ehlpetsc.physics.oil.viscosity_laws import KELVIN
from ehlpetsc.pictures import style
from ehlpetsc.pictures.frames import choice as frames
from ehlpetsc.pictures.frames.choice import Choice
from ehlpetsc.pictures.frames.data import (
    COLOUR_PERCENTILE,
    MOSTLY,
    PRESSURE_LABEL,
    Frame,
    Limits,
    common,
    contact_share,
    contact_word,
    described,
)
from ehlpetsc.pictures.style import ACROSS
from ehlpetsc.results.index import distinguishing_names
from ehlpetsc.results.means import filled_from
from ehlpetsc.results.reader import Result

LINE_SIZE = (8.4, 5.6)  # inches
HEIGHT_WITH_SURFACES = 7.6  # inches
SCALAR_SIZE, SCALAR_LABEL = (8.4, 4.0), 40  # inches, characters of a line
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


TEMPERATURES = {
    "film_temperature": ("film", style.FILM),
    "temperature_1": ("surface 1", style.SURFACES["1"]),
    "temperature_2": ("surface 2", style.SURFACES["2"]),
}
HEIGHTS = (1, 1, 1, 1.5)  # of the panels of temperatures, the last one over time
TEMPERATURE_SIZE, STEADY_SIZE = (8.4, 10.0), (8.4, 6.6)  # inches
LOADS = {"N/m": ("load [N/mm]", 1e-3), "N": ("load [N]", 1.0)}  # label and factor of its panel by its unit
COURSES = {  # panels over time: factor from SI units, scalars with their labels and colours
    "speed [m/s]": (1.0, {f"speed_{k}": (f"surface {k}", colour) for k, colour in style.SURFACES.items()}),
    "film [µm]": (1e6, {"film_central": ("central", style.SINGLE), "h_min": ("minimum", style.SECOND)}),
    "maximum\npressure [GPa]": (1e-9, {"p_max": ("maximum", style.SINGLE)}),
    "friction\ncoefficient": (1.0, {"friction_coefficient": ("friction", style.SINGLE)}),
    "share of the load\non the solids": (1.0, {"contact_share": ("solids", style.SINGLE)}),
    "maximum\ntemperature [K]": (1.0, {f"{name}_max": shown for name, shown in TEMPERATURES.items()}),
}
COURSE_HEIGHT = 1.5  # inches of a panel


def draw_map(results: list[Result], options: argparse.Namespace) -> Figure:
    """Pressure or another field of one result over x and time, contacts outlined."""
    [result] = results
    figure, axes = style.new_figure(1, 1, LINE_SIZE)
    window, name = frames.view(results, options.window), options.field or "pressure"
    _, label, factor = described(result, name)
    lowest = dict(vmin=0.0) if name == "pressure" else {}
    image = space_time_map(axes, result, name, window, factor, **lowest)
    figure.colorbar(image, ax=axes, label=label, extend="max")
    x = result.x / result.attrs["a"]
    columns = style.in_view(x, window)
    share = contact_share(result, (slice(0, len(result.time)), columns))
    if share.max() > MOSTLY:
        axes.contour(x[columns], 1e6 * result.time, share, [MOSTLY], colors=style.CONTACTS, linewidths=0.7)
        axes.plot([], [], color=style.CONTACTS, lw=1.0, label=contact_word(result))
        axes.legend(loc="upper left", fontsize="small")
    style.set_title(figure, str(result.attrs["title"]), style.conditions(results))
    return figure


def space_time_map(
    axes: Axes, result: Result, name: str, window: Sequence[float], factor: float = 1.0, **colours: object
) -> AxesImage:
    """Draw a field times a factor over x and time; returns the image for a colour bar."""
    if len(result.time) < 2:
        raise OutputError(f"{result.path}: a map over time needs more than one stored frame")
    columns = style.in_view(result.x / result.attrs["a"], window)
    x, time = result.x[columns] / result.attrs["a"], 1e6 * result.time
    values = factor * result[name][: len(time), columns]
    edges = (np.concatenate([v[:1], 0.5 * (v[1:] + v[:-1]), v[-1:]]) for v in (x, time))
    axes.set(xlabel=ACROSS, ylabel="time [µs]")
    return axes.pcolorfast(*edges, values, vmax=np.percentile(values, COLOUR_PERCENTILE), **colours)


def draw_temperatures(results: list[Result], options: argparse.Namespace) -> Figure:
    """Pressure, film and temperatures of one result at an instant, the hotter surface over x and time."""
    [result], window = results, frames.view(results, options.window)
    steady = len(result.time) == 1
    size, heights = (STEADY_SIZE, HEIGHTS[:3]) if steady else (TEMPERATURE_SIZE, HEIGHTS)
    figure, axes = style.new_figure(len(heights), 1, size, sharex=True, height_ratios=heights)
    choice = frames.Choice.of(results, options)
    fill(axes[:2], choice)
    temperatures_at(axes[2], result, choice.indices[0], window)
    axes[1].set_xlabel("")
    axes[-1].set_xlabel(ACROSS)
    if not steady:
        side = max("12", key=lambda name: np.nanmean(result.steps(f"temperature_{name}_mean")))
        image = space_time_map(axes[3], result, f"temperature_{side}", window, cmap="inferno")
        figure.colorbar(image, ax=axes[3], label=f"temperature of\nsurface {side} [K]")
    style.set_title(figure, *choice.title)
    return figure


def temperatures_at(axes: Axes, result: Result, index: int, window: Sequence[float]) -> None:
    """Draw temperatures along the contact, in K and in degrees Celsius."""
    x = result.x / result.attrs["a"]
    columns = style.in_view(x, window)
    for name, (label, colour) in TEMPERATURES.items():
        axes.plot(x[columns], result.frame(name, index)[columns], color=colour, lw=1.0, label=label)
    axes.set_ylabel("temperature [K]")
    celsius = axes.secondary_yaxis("right", functions=(lambda t: t - KELVIN, lambda t: t + KELVIN))
    celsius.set_ylabel("[°C]")
    axes.grid(lw=0.3)
    axes.legend(loc="upper left", **style.SMALL)


def draw_scalar(results: list[Result], options: argparse.Namespace) -> Figure:
    """One scalar of the steps over time, of one or several results."""
    name = options.steps
    for result in results:
        if name not in result.scalars:
            allowed = ", ".join(found for found in result.scalars if found != "time")
            raise OutputError(f"{result.path}: --steps {name}: not stored; allowed: {allowed}")
        if len(result.steps("time")) < 2:
            raise OutputError(f"{result.path}: is steady; allowed: --steps of runs over time")
    figure, axes = style.new_figure(1, 1, SCALAR_SIZE)
    names = distinguishing_names(results) or [str(result.attrs["title"]) for result in results]
    for result, words in zip(results, names, strict=True):
        axes.plot(1e3 * result.steps("time"), result.steps(name), lw=1.0, label=words)
    described = str(results[0][f"steps/{name}"].attrs.get("long_name", name))
    unit = results[0].unit(f"steps/{name}")
    label = described if unit == "1" else f"{described} [{unit}]"
    axes.set(xlabel="time [ms]", ylabel=textwrap.fill(label, SCALAR_LABEL))
    axes.grid(lw=0.3)
    if len(results) > 1:
        axes.legend(fontsize="small")
    style.set_title(figure, str(results[0].attrs["title"]), style.conditions(results), "")
    return figure


def draw_courses(results: list[Result], _options: argparse.Namespace | None) -> Figure:
    """Conditions, film, pressure, friction and temperatures of every step of one result over time."""
    [result] = results
    if len(result.steps("time")) < 2:
        raise OutputError(f"{result.path}: is steady; allowed: --over-time of a run over time")
    time = 1e3 * result.steps("time")
    filled = min(1e3 * filled_from(result), time[-1])
    load, per_unit = LOADS[result.unit("steps/load")]
    courses = {load: (per_unit, {"load_given": ("load", style.SINGLE)})} | COURSES
    panels = {
        label: (factor, shown)
        for label, (factor, names) in courses.items()
        if (shown := {name: names[name] for name in names if name in result.scalars})
    }
    size = (8.4, 1.0 + COURSE_HEIGHT * len(panels))
    figure, axes = style.new_figure(len(panels), 1, size, sharex=True, squeeze=False)
    for panel, (label, (factor, shown)) in zip(axes[:, 0], panels.items(), strict=True):
        for name, (words, colour) in shown.items():
            panel.plot(time, factor * result.steps(name), color=colour, lw=1.0, label=words)
        panel.set_ylabel(label, fontsize="small")
        panel.grid(lw=0.3)
        panel.axvspan(time[0], filled, color="0.93", lw=0, zorder=0)
        if len(shown) > 1:
            style.legend_beside(panel)
    axes[-1, 0].set(xlabel="time [ms]", xlim=(time[0], time[-1]))
    note = "grey: the surfaces do not yet fill the contact" if filled > time[0] else ""
    style.set_title(figure, str(result.attrs["title"]), style.conditions(results), note)
    return figure
