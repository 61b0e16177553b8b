"""Film as interference fringes, the picture of optical interferometry of a ball on a glass disc."""

from __future__ import annotations

import argparse
from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ehlpetsc.pictures import frames, style
from ehlpetsc.pictures.frame_data import Frame
from ehlpetsc.pictures.plane import WIDTH, draw_map, map_height, outline
from ehlpetsc.results.reader import Result

OIL_INDEX = 1.5  # refractive index of the oil; of a dry gap 1
WAVELENGTHS = {"red": 630e-9, "green": 530e-9, "blue": 460e-9}  # m
BANDWIDTH = 20e-9  # of the colours, full width at half of the maximum [m]
PIXELS = 600  # along the longer side: on the mesh itself fringes outside the contact would be aliased
MARGIN = 2.0  # inches above and below the maps
CHART = 400  # films of the chart of intensities


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
    choice = frames.Choice.of(results, options)
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
        outline(column[0], frame.half_widths, style.CONTACT)
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
