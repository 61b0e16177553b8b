"""Means over time of the members of a series, for curves of friction."""

from dataclasses import dataclass

import numpy as np

from ehlpetsc.results.means import filled_weights, mean, weighted_percentiles

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


def time_statistics(result, name, weights):
    """Weighted mean and percentiles of the finite values of a scalar; nan without any."""
    average = mean(result, name, weights)
    if not np.isfinite(average):
        return TimeStatistics(np.nan, np.nan, np.nan)
    values = result.steps(name).astype(float)
    used = np.isfinite(values) & (weights > 0.0)
    low, high = weighted_percentiles(values[used], weights[used], BAND)
    return TimeStatistics(average, float(low), float(high))


def operating_point(result, speed):
    """Means of one member; None if it ends before both surfaces fill the contact.

    Parameters
    ----------
    result : ehlpetsc.results.reader.Result
    speed : float
        Value of the abscissa.
    """
    weights = filled_weights(result)
    if not weights.any():
        return None
    scalars = {name: time_statistics(result, name, weights) for name in QUANTITIES}
    smooth = float(result.steps("friction_coefficient")[0])
    return OperatingPoint(speed, scalars, smooth, result.case.contact.boundary_friction)
