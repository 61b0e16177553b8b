"""Maps, sections and interference fringes of a point contact or strip; lengths in half-widths a."""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, Normalize, to_rgba
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from matplotlib.lines import Line2D

from ehlpetsc.base.errors import OutputError
from ehlpetsc.pictures import style
from ehlpetsc.pictures.frames.choice import Choice, view
from ehlpetsc.pictures.frames.data import (
    COLOUR_PERCENTILE,
    PRESSURE_LABEL,
    Frame,
    Limits,
    aspect,
    contact_word,
    has_layer,
    in_view,
)
from ehlpetsc.pictures.frames.line import draw_curves, draw_hertz
from ehlpetsc.results.reader import Result

WIDTH, SECTION_HEIGHT, MARGIN = 7.0, 1.6, 2.0  # inches: of the figure, of a row of sections, around the maps
MAP_WIDTH = 2.9  # inches
PANEL_RATIOS = (0.4, 1.6)  # height over width of the panel of a map
TO_SCALE = (0.2, 5.0)  # height over width of a map: beyond, lengths along and across are not to one scale
PRESSURE_COLOURS, FILM_COLOURS, OTHER_COLOURS = "viridis", "Blues", "cividis"  # the last one of other fields
SHARES = LinearSegmentedColormap.from_list("share", [to_rgba(style.CONTACTS, 0.0), to_rgba(style.CONTACTS)])
CONTACTS_WIDTH, CONTACTS_MARGIN = 4.6, 1.9  # inches
MOVIE_MARGIN = 1.6  # inches above and below the maps

OIL_INDEX = 1.5  # refractive index of the oil; of a dry gap 1
WAVELENGTHS = {"red": 630e-9, "green": 530e-9, "blue": 460e-9}  # m
BANDWIDTH = 20e-9  # of the colours, full width at half of the maximum [m]
PIXELS = 600  # along the longer side: on the mesh itself fringes outside the contact would be aliased
CHART = 400  # films of the chart of intensities


def draw_frame(figure: Figure, choice: Choice) -> None:
    """Draw maps and sections of pressure and film, or another field, into an empty figure."""
    [frame], contact = choice.frames, contact_word(choice.results[0])
    limits, heights = frame.limits, (map_height(frame), SECTION_HEIGHT, SECTION_HEIGHT)
    figure.set_size_inches(WIDTH, sum(heights) + MARGIN)
    axes = figure.subplots(3, 2, height_ratios=heights)
    add_bars(figure, axes[0], frame, limits)
    fill(axes[0], choice, limits)
    middle = frame.x[np.argmin(np.abs(frame.x))]
    at = f"{middle:.2g} a" if np.abs(middle) > np.diff(frame.x).max() else "0"
    for panels, label in ((axes[1], "x/a along y = 0"), (axes[2], f"y/a along x = {at}")):
        section = frame.section(along=label[0] == "x")
        ends = float(section.x[0]), float(section.x[-1])
        draw_curves(panels, section, contact)
        draw_hertz(panels[0], section, ends)
        panels[0].set(xlim=ends, xlabel=label, ylim=(0.0, limits.pressure), ylabel=PRESSURE_LABEL)
        panels[1].set(xlim=ends, xlabel=label, ylim=limits[2:], ylabel=frame.label)
        marks = [line for line in panels[1].lines if line.get_marker() == "v"]
        if marks:
            panels[1].legend(handles=marks, loc="best", frameon=False, **style.SMALL)
    axes[1, 0].legend(loc="best", frameon=False, handlelength=1.2, **style.SMALL)


def movie_panels(figure: Figure, frame: Frame, limits: Limits) -> Sequence[Axes]:
    """Axes of a movie in an empty figure, with bars of their colours."""
    figure.set_size_inches(WIDTH, map_height(frame) + MOVIE_MARGIN)
    axes = figure.subplots(1, 2)
    add_bars(figure, axes, frame, limits)
    return axes


def map_height(frame: Frame) -> float:
    """Height [inches] of the panel of a map, `MAP_WIDTH` wide."""
    return MAP_WIDTH * float(np.clip(np.ptp(frame.y) / np.ptp(frame.x), *PANEL_RATIOS))


def colours_of(frame: Frame, limits: Limits) -> tuple[dict, dict]:
    """Colour maps of pressure and values with their ends."""
    of_values = FILM_COLOURS if frame.is_film else OTHER_COLOURS
    return (
        dict(cmap=PRESSURE_COLOURS, vmin=0.0, vmax=limits.brightest),
        dict(cmap=of_values, vmin=limits.low, vmax=limits.high),
    )


