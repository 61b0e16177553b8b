r"""Damage at asperity peaks and its Weibull distribution (Holmes et al. 2005, section 3.2)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ehlpetsc.results.post_result import WeibullFit

MIN_PROMINENCE = 0.1  # of Rq: smaller peaks are noise of the measurement
MIN_ASPERITIES = 10  # for a distribution
MIN_SPREAD = 1e-6  # relative: damages are accurate to about 1e-6


class Asperities(NamedTuple):
    """Peaks of a surface (s, height in m), the nearest body point of each and, of a map, its row."""

    s: np.ndarray
    height: np.ndarray
    point: np.ndarray
    row: np.ndarray | None

    @property
    def at(self) -> tuple[np.ndarray, ...]:
        """Indices of the peaks in arrays over the body points."""
        return (self.point,) if self.row is None else (self.row, self.point)


def asperities(
    profile: tuple[np.ndarray, np.ndarray] | None,
    s: np.ndarray,
    complete: np.ndarray,
    rows: np.ndarray | None = None,
    periodic: bool = False,
) -> Asperities:
    """Peaks of a surface (s, z) among the body points that passed the whole contact; none if it is smooth.

    `s` are the uniform body points [m], `complete` is true for those that passed. Of a map z (ny, n) they are
    its local maxima, `periodic` across or not, in the `rows` (ny,) that are True; a profile has no rows.
    """
    none = np.empty(0, int)
    if profile is None or not complete.any():
        return Asperities(np.empty(0), np.empty(0), none, None if rows is None else none)
    abscissae, heights = profile
    passed = s[complete]
    inside = (abscissae >= passed[0]) & (abscissae <= passed[-1])
    rough = np.std(heights[..., inside]) if inside.any() else 0.0
    prominence = max(MIN_PROMINENCE * float(rough), float(np.finfo(float).tiny))
    at = np.array(_maxima(heights, prominence, periodic))
    at = at[:, inside[at[-1]] & (True if rows is None else rows[at[0]])]
    peaks = abscissae[at[-1]]
    nearest = np.rint((peaks - s[0]) / (s[1] - s[0])).astype(int)
    return Asperities(peaks, heights[tuple(at)], nearest, None if rows is None else at[0])


def _maxima(heights: np.ndarray, prominence: float, periodic: bool) -> tuple[np.ndarray, ...]:
    """Indices of the local maxima at least `prominence` above the saddle to a higher one.

    The heights of a map are reconstructed from themselves less the prominence (Vincent (1993), IEEE Trans.
    Image Process. 2): the tops of such maxima remain lower by all of it. Maxima at the edges do not count,
    but for those across a period.
    """
    if heights.ndim == 1:
        from scipy.signal import find_peaks  # a third of what the package takes to import

        return (find_peaks(heights, prominence=prominence)[0],)
    from scipy.ndimage import maximum_filter

    modes = ("wrap" if periodic else "nearest"), "nearest"
    lowered = reached = heights - prominence
    while ((spread := np.minimum(maximum_filter(reached, 3, mode=modes), heights)) > reached).any():
        reached = spread
    tops = (heights == maximum_filter(heights, 3, mode=modes)) & (reached == lowered)
    tops[:, [0, -1]] = False
    if not periodic:
        tops[[0, -1]] = False
    return np.nonzero(tops)


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


CONFIDENCE = 0.9  # of two-sided bounds


class WeibullLikelihood(NamedTuple):
    """Scale alpha, shape beta, and covariance (2, 2) of their logarithms; nan without a fit."""

    alpha: float
    beta: float
    covariance: np.ndarray

    def interval(self, confidence: float = CONFIDENCE) -> np.ndarray:
        """Two-sided bounds (2, 2): lower and upper ones of alpha, then of beta."""
        spread = _normal_quantile(confidence) * np.sqrt(np.diag(self.covariance))
        return np.array([self.alpha, self.beta])[:, None] * np.exp(np.multiply.outer(spread, [-1.0, 1.0]))

    def fractions(self, x: np.ndarray, confidence: float = CONFIDENCE) -> np.ndarray:
        """Fractions (3, n) that failed up to x > 0 (n,): estimate, lower and upper two-sided bound."""
        w = self.beta * np.log(np.asarray(x, float) / self.alpha)
        slopes = np.stack([np.full(w.shape, -self.beta), w], axis=-1)
        spread = np.sqrt(np.einsum("...i,ij,...j->...", slopes, self.covariance, slopes))
        spread = spread * _normal_quantile(confidence)
        return -np.expm1(-np.exp(np.stack([w, w - spread, w + spread])))


def _normal_quantile(confidence: float) -> float:
    from scipy.special import ndtri

    return float(ndtri((1 + confidence) / 2))


def weibull_likelihood(values: np.ndarray, survived: np.ndarray | None = None) -> WeibullLikelihood:
    r"""Two-parameter Weibull distribution of lives by maximum likelihood, some of them censored.

    With :math:`w=\beta\ln(x/\alpha)` a failure at x contributes :math:`\ln\beta+w-e^w`, a life that survived
    x :math:`-e^w`, one that failed before x :math:`\ln(1-\exp(-e^w))` to the log-likelihood. The bounds
    are normal approximations from the observed Fisher information of :math:`\ln\alpha` and :math:`\ln\beta`
    (Meeker & Escobar (1998), Statistical Methods for Reliability Data, chapter 8): too narrow below ten
    failures.

    nan with fewer than two different failures.

    Parameters
    ----------
    values
        Lives, or -log10 of damages as for :func:`ehlpetsc.post.weibull_fit`: an infinite one has survived the
        highest finite value, one of 0 or less has failed before the lowest positive one.
    survived
        True where a life ended without failure: it is longer than its value.
    """
    values = np.asarray(values, float).ravel()
    if np.isnan(values).any():
        raise ValueError("values must not be nan")
    ended = np.zeros(values.size, bool) if survived is None else np.array(survived, bool).ravel()
    usual = (values > 0) & np.isfinite(values)
    failures = values[usual & ~ended]
    if failures.size < 2 or not np.ptp(failures) > MIN_SPREAD * failures.max():
        return WeibullLikelihood(np.nan, np.nan, np.full((2, 2), np.nan))
    ended |= values == np.inf
    before = values <= 0
    x = np.clip(values, values[usual].min(), values[usual].max())
    return _maximum(np.log(x), ~(ended | before), before & ~ended)


def _maximum(log_x: np.ndarray, failed: np.ndarray, before: np.ndarray) -> WeibullLikelihood:
    from scipy.optimize import minimize

    def terms(theta: np.ndarray) -> tuple[float, np.ndarray, np.ndarray]:
        """Minus the logarithm of the likelihood, its gradient and its matrix of second derivatives."""
        beta = np.exp(theta[1])
        w = np.minimum(beta * (log_x - theta[0]), 100.0)
        u = np.exp(w)
        value = np.where(before, np.log(-np.expm1(-u)), failed * (theta[1] + w) - u)
        early = u / np.expm1(np.minimum(u, 500.0))
        first = np.where(before, early, failed - u)
        second = np.where(before, early * (1 - early * np.exp(np.minimum(u, 500.0))), -u)
        mixed = -beta * (second * w + first).sum()
        gradient = np.array([-beta * first.sum(), failed.sum() + (first * w).sum()])
        square = (second * w * w + first * w).sum()
        return -value.sum(), -gradient, -np.array([[beta**2 * second.sum(), mixed], [mixed, square]])

    alpha, beta, _ = weibull_fit(np.exp(log_x[failed]))
    start = np.log([alpha, beta])
    parts = {"jac": lambda theta: terms(theta)[1], "hess": lambda theta: terms(theta)[2]}
    best = minimize(lambda theta: terms(theta)[0], start, method="trust-exact", tol=1e-10, **parts).x
    scale, shape = map(float, np.exp(best))
    return WeibullLikelihood(scale, shape, np.linalg.inv(terms(best)[2]))
