"""Surfaces after a pass, and from which pass on they have run in."""

import h5py
import numpy as np
import pytest
from support.made_results import make_result

from ehlpetsc.results.reader import read_result
from ehlpetsc.results.running_in import heights, passes_to_run_in, statistics


@pytest.mark.parametrize(
    "added, number",
    [
        ([10.0, 1.5, 0.3, 0.08, 0.02], 4),
        ([10.0, 0.05, 2.0, 0.06, 0.04], 4),  # other pairs of asperities have met in the third
        ([10.0, 0.05, 2.0], None),
        ([0.0, 0.0], None),
    ],
)
def test_running_in_ends_where_no_later_pass_adds_more(added, number):
    rows = [{"pass": k, "added": value} for k, value in enumerate(added, 1)]
    assert passes_to_run_in(rows) == number


def test_one_small_shifted_pass_does_not_end_running_in():
    rows = [{"pass": k, "added": value} for k, value in enumerate([10.0, 1.0, *12 * [0.05]], 1)]
    assert passes_to_run_in(rows[:3], 10) is None
    assert passes_to_run_in(rows, 10) == passes_to_run_in(rows[:12], 10) == 3
    assert passes_to_run_in(rows[:11], 10) is None


def test_depths_of_all_effects_are_taken_from_the_heights(tmp_path):
    path = make_result(tmp_path / "r.h5", rough=True)
    depth = np.linspace(0.0, 2e-8, 50)
    with h5py.File(path, "r+", libver="latest") as file:
        file["surface/1/set"], file["surface/1/wear"] = depth, 0.5 * depth
    with read_result(path) as result:
        s, before, after = heights(result, "1")
        np.testing.assert_allclose(before - after, 1.5 * depth, atol=1e-20)
        found = statistics(result, "1")
    assert found["deepest"] == pytest.approx(3e-8)
    assert found["rq"] == pytest.approx(np.std(after)) and found["ra"] == pytest.approx(
        np.abs(after - after.mean()).mean()
    )
    assert found["slope"] == pytest.approx(np.abs(np.diff(after) / np.diff(s)).max())