def add_bars(figure: Figure, panels: Sequence[Axes], frame: Frame, limits: Limits) -> None:
    """Add bars of the colours above the maps."""
    labels, extends = (PRESSURE_LABEL, frame.label), ("max", "max" if frame.is_film else "neither")
    for panel, colours, label, extend in zip(panels, colours_of(frame, limits), labels, extends, strict=True):
        shown = ScalarMappable(Normalize(colours["vmin"], colours["vmax"]), colours["cmap"])
        figure.colorbar(shown, ax=panel, label=label, location="top", extend=extend, aspect=30)


def fill(panels: Sequence[Axes], choice: Choice, limits: Limits) -> None:
    """Draw maps of pressure and values of a frame, the dry contact as a line, contacts in red on the film.

    Of a compliant layer the red is as opaque as the share of the solids in the pressure.
    """
    [frame] = choice.frames
    for panel, values, colours, edge in zip(
        panels, (frame.pressure, frame.values), colours_of(frame, limits), ("w", "k"), strict=True
    ):
        draw_map(panel, frame.x, frame.y, values, **colours)
        handles = [outline(panel, frame.half_widths, edge)]
        if values is frame.values and frame.is_film and frame.share.any():
            draw_map(panel, frame.x, frame.y, frame.share, cmap=SHARES, vmin=0.0, vmax=1.0)
            handles += contact_handles(choice.results[0])
        look = dict(frameon=False, labelcolor="w") if edge == "w" else dict(facecolor="w", framealpha=0.8)
        place = dict(loc="lower left", handletextpad=0.3, borderpad=0.2, handlelength=0.9, labelspacing=0.2)
        panel.legend(handles=handles, **place, **look, fontsize="x-small")
        panel.set_xlabel(choice.along)


def contact_handles(result: Result) -> list[Line2D]:
    """Squares for a legend of the nodes in contact, of a compliant layer of three shares of the pressure."""
    square = dict(ls="", marker="s", ms=5, color=style.CONTACTS, mec="0.5", mew=0.3)
    if not has_layer(result):
        return [Line2D([], [], label="in contact", **square)]
    return [
        Line2D([], [], mfc=SHARES(share), label=f"solids {100 * share:g} %", **square)
        for share in (0.1, 0.5, 1.0)
    ]


def draw_map(axes: Axes, x: np.ndarray, y: np.ndarray, values: np.ndarray, **colours: object) -> AxesImage:
    """Draw a field of shape (ny, nx) over equally spaced x/a and y/a."""
    dx, dy = 0.5 * (x[1] - x[0]), 0.5 * (y[1] - y[0])
    extent = (x[0] - dx, x[-1] + dx, y[0] - dy, y[-1] + dy)
    is_compact = TO_SCALE[0] <= np.ptp(y) / np.ptp(x) <= TO_SCALE[1]
    shape = dict(origin="lower", extent=extent, aspect="equal" if is_compact else "auto")
    image = axes.imshow(values, **{"interpolation": "nearest"} | shape | colours)
    axes.set(xlabel=style.ACROSS, ylabel="y/a")
    return image


def outline(axes: Axes, half_widths: tuple[float, float], colour: str) -> Line2D:
    """Draw the edge of the dry contact, an ellipse or the two lines of a strip; returns it for legends."""
    a, b = half_widths
    limits = axes.axis()
    if np.isfinite(b):
        angle = np.linspace(0.0, 2.0 * np.pi, 181)
        axes.plot(a * np.cos(angle), b * np.sin(angle), color=colour, lw=0.6)
    else:
        for edge in (-a, a):
            axes.axvline(edge, color=colour, lw=0.6)
    axes.axis(limits)
    return Line2D([], [], color=colour, lw=0.8, label="dry contact")


def draw_contacts(results: list[Result], options: argparse.Namespace) -> Figure:
    """Share of the time steps of a run in which each node is in contact."""
    [result], window = results, view(results, options.window)
    if not result.contact_count.any():
        raise OutputError(f"{result.path}: no node is in contact in any step")
    part, x, y = in_view(result, window)
    steps = len(result.steps("time"))
    percent = 100.0 * result.contact_count[part] / steps
    ratio = float(np.clip(np.ptp(y) / np.ptp(x), *PANEL_RATIOS))
    size = CONTACTS_WIDTH, (CONTACTS_WIDTH - 0.8) * ratio + CONTACTS_MARGIN
    figure, axes = style.new_figure(1, 1, size)
    top = float(np.percentile(percent[percent > 0.0], COLOUR_PERCENTILE))
    image = draw_map(axes, x, y, percent, cmap="Reds", vmin=0.0, vmax=top)
    touching = "with over 10 MPa on the solids" if has_layer(result) else "in contact"
    label = f"steps {touching} [%]"
    figure.colorbar(image, ax=axes, label=label, extend="max", location="top", aspect=30)
    axes.legend(handles=[outline(axes, (1.0, aspect(result)), "k")], loc="lower left", **style.SMALL)
    axes.set_xlabel(Choice(results, [0], window).along)
    motion, _, rest = style.conditions([result]).rpartition(", a = ")  # too long for one line
    style.set_title(figure, f"{result.attrs['title']}: {steps} steps", motion, f"a = {rest}")
    return figure


