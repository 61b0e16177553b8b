"""Roughness parameters, power spectrum and picture of a surface file: ``ehlpetsc surface FILE``.

FILE is a profile or map as in ``[surface.1]``, whose keys ``--set unit=um``, ``--set cutoff=0.8e-3`` and so
on set. The least-squares line or plane is subtracted, except with ``--set level=false``. Without a cutoff the
parameters are those of the primary profile. ``--csv FILE.csv`` writes the power spectral density, of a map
those along and across its rows. ``-o FILE.gsf``, ``.x3p`` or ``.vti`` writes the surface as used, in place of
the picture. ``--minus OTHER`` takes the difference of two maps of one part, with the same keys, and prints
the worn volume and depth.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from ehlpetsc.base.command_line import CommandParser, exit_status
from ehlpetsc.base.declarations import Values
from ehlpetsc.base.errors import CaseError, ProfileError
from ehlpetsc.base.toml_file import parsed, with_key
from ehlpetsc.case.checking import check, in_si
from ehlpetsc.case.tables.surface import PROFILE
from ehlpetsc.pictures import style
from ehlpetsc.pictures.surface import csv, draw_map, draw_profile, rows, spectra
from ehlpetsc.results.exports import WRITERS, GridField
from ehlpetsc.results.output_guard import PICTURES, atomic_write, check_derived, check_new, check_table
from ehlpetsc.surfaces.differences import difference, wear_of
from ehlpetsc.surfaces.motion.profile_checks import doubts
from ehlpetsc.surfaces.parameters import MIN_PARAMETER_POINTS, equally_spaced, profile_parameters
from ehlpetsc.surfaces.samples import measured_samples
from ehlpetsc.surfaces.topography import Topography

TABLE = "surface.1."


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
    masks = [file.parent / spec.mask for file in inputs if spec.mask]
    kind = "minus" if chosen.minus else "surface"
    target = None if chosen.no_picture else Path(chosen.output or path.with_suffix(f".{kind}.png"))
    for file, endings, option in (
        (target, (*PICTURES, *WRITERS), "-o"),
        (chosen.csv, (".csv", ".txt"), "--csv"),
    ):
        if file is not None:
            check_derived(Path(file), [*inputs, *masks], endings, option)
    if target and target.suffix.lower() in WRITERS:
        check_new(target, chosen.overwrite)
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
    densities = spectra(surface)
    table = csv(densities)
    if chosen.csv is not None:
        check_table(Path(chosen.csv), table.partition("\n")[0], chosen.overwrite, "--csv")
    notes = [*surface.notes, *doubts(surface)]
    wear = [wear_of(surface).text] if chosen.minus else []
    print("\n".join([f"{chosen.file}: {surface.extent_text}", *notes, *wear, *rows(parameters)]))
    if chosen.csv is not None:
        atomic_write(Path(chosen.csv), table.encode())
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
            table = with_key(table, keys, value)
        except ValueError:
            raise CaseError([f"--set {override}: allowed: KEY=VALUE, as in unit=um"]) from None
    if "form" not in table:
        table.setdefault("level", True)
    tables, faults = in_si({"surface": {"1": table}}, "line")
    spec, found = (None, []) if faults else check(PROFILE, tables["surface"]["1"], TABLE)
    if faults or found:
        raise CaseError([f"{file}: {fault.text.removeprefix(TABLE)}" for fault in [*faults, *found]])
    return spec
