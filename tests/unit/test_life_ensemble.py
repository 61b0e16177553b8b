"""Lives of a series: one a member, means over seeds with bounds; the band over fatigue criteria."""

import json

import numpy as np
import pytest
from support import COARSE_LIFE
from support.made_loads import Scene, write
from support.made_results import save_life

from ehlpetsc.base.errors import Stopped
from ehlpetsc.case.loading import load
from ehlpetsc.commands.life import main
from ehlpetsc.life.body import LifeBody
from ehlpetsc.life.ensemble import band, read_lives, run_lives
from ehlpetsc.life.history import LifeHistory, read_life
from ehlpetsc.life.one_pass import LIFE_CRITERIA, lines_of, passes_to_failure
from ehlpetsc.life.one_pass import band as criteria_band
from ehlpetsc.post.run import Job, run
from ehlpetsc.results.post_result import PostResult

SERIES = """
[series]
keys = ["surface.1.synthetic.seed", "motion.entrainment_speed"]
values = [[1, 2, 3], [2.0, 1.0]]
"""


def life(passes, damage):
    """A life with rows at these passes, in which a growing share of both bodies is damaged."""
    made = LifeHistory('contact = { material = "100Cr6" }', "title")
    one = LifeBody.new(np.arange(10.0), np.zeros((2, 10)), np.array([0.0, 1.0, 2.0]), np.arange(2.0))
    for done, share in zip(passes, damage, strict=True):
        cells = np.zeros((2, 2, 10))
        cells[1, :, : round(10 * share)] = 0.2
        body = one._replace(damage=cells)
        row = {"passes": done, "jump": 1, "friction": 0.05, "solved": 1, "smooth_pressure": 1.7e9}
        for k in (1, 2):
            row |= {f"pitted_share_{k}": 0.0, f"pits_{k}": 0, f"wear_volume_{k}": 1e-12 * done}
            row |= {f"smooth_life_{k}": 5.0, f"smooth_depth_{k}": 1e-5}
        made.add(row, (body, body), {})
    return made


def test_mean_and_bounds_over_lives_with_rows_at_different_passes():
    lives = [life([10, 40], [0.1, 0.4]), life([20, 30], [0.4, 0.6]), life([40], [0.8])]
    passes, (mean, low, high) = band(lives, "damaged_share_1")
    assert passes.tolist() == [10, 20, 30]
    assert mean == pytest.approx([(0.1 + 0.2 + 0.2) / 3, (0.2 + 0.4 + 0.4) / 3, (0.3 + 0.6 + 0.6) / 3])
    assert (low <= mean).all() and (mean <= high).all() and high[1] == pytest.approx(0.4)
    assert band(lives, "friction")[1][0] == pytest.approx(0.05)


def test_lives_that_are_stopped_before_they_begin_raise(tmp_path):
    from mpi4py import MPI

    speeds = {"series": {"key": "motion.entrainment_speed", "values": [1.0, 2.0]}}
    with pytest.raises(Stopped):
        run_lives(load(COARSE_LIFE, speeds), tmp_path / "l.life.h5", MPI.COMM_SELF, stop=lambda comm: True)


def test_lives_of_an_index_are_printed_and_drawn_by_their_other_settings(tmp_path, capsys):
    files = [f"a_{k}.life.h5" for k in range(6)]
    for number, file in enumerate(files[:-1]):  # the last one is not there yet
        save_life(life([10], [0.1 * number]), tmp_path / file)
    index = tmp_path / "a.life.series.json"
    index.write_text(json.dumps({"case": SERIES, "members": [{"file": file} for file in files]}))
    lives = read_lives(index)
    assert {name: len(members) for name, members in lives.items()} == {
        "entrainment_speed = 2.0": 3,
        "entrainment_speed = 1.0": 2,
    }
    assert main([str(index)]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("entrainment_speed = 2.0: damaged_share_1 after 10 passes, 3 lives: 0.2 (")
    assert "entrainment_speed = 1.0: smooth contact: smooth_life_2=5 passes smooth_depth_2=1e-05 m" in lines
    assert sum("2.0: limit: of 10 passes those after 5 exceed" in line for line in lines) == 2
    assert (tmp_path / "a.life.series.png").stat().st_size > 10_000
    (tmp_path / "b.series.json").write_text(json.dumps({"members": []}))
    assert main([str(tmp_path / "b.series.json")]) == 2
    assert "none of its lives is beside it" in capsys.readouterr().err


def test_each_member_of_a_series_has_a_life(tmp_path):
    from mpi4py import MPI

    keys = {"mesh.points_per_half_width": 8, "time.travel": 3.6, "life.max_solved": 1}
    series = {"series.key": "wear.coefficient", "series.values": [1e-18, 1e-17]}
    case, shown = load(COARSE_LIFE, keys | series), []
    for _ in range(2):
        index = run_lives(case, tmp_path / "a.life.h5", MPI.COMM_SELF, unresolved=True, show=shown.append)
    low, high = (lives[0] for lives in read_lives(index).values())
    assert shown[0].startswith("[coefficient=1e-18] solved=1 ") and shown[2:] == shown[:2]
    assert high("wear_rate_1") == pytest.approx(10.0 * low("wear_rate_1"), rel=1e-6)
    assert read_life(tmp_path / "a_coefficient_1e-17.life.h5")("damage_1") == high("damage_1")


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
    found = criteria_band(result)
    assert found.keys() == LIFE_CRITERIA.keys()
    assert found["morrow"][0] > found["von-mises"][0]  # benefit of compression
    lines = list(lines_of({"one": (2e6, 3e6), "two": (5e6, 1e6)}, (2e6, 2e6)))
    assert lines[0].endswith("over 2e+06 passes: one 1, two 2.5 (band of a factor 2.5)")
    assert lines[1].endswith("over 2e+06 passes: one 1.5, two 0.5 (band of a factor 3)")