def intensity(film: np.ndarray, wavelength: float, index: float, bandwidth: float = 0.0) -> np.ndarray:
    r"""Intensity of the interference of two equal beams at normal incidence, from 0 to 1.

    .. math:: I=\tfrac12\Bigl(1+V\cos\frac{2\pi\delta}\lambda\Bigr),\qquad \delta=2nh,\qquad
       V=\exp\Bigl(-\Bigl(\frac{\pi\,\Delta\lambda}{2\sqrt{\ln2}\,\lambda^2}\,\delta\Bigr)^2\Bigr),

    V the visibility for a line of Gaussian shape (Born and Wolf 1999, section 7.5.8); bright without a film,
    as with a layer of chromium on the glass, shift of phase on reflection neglected.

    Parameters
    ----------
    film
        h [m].
    wavelength, bandwidth
        lambda and its full width at half of the maximum [m].
    index
        Refractive index n.
    """
    path = 2.0 * index * film
    fading = np.pi * bandwidth * path / (2.0 * np.sqrt(np.log(2.0)) * wavelength**2)
    return 0.5 * (1.0 + np.exp(-(fading**2)) * np.cos(2.0 * np.pi * path / wavelength))


def monochromatic(film: np.ndarray, index: float) -> np.ndarray:
    """Intensity of green light, shape of the film [m]."""
    return intensity(film, WAVELENGTHS["green"], index)


def coloured(film: np.ndarray, index: float) -> np.ndarray:
    """Intensities of red, green and blue light of some bandwidth, along a last axis."""
    return np.stack([intensity(film, length, index, BANDWIDTH) for length in WAVELENGTHS.values()], axis=-1)


def draw_fringes(results: list[Result], options: argparse.Namespace) -> Figure:
    """Interference of one colour and of three at an instant, each with its chart over the film."""
    choice = Choice.of(results, options)
    [frame] = choice.frames
    n = OIL_INDEX if results[0].case.fluid else 1.0
    x, y, film = refined(frame)
    height = map_height(frame)
    figure, axes = style.new_figure(2, 2, (WIDTH, height + MARGIN), height_ratios=(height, 0.12))
    colourings = ("wavelength", monochromatic, ["green"]), ("wavelengths", coloured, list(WAVELENGTHS))
    for column, (word, colours, names) in zip(axes.T, colourings, strict=True):
        shades = dict(cmap="gray", vmin=0.0, vmax=1.0, interpolation="antialiased")
        draw_map(column[0], x, y, colours(film, n), **shades)
        column[0].set_xlabel(choice.along)
        outline(column[0], frame.half_widths, style.CONTACTS)
        lengths = ", ".join(f"{1e9 * WAVELENGTHS[name]:.0f}" for name in names)
        column[0].set_title(f"{word} {lengths} nm", fontsize="small")
        draw_chart(column[1], colours, n, frame)
    note = f"refractive index {n:g}; red: edge of the dry contact"
    style.set_title(figure, *choice.title, note)
    return figure


def refined(frame: Frame) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """x/a and y/a of pixels, and the film there [m] by cubic splines."""
    from scipy.interpolate import RectBivariateSpline

    longer = max(np.ptp(frame.x), np.ptp(frame.y))
    counts = (max(round(PIXELS * np.ptp(axis) / longer), len(axis)) for axis in (frame.x, frame.y))
    x, y = (np.linspace(axis[0], axis[-1], n) for axis, n in zip((frame.x, frame.y), counts, strict=True))
    order = min(3, len(frame.y) - 1)
    film = RectBivariateSpline(frame.y, frame.x, 1e-6 * frame.values, kx=order)(y, x)
    return x, y, np.maximum(film, 0.0)


def draw_chart(
    axes: Axes, colours: Callable[[np.ndarray, float], np.ndarray], index: float, frame: Frame
) -> None:
    """Draw the colours over the films of a frame."""
    thickest = frame.limits.high
    film = np.linspace(0.0, thickest, CHART)
    shape = dict(extent=(0.0, thickest, 0.0, 1.0), aspect="auto", cmap="gray", vmin=0.0, vmax=1.0)
    axes.imshow(colours(1e-6 * film, index)[np.newaxis], **shape)
    axes.set(yticks=[], xlabel=frame.label)
