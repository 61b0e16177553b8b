"""Roughness parameters and picture of an areal map, for ``ehlpetsc surface FILE``."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ehlpetsc.pictures import style
from ehlpetsc.surfaces.parameters import (
    CORRELATION_THRESHOLD,
    ArealParameters,
    CoreParameters,
    autocorrelation,
    core_parameters,
)
from ehlpetsc.surfaces.topography import Topography

SIZE = (10.0, 4.2)  # inches
MAX_PIXELS = 1500  # of the picture, along either side
EXTREME_SHARE = 0.001  # of the heights, beyond the ends of the colours
COLOURS = "viridis"
CORRELATION_LENGTHS = 5  # of the slowest decay that the picture shows


def lines(file: str, surface: Topography) -> list[str]:
    """Size, notes and parameters of a map with unit and meaning, a line each."""
    ny, nx = surface.z.shape
    size = f"{1e3 * surface.length:.4g} x {1e3 * surface.dy * (ny - 1):.4g} mm"
    points = f"{nx} x {ny} points {1e6 * surface.dx:.4g} um and {1e6 * surface.dy:.4g} um apart"
    return [
        f"{file}: {size}, {points}",
        *surface.notes,
        *rows(surface.parameters, core_parameters(surface.z)),
    ]


def rows(found: ArealParameters, core: CoreParameters) -> list[str]:
    """Parameters with unit and meaning, a line each."""
    um = 1e6
    table = (
        ("Sa", um * found.sa, "um", "arithmetic mean height"),
        ("Sq", um * found.sq, "um", "root mean square height"),
        ("Ssk", found.ssk, "", "skewness"),
        ("Sku", found.sku, "", "kurtosis"),
        ("Spk", um * core.rpk, "um", "reduced peak height"),
        ("Sk", um * core.rk, "um", f"core height, from {core.mr1:.1%} to {core.mr2:.1%} of material"),
        ("Svk", um * core.rvk, "um", "reduced valley depth"),
        ("Sdq", found.sdq, "", "root mean square gradient"),
        ("Sal", um * found.sal, "um", "autocorrelation length, 0.2 in the direction of its fastest decay"),
        ("Str", found.str, "", "texture aspect ratio: 0 a lay, 1 isotropic"),
    )
    return [f"{name:3s} {value:10.4f} {unit:2s}  {text}" for name, value, unit, text in table]


def draw(name: str, surface: Topography) -> Figure:
    """Map of the heights, and autocorrelation along and across its rows."""
    found = surface.parameters
    figure, (heights, correlation) = style.new_figure(1, 2, SIZE, width_ratios=(1.6, 1.0))
    style.set_title(
        figure,
        name,
        f"Sa {1e6 * found.sa:.3g} µm, Sq {1e6 * found.sq:.3g} µm, Ssk {found.ssk:.2f}, "
        f"Sdq {found.sdq:.3g}, Str {found.str:.2g}",
    )
    _draw_heights(figure, heights, surface)
    _draw_correlation(correlation, surface)
    return figure


def _draw_heights(figure: Figure, axes: Axes, surface: Topography) -> None:
    every = [-(-n // MAX_PIXELS) for n in surface.z.shape]
    z = 1e6 * surface.z[:: every[0], :: every[1]]
    low, high = np.quantile(z, (EXTREME_SHARE, 1 - EXTREME_SHARE))
    edges = 1e3 * np.array([surface.X[0], surface.X[-1], surface.Y[0], surface.Y[-1]])
    image = axes.imshow(z, COLOURS, extent=edges, origin="lower", vmin=low, vmax=high)
    figure.colorbar(image, ax=axes, label="height [µm]", extend="both")
    axes.set(xlabel="X [mm]", ylabel="Y [mm]")


def _draw_correlation(axes: Axes, surface: Topography) -> None:
    found = autocorrelation(surface.z - surface.z.mean())
    row, column = (n // 2 for n in found.shape)
    along, across = found[row, column:], found[row:, column]
    axes.plot(1e6 * surface.dx * np.arange(along.size), along, color=style.SINGLE, label="along the rows")
    axes.plot(1e6 * surface.dy * np.arange(across.size), across, color=style.SECOND, label="across")
    axes.axhline(CORRELATION_THRESHOLD, color=style.FAINT, lw=0.8)
    axes.set(xlabel="lag [µm]", ylabel="autocorrelation", ylim=(min(-0.3, along.min(), across.min()), 1.05))
    if np.isfinite(surface.parameters.sal):
        longest = surface.parameters.sal / np.nan_to_num(surface.parameters.str, nan=1.0)
        axes.set_xlim(0.0, 1e6 * CORRELATION_LENGTHS * longest)
    axes.legend(frameon=False, **style.SMALL)
