"""Results over time: maps over x and time, temperatures, the course of all steps; movies."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from matplotlib.animation import PillowWriter
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ehlpetsc.base.errors import OutputError
from ehlpetsc.pictures import frames, style
from ehlpetsc.pictures.style import ACROSS
from ehlpetsc.results.means import filled_from
from ehlpetsc.results.output_guard import replacing
from ehlpetsc.results.reader import Result

MAX_MAP_ROWS = 1000  # rows of pixels of a space-time map
COLOUR_PERCENTILE = 99.9  # upper end of the colours, without a few sharp peaks
TEMPERATURES = {
    "film_temperature": ("film", style.FILM),
    "temperature_1": ("surface 1", style.SURFACES["1"]),
    "temperature_2": ("surface 2", style.SURFACES["2"]),
}
HEIGHTS = (1, 1, 1, 1.5)  # of the panels of temperatures, the last one over time
TEMPERATURE_SIZE, STEADY_SIZE = (8.4, 10.0), (8.4, 6.6)  # inches
KELVIN = 273.15
COURSES = {  # panels over time: factor from SI units, scalars with their labels and colours
    "load [N/mm]": (1e-3, {"load_given": ("load", style.SINGLE)}),
    "speed [m/s]": (1.0, {f"speed_{k}": (f"surface {k}", colour) for k, colour in style.SURFACES.items()}),
    "film [µm]": (1e6, {"film_central": ("central", style.SINGLE), "h_min": ("minimum", style.SECOND)}),
    "maximum\npressure [GPa]": (1e-9, {"p_max": ("maximum", style.SINGLE)}),
    "friction\ncoefficient": (1.0, {"friction_coefficient": ("friction", style.SINGLE)}),
    "share of the load\non the solids": (1.0, {"contact_share": ("solids", style.SINGLE)}),
    "maximum\ntemperature [K]": (1.0, {f"{name}_max": shown for name, shown in TEMPERATURES.items()}),
}
COURSE_HEIGHT = 1.5  # inches of a panel


def draw_map(results: list[Result], options: argparse.Namespace) -> Figure:
    """Pressure of one result over x and time, contacts outlined."""
    result = _only(results, "--map")
    figure, axes = style.new_figure(1, 1, frames.SIZE)
    columns, stride, values = field_over_time(result, "pressure", frames.window(results, options))
    limits = (0.0, 1e-9 * float(np.percentile(values, COLOUR_PERCENTILE)))
    image = space_time_map(axes, result, columns, stride, 1e-9 * values, limits, "viridis")
    outline_contacts(axes, result, columns, stride)
    figure.colorbar(image, ax=axes, label=frames.PRESSURE, extend="max")
    if result.contact_count.any():
        mark = Line2D([], [], color=style.CONTACT, lw=1.0, label="in contact")
        axes.legend(handles=[mark], loc="upper left", fontsize="small")
    style.set_title(figure, str(result.attrs["title"]), style.conditions(results))
    return figure


def field_over_time(result: Result, name: str, window: tuple[float, float]) -> tuple[slice, int, np.ndarray]:
    """Columns in view, stride of the drawn frames, and a field there, shape (frames, columns)."""
    if len(result.time) < 2:
        raise OutputError(f"{result.path}: a map over time needs more than one stored frame")
    stride = -(-len(result.time) // MAX_MAP_ROWS)
    columns = style.in_view(result.x / result.attrs["a"], window)
    return columns, stride, result[name][: len(result.time) : stride, columns].astype(float)


def space_time_map(
    axes: Axes,
    result: Result,
    columns: slice,
    stride: int,
    values: np.ndarray,
    limits: tuple[float | None, float],
    colours: str,
) -> ScalarMappable:
    """Draw a field of every `stride`-th frame over x and time; returns the image for a colour bar."""
    x, time = result.x[columns] / result.attrs["a"], 1e6 * result.time
    mesh = dict(vmin=limits[0], vmax=limits[1], cmap=colours, shading="nearest", rasterized=True)
    image = axes.pcolormesh(x, time[::stride], values, **mesh)
    axes.set(xlabel=ACROSS, ylabel="time [µs]", xlim=(x[0], x[-1]), ylim=(time[0], time[-1]))
    return image


def outline_contacts(axes: Axes, result: Result, columns: slice, stride: int) -> None:
    """Outline nodes in contact, also of the frames between the drawn ones."""
    touching = contacts_of_blocks(result, columns, stride) if "in_contact" in result else np.zeros(0)
    if touching.any():
        x, rows = result.x[columns] / result.attrs["a"], 1e6 * result.time[::stride]
        axes.contour(x, rows, touching, [0.5], colors=style.CONTACT, linewidths=0.7)


def contacts_of_blocks(result: Result, columns: slice, stride: int) -> np.ndarray:
    """1 where a node is in contact in any of `stride` frames, one row for every `stride` frames."""
    last = len(result.time)
    blocks = (slice(begin, min(begin + stride, last)) for begin in range(0, last, stride))
    return np.array([result.contacts_at(block, columns).any(axis=0) for block in blocks], dtype=int)


def draw_temperatures(results: list[Result], options: argparse.Namespace) -> Figure:
    """Pressure, film and temperatures of one result at an instant, the hotter surface over x and time."""
    result = _only(results, "--temperatures")
    if missing := [name for name in TEMPERATURES if name not in result.fields]:
        raise OutputError(
            f"{result.path}: does not store {', '.join(missing)}: the case needs a table [heat], and "
            "output.fields with them where it is given"
        )
    steady, view = len(result.time) == 1, frames.window(results, options)
    size, heights = (STEADY_SIZE, HEIGHTS[:3]) if steady else (TEMPERATURE_SIZE, HEIGHTS)
    figure, axes = style.new_figure(len(heights), 1, size, sharex=True, height_ratios=heights)
    [index] = frames.choose_frames(results, options.step, options.time)
    frames.fill_frame(axes[:2], results, [index], view)
    temperatures_at(axes[2], result, index, view)
    axes[1].set_xlabel("")
    axes[-1].set_xlabel(ACROSS)
    if not steady:
        side = max("12", key=lambda name: np.nanmean(result.steps(f"temperature_{name}_mean")))
        columns, stride, values = field_over_time(result, f"temperature_{side}", view)
        limits = (None, float(np.percentile(values, COLOUR_PERCENTILE)))
        image = space_time_map(axes[3], result, columns, stride, values, limits, "inferno")
        figure.colorbar(image, ax=axes[3], label=f"temperature of\nsurface {side} [K]")
    style.set_title(figure, *frames.panel_title(results, [index]))
    return figure


def temperatures_at(axes: Axes, result: Result, index: int, window: tuple[float, float]) -> None:
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


def draw_courses(results: list[Result], _options: argparse.Namespace | None) -> Figure:
    """Conditions, film, pressure, friction and temperatures of every step of one result over time."""
    result = _only(results, "--over-time")
    if len(result.steps("time")) < 2:
        raise OutputError(f"{result.path}: is steady; allowed: --over-time of a run over time")
    time, filled = 1e3 * result.steps("time"), 1e3 * filled_from(result)
    panels = {
        label: (factor, shown)
        for label, (factor, names) in COURSES.items()
        if (shown := {name: names[name] for name in names if name in result.scalars})
    }
    size = (8.4, 1.0 + COURSE_HEIGHT * len(panels))
    figure, axes = style.new_figure(len(panels), 1, size, sharex=True, squeeze=False)
    for panel, (label, (factor, shown)) in zip(axes[:, 0], panels.items(), strict=True):
        for name, (words, colour) in shown.items():
            panel.plot(time, factor * result.steps(name), color=colour, lw=1.0, label=words)
        panel.set_ylabel(label, fontsize="small")
        panel.grid(lw=0.3)
        if time[0] < filled < time[-1]:
            panel.axvspan(time[0], filled, color="0.93", zorder=0)
        if len(shown) > 1:
            style.legend_beside(panel)
    axes[-1, 0].set(xlabel="time [ms]", xlim=(time[0], time[-1]))
    note = "grey: the profiles do not yet fill the contact" if time[0] < filled < time[-1] else ""
    style.set_title(figure, str(result.attrs["title"]), style.conditions(results), note)
    return figure


def _only(results: list[Result], option: str) -> Result:
    if len(results) > 1:
        raise OutputError(f"{len(results)} results; allowed: {option} of one")
    return results[0]


MAX_FRAMES = 150
RATE = 15  # frames per second
DPI = 80


def save_movie(results: list[Result], options: argparse.Namespace, path: Path) -> None:
    """Write at most `MAX_FRAMES` frames with common axes."""
    last = len(results[0].time) - 1
    chosen = np.unique(np.linspace(0, last, min(last + 1, MAX_FRAMES)).round().astype(int))
    figure, axes = style.new_figure(2, 1, frames.SIZE, sharex=True)
    window, limits = frames.window(results, options), _limits(results, chosen)
    writer = PillowWriter(fps=RATE)
    with replacing(path) as temporary, writer.saving(figure, temporary, DPI):
        for index in chosen:
            for panel in axes:
                panel.clear()
            indices = frames.choose_frames(results, time=results[0].time[index])
            frames.fill_frame(axes, results, indices, window)
            style.set_title(figure, *frames.panel_title(results, indices))
            for panel, limit in zip(axes, limits, strict=True):
                panel.set_ylim(0.0, limit)
            if index == 0:  # one layout for all frames
                figure.draw_without_rendering()
                figure.set_layout_engine("none")
            writer.grab_frame()


def _limits(results: list[Result], chosen: np.ndarray) -> tuple[float, float]:
    """Upper limits of the axes [GPa, µm] for all pressures and for the film inside the contact."""
    film = 1e-9
    for result in results:
        inside = np.abs(result.x) <= result.attrs["a"]
        shown = [index for index in chosen if index < len(result.time)]
        film = max(film, *(result.frame("film_thickness", index)[inside].max() for index in shown))
    pressure = max(np.nanmax(result.steps("p_max")) for result in results)
    return 1.05e-9 * pressure, 1.15e6 * film
