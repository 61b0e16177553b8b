r"""Weibull distribution by maximum likelihood, with censored lives and confidence bounds.

With :math:`w=\beta\ln(x/\alpha)` a failure at x contributes :math:`\ln\beta+w-e^w`, a life that survived x
:math:`-e^w`, one that failed before x :math:`\ln(1-\exp(-e^w))` to the log-likelihood. The bounds
are normal approximations from the observed Fisher information of :math:`\ln\alpha` and :math:`\ln\beta`
(Meeker & Escobar (1998), Statistical Methods for Reliability Data, chapter 8): too narrow below ten failures.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ehlpetsc.post.fatigue.statistics import MIN_SPREAD, weibull_fit

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
    """Two-parameter Weibull distribution of lives by maximum likelihood.

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
