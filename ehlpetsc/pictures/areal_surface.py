"""Maps of areal surfaces: of a file with its parameters, of a case."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Ellipse, Rectangle

from ehlpetsc.pictures import style
from ehlpetsc.surfaces.areal_parameters import SurfaceParameters
from ehlpetsc.surfaces.parameters import (
    CORRELATION_THRESHOLD,
    ArealParameters,
    CoreParameters,
    autocorrelation,
    binned,
    core_parameters,
    power_spectrum,
)
from ehlpetsc.surfaces.profile_checks import doubts, entry_times
from ehlpetsc.surfaces.topography import Topography

if TYPE_CHECKING:
    from ehlpetsc.physics.scales import Scales
    from ehlpetsc.surfaces.roughness import MovingTopography


SIZE = (13.0, 4.2)  # inches
MAX_PIXELS = 1500  # of the picture, along either side
EXTREME_SHARE = 0.001  # of the heights, beyond the ends of the colours
COLOURS = "viridis"
SHOWN_DENSITY = 1e-12  # over the highest: below it is the rounding of synthetic waves
CORRELATION_LENGTHS = 5  # of the slowest decay that the picture shows


def lines(file: str, surface: Topography) -> list[str]:
    """Size, notes and parameters of a map with unit and meaning, a line each."""
    ny, nx = surface.z.shape
    size = f"{1e3 * surface.length:.4g} x {1e3 * surface.dy * (ny - 1):.4g} mm"
    points = f"{nx} x {ny} points {1e6 * surface.dx:.4g} um and {1e6 * surface.dy:.4g} um apart"
    return [
        f"{file}: {size}, {points}",
        *surface.notes,
        *doubts(surface),
        *rows(
            surface.parameters,
            core_parameters(surface.z),
            SurfaceParameters.of(surface.z, surface.dx, surface.dy),
        ),
    ]


def rows(found: ArealParameters, core: CoreParameters, more: SurfaceParameters) -> list[str]:
    """Parameters with unit and meaning, a line each."""
    um = 1e6
    table = (
        ("Sa", um * found.sa, "um", "arithmetic mean height"),
        ("Sq", um * found.sq, "um", "root mean square height"),
        ("Sz", um * more.sz, "um", "maximum height"),
        ("S10z", um * more.s10z, "um", "ten-point height, of peaks and pits of more than 5% of Sz"),
        ("Ssk", found.ssk, "", "skewness"),
        ("Sku", found.sku, "", "kurtosis"),
        ("Spk", um * core.rpk, "um", "reduced peak height"),
        ("Sk", um * core.rk, "um", f"core height, from {core.mr1:.1%} to {core.mr2:.1%} of material"),
        ("Svk", um * core.rvk, "um", "reduced valley depth"),
        ("Vmp", um * more.vmp, "um", "volume of the peaks above 10% of material, per area"),
        ("Vvv", um * more.vvv, "um", "volume of the valleys below 80% of material, per area"),
        ("Sdq", found.sdq, "", "root mean square gradient"),
        ("Sdr", 100.0 * more.sdr, "%", "developed interfacial area ratio"),
        ("Sal", um * found.sal, "um", "autocorrelation length, 0.2 in the direction of its fastest decay"),
        ("Str", found.str, "", "texture aspect ratio: 0 a lay, 1 isotropic"),
        ("Std", more.std, "°", "direction of the lay against the rows, towards Y"),
    )
    return parameter_lines(
        table, f"stays above {CORRELATION_THRESHOLD:g} up to half the map in some direction"
    )


def parameter_lines(table: tuple[tuple[str, float, str, str], ...], correlated: str) -> list[str]:
    """Parameters with unit and meaning, a line each, with the reason for one that is not a number.

    `correlated`: of messages, how an autocorrelation does that gives no length.
    """
    smooth = any(np.isnan(value) for name, value, *_ in table if name[1:] == "ku")
    reason = "none: no height differs" if smooth else f"none: the autocorrelation {correlated}"
    return [
        f"{name:4s}{value:10.4f} {unit:2s}  {text}{f'; {reason}' if np.isnan(value) else ''}"
        for name, value, unit, text in table
    ]


def draw(name: str, surface: Topography) -> Figure:
    """Map of the heights, autocorrelation and power spectral density along and across its rows."""
    found = surface.parameters
    figure, (heights, correlation, spectrum) = style.new_figure(1, 3, SIZE, width_ratios=(1.6, 1.0, 1.0))
    style.set_title(
        figure,
        name,
        f"Sa {1e6 * found.sa:.3g} µm, Sq {1e6 * found.sq:.3g} µm, Sdq {found.sdq:.3g}"
        + "".join(f", {name} {v:.2g}" for name, v in (("Ssk", found.ssk), ("Str", found.str)) if v == v),
    )
    _draw_heights(figure, heights, surface)
    if surface.sq == 0.0:
        for empty in (correlation, spectrum):
            empty.set_axis_off()
        return figure
    _draw_correlation(correlation, surface)
    draw_spectra(spectrum, spectra(surface))
    spectrum.legend(frameon=False, **style.SMALL)
    return figure


def spectra(surface: Topography) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Power spectral densities [m^3] over the wavenumber [rad/m] along and across the rows."""
    z = surface.z - surface.z.mean()
    return {"along": power_spectrum(z, surface.dx), "across": power_spectrum(z.T, surface.dy)}


