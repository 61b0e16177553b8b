"""Means over the time in which both surfaces fill the contact: one definition for all doors."""

import csv

import h5py
import numpy as np
import pytest
from support.made_results import A, make_result

import ehlpetsc
from ehlpetsc.analysis.summary import main as summary
from ehlpetsc.analysis.summary import run_scalars
from ehlpetsc.case.loading import load
from ehlpetsc.physics.scales import Scales
from ehlpetsc.pictures.series import time_statistics
from ehlpetsc.results.means import both_fill, filled_from, means, pass_summary
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
    """Last line, summary, ensembles, index of passes and pictures agree on the magnitude of friction."""
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


def test_smooth_surfaces_fill_the_contact_from_the_start(tmp_path):
    path = make_result(tmp_path / "r.h5", speed=50.0, rough=True)
    with h5py.File(path, "r+", libver="latest") as file:
        file["surface/2/z"][:] = 0.0
    with read_result(path) as result:
        assert filled_from(result) == pytest.approx((3.5 + RAMP_LENGTH) * A / (1.12 * 50.0))
    with h5py.File(path, "r+", libver="latest") as file:
        file["surface/1/z"][:] = 0.0
    with read_result(path) as result:
        assert filled_from(result) == 0.0 and both_fill(result, result.steps("time")).all()


def test_filling_time_follows_distance_under_changing_speeds(tmp_path):
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
