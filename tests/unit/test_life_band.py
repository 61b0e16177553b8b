"""Band of a life over fatigue criteria, from the result of one pass."""

import numpy as np
import pytest
from support.made_loads import Scene, write

from ehlpetsc.life.one_pass import LIFE_CRITERIA, band, lines_of, passes_to_failure
from ehlpetsc.post.run import Job, run
from ehlpetsc.results.post_result import PostResult


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    scene = Scene(per_width=20, ratio=0.5, travel=7.0)
    return write(tmp_path_factory.mktemp("band") / "pass.h5", scene, depths=(0.0, 0.05))


def test_passes_are_those_of_the_worst_point(result, tmp_path):
    settings = ("post.mean_stress=goodman",)
    run(Job(str(result), str(tmp_path / "o.h5"), settings=settings, precision="float64"))
    stored = PostResult(tmp_path / "o.h5")
    expected = [1 / np.nanmax(stored.damage[side]) for side in ("1", "2")]
    assert passes_to_failure(result, settings) == pytest.approx(expected, rel=1e-12)


def test_lines_give_ratios_and_the_factor_of_the_band(result):
    found = band(result)
    assert found.keys() == LIFE_CRITERIA.keys()
    assert found["morrow"][0] > found["von-mises"][0]  # benefit of compression
    lines = list(lines_of({"one": (2e6, 3e6), "two": (5e6, 1e6)}, (2e6, 2e6)))
    assert lines[0].endswith("over 2e+06 passes: one 1, two 2.5 (band of a factor 2.5)")
    assert lines[1].endswith("over 2e+06 passes: one 1.5, two 0.5 (band of a factor 3)")
