"""Surface temperatures of body points on their way through the contact."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from ehlpetsc.post.loads import Loads
from ehlpetsc.post.stresses.body_stress import limited_slopes
from ehlpetsc.results.post_result import PointTemperatures


def point_temperatures(loads: Loads, surface: str, s: np.ndarray, complete: np.ndarray) -> PointTemperatures:
    r"""Highest and mean surface temperature of body points s and their flash temperature.

    The mean is over the time at which a point is inside the Hertz contact, |x| <= a, by the trapezoidal rule
    over the stored frames; the flash temperature is the highest temperature minus that of the body.
    nan for points that are not `complete`: they did not pass the whole contact.
    """
    highest, sums, times = np.full(s.size, np.nan), np.zeros(s.size), np.zeros(s.size)
    step = np.diff(loads.time)
    for frame, duration in enumerate(0.5 * (np.append(step, 0.0) + np.insert(step, 0, 0.0))):
        x = s + loads.travelled[surface][frame]
        values, is_inside = temperatures(loads, surface, frame, x), np.abs(x) <= loads.a
        highest = np.fmax(highest, values)
        sums[is_inside] += duration * values[is_inside]
        times[is_inside] += duration
    highest[~complete] = np.nan
    with np.errstate(invalid="ignore", divide="ignore"):
        mean = np.where(complete, sums / times, np.nan)
    return PointTemperatures(highest, mean, highest - loads.bulk_temperature(surface))


def temperatures(loads: Loads, surface: str, frame: int, x: np.ndarray) -> np.ndarray:
    """Temperatures at positions x [m] in a frame by cubics with limited slopes; nan beyond the nodes."""
    row = loads.rows(f"temperature_{surface}", frame, frame + 1)
    slopes = np.empty_like(row)
    limited_slopes(row, slopes)
    return CubicHermiteSpline(loads.x, row[0], slopes[0] / loads.dx, extrapolate=False)(x)
