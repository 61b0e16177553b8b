"""Body points of a result: fields that it must have, their histories, changing speeds and flanks."""

import h5py
import numpy as np
import pytest
from support.made_loads import LOAD, Scene, write

from ehlpetsc.base.errors import PostError
from ehlpetsc.case.loading import load
from ehlpetsc.physics import operation_of
from ehlpetsc.physics.contact.hertz import hertz_line
from ehlpetsc.physics.scales import Scales
from ehlpetsc.post.loads import DEPTHS, Loads, prepare
from ehlpetsc.post.run import Job, run
from ehlpetsc.results.post_result import PostResult


@pytest.fixture(scope="module")
def scene():
    return Scene(per_width=20, ratio=0.5, travel=9.0)


@pytest.mark.parametrize("name", ["pressure", "shear_stress_2"])
def test_missing_field_is_refused(name, scene, tmp_path):
    path = write(tmp_path / "a.h5", scene, edit=lambda file: file.__delitem__(name))
    with pytest.raises(PostError, match=f'{name} .*"{name}" in output.fields'), Loads(path) as loads:
        prepare(loads, ("2", "1"), print)


@pytest.mark.parametrize("name", ["pressure", "shear_stress_1"])
def test_field_that_is_not_finite_is_refused(name, scene, tmp_path):
    """Also in the last frames; the output is not written."""

    def edit(file):
        file[name][160, 30] = np.nan

    path = write(tmp_path / "a.h5", scene, edit=edit)
    with pytest.raises(PostError, match=rf"a.h5: {name} is not finite in frame 160; run the case again"):
        run(Job(str(path), str(tmp_path / "o.h5"), settings=("post.depths=[0.0]",)))
    assert not (tmp_path / "o.h5").exists()


def test_default_depths_reach_the_stresses_of_the_smooth_contact():
    """The largest von Mises stress of a line contact is at 0.7 a."""
    assert (DEPTHS[0], DEPTHS[-2], DEPTHS[-1]) == (0.0, 0.7, 1.0)


def test_history_contains_every_sample_of_every_point(scene, tmp_path):
    """As many as the sweep counts, also where a frame finds the point at the first node but for rounding."""
    from support.histories import history_at

    path = write(tmp_path / "a.h5", scene)
    run(Job(str(path), str(tmp_path / "o.h5"), surfaces=("2",), settings=("post.depths=[0.0]",)))
    result = PostResult(tmp_path / "o.h5")
    with Loads(path) as loads:
        motion = prepare(loads, ("2",), print).motions["2"]
        for j in np.flatnonzero(result.complete["2"])[::9]:
            time, values = history_at(loads, "2", result.s[j], 0.0)
            assert time.size == motion.leave[j] - motion.enter[j] + 1 == values.shape[1] - 2
            assert time[0] == loads.time[motion.enter[j]]


def test_points_follow_surface_positions_under_changing_speeds(scene, tmp_path):
    """Damage is of the positions alone: the same frames at other times give the same."""
    count = scene.time.size
    warped = scene.time[-1] * (scene.time / scene.time[-1]) ** 1.3
    columns = (
        f"time = {warped[[0, count // 2, -1]].tolist()}\nload = [{LOAD}, {LOAD}, {LOAD}]\n"
        f"speed_1 = [{scene.u1}, {scene.u1}, {scene.u1}]\nspeed_2 = [{scene.u2}, {scene.u2}, {scene.u2}]"
    )

    def edit(file):
        case = file.attrs["case"].replace("load = 527e3\n", "")
        case = case.replace(case[case.index("[motion]") : case.index("[mesh]")], "")
        file.attrs["case"] = f"{case}\n[operation]\n{columns}\n"
        for name in ("time", "steps/time"):
            file[name][...] = warped
        for name, speed in (("displacement_1", scene.u1), ("displacement_2", scene.u2)):
            file[f"steps/{name}"] = speed * scene.time
        file["steps/load_given"] = np.full(count, LOAD)

    paths = [write(tmp_path / "a.h5", scene), write(tmp_path / "b.h5", scene, edit=edit)]
    found = []
    for path in paths:
        run(Job(str(path), f"{path}.post", settings=("post.depths=[0.0, 0.5]",)))
        found.append(PostResult(f"{path}.post").damage)
    for side in ("2", "1"):
        np.testing.assert_allclose(found[1][side], found[0][side], rtol=1e-9)


def test_gear_flanks_have_damage_along_the_path_of_contact(tmp_path):
    """Hertz's pressure along the path of contact of the FZG pair: both flanks from its begin to its end."""
    case = load("cases/fzg.toml", {"mesh.points_per_half_width": 20})
    scales = Scales.of(case)
    operation = operation_of(case, scales)
    time = [0.0]
    while time[-1] < operation.duration * (1 - 1e-9):
        time.append(time[-1] + operation.time_left(time[-1], scales.dt))
    conditions = [operation.at(t) for t in time]
    x = scales.x * scales.a
    pressure = []
    for now in conditions:
        a, _ = hertz_line(now.load, now.radius, scales.E)
        p = np.sqrt(np.clip(1 - (x / a) ** 2, 0, None))
        pressure.append(p * now.load / (p.sum() * scales.spacing))
    ways = np.array([operation.travelled(t) for t in time])
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file.attrs.update(format_version=1, title="flanks", case=case.text, status="done")
        file.attrs.update(a=scales.a, p0=scales.p0, u1=scales.u1, u2=scales.u2)
        file["x"], file["contact_count"] = x, np.zeros(x.size, int)
        file["pressure"], file["shear_stress_2"] = pressure, 0.05 * np.array(pressure)
        file["shear_stress_1"] = -0.05 * np.array(pressure)
        for name in ("time", "steps/time"):
            file[name] = time
        for name in ("step", "steps/step"):
            file[name] = np.arange(len(time))
        file["steps/load_given"] = [now.load for now in conditions]
        file["steps/displacement_1"], file["steps/displacement_2"] = ways.T
    run(Job(str(tmp_path / "a.h5"), str(tmp_path / "o.h5"), settings=("post.depths=[0.5]",)))
    found = PostResult(tmp_path / "o.h5")
    for side in found.surfaces:
        damage = found.passed(side)
        assert damage.shape[1] * scales.spacing > 0.9 * abs(ways[-1]).min() and np.isfinite(damage).all()
        assert damage.max() > 1e-9
