r"""Damage at asperity peaks and its Weibull distribution (Holmes et al. 2005, section 3.2)."""

from typing import NamedTuple

import numpy as np

from ehlpetsc.results.post_result import WeibullFit

MIN_PROMINENCE = 0.1  # of Rq: smaller peaks are noise of the measurement
MIN_SPREAD = 1e-6  # relative: damages are accurate to about 1e-6
CONFIDENCE = 0.9  # of the bounds
DRAWS = 1000  # of the bootstrap


class Asperities(NamedTuple):
    """Peaks of a profile (s, height in m) and the nearest body point of each."""

    s: np.ndarray
    height: np.ndarray
    point: np.ndarray


class WeibullBounds(NamedTuple):
    """Lower and upper bounds of scale and shape, and the drawn rows (alpha, beta)."""

    alpha: tuple[float, float]
    beta: tuple[float, float]
    draws: np.ndarray


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


def _lines(rows: np.ndarray) -> np.ndarray:
    """Columns alpha, beta, squared correlation of each row (draws, n); nan if its values are too similar."""
    rows = np.sort(rows, axis=1)
    used = (rows > 0) & np.isfinite(rows)
    count = used.sum(axis=1)
    y = np.where(used, np.log(-np.log1p(-benard_ranks(rows.shape[1]))), 0.0)
    x = np.log(np.where(used, rows, 1.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        mean_x, mean_y = x.sum(axis=1) / count, y.sum(axis=1) / count
        dx, dy = np.where(used, x - mean_x[:, None], 0), np.where(used, y - mean_y[:, None], 0)
        xx, xy, yy = (dx * dx).sum(axis=1), (dx * dy).sum(axis=1), (dy * dy).sum(axis=1)
        beta = yy / xy
        fits = np.column_stack([np.exp(mean_x - mean_y / beta), beta, xy**2 / (xx * yy)])
    fits[~(np.isfinite(fits).all(axis=1) & (fits > 0).all(axis=1))] = np.nan
    return fits


def _checked(values: np.ndarray) -> tuple[np.ndarray, bool]:
    """Values as one row, and whether they suffice for a fit: their range is above `MIN_SPREAD`."""
    values = np.asarray(values, float).ravel()
    if np.isnan(values).any():
        raise ValueError("values must not be nan")
    used = values[(values > 0) & np.isfinite(values)]
    return values, used.size > 1 and bool(used.max() - used.min() > MIN_SPREAD * used.max())


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
    values, enough = _checked(values)
    return WeibullFit(*map(float, _lines(values[None])[0])) if enough else WeibullFit(np.nan, np.nan, np.nan)


def weibull_bounds(
    values: np.ndarray, level: float = CONFIDENCE, draws: int = DRAWS, seed: int = 0
) -> WeibullBounds:
    """Bounds of :func:`weibull_fit` by resampling the values with replacement (Efron's percentiles).

    `level` is the fraction of the `draws` fits between the bounds; nan if the values are too similar.
    Neighbouring asperities are in contact with the same parts of the other surface; if damages are
    correlated, the true bounds are wider.
    """
    values, enough = _checked(values)
    if not 0 < level < 1:
        raise ValueError("level must lie between 0 and 1")
    if not enough:
        return WeibullBounds((np.nan, np.nan), (np.nan, np.nan), np.full((0, 2), np.nan))
    chosen = np.random.default_rng(seed).integers(values.size, size=(draws, values.size))
    fits = _lines(values[chosen])[:, :2]
    fits = fits[np.isfinite(fits[:, 0])]
    ends = np.quantile(fits, [(1 - level) / 2, (1 + level) / 2], axis=0)
    return WeibullBounds(tuple(ends[:, 0]), tuple(ends[:, 1]), fits)


def rank_correlation(first: np.ndarray, second: np.ndarray) -> float:
    """Spearman's rank correlation of two samples, ties at their mean rank; nan if one is constant."""
    from scipy.stats import rankdata  # an import of one second, only for pictures and criteria

    if first.size < 2 or np.ptp(first) == 0 or np.ptp(second) == 0:
        return np.nan
    return float(np.corrcoef(rankdata(first), rankdata(second))[0, 1])


def log_life(damage: np.ndarray) -> np.ndarray:
    """-log10 D; infinite without damage."""
    with np.errstate(divide="ignore"):
        return -np.log10(damage)


def exceedance(damage: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Fraction of asperities with more damage than each, by Benard's ranks: (falling damage, probability)."""
    falling = np.sort(np.asarray(damage, float))[::-1]
    return falling, benard_ranks(falling.size)


def fitted_exceedance(damage: np.ndarray, alpha: float, beta: float) -> np.ndarray:
    """P(damage at a peak > D) of a fitted distribution, = F(-log10 D); 0 from D = 1 on."""
    x = np.clip(log_life(np.asarray(damage, float)), 0.0, None)
    return -np.expm1(-((x / alpha) ** beta))
