"""Scalars of one run: means and extremes over its time, quantiles of damage, flash temperatures."""

import numpy as np

from ehlpetsc.errors import OutputError
from ehlpetsc.results.filling import both_fill
from ehlpetsc.results.post_result import damage_beside

QUANTILES = (0.5, 0.9, 0.99)  # of damage over the points of a surface
EXTREMES = {"h_min": min, "p_max": max, "oil_pressure": max, "mass_error": max, "load_error": max}
EXCLUDED_SCALARS = ("step", "time", "dt", "wall", "load", "approach")


def run_scalars(result):
    """Scalars of one run, by name.

    Parameters
    ----------
    result : ehlpetsc.results.reader.Result

    Returns
    -------
    dict of str to float
        Means over the time in which the roughness of both surfaces fills the contact, or over the whole run
        where it never does; extremes of the scalars in `EXTREMES`. With a RESULT.post.h5 beside the result
        also quantiles of damage and flash temperatures [K].

    Raises
    ------
    OutputError
        The result holds no time step.
    """
    time, dt = result.steps("time"), np.nan_to_num(result.steps("dt"))
    if not len(time):
        raise OutputError(f"{result.path}: no time step in it")
    kept = both_fill(result, time) & (dt > 0.0)
    if not kept.any():
        kept = dt > 0.0 if dt.any() else np.ones(len(time), bool)
    weights = dt[kept] if dt.any() else np.ones(1)
    found = {}
    for name in result.scalars:
        values = result.steps(name)[kept].astype(float)
        if name in EXCLUDED_SCALARS or not np.isfinite(values).all():
            continue
        reduce = EXTREMES.get(name)
        found[name] = float(reduce(values) if reduce else np.average(values, weights=weights))
    beside = damage_beside(result)
    return found | _damage(beside) | _flash_temperatures(beside)


def _damage(found):
    """Quantiles of damage over the points of each surface, at every depth; none without a result."""
    quantiles = {}
    for surface in found.surfaces if found else ():
        for depth, row in zip(found.z, found.passed(surface), strict=True):
            for quantile in QUANTILES if row.size else ():
                name = f"damage_{surface} z/a={depth:g} q={quantile:g}"
                quantiles[name] = float(np.quantile(row, quantile))
    return quantiles


def _flash_temperatures(found):
    """Largest and median flash temperature [K] over the points of each surface; none without heat."""
    known = found.temperatures if found else {}
    values = {side: one.flash[np.isfinite(one.flash)] for side, one in known.items()}
    figures = {}
    for side, flash in values.items():
        if flash.size:
            figures[f"flash_temperature_{side} largest"] = float(flash.max())
            figures[f"flash_temperature_{side} q=0.5"] = float(np.median(flash))
    return figures
