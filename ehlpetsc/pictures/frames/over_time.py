"""Results over time: maps over x and time, temperatures, the course of all steps."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.image import AxesImage

from ehlpetsc.base.errors import OutputError
from ehlpetsc.physics.oil.viscosity_laws import KELVIN
from ehlpetsc.pictures import style
from ehlpetsc.pictures.frames import choice as frames
from ehlpetsc.pictures.frames import line
from ehlpetsc.pictures.frames.data import COLOUR_PERCENTILE, MOSTLY, contact_share, contact_word, described
from ehlpetsc.pictures.style import ACROSS
from ehlpetsc.results.means import filled_from
from ehlpetsc.results.reader import Result

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
    figure, axes = style.new_figure(1, 1, line.LINE_SIZE)
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
    line.fill(axes[:2], choice)
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
