"""Weibull fits, ranks, asperity peaks; rainflow counts against the standard and other programs."""

from collections import Counter
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import weibull_min
from support import optional

from ehlpetsc.post import rainflow, weibull_fit, weibull_likelihood
from ehlpetsc.post.fatigue.statistics import asperities, benard_ranks, exceedance, fitted_exceedance, log_life

DATA = [16, 34, 53, 75, 93, 120]


def test_textbook_data_by_regression_and_likelihood():
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
    # ten asperities, small noise
    z = 1e-6 * np.sin(2 * np.pi * s / 1e-4) + 1e-9 * np.sin(2 * np.pi * s / 5e-6)
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


def test_censored_lives_of_one_shape_and_failures_before_the_first_value():
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


ASTM = [-2, 1, -3, 5, -1, 3, -4, 4, -2]


def counts(cycles):
    total = Counter()
    for size, *_ in cycles:
        total[size] += 1
    return dict(total)


def three_point(series):
    """ASTM E1049, 5.4.4, written as the standard's text reads; ranges and counts."""
    turns = [v for k, v in enumerate(series) if k == 0 or v != series[k - 1]]
    ends = 0, len(turns) - 1
    turns = [v for k, v in enumerate(turns) if k in ends or (v - turns[k - 1]) * (turns[k + 1] - v) < 0]
    stack, total = [], Counter()
    for value in turns:
        stack.append(value)
        while len(stack) >= 3:
            x, y = abs(stack[-1] - stack[-2]), abs(stack[-2] - stack[-3])
            if x < y:
                break
            if len(stack) == 3:
                total[y] += 0.5
                del stack[0]
            else:
                total[y] += 1.0
                del stack[-3:-1]
    for a, b in pairwise(stack):
        total[abs(b - a)] += 0.5
    return {size: count for size, count in total.items() if size > 0}


def test_largest_range_and_the_astm_example_repeated():
    assert counts(rainflow(ASTM)) == {3: 1, 4: 1, 7: 1, 9: 1}
    series = [0, 100, -50, 80, -100, 0]
    assert counts(rainflow(series)) == {200: 1, 130: 1}


def half_counts(cycles):
    total = Counter()
    for size, *_, count in cycles:
        total[size] += count
    return dict(total)


def test_half_cycles_of_the_astm_example_and_of_random_series():
    """ASTM E1049, 5.4.4: half cycles of the residue."""
    expected = {3: 0.5, 4: 1.5, 6: 0.5, 8: 1.0, 9: 0.5}
    assert half_counts(rainflow(ASTM, "half")) == expected == three_point(ASTM)
    rng = np.random.default_rng(3)
    for k in range(400):
        series = rng.integers(-8, 9, rng.integers(2, 80)) if k % 2 else rng.normal(size=rng.integers(2, 300))
        assert half_counts(rainflow(series, "half")) == three_point(series.tolist())


def test_half_cycles_against_rainflow():
    package = optional("rainflow")
    for seed in range(20):
        series = np.cumsum(np.random.default_rng(seed).normal(size=400))
        expected = Counter()
        for size, _, count, *_ in package.extract_cycles(series):
            expected[round(size, 9)] += count
        found = Counter()
        for size, *_, count in rainflow(series, "half"):
            found[round(size, 9)] += count
        assert found == expected


def test_half_cycles_against_fatpack():
    package = optional("fatpack")
    series = np.cumsum(np.random.default_rng(7).normal(size=2000))
    step = np.sign(np.diff(series))
    turns = series[np.concatenate([[True], step[1:] != step[:-1], [True]])]
    full, residue = package.find_rainflow_cycles(turns)
    ranges = np.abs(np.diff(full, axis=1))[:, 0]
    found = rainflow(series, "half")
    assert np.sort(found[found[:, 4] == 1.0, 0]) == pytest.approx(np.sort(ranges))
    assert found[found[:, 4] == 0.5, 0] == pytest.approx(np.abs(np.diff(residue)))


def test_random_series_against_the_standard():
    rng = np.random.default_rng(0)
    for k in range(1000):
        series = rng.integers(-8, 9, rng.integers(2, 80)) if k % 2 else rng.normal(size=rng.integers(2, 300))
        once = np.roll(series, -series.argmax()).tolist()  # a period that begins and ends at its maximum
        assert counts(rainflow(series)) == three_point([*once, once[0]])


@given(st.lists(st.integers(-9, 9), min_size=2, max_size=60))
def test_closed_residue_is_one_period(series):
    """Every range of a repeated history: any start gives the same count, three periods thrice it."""
    once = counts(rainflow(series))
    for turn in (1, len(series) // 2):
        assert counts(rainflow(series[turn:] + series[:turn])) == once
    assert counts(rainflow(series * 3)) == {size: 3 * count for size, count in once.items()}
    assert max(once, default=0) == max(series) - min(series)


@given(st.lists(st.floats(-1e9, 1e9), min_size=2, max_size=60))
def test_sum_of_closed_ranges_is_half_the_path(series):
    cycles = rainflow(series)
    path = np.abs(np.diff([*series, series[0]])).sum()
    assert 2 * cycles[:, 0].sum() == pytest.approx(path, rel=1e-9, abs=1e-300)


def test_plateaus_keep_their_first_sample_and_short_series_have_no_cycles():
    series = [0, 0, 5, 5, 5, 1, 1, 3, 3, 0, 0]
    cycles = rainflow(series)
    assert sorted(map(tuple, cycles[:, 2:])) == [(2, 9), (5, 7)]
    for series in ([], [1.0], [2.0, 2.0, 2.0]):
        assert rainflow(series).shape == (0, 4)
