"""Map of one areal surface, from its table in the case file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.base.errors import ProfileError
from ehlpetsc.surfaces import synthetic_areal
from ehlpetsc.surfaces.areal_files import Map, MapLayout, checked, is_map, read_map
from ehlpetsc.surfaces.continued_spline import Continuation
from ehlpetsc.surfaces.filters import SPACING_TOLERANCE, mean_surface, without_form
from ehlpetsc.surfaces.profile_files import UNITS
from ehlpetsc.surfaces.samples import MEAN_TOLERANCE, mean_deviation, samples
from ehlpetsc.surfaces.topography import Topography

if TYPE_CHECKING:
    from ehlpetsc.base.declarations import Values


def areal_samples(folder: Path, spec: Values, width: float, is_strip: bool) -> Topography:
    """Areal surface of a body; a profile is a ridge across the width.

    A map is read, levelled, filtered, turned, centred, flipped and scaled; for a strip it is also made
    periodic.

    `folder`: of map files, that of the case file.
    `width`: of the mesh across [m].
    `is_strip`: whether the contact is periodic over the width.
    """
    if spec.synthetic is not None:
        surface = synthetic_areal.sampled(spec.synthetic, spec.direction or 0.0, width, is_strip)
        return replace(surface, z=spec.scale * surface.z)
    if not holds_map(folder, spec):
        _refuse(spec, ("spacing_across", "direction", "position_across"), "of a map, not of a profile")
        profile = samples(folder, spec)
        along: Continuation = "mirrored" if profile.repeats else "zero"
        return Topography(
            profile.X, np.zeros(1), profile.z[np.newaxis], along, measured=True, notes=profile.notes
        )
    if spec.x is None:
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
    return spec.columns is None and is_map(folder / spec.file, layout_of_map(spec))


def layout_of_map(spec: Values) -> MapLayout:
    """Layout of the file of a map."""
    return MapLayout(**{key: getattr(spec, key) for key in MapLayout._fields})


def _map(folder: Path, spec: Values) -> Map:
    """Map in the file of a surface, or in its table."""
    if spec.z is None:
        return read_map(folder / spec.file, layout_of_map(spec))
    dx = spec.spacing or _step(spec.x, "x", spec)
    dy = spec.spacing_across or spec.spacing or _step(spec.y, "y", spec)
    return checked(Map(UNITS[spec.unit or "m"] * np.array(spec.z, float), dx, dy), layout_of_map(spec))


def _step(values: list[float], key: str, spec: Values) -> float:
    """Distance [m] of equally spaced abscissas."""
    steps = np.diff(values)
    if np.ptp(steps) > 2 * SPACING_TOLERANCE * abs(steps.mean()) or not steps.mean() > 0:
        raise ProfileError(f"{key}: allowed for a map: equally spaced, increasing")
    return UNITS[spec.x_unit or spec.unit or "m"] * float(steps.mean())


def _processed(found: Map, spec: Values) -> Topography:
    z, dx, dy, notes = found
    X, Y = dx * np.arange(z.shape[1]), dy * np.arange(z.shape[0])
    if degree := spec.form or int(spec.level):
        z = without_form((Y, X), z, degree)
    if spec.cutoff is not None:
        z = z - mean_surface(X, Y, z, spec.cutoff, "cutoff")
    if spec.short_cutoff is not None:
        before, z = mean_deviation(z), mean_surface(X, Y, z, spec.short_cutoff, "short_cutoff")
        shown = [f"{1e6 * abs(spec.scale) * value:.4f} um" for value in (before, mean_deviation(z))]
        notes += (f"short_cutoff: Sa {shown[0]} before, {shown[1]} after",)
    z, dx, dy = turned(z, dx, dy, spec.direction or 0.0)
    mean = float(z.mean())
    if abs(mean) > MEAN_TOLERANCE * (z - mean).std():  # it would enter as a step and change the film
        z = z - mean
        notes += (f"mean height of {1e6 * mean:.4g} um subtracted",)
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
    x, y = (step * (np.arange(n) - 0.5 * (n - 1)) for n in (int(length / step) + 1, int(width / step) + 1))
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
