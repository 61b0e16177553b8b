"""From which pass on the surfaces have run in."""

import pytest

from ehlpetsc.results.running_in import passes_to_run_in


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
    assert passes_to_run_in(rows, 10) == 3
