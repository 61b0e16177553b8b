"""Surfaces after a pass, and damage of passes."""

import json

import h5py
import numpy as np
import pytest
from matplotlib.figure import Figure
from support.made_loads import Scene, write
from support.made_results import make_result

from ehlpetsc.base.errors import ExitStatus
from ehlpetsc.pictures.series import draw_fatigue
from ehlpetsc.post.command import main
from ehlpetsc.results.means import heights, passes_to_run_in, statistics
from ehlpetsc.results.post_result import PostResult, damage_beside
from ehlpetsc.results.reader import read_result


@pytest.fixture
def index(tmp_path):
    """The index of two passes, the second of a calmer pressure."""

    rows = []
    for number, ripple in ((1, 3e6), (2, 1e6)):
        scene = Scene(per_width=20, ratio=0.5, travel=9.0, ripple=ripple)
        write(tmp_path / f"run.pass{number}.h5", scene, depths=(0.0, 0.1))
        rows.append({"pass": number, "file": f"run.pass{number}.h5", "set_volume": 1e-12})
    path = tmp_path / "run.passes.json"
    path.write_text(json.dumps({"title": "made up", "passes": rows}))
    return path


def test_every_pass_of_an_index_is_processed(index, capsys):
    assert main([str(index)]) == ExitStatus.DONE
    assert capsys.readouterr().out.count("ehlpetsc post: done ") == 2
    posts = [PostResult(index.with_name(f"run.pass{k}.post.h5")) for k in (1, 2)]
    axes = Figure().add_subplot()
    draw_fatigue(axes, posts, "2")
    for depth, line in enumerate(axes.lines):
        maxima = [post.passed("2")[depth].max() for post in posts]
        np.testing.assert_array_equal(line.get_xydata(), [[1, maxima[0]], [2, maxima[1]]])
    assert len(axes.lines) == 2 and maxima[1] < maxima[0]


def test_damage_of_another_case_is_not_that_of_a_pass(index):
    pass_file = index.with_name("run.pass1.h5")
    assert main([str(pass_file)]) == ExitStatus.DONE
    with read_result(pass_file) as result:
        assert damage_beside(result) is not None
        result.attrs = {"case": "another"}
        assert damage_beside(result) is None


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
        _, before, after = heights(result, "1")
        np.testing.assert_allclose(before - after, 1.5 * depth, atol=1e-20)
        found = statistics(result, "1")
    assert found["deepest"] == pytest.approx(3e-8)
    assert found["rq"] == pytest.approx(np.std(after))
    assert found["ra"] == pytest.approx(np.abs(after - after.mean()).mean())
