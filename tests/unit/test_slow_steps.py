"""Warning of a run that has become several times slower."""

from types import SimpleNamespace

import pytest
from support import is_line_with

from ehlpetsc.run.progress import MEDIAN_STEPS, SKIPPED_STEPS, SLOWDOWN, SlowSteps


def warned(times, ranks=2):
    """Lines shown for steps of these wall times [s], of four iterations each; the first ones compile."""
    lines = []
    output = SlowSteps(ranks, lines.append)
    for step, wall in enumerate([60.0] * (SKIPPED_STEPS + 1) + times):
        output.write(SimpleNamespace(scalars={"step": step, "newton": 4, "wall": wall}))
    output.close(None)
    return lines


@pytest.mark.parametrize("ranks, cure", [(1, "other work"), (2, "-n 1")])
def test_slow_run_is_warned_of_once(ranks, cure):
    begun, later = [0.004] * MEDIAN_STEPS, [0.004 * 1.5 * SLOWDOWN] * (4 * MEDIAN_STEPS)
    (line,) = warned(begun + later, ranks)
    assert is_line_with(line, "warning: ", " 4.5 ms, 4.5 times ", cure)


def test_contact_and_single_slow_steps_are_no_warning():
    begun = [0.004] * MEDIAN_STEPS
    assert warned(begun + [0.8 * SLOWDOWN * 0.004] * (4 * MEDIAN_STEPS)) == []
    assert warned((begun + [1.0]) * 5) == []