def draw_spectra(axes: Axes, spectra: dict[str, tuple[np.ndarray, np.ndarray]]) -> None:
    """Draw power spectral densities by direction, with their means in bins."""
    for (direction, spectrum), colour in zip(spectra.items(), (style.SINGLE, style.SECOND), strict=False):
        axes.loglog(*spectrum, color=style.FAINT, lw=0.4)
        axes.loglog(*binned(*spectrum), color=colour, lw=1.4, label=direction)
    highest = max(density.max() for _, density in spectra.values())
    axes.set(xlabel="wavenumber [rad/m]", ylabel="power spectral density [m³]")
    axes.set_ylim(max(axes.get_ylim()[0], SHOWN_DENSITY * highest))
    above = axes.secondary_xaxis("top", functions=(_wavelength, _wavelength))
    above.tick_params(labelsize="small")
    above.set_xlabel("wavelength [µm]", fontsize="small")


def _wavelength(q: np.ndarray) -> np.ndarray:
    """Wavelength [um] of a wavenumber [rad/m], and the reverse."""
    return 2e6 * np.pi / np.maximum(q, 1e-300)


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


WIDTH, MAP_WIDTH, MARGIN = 7.0, 5.3, 1.1  # inches: of the figure, of a map, above and below a map
MAX_LENGTH = 4.0  # shown length of a surface over the width of the mesh


def draw_maps(
    surfaces: dict[str, MovingTopography], parts: list[tuple[float, float]], scales: Scales, travel: float
) -> Figure:
    """Draw the map of each rough surface, pale beyond the part that passes the whole contact.

    `parts`: ends of these parts [m].
    `travel`: of the faster surface in half-widths.
    """
    width = scales.grid.spacings[0] * scales.grid.shape[0]
    lengths = [min(surface.given.length, MAX_LENGTH * width) for surface in surfaces.values()]
    heights = [MAP_WIDTH * width / max(lengths) + MARGIN for _ in lengths]
    size = WIDTH, sum(heights) + 0.5
    figure, axes = style.new_figure(len(surfaces), 1, size, squeeze=False)
    for panel, (side, surface), length, part in zip(
        axes[:, 0], surfaces.items(), lengths, parts, strict=True
    ):
        X, z = heights_on_rows(surface, scales, length)
        low, high = np.quantile(z, (EXTREME_SHARE, 1.0 - EXTREME_SHARE))
        edges = 1e3 * X[0], 1e3 * X[-1], -5e2 * width, 5e2 * width
        colours = dict(cmap=COLOURS, vmin=1e6 * low, vmax=1e6 * high)
        image = panel.imshow(1e6 * z, extent=edges, origin="lower", interpolation="nearest", **colours)
        figure.colorbar(image, ax=panel, label="height [µm]", extend="both")
        panel.set(xlabel="abscissa of the map [mm]", ylabel=f"surface {side}, across [mm]")
        panel.set_title(_text(surface, scales, travel, part, X), fontsize="small", loc="left")
        if part[1] < X[-1]:
            panel.axvspan(1e3 * max(part[1], X[0]), edges[1], color="w", alpha=0.6, lw=0)
        _draw_contact(panel, 1e3 * (X[0] + 1.2 * scales.a), scales, width)
    return figure


def heights_on_rows(
    surface: MovingTopography, scales: Scales, length: float
) -> tuple[np.ndarray, np.ndarray]:
    """Abscissas [m] up to a length, and mean heights [m] of the rows of the mesh there, shape (ny, n)."""
    topography, dy, ny = surface.given, scales.grid.spacings[0], scales.grid.shape[0]
    rows = topography.row_means(topography.middle + dy * (np.arange(ny + 1) - 0.5 * ny)).T
    X = np.linspace(topography.X[0], topography.X[0] + length, min(MAX_PIXELS, len(topography.X)))
    z = np.stack([np.interp(X, topography.X, row) for row in rows])
    return X, np.broadcast_to(z, (ny, len(X)))


def _text(
    surface: MovingTopography, scales: Scales, travel: float, part: tuple[float, float], X: np.ndarray
) -> str:
    """Parameters of the whole map, and when it arrives."""
    found, arrives = surface.given.parameters, entry_times(surface, scales)
    texts = [f"Sa {1e6 * found.sa:.3f} µm, Sq {1e6 * found.sq:.3f} µm, Sdq {found.sdq:.3g}"]
    if np.isfinite(found.str):
        texts[0] += f", Str {found.str:.2g}"
    if arrives:
        texts.append(f"left end first, at the contact at travel {arrives[0]:.2f} a of {travel:g} a")
        if part[1] < X[-1]:
            texts[1] += "; pale: does not pass the whole contact"
    return "\n".join(texts)


def _draw_contact(axes: Axes, centre: float, scales: Scales, width: float) -> None:
    """Draw the edge of the dry contact to scale, around an abscissa [mm]."""
    a, line = 1e3 * scales.a, dict(fill=False, color="k", lw=1.0)
    if np.isfinite(scales.b):
        axes.add_patch(Ellipse((centre, 0.0), 2.0 * a, 2e3 * scales.b, **line))
    else:
        axes.add_patch(Rectangle((centre - a, -5e2 * width), 2.0 * a, 1e3 * width, **line))
