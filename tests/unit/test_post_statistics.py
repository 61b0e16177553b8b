"""Weibull fits, ranks, and asperity peaks."""

import numpy as np
import pytest

from ehlpetsc.post import weibull_fit
from ehlpetsc.post.fatigue.statistics import asperities, benard_ranks, exceedance, fitted_exceedance, log_life

DATA = [16, 34, 53, 75, 93, 120]


def test_textbook_data():
    fit = weibull_fit(DATA)
    assert (fit.beta, fit.alpha) == pytest.approx((1.43966, 76.1096), rel=4e-6)
    assert 0.99 < fit.r_squared < 1


def test_recovers_its_own_quantiles():
    ranks = benard_ranks(25)
    values = 7.0 * (-np.log1p(-ranks)) ** (1 / 9.0)
    assert weibull_fit(values) == pytest.approx((7.0, 9.0, 1.0), rel=1e-10)


def test_undamaged_values_are_censored():
    ranks = benard_ranks(25)
    values = 7.0 * (-np.log1p(-ranks)) ** (1 / 9.0)
    values[20:] = log_life(np.zeros(5))  # no damage: infinite
    assert weibull_fit(values) == pytest.approx((7.0, 9.0, 1.0), rel=1e-10)


def test_immediate_failures_keep_their_ranks():
    ranks = benard_ranks(25)
    values = 7.0 * (-np.log1p(-ranks)) ** (1 / 9.0)
    values[:3] = log_life(np.array([1.0, 3.0, 40.0]))  # damage of 1 and more: no logarithm of -log10 D
    assert weibull_fit(values) == pytest.approx((7.0, 9.0, 1.0), rel=1e-10)


def test_too_few_values():
    for values in ([], [1.0], [2.0, 2.0], [np.inf, np.inf], [-1.0, 3.0]):
        assert np.isnan(weibull_fit(values)).all()


def test_exceedance_and_its_fit_agree():
    values = 7.0 * (-np.log1p(-benard_ranks(25))) ** (1 / 9.0)
    damages = 10.0**-values
    falling, share = exceedance(damages)
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
