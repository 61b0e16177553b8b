"""Picture of a profile or map with its roughness parameters and power spectra, and both as text."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ehlpetsc.pictures import style
from ehlpetsc.surfaces.parameters import (
    CORRELATION_THRESHOLD,
    ISOTROPIC,
    PARAMETERS,
    autocorrelation,
    binned,
    power_spectrum,
)
from ehlpetsc.surfaces.topography import Topography

SURFACE_SIZE, MAP_SIZE = (9.0, 6.0), (13.0, 4.2)  # inches
HEADING = "wavelength [m],wavenumber [rad/m],power spectral density [m^3]"
DECIMALS = {"/m": 1}  # shown; of others four
FACTORS = {"um": 1e6, "%": 100.0}  # of the shown units
NO_LENGTH = {
    "R": "stays above 1/e up to half the profile",
    "S": f"stays above {CORRELATION_THRESHOLD:g} up to half the map in some direction",
}  # of parameters that are not numbers, how the autocorrelation behaves
MAX_PIXELS = 1500  # of the picture of a map, along either side
EXTREME_SHARE = 0.001  # of the heights, beyond the ends of the colours
HEIGHT_COLOURS = "viridis"
SHOWN_DENSITY = 1e-12  # over the highest: below it is the rounding of synthetic waves
SHOWN_DECAYS = 5  # of the slowest decay that the picture shows

Spectra = dict[str, tuple[np.ndarray, np.ndarray]]


def rows(found: dict[str, float]) -> list[str]:
    """Parameters with unit and meaning, a line each, with the reason for one that is not a number."""
    letter = "R" if "Ra" in found else "S"
    is_smooth = np.isnan(found[f"{letter}ku"])
    reason = "no height differs" if is_smooth else f"the autocorrelation {NO_LENGTH[letter]}"
    reasons = {} if is_smooth else {"Std": f"no lay, as Str is above {ISOTROPIC:g}"}
    core = {ratio: found[letter + ratio] for ratio in ("mr1", "mr2")}
    lines = []
    for pattern, unit, meaning in PARAMETERS:
        value = FACTORS.get(unit, 1.0) * found.get(name := pattern.replace("?", letter), np.inf)
        text = meaning.format(**core) + (f"; none: {reasons.get(name, reason)}" if np.isnan(value) else "")
        lines += [f"{name:4s}{value:10.{DECIMALS.get(unit, 4)}f} {unit:2s}  {text}"] * (name in found)
    return lines


def spectra(surface: Topography) -> Spectra:
    """Power spectral densities [m^3] over q [rad/m]: "" of a profile, "along" and "across" of a map."""
    z = surface.z - surface.z.mean()
    if surface.is_ridge:
        return {"": power_spectrum(z[0], surface.dx)}
    return {"along": power_spectrum(z, surface.dx), "across": power_spectrum(z.T, surface.dy)}


def csv(spectra: Spectra) -> str:
    """Power spectral densities by direction as CSV, one line a wavenumber [rad/m]."""
    table = {f",{direction}" if direction else "": spectrum for direction, spectrum in spectra.items()}
    lines = [
        f"{2 * np.pi / k:.8e},{k:.8e},{c:.8e}{direction}"
        for direction, spectrum in table.items()
        for k, c in zip(*spectrum, strict=True)
    ]
    return "\n".join([HEADING if "" in table else f"{HEADING},direction", *lines]) + "\n"


def draw_profile(name: str, profile: Topography, found: dict[str, float], spectra: Spectra) -> Figure:
    """Profile, power spectral density and material ratio curve."""
    figure = Figure(figsize=SURFACE_SIZE, layout="constrained")
    axes = figure.subplot_mosaic([["profile", "profile"], ["spectrum", "material"]])
    style.set_title(figure, name, shown_parameters(found, "R"))
    axes["profile"].plot(1e3 * profile.X, 1e6 * profile.z[0], color=style.SINGLE, lw=0.7)
    axes["profile"].set(xlabel="X [mm]", ylabel="height [µm]", xlim=1e3 * profile.X[[0, -1]])
    if profile.sq > 0.0:
        _draw_spectra(axes["spectrum"], spectra)
    else:
        axes["spectrum"].set_axis_off()
    _draw_material_ratio(axes["material"], profile.z, found)
    return figure


def draw_map(name: str, surface: Topography, found: dict[str, float], spectra: Spectra) -> Figure:
    """Map of the heights, autocorrelation and power spectral density along and across its rows."""
    figure, (heights, *others) = style.new_figure(1, 3, MAP_SIZE, width_ratios=(1.6, 1.0, 1.0))
    style.set_title(figure, name, shown_parameters(found, "S"))
    every = [-(-n // MAX_PIXELS) for n in surface.z.shape]
    edges = surface.X[0], surface.X[-1], surface.Y[0], surface.Y[-1]
    draw_heights(heights, surface.z[:: every[0], :: every[1]], edges)
    heights.set(xlabel="X [mm]", ylabel="Y [mm]")
    if surface.sq == 0.0:
        for empty in others:
            empty.set_axis_off()
        return figure
    _draw_correlation(others[0], surface, found)
    _draw_spectra(others[1], spectra)
    others[1].legend(frameon=False, **style.SMALL)
    return figure


def shown_parameters(found: dict[str, float], letter: str) -> str:
    """The most important parameters, but those that are not numbers, for titles."""
    lengths = [f"{letter}{name} {1e6 * found[letter + name]:.3g} µm" for name in "aq"]
    others = {letter + name: found.get(letter + name, np.nan) for name in ("sk", "dq", "tr")}
    return ", ".join(lengths + [f"{name} {value:.2g}" for name, value in others.items() if value == value])


def draw_heights(axes: Axes, z: np.ndarray, edges: tuple[float, ...], **options: object) -> None:
    """Draw heights [m] between edges [m] in x and y as colours, with their bar; extremes are cut off."""
    low, high = 1e6 * np.quantile(z, (EXTREME_SHARE, 1 - EXTREME_SHARE))
    place = dict(extent=1e3 * np.array(edges), origin="lower")
    image = axes.imshow(1e6 * z, HEIGHT_COLOURS, vmin=low, vmax=high, **place, **options)
    axes.figure.colorbar(image, ax=axes, label="height [µm]", extend="both")


def _draw_spectra(axes: Axes, spectra: Spectra) -> None:
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


def _draw_material_ratio(axes: Axes, z: np.ndarray, found: dict[str, float]) -> None:
    heights = np.sort(z, axis=None)[::-1]
    axes.plot(100 * (np.arange(z.size) + 0.5) / z.size, 1e6 * heights, color=style.SINGLE)
    ends = 1e6 * np.array([found["Rtop"], found["Rtop"] - found["Rk"]])
    axes.plot([0, 100], ends, "--", color=style.SECOND, lw=1)
    axes.plot([100 * found["Rmr1"], 100 * found["Rmr2"]], ends, "o", color=style.SECOND, ms=4)
    texts = (f"{name} {1e6 * found[name]:.3g} µm" for name in ("Rpk", "Rk", "Rvk"))
    axes.set_title(", ".join(texts), fontsize="small")
    axes.set(xlabel="material ratio [%]", ylabel="height [µm]", xlim=(0, 100))


def _draw_correlation(axes: Axes, surface: Topography, found: dict[str, float]) -> None:
    correlation = autocorrelation(surface.z - surface.z.mean())
    row, column = (n // 2 for n in correlation.shape)
    along, across = correlation[row, column:], correlation[row:, column]
    axes.plot(1e6 * surface.dx * np.arange(along.size), along, color=style.SINGLE, label="along the rows")
    axes.plot(1e6 * surface.dy * np.arange(across.size), across, color=style.SECOND, label="across")
    axes.axhline(CORRELATION_THRESHOLD, color=style.FAINT, lw=0.8)
    axes.set(xlabel="lag [µm]", ylabel="autocorrelation", ylim=(min(-0.3, along.min(), across.min()), 1.05))
    if np.isfinite(found["Sal"]):
        longest = found["Sal"] / np.nan_to_num(found["Str"], nan=1.0)
        axes.set_xlim(0.0, 1e6 * SHOWN_DECAYS * longest)
    axes.legend(frameon=False, **style.SMALL)
