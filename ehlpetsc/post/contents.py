"""Datasets of a post-processing result from computed damage, and their file."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ehlpetsc.post.fatigue.statistics import (
    CONFIDENCE,
    asperities,
    log_life,
    rank_correlation,
    weibull_bounds,
    weibull_fit,
)
from ehlpetsc.post.prepare import Prepared
from ehlpetsc.post.temperatures import point_temperatures
from ehlpetsc.results.output_guard import atomic_write
from ehlpetsc.results.post_result import CRITERIA, SURFACES, WeibullFit, stored_names

FORMAT_VERSION = 1
MIN_ASPERITIES = 10  # for a distribution
UNDEFINED = WeibullFit(np.nan, np.nan, np.nan)
SCALES = {"s": "damage/s", "z": "damage/z_over_a"}


def main_surface(prepared: Prepared) -> str:
    """Surface of the summary: 2, whose asperities have more contacts, if it is rough and passed."""
    passed = [name for name, motion in prepared.motions.items() if motion.complete.any()]
    return next((name for name in passed if prepared.loads.profiles[name] is not None), passed[0])


def datasets_of(
    prepared: Prepared, surface: str, values: np.ndarray, criteria: Sequence[tuple[str, str]]
) -> tuple[dict[str, np.ndarray], list[str]]:
    """Datasets of a surface by name, and notes.

    Parameters
    ----------
    values
        Damage, cycles, peak range and columns of criteria, shape (depths, points, 3 ...).
    criteria
        Pairs (criterion, column) after the first three columns.
    """
    passed = prepared.motions[surface].complete
    found = {
        f"damage/{surface}": values[..., 0],
        f"damage/{surface}_complete": passed.astype(np.uint8),
        f"damage/{surface}_cycles": values[..., 1],
        f"damage/{surface}_peak_range": values[..., 2],
    }
    for index, (criterion, column) in enumerate(criteria, start=3):
        name = criterion.replace("-", "_")
        found[f"criteria/{name}/{surface}_{column}"] = values[..., index]
        if column == CRITERIA[name]:
            pairs = zip(values[:, passed, 0], values[:, passed, index], strict=True)
            ranks = np.array([rank_correlation(paper, other) for paper, other in pairs])
            found[f"criteria/{name}/{surface}_rank_correlation"] = ranks
    of_asperities, notes = _of_asperities(prepared, surface, values[..., 0])
    found |= of_asperities
    if surface in prepared.loads.heated([surface]):
        temperatures = point_temperatures(prepared.loads, surface, prepared.motions[surface], prepared.s.size)
        found |= {f"temperature/{surface}_{name}": array for name, array in temperatures._asdict().items()}
    return found, notes


def _of_asperities(
    prepared: Prepared, surface: str, damage: np.ndarray
) -> tuple[dict[str, np.ndarray], list[str]]:
    loads, depths = prepared.loads, prepared.settings.depths
    profile = loads.profiles[surface]
    peaks = asperities(profile, prepared.s, prepared.motions[surface].complete)
    under = damage[:, peaks.point]
    at_least_one = (under >= 1).sum(axis=1)
    found = {
        f"asperities/{surface}_s": peaks.s,
        f"asperities/{surface}_height": peaks.height,
        f"asperities/{surface}_damage": under,
        f"weibull/{surface}_at_least_one": at_least_one,
        f"weibull/{surface}_undamaged": (under == 0).sum(axis=1),
    }
    if profile is not None:
        found |= {f"profile/{surface}_s": profile[0], f"profile/{surface}_z": profile[1]}
    enough = peaks.s.size >= MIN_ASPERITIES
    for name, column in _distribution(under if enough else np.full((len(depths), 2), np.inf)).items():
        found[f"weibull/{surface}_{name}"] = column
    notes = [
        f"note: {count} of {peaks.s.size} asperities of surface {surface} have damage of 1 "
        f"or more at z/a = {depth:g}: failure in the first pass"
        for depth, count in zip(depths, at_least_one, strict=True)
        if count
    ]
    if profile is not None and not enough:
        notes.append(
            f"note: {peaks.s.size} asperities of surface {surface} passed: a Weibull distribution needs "
            f"{MIN_ASPERITIES} or more"
        )
    return found, notes


def _distribution(under: np.ndarray) -> dict[str, np.ndarray]:
    """Weibull constants of the damage under asperities (depths, peaks) with their bounds, one a depth."""
    lives = [log_life(row) for row in under]
    columns = np.array([weibull_fit(row) for row in lives]).T
    bounds = [weibull_bounds(row) for row in lives]
    found = dict(zip(WeibullFit._fields, columns, strict=True))
    for k, name in enumerate(("alpha", "beta")):
        found[f"{name}_low"], found[f"{name}_high"] = np.array([bound[k] for bound in bounds]).T
    return found


def attributes_of(prepared: Prepared) -> dict[str, Any]:
    """Root attributes: provenance and scales of the result."""
    loads = prepared.loads
    mean = (loads.speeds["1"] + loads.speeds["2"]) / 2
    return {
        "title": loads.title,
        "case": loads.case_text,
        "source": str(loads.path),
        "surface": main_surface(prepared),
        "a": loads.a,
        "inlet": loads.x[0],
        "outlet": loads.x[-1],
        "p0": loads.p0,
        "slide_roll_ratio": (loads.speeds["1"] - loads.speeds["2"]) / mean if mean else 0.0,
        "every": prepared.every,
        "bounds_level": CONFIDENCE,
        **{f"speed_{name}": loads.speeds[name] for name in prepared.motions},
    }


def write_result(path: str | Path, datasets: Mapping[str, Any], attributes: Mapping[str, Any]) -> None:
    """Write datasets by name, with units, texts and axes of their table; replaces `path` at once."""
    table = {name: dataset for surface in SURFACES for name, dataset in stored_names(surface).items()}
    image = io.BytesIO()  # HDF5 crashes on a full disk, a plain write does not
    with h5py.File(image, "w") as file:
        file.attrs.update({"format_version": FORMAT_VERSION, **attributes})
        for name, values in datasets.items():
            file[name] = values
            file[name].attrs.update(units=table[name].unit, long_name=table[name].text)
        for axis, name in SCALES.items():
            file[name].make_scale(axis)
        for name in datasets.keys() - SCALES.values():
            for dimension, axis in enumerate(table[name].axes.split()):
                if axis in SCALES:
                    file[name].dims[dimension].attach_scale(file[SCALES[axis]])
    atomic_write(Path(path), image.getvalue())
