"""Means over time of the members of a series, for curves of friction."""

import tomllib
from dataclasses import dataclass

import numpy as np

from ehlpetsc.analysis.summary import weighted_percentiles
from ehlpetsc.results.filling import both_fill

BAND = (5.0, 95.0)  # percentiles over time
QUANTITIES = {
    "friction_coefficient": "friction coefficient",
    "contact_share": "share of the load\non the solids",
    "mean_gap_ratio": "mean gap over\nthe combined Rq",
}


@dataclass(frozen=True)
class TimeStatistics:
    """Mean over time and the percentiles `BAND`; nan where a result does not have the quantity."""

    mean: float
    low: float
    high: float


@dataclass(frozen=True)
class OperatingPoint:
    """Means of one member of a series.

    Attributes
    ----------
    speed : float
        Value of the abscissa, such as the entrainment speed [m/s].
    scalars : dict of str to TimeStatistics
        By the names in `QUANTITIES`.
    smooth : float
        Friction coefficient of the smooth contact, before roughness enters.
    boundary : float
        Friction coefficient of the solids.
    """

    speed: float
    scalars: dict
    smooth: float
    boundary: float


def scalar_over_time(result, name):
    """Scalar of every step; the friction coefficient also from files with the friction force alone.

    Returns
    -------
    ndarray, shape (nsteps,)
        nan if the file does not have the scalar.
    """
    if name in result.scalars:
        values = result.steps(name).astype(float)
    elif name == "friction_coefficient":
        values = result.steps("friction") / result.steps("load")
    else:
        values = np.full(len(result.steps("time")), np.nan)
    return np.abs(values) if name == "friction_coefficient" else values


def time_statistics(values, weights):
    """Weighted mean and percentiles of the finite values."""
    usable = np.isfinite(values) & (weights > 0.0)
    if not usable.any():
        return TimeStatistics(np.nan, np.nan, np.nan)
    values, weights = values[usable], weights[usable]
    low, high = weighted_percentiles(values, weights, BAND)
    return TimeStatistics(float(np.average(values, weights=weights)), float(low), float(high))


def operating_point(result, speed):
    """Means of one member; None if it ends before both surfaces fill the contact.

    Parameters
    ----------
    result : ehlpetsc.results.reader.Result
    speed : float
        Value of the abscissa.
    """
    time = result.steps("time")
    steady = len(time) == 1
    filled = np.ones(1, bool) if steady else both_fill(result, time)
    if not filled.any():
        return None
    weights = np.ones(1) if steady else np.nan_to_num(result.steps("dt"))[filled]
    scalars = {name: time_statistics(scalar_over_time(result, name)[filled], weights) for name in QUANTITIES}
    contact = tomllib.loads(result.attrs["case"]).get("contact", {})
    smooth = float(scalar_over_time(result, "friction_coefficient")[0])
    return OperatingPoint(speed, scalars, smooth, float(contact.get("boundary_friction", 0.0)))
