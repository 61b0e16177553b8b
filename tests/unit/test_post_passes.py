"""Statistics over passes, passes within one result, and damage near an asperity."""

import numpy as np
import pytest

from ehlpetsc.post import fold, largest_near, pass_statistics


def test_mean_scatter_and_life():
    result = pass_statistics([[1e-3, 0.0, np.nan], [3e-3, 0.0, 2e-4], [2e-3, 0.0, np.nan]])
    assert result.mean == pytest.approx([2e-3, 0.0, 2e-4])
    assert result.deviation[:2] == pytest.approx([1e-3, 0.0]) and np.isnan(result.deviation[2])
    assert result.largest == pytest.approx([3e-3, 0.0, 2e-4]) and list(result.count) == [3, 3, 1]
    assert result.life == pytest.approx([500, np.inf, 5000])


def test_miners_sum_reaches_one_after_the_expected_passes():
    rng = np.random.default_rng(0)
    damages = 10.0 ** -rng.uniform(3, 5, size=2000)
    known = pass_statistics(damages[:, None])
    drawn = np.cumsum(rng.choice(damages, 20000))
    assert np.searchsorted(drawn, 1.0) == pytest.approx(known.life[0], rel=0.1)


def test_no_pass_is_nan_and_bad_ones_are_refused():
    assert np.isnan(pass_statistics([[np.nan]]).mean).all()
    with pytest.raises(ValueError, match="negative"):
        pass_statistics([-1.0])
    for none in ([], 3.0):
        with pytest.raises(ValueError, match="one pass"):
            pass_statistics(none)


def test_fold_puts_the_same_points_below_each_other():
    s = 1e-6 * np.arange(10)
    damage = np.arange(20.0).reshape(2, 10)
    damage[:, 0] = np.nan  # the last that entered has not left
    passes = fold(s, damage, 4e-6)
    assert passes.shape == (3, 2, 4)
    assert passes[0][0, :2] == pytest.approx([8, 9]) and np.isnan(passes[0][0, 2:]).all()
    assert passes[1][1] == pytest.approx([14, 15, 16, 17])
    assert np.isnan(passes[2][0, 0]) and passes[2][0, 1:] == pytest.approx([1, 2, 3])
    for stretch in (0.2e-6, 1e-4, np.nan):
        with pytest.raises(ValueError, match="does not fit"):
            fold(s, damage, stretch)


def test_largest_near_a_peak():
    s = np.linspace(0, 1, 11)
    damage = np.array([[0, 5, 0, 1, 0, 0, 9, 0, 0, np.nan, np.nan]], float)
    places = [0.31, 0.95]
    assert largest_near(s, damage, places, 0.05)[0][0] == 1
    assert largest_near(s, damage, places, 0.25)[0][0] == 5
    assert largest_near(s, damage, places, 0.3)[0][0] == 9
    assert largest_near(s, damage, places, 0.0)[0][0] == 1  # the nearest point always counts
    assert np.isnan(largest_near(s, damage, places, 0.05)[0][1])
    assert largest_near(s, damage[0], places, 0.2).shape == (2,)
