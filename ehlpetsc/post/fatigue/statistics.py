r"""Damage at asperity peaks and its Weibull distribution (Holmes et al. 2005, section 3.2)."""

from typing import NamedTuple

import numpy as np

from ehlpetsc.results.post_result import WeibullFit

MIN_PROMINENCE = 0.1  # of Rq: smaller peaks are noise of the measurement
MIN_ASPERITIES = 10  # for a distribution
MIN_SPREAD = 1e-6  # relative: damages are accurate to about 1e-6


class Asperities(NamedTuple):
    """Peaks of a profile (s, height in m) and the nearest body point of each."""

    s: np.ndarray
    height: np.ndarray
    point: np.ndarray


def asperities(
    profile: tuple[np.ndarray, np.ndarray] | None, s: np.ndarray, complete: np.ndarray
) -> Asperities:
    """Peaks of a profile (s, z) among the body points that passed the whole contact; none if it is smooth.

    `s` are the uniform body points [m], `complete` is true for those that passed.
    """
    if profile is None or not complete.any():
        return Asperities(np.empty(0), np.empty(0), np.empty(0, int))
    from scipy.signal import find_peaks  # a third of what the package takes to import

    abscissae, heights = profile
    passed = s[complete]
    inside = (abscissae >= passed[0]) & (abscissae <= passed[-1])
    rough = np.std(heights[inside]) if inside.any() else 0.0
    peaks, _ = find_peaks(heights, prominence=max(MIN_PROMINENCE * rough, np.finfo(float).tiny))
    peaks = peaks[inside[peaks]]
    nearest = np.rint((abscissae[peaks] - s[0]) / (s[1] - s[0])).astype(int)
    return Asperities(abscissae[peaks], heights[peaks], nearest)


def benard_ranks(n: int) -> np.ndarray:
    """Median ranks (i - 0.3)/(n + 0.4) of n values in rising order."""
    return (np.arange(1, n + 1) - 0.3) / (n + 0.4)


def weibull_fit(values: np.ndarray) -> WeibullFit:
    r"""Two-parameter Weibull by median rank regression.

    .. math:: F(x) = 1-\exp[-(x/\alpha)^\beta]

    (Holmes et al. 2005, section 3.2), a straight line of ln(-ln(1 - F)) over ln x, through Benard's ranks,
    with the smallest deviations of ln x. nan if fewer than two values remain or their relative range is below
    1e-6, where rounding would yield a beta of a million.

    Parameters
    ----------
    values
        -log10 of damages. An infinite value (no damage) is censored: it counts in the ranks, above all other
        values. A value of 0 or less (damage of 1 or more) has a rank, but is not used for the line.
    """
    values = np.sort(np.asarray(values, float).ravel())
    used = (values > 0) & np.isfinite(values)
    if np.isnan(values).any():
        raise ValueError("values must not be nan")
    if used.sum() < 2 or not np.ptp(values[used]) > MIN_SPREAD * values[used].max():
        return WeibullFit(np.nan, np.nan, np.nan)
    x, y = np.log(values[used]), np.log(-np.log1p(-benard_ranks(values.size)[used]))
    slope, intercept = np.polyfit(y, x, 1)
    return WeibullFit(float(np.exp(intercept)), float(1 / slope), float(np.corrcoef(x, y)[0, 1] ** 2))


def log_life(damage: np.ndarray) -> np.ndarray:
    """-log10 D; infinite without damage."""
    with np.errstate(divide="ignore"):
        return -np.log10(damage)


def fitted_asperities(damage: np.ndarray) -> int:
    """Number of asperities whose damage, between 0 and 1, the line of :func:`weibull_fit` goes through."""
    return int(np.count_nonzero((damage > 0.0) & (damage < 1.0)))


def exceedance(damage: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Fraction of asperities with more damage than each, by Benard's ranks: (falling damage, probability)."""
    falling = np.sort(np.asarray(damage, float))[::-1]
    return falling, benard_ranks(falling.size)


def fitted_exceedance(damage: np.ndarray, alpha: float, beta: float) -> np.ndarray:
    """P(damage at a peak > D) of a fitted distribution, = F(-log10 D); 0 from D = 1 on."""
    x = np.clip(log_life(np.asarray(damage, float)), 0.0, None)
    return -np.expm1(-((x / alpha) ** beta))
