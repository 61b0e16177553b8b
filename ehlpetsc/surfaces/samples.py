"""Profile of one surface, from its table in the case file."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ehlpetsc.surfaces import synthetic
from ehlpetsc.surfaces.filters import deviations, levelled, mean_line, without_form
from ehlpetsc.surfaces.profile_files import KEYS, UNITS, Layout, checked, read_profile
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
        X, z, notes = checked(steps, UNITS[unit] * np.array(spec.z), layout_of(spec))
    else:
        X, z, notes = read_profile(folder / spec.file, layout_of(spec))
    given = z
    if spec.form is not None:
        z = without_form([X], z, spec.form)
    elif spec.level:
        z = levelled(X, z)
    if spec.cutoff is not None:
        z = z - mean_line(X, z, spec.cutoff, "cutoff")
    if spec.short_cutoff is not None:
        z, note = without_short_waves(z, mean_line(X, z, spec.short_cutoff, "short_cutoff"), "Ra", spec)
        notes += (note,)
    z, notes = centred(z, given, notes)
    if spec.flip:
        X, z = X[-1] + X[0] - X[::-1], z[::-1]
    return Topography.profile(X, spec.scale * z, measured=True, notes=notes)


def layout_of(spec: Values) -> Layout:
    """Layout of the file of a surface."""
    values = {key: getattr(spec, key) for key in KEYS}
    return Layout(**values | {"columns": spec.columns and tuple(spec.columns)})


def without_short_waves(z: np.ndarray, mean: np.ndarray, name: str, spec: Values) -> tuple[np.ndarray, str]:
    """Mean line or surface of heights, and a note on the mean deviation, `name`, of both."""
    shown = (f"{1e6 * abs(spec.scale) * np.abs(part - part.mean()).mean():.4f} um" for part in (z, mean))
    return mean, f"short_cutoff: {name} {next(shown)} before, {next(shown)} after"


def centred(z: np.ndarray, given: np.ndarray, notes: tuple[str, ...]) -> tuple[np.ndarray, tuple[str, ...]]:
    """Heights minus their mean, which would enter as a step and change the film, and notes with one on it.

    `given`: heights before a form was subtracted [m].
    """
    mean = float(z.mean())
    if not deviations(z, given).any():
        return np.zeros_like(z), (*notes, "all heights are equal, or on the form subtracted: smooth")
    if abs(mean) <= MEAN_TOLERANCE * (z - mean).std():
        return z, notes
    return z - mean, (*notes, f"mean height of {1e6 * mean:.4g} um subtracted")
