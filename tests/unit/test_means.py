"""Means over the time in which both surfaces fill the contact; surfaces after a pass, damage of passes."""

import csv
import json

import h5py
import numpy as np
import pytest
from matplotlib.figure import Figure
from support.made_loads import Scene, write
from support.made_results import A, make_result

import ehlpetsc
from ehlpetsc.analysis.summary import run_scalars
from ehlpetsc.base.errors import ExitStatus
from ehlpetsc.case.loading import load
from ehlpetsc.commands.post import main
from ehlpetsc.commands.summary import main as summary
from ehlpetsc.physics.scales import Scales
from ehlpetsc.pictures.series import draw_fatigue, time_statistics
from ehlpetsc.results.means import (
    both_fill,
    filled_from,
    heights,
    means,
    pass_summary,
    passes_to_run_in,
    statistics,
)
from ehlpetsc.results.post_result import PostResult, damage_beside
from ehlpetsc.results.reader import read_result
from ehlpetsc.surfaces.motion.profile_checks import entry_times
from ehlpetsc.surfaces.motion.roughness import RAMP_LENGTH, Roughness

CONTACT = {"radius": 0.0191, "load": 527e3, "youngs_modulus": [207e9] * 2, "poisson_ratio": [0.3] * 2}
CASE = {
    "title": "t",
    "contact": CONTACT,
    "mesh": {"inlet": -2.5, "outlet": 1.5, "points_per_half_width": 20},
    "motion": {"entrainment_speed": 5.0, "slide_roll_ratio": 0.4},
    "time": {"travel": 6.0},
}
WAVE = {"synthetic": {"kind": "sine", "amplitude": 1e-7, "wavelength": 1e-4}}
RIDGE = {"synthetic": {"kind": "ridge", "amplitude": 1e-7, "wavelength": 1e-4, "position": 3e-4}}


class Stored:
    """What a result holds of a case that has not been run."""

    def __init__(self, case):
        self.scales = Scales.of(case)
        self.rough = Roughness.of(case, self.scales)
        s = self.scales
        self.x = s.x * s.a
        self.case, self.attrs = case, {"a": s.a, "u1": s.u1, "u2": s.u2}

    def steps(self, name):
        return np.linspace(0.0, self.scales.duration, 11)

    def profile(self, side):
        profile = self.rough.side(side)
        return profile and (profile.s, profile.z, profile.speed)

    def __contains__(self, name):
        return False


REVERSAL = {"time": [0.0, 2e-4], "speed_1": [3.6, 2.4], "speed_2": [2.4, 3.6]}
OIL = {"viscosity": 0.01, "law": "roelands", "pressure_viscosity": 1.1e-8, "density": "incompressible"}
OIL["eyring_stress"] = 1e7


@pytest.fixture(scope="module")
def reversal(tmp_path_factory):
    """Result of a smooth contact whose sliding reverses in mid-run."""
    path = tmp_path_factory.mktemp("means") / "reversal.h5"
    motion = {"entrainment_speed": 3.0}
    tables = {"fluid": OIL, "operation": REVERSAL, "motion": motion, "time": {"travel": 2.0}}
    mesh = {"inlet": -2.0, "outlet": 1.4, "points_per_half_width": 20}
    ehlpetsc.solve(CASE | tables | {"mesh": mesh}, output=path, options={}).close()
    return path


def test_mean_friction_under_reversed_sliding_is_one_figure(reversal, capsys, tmp_path):
    with read_result(reversal) as result:
        steps = result.steps
        assert steps.friction[0] * steps.friction[-1] < 0.0
        magnitude = 0.5 * np.abs(steps.friction - steps.friction_1) / steps.load
        expected = np.average(magnitude, weights=steps.dt)
        assert expected > 5.0 * abs(np.average(steps.friction / steps.load, weights=steps.dt))
        found = {
            "last line": means(result)["friction_coefficient"],
            "ensemble": run_scalars(result)["friction_coefficient"],
            "index": pass_summary(result)["friction_coefficient"],
            "pictures": time_statistics([result], "friction_coefficient")[0, 0],
        }
    assert summary([str(reversal)]) == 0
    rows = csv.DictReader(capsys.readouterr().out.splitlines())
    found["summary"] = float(next(row["mean"] for row in rows if row["scalar"] == "friction_coefficient"))
    assert found == {name: pytest.approx(expected, rel=1e-5) for name in found}


