"""Maps and sections of a point contact or strip at an instant; lengths in half-widths a."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.animation import PillowWriter
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D

from ehlpetsc.base.errors import OutputError
from ehlpetsc.physics.hertz import hertz_pressure
from ehlpetsc.pictures import frames, over_time, style
from ehlpetsc.results.output_guard import replacing
from ehlpetsc.results.reader import Result

WIDTH, SECTION_HEIGHT, MARGIN = 7.0, 1.6, 2.0  # inches: of the figure, of a row of sections, around the maps
MAP_WIDTH = 2.9  # inches
PANEL_RATIOS = (0.4, 1.6)  # height over width of the panel of a map
TO_SCALE = (0.2, 5.0)  # height over width of a map: beyond, lengths along and across are not to one scale
PRESSURE_COLOURS, FILM_COLOURS = "viridis", "Blues"
COLOUR_PERCENTILE = 99.9  # upper end of the colours of pressure, without a few sharp peaks
FILM_ROOM = 1.15  # upper end of film over the maximum inside the dry contact


@dataclass(frozen=True)
class PlaneFrame:
    """Fields of a frame in view.

    `x`, `y`: nodes in half-widths a, shapes (nx,), (ny,).
    `pressure`, `solids`: total and of the solids [GPa], `film` [µm], `contact`: shape (ny, nx).
    `half_widths`: of the dry contact along and across in a, across infinite in a strip.
    `p0`: maximum pressure of the dry contact [GPa].
    `film_label`: of axes, film or gap.
    """

    x: np.ndarray
    y: np.ndarray
    pressure: np.ndarray
    solids: np.ndarray
    film: np.ndarray
    contact: np.ndarray
    half_widths: tuple[float, float]
    p0: float
    film_label: str

    @classmethod
    def of(cls, result: Result, index: int, window: Sequence[float]) -> PlaneFrame:
        """Frame `index` of a result within limits of x/a."""
        part, x, y = in_view(result, window)
        a, p0 = style.hertz_at(result, index)
        shape = (len(y), len(x))
        pressure = 1e-9 * _part(result, "pressure", index, part)
        film = 1e6 * _part(result, "film_thickness", index, part)
        solids, contact = np.zeros(shape), np.zeros(shape, bool)
        if "contact_pressure" in result:
            solids = 1e-9 * _part(result, "contact_pressure", index, part)
        if "in_contact" in result:
            contact = _part(result, "in_contact", index, part) > 0.0
        width, label = a / result.attrs["a"], frames.FILM if result.case.fluid else frames.GAP
        return cls(x, y, pressure, solids, film, contact, (width, width * aspect(result)), 1e-9 * p0, label)

    @property
    def hertz(self) -> np.ndarray:
        """Pressure of the dry contact [GPa], shape (ny, nx)."""
        distance = np.hypot(self.x / self.half_widths[0], self.y[:, np.newaxis] / self.half_widths[1])
        return hertz_pressure(distance, 1.0, self.p0)

    @property
    def thickest(self) -> float:
        """Upper end of the scale of film [µm], above the maximum in the dry contact, if any is in view."""
        across = self.y[:, np.newaxis] / self.half_widths[1]
        inside = (self.x / self.half_widths[0]) ** 2 + across**2 <= 1.0
        return FILM_ROOM * float(self.film[inside if inside.any() else ...].max()) or 1.0


def _part(result: Result, name: str, index: int, part: tuple[slice, slice]) -> np.ndarray:
    return result[name][(index, *part)].astype(float)


def aspect(result: Result) -> float:
    """Half-width of the dry contact across over that along; infinite in a strip."""
    return float(result.attrs["b"] / result.attrs["a"])


def in_view(result: Result, window: Sequence[float]) -> tuple[tuple[slice, slice], np.ndarray, np.ndarray]:
    """Nodes within limits of x/a, with x/a and y/a.

    Across, as far from the middle as :func:`.style.reach_across`.
    """
    a = result.attrs["a"]
    across = style.reach_across(result, window) / a
    x, y = result.x / a, result.y / a
    part = style.in_view(y, (-across, across)), style.in_view(x, window)
    return part, x[part[1]], y[part[0]]


def draw_frame(result: Result, options: argparse.Namespace) -> Figure:
    """Maps of pressure and film at an instant, and their sections through the middle."""
    [index] = frames.choose_frames([result], options.step, options.time)
    return fill_figure(Figure(layout="constrained"), result, index, frames.view([result], options.window))


def fill_figure(figure: Figure, result: Result, index: int, window: Sequence[float]) -> Figure:
    """Draw maps and sections of a frame into an empty figure, which gets its size."""
    frame = PlaneFrame.of(result, index, window)
    heights = (map_height(frame), SECTION_HEIGHT, SECTION_HEIGHT)
    figure.set_size_inches(WIDTH, sum(heights) + MARGIN)
    axes = figure.subplots(3, 2, height_ratios=heights)
    draw_maps(figure, axes[0], frame)
    row, column = np.argmin(np.abs(frame.y)), np.argmin(np.abs(frame.x))
    at = f"{frame.x[column]:.2g} a" if np.abs(frame.x[column]) > np.diff(frame.x).max() else "0"
    for panels, abscissa, nodes, label in (
        (axes[1], frame.x, np.s_[row, :], "x/a along y = 0"),
        (axes[2], frame.y, np.s_[:, column], f"y/a along x = {at}"),
    ):
        draw_section(panels, frame, abscissa, nodes)
        for panel in panels:
            panel.set_xlabel(label)
    axes[1, 0].legend(loc="best", frameon=False, handlelength=1.2, **style.SMALL)
    style.set_title(figure, *frames.panel_title([result], [index]))
    return figure


def map_height(frame: PlaneFrame) -> float:
    """Height [inches] of the panel of a map, `MAP_WIDTH` wide."""
    return MAP_WIDTH * float(np.clip(np.ptp(frame.y) / np.ptp(frame.x), *PANEL_RATIOS))


def draw_maps(figure: Figure, panels: Sequence[Axes], frame: PlaneFrame) -> tuple[AxesImage, ...]:
    """Draw maps of pressure and film, nodes in contact in one colour, the dry contact as a line.

    Returns the images of pressure, film and contact.
    """
    highest = float(np.percentile(frame.pressure, COLOUR_PERCENTILE)) or 1.0
    pressure = draw_map(
        panels[0], frame.x, frame.y, frame.pressure, cmap=PRESSURE_COLOURS, vmin=0, vmax=highest
    )
    film = draw_map(panels[1], frame.x, frame.y, frame.film, cmap=FILM_COLOURS, vmin=0, vmax=frame.thickest)
    for image, panel, label in zip(
        (pressure, film), panels, (frames.PRESSURE, frame.film_label), strict=True
    ):
        figure.colorbar(image, ax=panel, label=label, location="top", extend="max", aspect=30)
    touching = draw_map(
        panels[1],
        frame.x,
        frame.y,
        touched(frame.contact),
        cmap=ListedColormap([style.CONTACT]),
        vmin=0,
        vmax=1,
    )
    outline(panels[0], frame.half_widths, "w")
    outline(panels[1], frame.half_widths, "k")
    if frame.contact.any():
        mark = Line2D([], [], ls="", marker="s", ms=5, color=style.CONTACT, label="in contact")
        panels[1].legend(handles=[mark], loc="lower left", handletextpad=0.2, borderpad=0.2, **style.SMALL)
    return pressure, film, touching


def touched(contact: np.ndarray) -> np.ma.MaskedArray:
    """Ones at nodes in contact, transparent elsewhere."""
    return np.ma.masked_equal(contact.astype("u1"), 0)


def draw_map(axes: Axes, x: np.ndarray, y: np.ndarray, values: np.ndarray, **colours: object) -> AxesImage:
    """Draw a field of shape (ny, nx) over equally spaced x/a and y/a."""
    dx, dy = 0.5 * (x[1] - x[0]), 0.5 * (y[1] - y[0])
    extent = (x[0] - dx, x[-1] + dx, y[0] - dy, y[-1] + dy)
    is_compact = TO_SCALE[0] <= np.ptp(y) / np.ptp(x) <= TO_SCALE[1]
    shape = dict(origin="lower", extent=extent, aspect="equal" if is_compact else "auto")
    image = axes.imshow(values, interpolation="nearest", **shape, **colours)
    axes.set(xlabel=style.ACROSS, ylabel="y/a")
    return image


def outline(axes: Axes, half_widths: tuple[float, float], colour: str) -> None:
    """Draw the edge of the dry contact, an ellipse or the two lines of a strip, as a thin line."""
    a, b = half_widths
    limits = axes.axis()
    if np.isfinite(b):
        angle = np.linspace(0.0, 2.0 * np.pi, 181)
        axes.plot(a * np.cos(angle), b * np.sin(angle), color=colour, lw=0.6)
    else:
        for edge in (-a, a):
            axes.axvline(edge, color=colour, lw=0.6)
    axes.axis(limits)


def draw_section(
    panels: Sequence[Axes],
    frame: PlaneFrame,
    abscissa: np.ndarray,
    nodes: tuple,
) -> None:
    """Draw pressure and film along one line of nodes."""
    upper, lower = panels
    solids, film, touching = frame.solids[nodes], frame.film[nodes], frame.contact[nodes]
    if solids.any():
        solid_area = dict(color=style.SOLIDS, lw=0, zorder=1.5, label="of the solids")
        upper.fill_between(abscissa, 0.0, solids, **solid_area)
    upper.plot(abscissa, frame.pressure[nodes], color=style.SINGLE, lw=1.0, label="pressure")
    upper.plot(abscissa, frame.hertz[nodes], ":", color="0.6", lw=0.9, zorder=1, label="Hertz")
    lower.plot(abscissa, film, color=style.SINGLE, lw=1.0)
    if touching.any():
        lower.plot(
            abscissa[touching], film[touching], "v", color=style.CONTACT, ms=3, clip_on=False, zorder=3
        )
    ends = abscissa[[0, -1]]
    upper.set(xlim=ends, ylim=(0.0, 1.05 * max(frame.pressure.max(), frame.p0)), ylabel=frames.PRESSURE)
    lower.set(xlim=ends, ylim=(0.0, frame.thickest), ylabel=frame.film_label)


CONTACTS_WIDTH, CONTACTS_MARGIN = 4.6, 1.9  # inches
MOVIE_MARGIN = 1.6  # inches above and below the maps


def draw_contacts(result: Result, options: argparse.Namespace) -> Figure:
    """Share of the time steps of a run in which each node is in contact."""
    window = frames.view([result], options.window)
    if not result.contact_count.any():
        raise OutputError(f"{result.path}: no node is in contact in any step")
    part, x, y = in_view(result, window)
    percent = 100.0 * result.contact_count[part] / len(result.steps("time"))
    ratio = float(np.clip(np.ptp(y) / np.ptp(x), *PANEL_RATIOS))
    size = CONTACTS_WIDTH, (CONTACTS_WIDTH - 0.8) * ratio + CONTACTS_MARGIN
    figure, axes = style.new_figure(1, 1, size)
    top = float(np.percentile(percent[percent > 0.0], over_time.COLOUR_PERCENTILE))
    image = draw_map(axes, x, y, percent, cmap="Reds", vmin=0.0, vmax=top)
    figure.colorbar(image, ax=axes, label="steps in contact [%]", extend="max", location="top", aspect=30)
    outline(axes, (1.0, aspect(result)), "k")
    steps = len(result.steps("time"))
    motion, _, rest = style.conditions([result]).rpartition(", a = ")  # too long for one line
    style.set_title(figure, f"{result.attrs['title']}: {steps} steps", motion, f"a = {rest}")
    return figure


def save_movie(result: Result, options: argparse.Namespace, path: Path) -> None:
    """Write maps of pressure and film of at most `over_time.MAX_FRAMES` frames with common colours."""
    chosen, window = (
        style.spread(len(result.time), over_time.MAX_FRAMES),
        frames.view([result], options.window),
    )
    first = PlaneFrame.of(result, 0, window)
    figure, axes = style.new_figure(1, 2, (WIDTH, map_height(first) + MOVIE_MARGIN))
    frame = PlaneFrame.of(result, frames.frame_to_show(result), window)  # which determines the colours
    images = draw_maps(figure, axes, frame)
    writer = PillowWriter(fps=over_time.RATE)
    with replacing(path) as temporary, writer.saving(figure, temporary, over_time.DPI):
        for index in chosen:
            frame = PlaneFrame.of(result, index, window)
            fields = frame.pressure, frame.film, touched(frame.contact)
            for image, values in zip(images, fields, strict=True):
                image.set_data(values)
            style.set_title(figure, *frames.panel_title([result], [index]))
            if index == 0:  # one layout for all frames
                figure.draw_without_rendering()
                figure.set_layout_engine("none")
            writer.grab_frame()
