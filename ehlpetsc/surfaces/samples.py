"""Profile or map of one surface, measured or synthetic, from its table in the case file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.base.counts import whole_down
from ehlpetsc.base.errors import ProfileError
from ehlpetsc.surfaces import synthetic
from ehlpetsc.surfaces.files import areal, profiles
from ehlpetsc.surfaces.files.areal import Map, is_map, read_map
from ehlpetsc.surfaces.files.instruments import LAYOUT_KEYS
from ehlpetsc.surfaces.files.profiles import UNITS, Layout, read_profile
from ehlpetsc.surfaces.filters import SPACING_TOLERANCE, deviations, levelled, smoothed, without_form
from ehlpetsc.surfaces.random_maps import RANDOM_MAPS, random_map
from ehlpetsc.surfaces.synthetic import POINTS_PER_WAVE
from ehlpetsc.surfaces.topography import Topography

if TYPE_CHECKING:
    from ehlpetsc.base.declarations import Values

MEAN_TOLERANCE = 1e-3  # of Rq: smaller means are rounding


def samples(folder: Path, spec: Values) -> Topography:
    """Profile of one surface: read or generated, levelled, filtered, centred, flipped, scaled.

    Profile files are in `folder`, that of the case file.
    """
    if spec.synthetic is not None:
        X, z, repeats = synthetic.sampled(spec.synthetic)
        return Topography.profile(X, spec.scale * z, repeats)
    if spec.z is not None:
        unit, x_unit = spec.unit or "m", spec.x_unit or spec.unit or "m"
        steps = spec.spacing * np.arange(len(spec.z)) if spec.x is None else UNITS[x_unit] * np.array(spec.x)
        X, given, notes = profiles.checked(steps, UNITS[unit] * np.array(spec.z), layout_of(spec))
    else:
        X, given, notes = read_profile(folder / spec.file, layout_of(spec))
    z, notes = centred(*_filtered((X,), given, notes, spec), given)
    if spec.flip:
        X, z = X[-1] + X[0] - X[::-1], z[::-1]
    return Topography.profile(X, spec.scale * z, measured=True, notes=notes)


def measured_samples(folder: Path, spec: Values) -> Topography:
    """Profile or map of a surface, whichever it gives; raises `ProfileError`."""
    if spec.synthetic is None and holds_map(folder, spec):
        return areal_samples(folder, spec, np.inf, is_strip=False)
    return samples(folder, spec)


def layout_of(spec: Values) -> Layout:
    """Layout of the file of a surface."""
    values = {key: getattr(spec, key) for key in LAYOUT_KEYS}
    return Layout(**values | {"columns": spec.columns and tuple(spec.columns)})


def _filtered(
    axes: tuple[np.ndarray, ...], z: np.ndarray, notes: tuple[str, ...], spec: Values
) -> tuple[np.ndarray, tuple[str, ...]]:
    """Heights of a profile, axes (X,), or a map, (Y, X), without form and filtered waves, and notes."""
    if spec.level == "rows":
        z = levelled(axes[-1], z)
    elif degree := spec.form or int(spec.level):
        z = without_form(axes, z, degree)
    if spec.cutoff is not None:
        z = z - smoothed(axes, z, spec.cutoff, "cutoff")
    if spec.short_cutoff is not None:
        mean = smoothed(axes, z, spec.short_cutoff, "short_cutoff")
        shown = (f"{1e6 * abs(spec.scale) * np.abs(part - part.mean()).mean():.4f} um" for part in (z, mean))
        name = "Ra" if len(axes) == 1 else "Sa"
        z, notes = mean, (*notes, f"short_cutoff: {name} {next(shown)} before, {next(shown)} after")
    return z, notes


def centred(z: np.ndarray, notes: tuple[str, ...], given: np.ndarray) -> tuple[np.ndarray, tuple[str, ...]]:
    """Heights minus their mean, which would enter as a step and change the film, and notes with one on it.

    `given`: heights before a form was subtracted [m].
    """
    mean = float(z.mean())
    if not deviations(z, given).any():
        return np.zeros_like(z), (*notes, "all heights are equal, or on the form subtracted: smooth")
    if abs(mean) <= MEAN_TOLERANCE * (z - mean).std():
        return z, notes
    return z - mean, (*notes, f"mean height of {1e6 * mean:.4g} um subtracted")


def areal_samples(folder: Path, spec: Values, width: float, is_strip: bool) -> Topography:
    """Areal surface of a body; a profile is a ridge across the width.

    A map is read, levelled, filtered, turned, centred, flipped and scaled; for a strip it is also made
    periodic.

    `folder`: of map files, that of the case file.
    `width`: of the mesh across [m].
    `is_strip`: whether the contact is periodic over the width.
    """
    if spec.synthetic is not None:
        surface = synthetic_map(spec.synthetic, spec.direction or 0.0, width, is_strip)
        return replace(surface, z=spec.scale * surface.z)
    if not holds_map(folder, spec):
        _refuse(
            spec, ("spacing_across", "direction", "position_across", "mask"), "of a map, not of a profile"
        )
        return samples(folder, spec)
    if spec.z is not None and spec.x is None:
        _refuse(spec, ("x_unit",), "of x, not of spacing, which is in m; leave it out")
    surface = _processed(_map(folder, spec), spec)
    return surface.periodic_over(width) if is_strip else surface


def _refuse(spec: Values, keys: tuple[str, ...], reason: str) -> None:
    given = [key for key in keys if getattr(spec, key) is not None]
    if given:
        raise ProfileError(f"{', '.join(given)}: {reason}")


def holds_map(folder: Path, spec: Values) -> bool:
    """Whether the file of a surface, or the heights in its table, are a map and not a profile."""
    if spec.z is not None:
        return np.ndim(spec.z) == 2
    return spec.columns is None and is_map(folder / spec.file, layout_of(spec))


def _map(folder: Path, spec: Values) -> Map:
    """Map in the file of a surface, or in its table."""
    if spec.z is None:
        return read_map(folder / spec.file, layout_of(spec))
    dx = spec.spacing or _step(spec.x, "x", spec)
    dy = spec.spacing_across or spec.spacing or _step(spec.y, "y", spec)
    return areal.checked(Map(UNITS[spec.unit or "m"] * np.array(spec.z, float), dx, dy), layout_of(spec))


def _step(values: list[float], key: str, spec: Values) -> float:
    """Distance [m] of equally spaced abscissas."""
    steps = np.diff(values)
    if np.ptp(steps) > 2 * SPACING_TOLERANCE * abs(steps.mean()) or not steps.mean() > 0:
        raise ProfileError(f"{key}: allowed for a map: equally spaced, increasing")
    return UNITS[spec.x_unit or spec.unit or "m"] * float(steps.mean())


def _processed(found: Map, spec: Values) -> Topography:
    z, dx, dy, notes = found
    X, Y = dx * np.arange(z.shape[1]), dy * np.arange(z.shape[0])
    z, notes = _filtered((Y, X), z, notes, spec)
    z, dx, dy = turned(z, dx, dy, spec.direction or 0.0)
    z, notes = centred(z, notes, found.z)
    if spec.flip:
        z = z[::-1, ::-1]  # turned by half a turn, not mirrored
    X, Y = dx * np.arange(z.shape[1]), dy * np.arange(z.shape[0])
    middle = 0.5 * Y[-1] if spec.position_across is None else spec.position_across
    if not 0.0 <= middle <= Y[-1]:
        raise ProfileError(f"position_across = {middle:g} m; allowed: on the map, from 0 to {Y[-1]:g} m")
    return Topography(X, Y, spec.scale * z, middle=middle, measured=True, notes=notes)


def turned(z: np.ndarray, dx: float, dy: float, direction: float) -> tuple[np.ndarray, float, float]:
    """Map whose rows lie at an angle against x, on rows along x, and its spacings [m].

    Exact by quarters of a turn; otherwise the largest upright rectangle in the turned map, by cubic
    splines, with the smaller of both spacings.

    `direction`: angle of the rows of z against x, towards y [degrees].
    """
    if direction % 90.0 == 0.0:
        quarters = round(direction / 90.0) % 4
        return np.rot90(z, -quarters), *((dy, dx) if quarters % 2 else (dx, dy))
    from scipy.ndimage import map_coordinates

    size = dx * (z.shape[1] - 1), dy * (z.shape[0] - 1)
    c, s = np.cos(np.radians(direction)), np.sin(np.radians(direction))
    step, (length, width) = min(dx, dy), inscribed(*size, abs(c), abs(s))
    if min(length, width) < 4 * step:
        raise ProfileError(
            f"direction = {direction:g}: the turned map holds {length:g} x {width:g} m; use a larger one"
        )
    x, y = (
        step * (np.arange(n) - 0.5 * (n - 1))
        for n in (whole_down(length / step) + 1, whole_down(width / step) + 1)
    )
    along = 0.5 * size[0] + c * x + s * y[:, np.newaxis]
    across = 0.5 * size[1] - s * x + c * y[:, np.newaxis]
    return map_coordinates(z, [across / dy, along / dx], order=3, mode="mirror"), step, step


def inscribed(length: float, width: float, c: float, s: float) -> tuple[float, float]:
    """Sides of the largest upright rectangle in a rectangle turned by an angle of cosine c and sine s."""
    short = min(length, width)
    if short <= 2.0 * s * c * max(length, width) or abs(s - c) < 1e-10:  # two corners on the long sides
        sides = 0.5 * short / s, 0.5 * short / c
        return sides if length >= width else sides[::-1]
    cos_2 = c * c - s * s
    return (length * c - width * s) / cos_2, (width * c - length * s) / cos_2


def synthetic_map(spec: Values, direction: float, width: float, is_strip: bool) -> Topography:
    """Map of a synthetic surface.

    A crest, the middle of a bump and the first row of a random map are at y = 0.

    `direction`: of the rows of a random surface against x [degrees].
    `width`: of the mesh across [m].
    `is_strip`: whether the contact is periodic over the width.
    """
    if spec.kind == "self-affine" or spec.kind == "ground" and spec.correlation_across is not None:
        return random_map(spec, direction, width if is_strip else None)
    if direction:
        raise ProfileError(
            f"direction = {direction:g}: of a map in a file or of a random surface; leave it out, or write "
            "kind = " + " or ".join(f'"{kind}"' for kind in RANDOM_MAPS)
        )
    if spec.kind == "sine" and spec.wavelength_across is not None:
        return _waves(spec, width, is_strip)
    if spec.kind == "dent" or spec.kind == "ridge" and spec.wavelength_across is not None:
        return _bump(spec, width, is_strip)
    return Topography.profile(*synthetic.sampled(spec))


def _waves(spec: Values, width: float, is_strip: bool) -> Topography:
    """Product of cosines with a crest at X = 0, y = 0."""
    across = spec.wavelength_across
    if is_strip and abs(width / across - max(round(width / across), 1)) > 1e-6 * width / across:
        fitting = width / max(round(width / across), 1)
        raise ProfileError(
            f"wavelength_across = {across:g} m; allowed: whole waves over the width of the strip, "
            f"{width:g} m, next to it {fitting:g} m"
        )
    half_wave = np.cos(np.linspace(0.0, np.pi, POINTS_PER_WAVE // 2 + 1))
    X, Y = (np.linspace(0.0, 0.5 * length, len(half_wave)) for length in (spec.wavelength, across))
    return Topography(X, Y, spec.amplitude * np.multiply.outer(half_wave, half_wave))


def _bump(spec: Values, width: float, is_strip: bool) -> Topography:
    r"""Ridge or dent, :math:`z=\pm A\exp[-(2(X-X_c)/w)^2-(2y/w_y)^2]`; over a strip one in every period."""
    across = spec.wavelength if spec.wavelength_across is None else spec.wavelength_across
    X, along = synthetic.bump(spec)
    reach = 0.5 * width if is_strip else 3 * across
    Y = np.linspace(-reach, reach, max(round(2 * reach / across * POINTS_PER_WAVE), 4) + 1)
    images = width * np.arange(-np.ceil(3 * across / width), np.ceil(3 * across / width) + 1)
    distances = np.subtract.outer(Y, images if is_strip else np.zeros(1))
    profile = np.exp(-((2 * distances / across) ** 2)).sum(axis=1)
    return Topography(X, Y, np.multiply.outer(profile, along), "zero", "periodic" if is_strip else "zero")
