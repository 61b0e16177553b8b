"""Rainflow counts against the standard, hand-made cases, and a second implementation."""

from collections import Counter
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from support import optional

from ehlpetsc.post import rainflow

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


def test_astm_example_repeated():
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


def test_plateaus_keep_their_first_sample():
    series = [0, 0, 5, 5, 5, 1, 1, 3, 3, 0, 0]
    cycles = rainflow(series)
    assert sorted(map(tuple, cycles[:, 2:])) == [(2, 9), (5, 7)]
    for series in ([], [1.0], [2.0, 2.0, 2.0]):
        assert rainflow(series).shape == (0, 4)
