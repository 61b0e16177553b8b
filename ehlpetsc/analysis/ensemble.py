"""Ensembles of runs that differ in seeds alone: means and deviations, ``ehlpetsc summary --ensemble``.

A scalar of a run is the mean over the time in which the roughness of both surfaces fills the contact (over
the whole run if it ends before) or, for minimum films and maximum pressures, the extreme. Members whose cases
differ only in seeds form one ensemble; several ensembles, as of a grid over seeds and speeds, are listed one
by one. If RESULT.post.h5 exists, quantiles of damage are included.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ehlpetsc.base.errors import OutputError
from ehlpetsc.results.index import groups
from ehlpetsc.results.means import filled_weights, mean
from ehlpetsc.results.post_result import PostResult, damage_beside
from ehlpetsc.results.reader import Result

QUANTILES = (0.5, 0.9, 0.99)  # of damage over the points of a surface
EXTREMES = {"h_min": min, "p_max": max, "oil_pressure": max, "mass_error": max, "load_error": max}
EXCLUDED_SCALARS = ("step", "time", "dt", "wall", "load", "approach")
COLUMNS = ("ensemble", "scalar", "unit", "runs", "mean", "deviation", "min", "max")


def run_scalars(result: Result) -> dict[str, float]:
    """Scalars of one run, by name; OutputError without a time step.

    Means over the time in which the roughness of both surfaces fills the contact, or over the whole run if it
    never does; extremes of the scalars in `EXTREMES`. If RESULT.post.h5 exists, also quantiles of damage and
    flash temperatures [K].
    """
    if not len(result.steps("time")):
        raise OutputError(f"{result.path}: no time step in it")
    weights = filled_weights(result, or_whole_run=True)
    selected = weights > 0.0
    scalars = {}
    for name in result.scalars:
        values = result.steps(name)[selected].astype(float)
        if name in EXCLUDED_SCALARS or not np.isfinite(values).all():
            continue
        reduce = EXTREMES.get(name)
        scalars[name] = float(reduce(values)) if reduce else mean(result, name, weights)
    post = damage_beside(result)
    return scalars | _damage(post) if post else scalars


def _damage(post: PostResult) -> dict[str, float]:
    """Quantiles of damage, maximum and median flash temperature [K], over the points of each surface."""
    found = {}
    for surface in post.surfaces:
        for depth, values in zip(post.z, post.passed(surface), strict=True):
            for quantile in QUANTILES if values.size else ():
                found[f"damage_{surface} z/a={depth:g} q={quantile:g}"] = float(np.quantile(values, quantile))
        flash = post.temperatures[surface].flash if surface in post.temperatures else np.array([np.nan])
        if np.isfinite(flash).any():
            found[f"flash_temperature_{surface} largest"] = float(np.nanmax(flash))
            found[f"flash_temperature_{surface} q=0.5"] = float(np.nanmedian(flash))
    return found


def ensembles(results: list[Result]) -> dict[str, dict[str, np.ndarray]]:
    """Scalars of the runs whose cases differ only in keys named seed, shape (runs,), by the other conditions.

    The conditions are keys and values in which ensembles differ, "" for a single ensemble.
    """
    found = {}
    for name, members in groups(results, "seed").items():
        runs = [run_scalars(result) for result in members]
        common = [scalar for scalar in runs[0] if all(scalar in run for run in runs)]
        found[name] = {scalar: np.array([run[scalar] for run in runs]) for scalar in common}
    return found


def table(results: list[Result]) -> list[Sequence]:
    """Names of the columns, then a row for each scalar of each ensemble."""
    found = ensembles(results)
    if len(found) == len(results) > 1:
        raise OutputError(
            f"{len(results)} results of as many conditions: no two differ in their seeds alone; "
            "without --ensemble single runs are listed"
        )
    rows: list[Sequence] = [COLUMNS]
    for ensemble, scalars in found.items():
        for name, values in scalars.items():
            deviation = values.std(ddof=1) if values.size > 1 else np.nan
            reduced = values.mean(), deviation, values.min(), values.max()
            others = "K" if name.startswith("flash_temperature") else "1"
            unit = results[0].unit(f"steps/{name}") if name in results[0].scalars else others
            rows.append((ensemble, name, unit, values.size, *(f"{v:.6g}" for v in reduced)))
    return rows
