"""Likelihood and bounds of Weibull fits, and values too alike to be fitted."""

import numpy as np
import pytest

from ehlpetsc.post import weibull_bounds, weibull_fit, weibull_likelihood
from ehlpetsc.post.fatigue.weibull import _fits

DATA = np.array([16.0, 34, 53, 75, 93, 120])


def sample(n, seed, alpha=7.0, beta=9.0):
    return alpha * np.random.default_rng(seed).weibull(beta, n)


def log_likelihood(alpha, beta, exact, above=(), below=()):
    """From the densities themselves."""
    x, a, b = np.array(exact), np.array(above), np.array(below)
    return (
        np.sum(np.log(beta / alpha * (x / alpha) ** (beta - 1)) - (x / alpha) ** beta)
        - np.sum((a / alpha) ** beta)
        + np.sum(np.log(-np.expm1(-((b / alpha) ** beta))))
    )


def test_textbook_likelihood():
    """The two equations of the complete sample: the shape's own, and the scale as a power mean."""
    fit = weibull_likelihood(DATA)
    power = DATA**fit.beta
    assert (power @ np.log(DATA)) / power.sum() - 1 / fit.beta == pytest.approx(
        np.log(DATA).mean(), rel=1e-10
    )
    assert fit.alpha == pytest.approx(power.mean() ** (1 / fit.beta), rel=1e-10)
    assert (fit.alpha, fit.beta) == pytest.approx((73.526, 1.933), rel=5e-4)


def test_censored_values_are_at_the_ends():
    exact = sample(30, 1)
    values = np.concatenate([exact, [np.inf] * 4, [-0.5, 0.0]])
    fit = weibull_likelihood(values)
    above, below = [exact.max()] * 4, [exact.min()] * 2
    best = log_likelihood(*fit, exact, above, below)
    for a, b in ((1.001, 1), (0.999, 1), (1, 1.01), (1, 0.99), (1.001, 1.01)):
        assert log_likelihood(fit.alpha * a, fit.beta * b, exact, above, below) < best
    assert fit.alpha > weibull_likelihood(exact).alpha * 0.99


def test_likelihood_recovers_its_parameters():
    fit = weibull_likelihood(sample(20000, 2))
    assert fit == pytest.approx((7.0, 9.0), rel=0.02)
    scaled = weibull_likelihood(1e-3 * sample(20000, 2))
    assert scaled == pytest.approx((1e-3 * fit.alpha, fit.beta), rel=1e-9)


def test_resampled_fits_are_those_of_weibull_fit():
    rows = np.array([sample(12, k) for k in range(6)])
    rows[2, :2], rows[3, 0] = np.inf, -1.0
    for regression in ("x on y", "y on x"):
        expected = [weibull_fit(row, regression)[:2] for row in rows]
        assert _fits(rows, regression) == pytest.approx(np.array(expected), rel=1e-9)


def test_weibull_bounds_have_their_nominal_coverage():
    inside = 0
    for seed in range(120):
        low, high = weibull_bounds(sample(69, seed), draws=200).beta
        inside += low <= 9.0 <= high
    assert 0.80 * 120 <= inside <= 0.97 * 120  # 90 % are asked for
    narrow, wide = (weibull_bounds(sample(n, 5)).beta for n in (1000, 20))
    assert narrow[1] - narrow[0] < (wide[1] - wide[0]) / 3


def test_bounds_are_reproducible_and_enclose_the_fit():
    values = sample(69, 3)
    fit, bounds = weibull_fit(values), weibull_bounds(values)
    again = weibull_bounds(values)
    assert bounds.alpha == again.alpha and bounds.beta == again.beta
    assert bounds.alpha[0] < fit.alpha < bounds.alpha[1] and bounds.beta[0] < fit.beta < bounds.beta[1]
    assert weibull_bounds(values, level=0.5).beta[1] < bounds.beta[1]


@pytest.mark.parametrize("spread", [0.0, 1e-12, 1e-7])
def test_nearly_equal_values_have_no_shape(spread):
    values = 7.0 * (1 + spread * np.linspace(0, 1, 20))
    assert np.isnan(weibull_fit(values)).all() and np.isnan(weibull_likelihood(values)).all()
    assert np.isnan(weibull_bounds(values).beta).all()
    assert np.isfinite(weibull_fit(7.0 * (1 + 1e-4 * np.linspace(0, 1, 20)))).all()


def test_faults():
    for call in (weibull_likelihood, weibull_bounds):
        with pytest.raises(ValueError, match="nan"):
            call([1.0, np.nan])
    with pytest.raises(ValueError, match="level"):
        weibull_bounds(DATA, level=1.0)
    with pytest.raises(ValueError, match="regression"):
        weibull_bounds(DATA, "both")
