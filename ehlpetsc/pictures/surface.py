"""Roughness parameters, power spectrum and picture of a surface file: ``ehlpetsc surface FILE``.

FILE is a profile or map as in ``[surface.1]``, whose keys ``--set unit=um``, ``--set cutoff=0.8e-3`` and so
on set. The least-squares line or plane is subtracted, except with ``--set level=false``. Without a cutoff the
parameters are those of the primary profile. ``--csv FILE.csv`` writes the power spectral density, of a map
those along and across its rows. ``-o FILE.gsf``, ``.x3p`` or ``.vti`` writes the surface as used, in place of
the picture. ``--minus OTHER`` takes the difference of two maps of one part, with the same keys.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ehlpetsc.base.command_line import CommandParser, exit_status
from ehlpetsc.base.declarations import Values
from ehlpetsc.base.errors import CaseError, ProfileError
from ehlpetsc.case.checking import check, in_si
from ehlpetsc.case.combinations import parsed, put
from ehlpetsc.case.tables.surface import PROFILE
from ehlpetsc.pictures import areal_surface, style
from ehlpetsc.results.output_guard import PICTURES, atomic_write, check_derived
from ehlpetsc.surfaces.areal_samples import areal_samples, holds_map
from ehlpetsc.surfaces.difference import difference
from ehlpetsc.surfaces.exports import WRITERS, GridField
from ehlpetsc.surfaces.parameters import (
    MIN_POINTS,
    CoreParameters,
    ProfileParameters,
    equally_spaced,
    power_spectrum,
)
from ehlpetsc.surfaces.profile_checks import doubts
from ehlpetsc.surfaces.samples import Samples, samples
from ehlpetsc.surfaces.topography import Topography

TABLE = "surface.1."
SIZE = (9.0, 6.0)  # inches
HEADING = "wavelength [m],wavenumber [rad/m],power spectral density [m^3]"


def arguments() -> CommandParser:
    """Parse the command line."""
    parser = CommandParser("surface", __doc__)
    parser.add_argument("file", help="profile or map")
    parser.add_argument(
        "-o", "--output", help="picture [FILE.surface.png]; .gsf, .x3p, .vti: the surface as used"
    )
    parser.add_argument("--minus", metavar="FILE", help="map to subtract, moved to where both correlate best")
    parser.add_argument("--no-picture", action="store_true", help="the parameters alone")
    parser.add_argument("--csv", metavar="FILE.csv", help="power spectral density over the wavenumber")
    parser.add_argument(
        "--set", action="append", default=[], metavar="KEY=VALUE", help="key of [surface.1]; may be repeated"
    )
    return parser


def main(words: list[str]) -> int:
    """Run the command; returns its exit status."""
    chosen = arguments().parse_args(words)
    return exit_status("surface", lambda: run(chosen))


def run(chosen: argparse.Namespace) -> None:
    """Print the parameters, write picture and spectrum."""
    path, spec = Path(chosen.file), _spec(chosen.file, chosen.set)
    inputs = [path, *([Path(chosen.minus)] if chosen.minus else [])]
    target = None if chosen.no_picture else Path(chosen.output or path.with_suffix(".surface.png"))
    for file, endings, option in (
        (target, (*PICTURES, *WRITERS), "-o"),
        (chosen.csv, (".csv", ".txt"), "--csv"),
    ):
        if file is not None:
            check_derived(Path(file), inputs, endings, option)
    try:
        if holds_map(Path(), spec):
            surface = areal_samples(Path(), spec, 0.0, False)
            return _run_map(chosen, _minus(surface, chosen) if chosen.minus else surface, target)
        if chosen.minus:
            raise ProfileError("a profile; allowed for --minus: maps")
        profile = samples(Path(), spec)
        if profile.X.size < MIN_POINTS:
            raise ProfileError(f"{profile.X.size} points; allowed for parameters: at least {MIN_POINTS}")
    except ProfileError as error:
        raise CaseError([f"{chosen.file}: {error}"]) from None
    dx, z, is_interpolated = equally_spaced(profile.X, profile.z)
    parameters, spectrum = ProfileParameters.of(z, dx, spec.cutoff), power_spectrum(z, dx)
    notes = [*profile.notes, *(["interpolated at equal spacing"] if is_interpolated else [])]
    print("\n".join([_size(chosen.file, profile), *notes, *doubts(profile), *rows(parameters)]))
    if chosen.csv is not None:
        atomic_write(chosen.csv, csv({"": spectrum}).encode())
        print(chosen.csv)
    _write(target, GridField(z[np.newaxis], dx, dx), lambda: draw(path.name, profile, parameters, spectrum))


def _minus(surface: Topography, chosen: argparse.Namespace) -> Topography:
    """Difference of the map and that of ``--minus``."""
    try:
        return difference(surface, areal_samples(Path(), _spec(chosen.minus, chosen.set), 0.0, False))
    except ProfileError as error:
        raise CaseError([f"{chosen.minus}: {error}"]) from None


def _write(target: Path | None, heights: GridField, picture: Callable[[], Figure]) -> None:
    """Write heights or, by the ending of the target, their picture."""
    if target is None:
        return
    if write := WRITERS.get(target.suffix.lower()):
        atomic_write(target, write(heights))
    else:
        style.save(picture(), target)
    print(target)


def _run_map(chosen: argparse.Namespace, surface: Topography, target: Path | None) -> None:
    print("\n".join(areal_surface.lines(chosen.file, surface)))
    if chosen.csv is not None:
        atomic_write(chosen.csv, csv(areal_surface.spectra(surface)).encode())
        print(chosen.csv)
    heights = GridField(surface.z, surface.dx, surface.dy)
    _write(target, heights, lambda: areal_surface.draw(Path(chosen.file).name, surface))


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
    faults = in_si({"surface": {"1": table}})
    spec, found = (None, []) if faults else check(PROFILE, table, TABLE)
    if faults or found:
        raise CaseError([f"{file}: {fault.text.removeprefix(TABLE)}" for fault in [*faults, *found]])
    return spec


def _size(file: str, profile: Samples) -> str:
    points = f"{profile.X.size} points {1e6 * profile.spacing:.4g} um apart"
    return f"{file}: {1e3 * profile.length:.4g} mm long, {points}"


def rows(parameters: ProfileParameters) -> list[str]:
    """Parameters with unit and meaning, a line each."""
    core, um = parameters.core, 1e6
    table = (
        ("Ra", um * parameters.ra, "um", "arithmetic mean height"),
        ("Rq", um * parameters.rq, "um", "root mean square height"),
        ("Rz", um * parameters.rz, "um", "mean maximum height of the sections"),
        ("Rsk", parameters.rsk, "", "skewness"),
        ("Rku", parameters.rku, "", "kurtosis"),
        ("Rpk", um * core.rpk, "um", "reduced peak height"),
        ("Rk", um * core.rk, "um", f"core height, from {core.mr1:.1%} to {core.mr2:.1%} of material"),
        ("Rvk", um * core.rvk, "um", "reduced valley depth"),
        ("Rdq", parameters.rdq, "", "root mean square slope"),
        ("l", um * parameters.correlation_length, "um", "correlation length, autocorrelation 1/e"),
    )
    return areal_surface.parameter_lines(table, "stays above 1/e up to half the profile")


def csv(spectra: dict[str, tuple[np.ndarray, np.ndarray]]) -> str:
    """Power spectral densities by direction, "" of a profile, as CSV, one line a wavenumber [rad/m]."""
    table = {f",{direction}" if direction else "": spectrum for direction, spectrum in spectra.items()}
    lines = [
        f"{2 * np.pi / k:.8e},{k:.8e},{c:.8e}{direction}"
        for direction, spectrum in table.items()
        for k, c in zip(*spectrum, strict=True)
    ]
    return "\n".join([HEADING if "" in table else f"{HEADING},direction", *lines]) + "\n"


def draw(
    name: str, profile: Samples, parameters: ProfileParameters, spectrum: tuple[np.ndarray, np.ndarray]
) -> Figure:
    """Profile, power spectral density and material ratio curve."""
    figure = Figure(figsize=SIZE, layout="constrained")
    axes = figure.subplot_mosaic([["profile", "profile"], ["spectrum", "material"]])
    style.set_title(
        figure,
        name,
        f"Ra {1e6 * parameters.ra:.3g} µm, Rq {1e6 * parameters.rq:.3g} µm, Rsk {parameters.rsk:.2f}, "
        f"Rdq {parameters.rdq:.3g}",
    )
    axes["profile"].plot(1e3 * profile.X, 1e6 * profile.z, color=style.SINGLE, lw=0.7)
    axes["profile"].set(xlabel="X [mm]", ylabel="height [µm]", xlim=1e3 * profile.X[[0, -1]])
    if parameters.rq > 0.0:
        areal_surface.draw_spectra(axes["spectrum"], {"": spectrum})
    else:
        axes["spectrum"].set_axis_off()
    _draw_material_ratio(axes["material"], profile.z, parameters.core)
    return figure


def _draw_material_ratio(axes: Axes, z: np.ndarray, core: CoreParameters) -> None:
    heights = np.sort(z)[::-1]
    axes.plot(100 * (np.arange(z.size) + 0.5) / z.size, 1e6 * heights, color=style.SINGLE)
    ends = 1e6 * np.array([core.top, core.top - core.rk])
    axes.plot([0, 100], ends, "--", color=style.SECOND, lw=1)
    for share, height in zip((core.mr1, core.mr2), ends, strict=True):
        axes.plot(100 * share, height, "o", color=style.SECOND, ms=4)
    texts = (f"{name} {1e6 * value:.3g} µm" for name, value in zip(("Rpk", "Rk", "Rvk"), core, strict=False))
    axes.set_title(", ".join(texts), fontsize="small")
    axes.set(xlabel="material ratio [%]", ylabel="height [µm]", xlim=(0, 100))