def test_friction_coefficient_of_backward_speeds_is_positive():
    speeds = {"time": [0.0, 2e-4], "speed_1": [-2.4, -2.4], "speed_2": [-3.6, -3.6]}
    tables = {"fluid": OIL, "operation": speeds, "time": {"travel": 0.1}}
    mesh = {"inlet": -2.0, "outlet": 2.0, "points_per_half_width": 20}
    with ehlpetsc.solve(CASE | tables | {"mesh": mesh}, options={}) as result:
        assert result.steps.speed_1[-1] < 0.0 < result.steps.friction_coefficient[-1]
        assert means(result)["friction_coefficient"] > 0.0


@pytest.mark.parametrize("xi", [0.4, 0.0, 2.5])
@pytest.mark.parametrize("surface", [{"1": WAVE}, {"2": WAVE}, {"1": WAVE, "2": WAVE}, {"1": RIDGE}])
def test_filling_time_equals_the_explained_travel(surface, xi):
    motion = CASE["motion"] | {"slide_roll_ratio": xi}
    result = Stored(load(CASE | {"surface": surface, "motion": motion}))
    s = result.scales
    fills = max(entry_times(p, s)[1] for p in (result.rough.surface_1, result.rough.surface_2) if p)
    assert filled_from(result) == pytest.approx(fills * s.a / s.u_max, rel=1e-12)
    begun = {"surface": surface, "motion": motion, "time": {"travel": 6.0, "start": "rough"}}
    assert filled_from(Stored(load(CASE | begun))) == 0.0


def test_filling_time_of_smooth_surfaces_and_under_changing_speeds(tmp_path):
    path = make_result(tmp_path / "r.h5", speed=50.0, rough=True)
    with h5py.File(path, "r+", libver="latest") as file:
        file["surface/2/z"][:] = 0.0
    with read_result(path) as result:
        assert filled_from(result) == pytest.approx((3.5 + RAMP_LENGTH) * A / (1.12 * 50.0))
    with h5py.File(path, "r+", libver="latest") as file:
        file["surface/1/z"][:] = 0.0
    with read_result(path) as result:
        assert filled_from(result) == 0.0 and both_fill(result, result.steps("time")).all()
    path = make_result(tmp_path / "r.h5", speed=50.0, rough=True)
    with read_result(path) as result:
        begin = filled_from(result)
    with h5py.File(path, "r+", libver="latest") as file:
        time = file["steps/time"][:]
        for number, factor in ((1, 1.12), (2, 0.88)):  # 100 m/s for 10 us, then 50 m/s
            way = factor * (100.0 * np.minimum(time, 10e-6) + 50.0 * np.maximum(time - 10e-6, 0.0))
            file[f"steps/displacement_{number}"] = way
    with read_result(path) as result:
        assert filled_from(result) == pytest.approx(begin - 10e-6, rel=1e-6)
    with h5py.File(path, "r+", libver="latest") as file:
        file["steps/displacement_1"][:] = file["steps/displacement_2"][:] = time
    with read_result(path) as result:
        assert filled_from(result) == np.inf


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


def test_every_pass_of_an_index_is_processed_and_damage_of_another_case_left_out(index, capsys):
    assert main([str(index)]) == ExitStatus.DONE
    assert capsys.readouterr().out.count("ehlpetsc post: done ") == 2
    posts = [PostResult(index.with_name(f"run.pass{k}.post.h5")) for k in (1, 2)]
    axes = Figure().add_subplot()
    draw_fatigue(axes, posts, "2")
    for depth, line in enumerate(axes.lines):
        maxima = [post.passed("2")[depth].max() for post in posts]
        np.testing.assert_array_equal(line.get_xydata(), [[1, maxima[0]], [2, maxima[1]]])
    assert len(axes.lines) == 2 and maxima[1] < maxima[0]
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
