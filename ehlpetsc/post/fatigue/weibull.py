r"""Confidence of a Weibull distribution: maximum likelihood, and bounds by resampling."""

from typing import NamedTuple

import numpy as np

from ehlpetsc.post.fatigue.statistics import REGRESSIONS, benard_ranks, too_alike

CONFIDENCE = 0.9  # of the bounds
DRAWS = 1000  # of the bootstrap
MAX_ITERATIONS = 100  # of Newton's method


class WeibullLikelihood(NamedTuple):
    """Scale alpha and shape beta of maximum likelihood."""

    alpha: float
    beta: float


class WeibullBounds(NamedTuple):
    """Lower and upper bounds of scale and shape, and the drawn rows (alpha, beta)."""

    alpha: tuple
    beta: tuple
    draws: np.ndarray


def _derivatives(z, kind):
    """First and second derivative by z of the log likelihood of values with e^z = (x/alpha)^beta."""
    hazard = np.exp(np.minimum(z, 700.0))
    first, second = -hazard, -hazard.copy()  # above the value: censored from the right
    exact = kind == 0
    first[exact] += 1
    below = kind < 0
    ratio = hazard[below] / np.expm1(np.minimum(hazard[below], 700.0))
    first[below], second[below] = ratio, ratio * (1 - hazard[below] - ratio)
    return first, second


def _log_likelihood(z, kind, slope, exact):
    hazard = np.exp(np.minimum(z, 700.0))
    below = kind < 0
    terms = np.where(kind == 0, z - hazard, -hazard)
    terms[below] = np.log(-np.expm1(-hazard[below]))
    return exact * np.log(slope) + terms.sum()


def weibull_likelihood(values):
    r"""Two-parameter Weibull distribution of maximum likelihood.

    .. math:: F(x) = 1-\exp[-(x/\alpha)^\beta]

    Newton in :math:`(\beta\ln\alpha, \beta)`, in which the log likelihood is concave.

    Parameters
    ----------
    values : array_like
        -log10 of damages, as in :func:`ehlpetsc.post.weibull_fit`. Infinite values are censored above the
        largest finite value, values of 0 or less below the smallest value above 0.

    Returns
    -------
    WeibullLikelihood
        nan if the finite values above 0 are too similar (as in :func:`ehlpetsc.post.weibull_fit`).

    Raises
    ------
    ValueError
        nan among the values.
    """
    values = np.asarray(values, float).ravel()
    if np.isnan(values).any():
        raise ValueError("values must not be nan")
    used = values[(values > 0) & np.isfinite(values)]
    if too_alike(used):
        return WeibullLikelihood(np.nan, np.nan)
    kind = np.where(np.isinf(values) & (values > 0), 1, np.where(values <= 0, -1, 0))
    y = np.log(np.clip(values, used.min(), used.max()))
    middle = y.mean()
    y = y - middle
    exact, slope = used.size, 1.2 / max(y.std(), 1e-300)
    shift = 0.0
    best = _log_likelihood(slope * y - shift, kind, slope, exact)
    for _ in range(MAX_ITERATIONS):
        first, second = _derivatives(slope * y - shift, kind)
        gradient = np.array([-first.sum(), exact / slope + (first * y).sum()])
        across = -(second * y).sum()
        matrix = np.array([[second.sum(), across], [across, -exact / slope**2 + (second * y * y).sum()]])
        step, damping = np.linalg.solve(matrix, -gradient), 1.0
        while damping > 1e-12:
            trial = shift + damping * step[0], slope + damping * step[1]
            if trial[1] > 0:
                trial_likelihood = _log_likelihood(trial[1] * y - trial[0], kind, trial[1], exact)
                if trial_likelihood >= best:
                    break
            damping /= 2
        else:
            break
        (shift, slope), best = trial, trial_likelihood
        if abs(step[1]) <= 1e-12 * slope and abs(step[0]) <= 1e-12 * (1 + abs(shift)):
            break
    return WeibullLikelihood(float(np.exp(middle + shift / slope)), float(slope))


def _fits(rows, regression):
    """(alpha, beta) of every row (draws, n) by median ranks; nan if values are too similar."""
    rows = np.sort(rows, axis=1)
    used = (rows > 0) & np.isfinite(rows)
    count = used.sum(axis=1)
    y = np.where(used, np.log(-np.log1p(-benard_ranks(rows.shape[1]))), 0.0)
    x = np.log(np.where(used, rows, 1.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        mean_x, mean_y = x.sum(axis=1) / count, y.sum(axis=1) / count
        dx, dy = np.where(used, x - mean_x[:, None], 0), np.where(used, y - mean_y[:, None], 0)
        xx, xy, yy = (dx * dx).sum(axis=1), (dx * dy).sum(axis=1), (dy * dy).sum(axis=1)
        beta = yy / xy if regression == "x on y" else xy / xx
        fits = np.column_stack([np.exp(mean_x - mean_y / beta), beta])
    fits[~(np.isfinite(fits).all(axis=1) & (fits > 0).all(axis=1))] = np.nan
    return fits


def weibull_bounds(values, regression="x on y", level=CONFIDENCE, draws=DRAWS, seed=0):
    """Bounds of a median rank fit by resampling the values with replacement (Efron's percentiles).

    Neighbouring asperities are in contact with the same parts of the other surface; if damages are
    correlated, the true bounds are wider.

    Parameters
    ----------
    values : array_like
        See :func:`ehlpetsc.post.weibull_fit`.
    regression : {"x on y", "y on x"}
    level : float
        Fraction of the drawn fits between the bounds.
    draws, seed : int
        Number of samples; seed of the random numbers.

    Returns
    -------
    WeibullBounds
        nan if the values are too similar.

    Raises
    ------
    ValueError
        nan among the values, unknown regression, a level not between 0 and 1.
    """
    values = np.asarray(values, float).ravel()
    if np.isnan(values).any():
        raise ValueError("values must not be nan")
    if regression not in REGRESSIONS:
        raise ValueError(f"regression must be one of {', '.join(REGRESSIONS)}")
    if not 0 < level < 1:
        raise ValueError("level must lie between 0 and 1")
    if too_alike(values[(values > 0) & np.isfinite(values)]):
        return WeibullBounds((np.nan, np.nan), (np.nan, np.nan), np.full((0, 2), np.nan))
    chosen = np.random.default_rng(seed).integers(values.size, size=(draws, values.size))
    fits = _fits(values[chosen], regression)
    fits = fits[np.isfinite(fits[:, 0])]
    ends = np.quantile(fits, [(1 - level) / 2, (1 + level) / 2], axis=0)
    return WeibullBounds(tuple(ends[:, 0]), tuple(ends[:, 1]), fits)
