"""Rollers: maps of pressure and film, load along the roller, sections, profile and deformed gap; y in mm."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure

from ehlpetsc.physics.contact.roller_loads import RollerLoads
from ehlpetsc.pictures import style
from ehlpetsc.pictures.frames.choice import Choice
from ehlpetsc.pictures.frames.data import COLOUR_PERCENTILE, FILM_ROOM, PRESSURE_LABEL, Frame, Limits
from ehlpetsc.pictures.frames.plane import FILM_COLOURS, OTHER_COLOURS, PRESSURE_COLOURS, fill, movie_panels

__all__ = ["draw_frame", "fill", "movie_panels"]
SIZE = (7.4, 8.6)  # inches
ALONG = "y [mm]"
UNDER_PRESSURE = 0.1  # of the maximum: nodes whose films determine the colours
LOADED = 0.05  # of the largest load per length: rows in the contact
GAP_ROOM = 2.0  # of the gap of the undeformed solids at the ends of the contact: top of its axis


def draw_frame(figure: Figure, choice: Choice) -> None:
    """Draw maps and sections of pressure and film, or another field, and the load, into an empty figure."""
    [frame], [result], [index] = choice.frames, choice.results, choice.indices
    loads = result.roller(index)
    figure.set_size_inches(SIZE)
    axes = figure.subplots(3, 2, height_ratios=(1.5, 1.0, 1.0))
    limits = limits_of(frame)
    edge = frame.half_widths[0] * np.sqrt(loads.lamina * loads.length / loads.load)  # by the lamina model
    draw_maps(figure, axes[0], choice, limits, loads, edge)
    draw_loads(axes[1, 0], loads)
    draw_gap(axes[1, 1], loads, result.frame("film_thickness", index), int(np.argmin(np.abs(result.x))))
    draw_sections(axes[2], frame, loads, limits)
    for panel in axes[1:].flat:
        panel.set(xlim=(1e3 * loads.y[0], 1e3 * loads.y[-1]), xlabel=ALONG)
        panel.legend(loc="best", frameon=False, handlelength=1.4, **style.SMALL)


def limits_of(frame: Frame) -> Limits:
    """Ends of axes; that of film is above the maximum under pressure."""
    if not frame.is_film:
        return frame.limits
    inside = frame.values[frame.pressure > UNDER_PRESSURE * frame.pressure.max()]
    high = FILM_ROOM * float(inside.max() or frame.values.max() or 1.0)
    return Limits(frame.limits.pressure, float(np.percentile(frame.pressure, COLOUR_PERCENTILE)), 0.0, high)


def draw_maps(
    figure: Figure,
    panels: Sequence[Axes],
    choice: Choice,
    limits: Limits,
    loads: RollerLoads,
    half_width: np.ndarray,
) -> None:
    """Draw maps of pressure and values over x/a and y with bars; a line: half-width of the contact in a."""
    [frame] = choice.frames
    colours = PRESSURE_COLOURS, FILM_COLOURS if frame.is_film else OTHER_COLOURS
    ends, labels = ((0.0, limits.brightest), limits[2:]), (PRESSURE_LABEL, frame.label)
    dx, y = 0.5 * (frame.x[1] - frame.x[0]), 1e3 * loads.y
    extent = (frame.x[0] - dx, frame.x[-1] + dx, y[0] - 0.5 * 1e3 * loads.dy, y[-1] + 0.5 * 1e3 * loads.dy)
    edge = np.where(half_width > 0.0, half_width, np.nan)  # nan: beside the contact
    for panel, values, name, (low, high), label, colour in zip(
        panels, (frame.pressure, frame.values), colours, ends, labels, ("w", "k"), strict=True
    ):
        shown = dict(origin="lower", aspect="auto", interpolation="nearest", cmap=name, vmin=low, vmax=high)
        panel.imshow(values, extent=extent, **shown)
        panel.plot(-edge, y, edge, y, color=colour, lw=0.6)
        panel.set(xlim=extent[:2], ylim=extent[2:], xlabel=choice.along, ylabel=ALONG)
        bar = ScalarMappable(Normalize(low, high), name)
        figure.colorbar(bar, ax=panel, label=label, location="top", extend="max", aspect=30)


def draw_loads(axes: Axes, loads: RollerLoads) -> None:
    """Draw the load per length, computed, of the lamina model and even."""
    y = 1e3 * loads.y
    axes.plot(y, 1e-3 * loads.w, color=style.SINGLE, lw=1.3, label="computed")
    axes.plot(y, 1e-3 * loads.lamina, "--", color=style.SECOND, lw=1.0, label="lamina model")
    axes.axhline(1e-3 * loads.load / loads.length, color="0.6", ls=":", lw=0.9, label="mean")
    axes.set(ylabel="load per length [N/mm]", ylim=(0.0, None))


def draw_gap(axes: Axes, loads: RollerLoads, film: np.ndarray, middle: int) -> None:
    """Draw profile with tilt, and film or gap of the deformed solids at the column in the middle [µm]."""
    y, loaded = 1e3 * loads.y, loads.w > LOADED * loads.w.max()
    undeformed = 1e6 * (loads.gap - loads.gap.min())
    axes.plot(y, undeformed, color="0.5", lw=1.0, label="undeformed")
    axes.plot(y, 1e6 * film[:, middle], color=style.FILM, lw=1.3, label="deformed, x = 0")
    axes.set(ylabel="gap [µm]", ylim=(0.0, GAP_ROOM * max(float(undeformed[loaded].max()), 0.5)))


def draw_sections(panels: Sequence[Axes], frame: Frame, loads: RollerLoads, limits: Limits) -> None:
    """Draw pressure and values along y at x = 0, with the extremes of the rows."""
    y, column = 1e3 * loads.y, int(np.argmin(np.abs(frame.x)))
    panels[0].plot(y, frame.pressure[:, column], color=style.SINGLE, lw=1.3, label="x = 0")
    panels[0].plot(y, frame.pressure.max(axis=1), ":", color=style.SECOND, lw=1.1, label="largest of the row")
    panels[0].set(ylabel=PRESSURE_LABEL, ylim=(0.0, limits.pressure))
    panels[1].plot(y, frame.values[:, column], color=style.SINGLE, lw=1.3, label="x = 0")
    panels[1].plot(y, frame.values.min(axis=1), ":", color=style.SECOND, lw=1.1, label="least of the row")
    panels[1].set(ylabel=frame.label, ylim=limits[2:])
