"""Weibull fits, ranks, and asperity peaks."""

import numpy as np
import pytest
from scipy.stats import weibull_min

from ehlpetsc.post import weibull_fit, weibull_likelihood
from ehlpetsc.post.fatigue.statistics import asperities, benard_ranks, exceedance, fitted_exceedance, log_life

DATA = [16, 34, 53, 75, 93, 120]


def test_textbook_data():
    fit = weibull_fit(DATA)
    assert (fit.beta, fit.alpha) == pytest.approx((1.43966, 76.1096), rel=4e-6)
    assert 0.99 < fit.r_squared < 1
    fit = weibull_likelihood(DATA)
    assert (fit.beta, fit.alpha) == pytest.approx((1.933, 73.526), rel=1e-3)
    expected = weibull_min.fit(DATA, floc=0)
    assert (fit.beta, fit.alpha) == pytest.approx((expected[0], expected[2]), rel=1e-5)


def quantiles():
    return 7.0 * (-np.log1p(-benard_ranks(25))) ** (1 / 9.0)


@pytest.mark.parametrize(
    "places, damage",
    [
        (slice(0), []),
        (slice(20, None), np.zeros(5)),  # no damage: infinite, censored
        (slice(3), [1.0, 3.0, 40.0]),  # damage of 1 and more: no logarithm of -log10 D, but its rank
    ],
)
def test_recovers_its_own_quantiles(places, damage):
    values = quantiles()
    values[places] = log_life(np.array(damage))
    assert weibull_fit(values) == pytest.approx((7.0, 9.0, 1.0), rel=1e-10)


def test_exceedance_and_its_fit_agree():
    values = quantiles()
    falling, share = exceedance(10.0**-values)
    assert (np.diff(falling) <= 0).all()
    alpha, beta, _ = weibull_fit(values)
    assert fitted_exceedance(falling, alpha, beta) == pytest.approx(share, rel=1e-9)
    assert fitted_exceedance(1.0, alpha, beta) == 0
    assert fitted_exceedance(0.0 + 1e-300, alpha, beta) == pytest.approx(1)


def test_peaks_of_the_profile_that_passed():
    s = np.linspace(0, 1e-3, 501)
    z = 1e-6 * np.sin(2 * np.pi * s / 1e-4) + 1e-9 * np.sin(
        2 * np.pi * s / 5e-6
    )  # ten asperities, small noise
    grid = np.linspace(-1e-3, 2e-3, 1501)
    complete = (grid > 0.2e-3) & (grid < 0.81e-3)
    peaks = asperities((s, z), grid, complete)
    assert peaks.s == pytest.approx(np.arange(0.225e-3, 0.8e-3, 1e-4), abs=3e-6)
    assert peaks.height == pytest.approx(np.full(6, 1e-6), abs=3e-9)
    assert np.abs(grid[peaks.point] - peaks.s).max() <= 1e-6 + 1e-15


@pytest.mark.parametrize("spread", [0.0, 1e-12, 1e-7])
def test_nearly_equal_values_have_no_shape(spread):
    values = 7.0 * (1 + spread * np.linspace(0, 1, 20))
    assert np.isnan(weibull_fit(values)).all()
    assert np.isfinite(weibull_fit(7.0 * (1 + 1e-4 * np.linspace(0, 1, 20)))).all()


def test_censored_lives_of_one_shape():
    """With a given shape the scale is (sum x^beta/failures)^(1/beta), survivors in the sum alone."""
    values, survived = np.array([16.0, 34, 53, 75, 93, 120, 120, 120]), np.arange(8) > 4
    fit = weibull_likelihood(values, survived)
    assert fit.alpha == pytest.approx(((values**fit.beta).sum() / 5) ** (1 / fit.beta), rel=1e-8)
    logarithms = np.log(values)
    weighted = (values**fit.beta * logarithms).sum() / (values**fit.beta).sum()
    assert 1 / fit.beta == pytest.approx(weighted - logarithms[:5].mean(), rel=1e-8)
    assert fit.alpha > weibull_likelihood(values[:5]).alpha
    undamaged = np.where(survived, np.inf, values)
    assert weibull_likelihood(undamaged).beta > fit.beta  # known to exceed 93 only
    lives = 5 * np.random.default_rng(1).weibull(3, 100_000)
    fit = weibull_likelihood(np.where(lives < 2, -1.0, lives))
    assert (fit.alpha, fit.beta) == pytest.approx((5, 3), rel=0.01)


def test_bounds_hold_at_their_confidence():
    """40 lives, 18 % censored: 90 % bounds of both parameters and of a fraction contain the truth."""
    generator, held, truth = np.random.default_rng(0), np.zeros(3), -np.expm1(-((2 / 5) ** 3))
    for _ in range(300):
        lives = 5 * generator.weibull(3, 40)
        fit = weibull_likelihood(np.minimum(lives, 6), lives > 6)
        (low, high), (first, last) = fit.interval()
        _, least, most = fit.fractions(np.array([2.0]))[:, 0]
        held += low < 5 < high, first < 3 < last, least < truth < most
    assert held / 300 == pytest.approx([0.9, 0.9, 0.9], abs=0.05)


@pytest.mark.parametrize("values", [[], [1.0], [2.0, 2.0], [np.inf, np.inf], [np.inf, 3.0], [-1.0, 3.0]])
def test_no_fit_without_two_failures(values):
    fit = weibull_likelihood(values)
    assert np.isnan(weibull_fit(values)).all()
    assert np.isnan([fit.alpha, fit.beta]).all() and np.isnan(fit.interval()).all()
