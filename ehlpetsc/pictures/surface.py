"""Roughness parameters, power spectrum and picture of a surface file: ``ehlpetsc surface FILE``.

FILE is a profile or map as in ``[surface.1]``, whose keys ``--set unit=um``, ``--set cutoff=0.8e-3`` and so
on set. The least-squares line or plane is subtracted, except with ``--set level=false``. Without a cutoff the
parameters are those of the primary profile. ``--csv FILE.csv`` writes the power spectral density, of a map
those along and across its rows. ``-o FILE.gsf``, ``.x3p`` or ``.vti`` writes the surface as used, in place of
the picture. ``--minus OTHER`` takes the difference of two maps of one part, with the same keys.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ehlpetsc.base.command_line import CommandParser, exit_status
from ehlpetsc.base.declarations import Values
from ehlpetsc.base.errors import CaseError, OutputError, ProfileError
from ehlpetsc.base.toml_file import parsed, put
from ehlpetsc.case.checking import check, in_si
from ehlpetsc.case.tables.surface import PROFILE
from ehlpetsc.pictures import style
from ehlpetsc.results.exports import WRITERS, GridField
from ehlpetsc.results.output_guard import OVERWRITE_ADVICE, PICTURES, atomic_write, check_derived
from ehlpetsc.surfaces.motion.profile_checks import doubts
from ehlpetsc.surfaces.parameters import (
    CORRELATION_THRESHOLD,
    MIN_PARAMETER_POINTS,
    PARAMETERS,
    autocorrelation,
    binned,
    equally_spaced,
    power_spectrum,
    profile_parameters,
)
from ehlpetsc.surfaces.samples import measured_samples
from ehlpetsc.surfaces.topography import Topography, difference

TABLE = "surface.1."
SURFACE_SIZE, MAP_SIZE = (9.0, 6.0), (13.0, 4.2)  # inches
HEADING = "wavelength [m],wavenumber [rad/m],power spectral density [m^3]"
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


def main(words: list[str]) -> int:
    """Run the command; returns its exit status."""
    parser = CommandParser("surface", __doc__)
    parser.add_argument("file", help="profile or map")
    parser.add_argument(
        "-o",
        "--output",
        help="picture [FILE.surface.png, FILE.minus.png]; .gsf, .x3p, .vti: the surface as used",
    )
    parser.add_argument("--minus", metavar="FILE", help="map to subtract, moved to where both correlate best")
    parser.add_argument("--no-picture", action="store_true", help="the parameters alone")
    parser.add_argument("--csv", metavar="FILE.csv", help="power spectral density over the wavenumber")
    parser.add_argument(
        "--set", action="append", default=[], metavar="KEY=VALUE", help="key of [surface.1]; may be repeated"
    )
    chosen = parser.parse_args(words)
    return exit_status("surface", lambda: run(chosen))


def run(chosen: argparse.Namespace) -> None:
    """Print the parameters, write picture and spectrum."""
    path, spec = Path(chosen.file), _spec(chosen.file, chosen.set)
    inputs = [path, *([Path(chosen.minus)] if chosen.minus else [])]
    kind = "minus" if chosen.minus else "surface"
    target = None if chosen.no_picture else Path(chosen.output or path.with_suffix(f".{kind}.png"))
    for file, endings, option in (
        (target, (*PICTURES, *WRITERS), "-o"),
        (chosen.csv, (".csv", ".txt"), "--csv"),
    ):
        if file is not None:
            check_derived(Path(file), inputs, endings, option)
    if target and target.suffix.lower() in WRITERS and target.exists() and not chosen.overwrite:
        raise OutputError(f"{target}: exists; {OVERWRITE_ADVICE}")
    surface = _used(chosen.file, spec, chosen.minus is not None)
    if chosen.minus:
        try:
            surface = difference(surface, _used(chosen.minus, _spec(chosen.minus, chosen.set), False))
        except ProfileError as error:
            raise CaseError([f"{chosen.minus}: {error}"]) from None
    if surface.is_ridge:
        parameters = profile_parameters(surface.z[0], surface.dx, spec.cutoff)
    else:
        parameters = surface.parameters
    notes = [*surface.notes, *doubts(surface)]
    print("\n".join([f"{chosen.file}: {surface.extent_text}", *notes, *rows(parameters)]))
    densities = spectra(surface)
    if chosen.csv is not None:
        atomic_write(chosen.csv, csv(densities).encode())
        print(chosen.csv)
    if target is None:
        return
    if write := WRITERS.get(target.suffix.lower()):
        atomic_write(target, write(GridField(surface.z, surface.dx, surface.dy)))
    else:
        draw = draw_profile if surface.is_ridge else draw_map
        style.save(draw(" minus ".join(file.name for file in inputs), surface, parameters, densities), target)
    print(target)


def _used(file: str, spec: Values, is_for_difference: bool) -> Topography:
    """Map, or profile at equal spacing, of a file; raises `CaseError`."""
    try:
        surface = measured_samples(Path(), spec)
        if not surface.is_ridge:
            return surface
        if is_for_difference:
            raise ProfileError("a profile; allowed for --minus: maps")
        if surface.X.size < MIN_PARAMETER_POINTS:
            allowed = f"allowed for parameters: at least {MIN_PARAMETER_POINTS}"
            raise ProfileError(f"{surface.X.size} points; {allowed}")
    except ProfileError as error:
        raise CaseError([f"{file}: {error}"]) from None
    X, z, is_interpolated = equally_spaced(surface.X, surface.z[0])
    notes = (*surface.notes, *(["interpolated at equal spacing"] if is_interpolated else []))
    return replace(surface, X=X, z=z[np.newaxis], notes=notes)


def _spec(file: str, overrides: list[str]) -> Values:
    """Checked table [surface.1] of a file; raises `CaseError`."""
    table: dict[str, Any] = {"file": file}
    for override in overrides:
        try:
            keys, value = parsed(override.removeprefix(TABLE))
            put(table, keys, value)
        except ValueError:
            raise CaseError([f"--set {override}: allowed: KEY=VALUE, as in unit=um"]) from None
    if "form" not in table:
        table.setdefault("level", True)
    faults = in_si({"surface": {"1": table}}, "line")
    spec, found = (None, []) if faults else check(PROFILE, table, TABLE)
    if faults or found:
        raise CaseError([f"{file}: {fault.text.removeprefix(TABLE)}" for fault in [*faults, *found]])
    return spec


def rows(found: dict[str, float]) -> list[str]:
    """Parameters with unit and meaning, a line each, with the reason for one that is not a number."""
    letter = "R" if "Ra" in found else "S"
    is_smooth = np.isnan(found[f"{letter}ku"])
    reason = "no height differs" if is_smooth else f"the autocorrelation {NO_LENGTH[letter]}"
    core = {ratio: found[letter + ratio] for ratio in ("mr1", "mr2")}
    lines = []
    for pattern, unit, meaning in PARAMETERS:
        value = FACTORS.get(unit, 1.0) * found.get(name := pattern.replace("?", letter), np.inf)
        text = meaning.format(**core) + (f"; none: {reason}" if np.isnan(value) else "")
        lines += [f"{name:4s}{value:10.4f} {unit:2s}  {text}"] * (name in found)
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
