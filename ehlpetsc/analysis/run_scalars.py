"""Scalars of one run: means and extremes over its time, quantiles of damage, flash temperatures."""

import numpy as np

from ehlpetsc.errors import OutputError
from ehlpetsc.results.means import filled_weights, mean
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
        if it never does; extremes of the scalars in `EXTREMES`. If RESULT.post.h5 exists, also quantiles of
        damage and flash temperatures [K].

    Raises
    ------
    OutputError
        The result has no time step.
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
    return scalars | _damage(post) | _flash_temperatures(post)


def _damage(post):
    """Quantiles of damage over the points of each surface, at every depth; {} without a post result."""
    quantiles = {}
    for surface in post.surfaces if post else ():
        for depth, values in zip(post.z, post.passed(surface), strict=True):
            for quantile in QUANTILES if values.size else ():
                name = f"damage_{surface} z/a={depth:g} q={quantile:g}"
                quantiles[name] = float(np.quantile(values, quantile))
    return quantiles


def _flash_temperatures(post):
    """Maximum and median flash temperature [K] over the points of each surface; {} without heat."""
    scalars = {}
    for side, temperatures in (post.temperatures if post else {}).items():
        flash = temperatures.flash[np.isfinite(temperatures.flash)]
        if flash.size:
            scalars[f"flash_temperature_{side} largest"] = float(flash.max())
            scalars[f"flash_temperature_{side} q=0.5"] = float(np.median(flash))
    return scalars
