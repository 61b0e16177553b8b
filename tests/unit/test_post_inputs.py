"""Body points of a result: required fields, histories, changing speeds, flanks, surface temperatures."""

import numpy as np
import pytest
from support.made_loads import LOAD, A, Scene, write

from ehlpetsc.base.errors import PostError
from ehlpetsc.commands.post import main
from ehlpetsc.pictures.damage_maps import damage_picture
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

    def edit(file):
        file[name][160, 30] = np.nan

    path = write(tmp_path / "a.h5", scene, edit=edit)
    with pytest.raises(PostError, match=rf"a.h5: {name} is not finite in frame 160; run the case again"):
        run(Job(str(path), str(tmp_path / "o.h5"), settings=("post.depths=[0.0]",)))
    assert not (tmp_path / "o.h5").exists()


def test_history_contains_every_sample_of_every_point_to_the_default_depths(scene, tmp_path):
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
    assert (DEPTHS[0], DEPTHS[-2], DEPTHS[-1]) == (0.0, 0.7, 1.0)


def test_points_follow_surface_positions_under_changing_speeds(scene, tmp_path):
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


BULK = 350.0, 360.0
FLUID = """[fluid]
viscosity = 0.005
law = "barus"
pressure_viscosity = 11.1e-9
density = "incompressible"
"""
HEAT = f"[heat]\nbulk_temperature = [{BULK[0]}, {BULK[1]}]\n{FLUID}"
WAVE = 10  # nodes
SHARE = 0.4  # of a rise that the body carries along


@pytest.fixture(scope="module")
def hot_scene():
    return Scene(per_width=40, ratio=0.5, travel=8.5)


def rise(hot_scene, x, time, speed):
    """Warmer towards x = a/2, times a ripple of ten nodes that the body carries."""
    phase = 2 * np.pi * (x - speed * time) / (WAVE * hot_scene.dx)
    return 80.0 * np.exp(-((x / A - 0.5) ** 2)) * (1.0 + SHARE * np.cos(phase))


def temperatures(hot_scene, side):
    speed, bulk = (hot_scene.u1, BULK[0]) if side == "1" else (hot_scene.u2, BULK[1])
    return bulk + rise(hot_scene, hot_scene.x, hot_scene.time[:, None], speed)


def heated(hot_scene, sides="12"):
    """For `write`: add temperatures."""

    def edit(file):
        for side in sides:
            values = temperatures(hot_scene, side)
            file.create_dataset(f"temperature_{side}", data=values, chunks=(8, hot_scene.x.size))

    return edit


@pytest.fixture
def result(hot_scene, tmp_path):
    def made(sides="12"):
        return write(tmp_path / "run.h5", hot_scene, depths=(0.0,), post=HEAT, edit=heated(hot_scene, sides))

    return made


def test_highest_mean_and_flash_temperature(hot_scene, result, tmp_path, capsys):
    assert main([str(result())]) == 0
    output = capsys.readouterr()
    found = PostResult(tmp_path / "run.post.h5")
    for side, bulk in zip("12", BULK, strict=True):
        s, known = found.s[found.complete[side]], found.temperatures[side]
        carried = 1.0 + SHARE * np.cos(2 * np.pi * s / (WAVE * hot_scene.dx))
        flash = 80.0 * carried  # reached at x = a/2
        np.testing.assert_allclose(known.flash[found.complete[side]], flash, rtol=2e-3)
        np.testing.assert_allclose(known.highest - bulk, known.flash)
        x = np.linspace(-A, A, 4001)
        mean = bulk + 80.0 * carried * np.exp(-((x / A - 0.5) ** 2)).mean()
        np.testing.assert_allclose(known.mean[found.complete[side]], mean, rtol=2e-3)
        assert np.isnan(known.highest[~found.complete[side]]).all()
        assert f"surface {side} temperature: highest={bulk + 112:.4g}"[:-1] in output.out
        assert np.nanmax(known.flash) == pytest.approx(112.0, rel=2e-3)
    assert output.err.count("note: thermal stresses") == 1


def test_mean_temperature_is_that_in_the_contact_of_the_instant(hot_scene, tmp_path):
    """A load that falls to a quarter halves the contact."""
    end = float(hot_scene.time[-1])
    speeds = f"speed_1 = [{hot_scene.u1}, {hot_scene.u1}]\nspeed_2 = [{hot_scene.u2}, {hot_scene.u2}]"
    table = f"[operation]\ntime = [0.0, {end!r}]\nload = [527e3, 131.75e3]\n{speeds}\n"
    path = write(tmp_path / "run.h5", hot_scene, depths=(0.0,), post=HEAT + table, edit=heated(hot_scene))
    assert main([str(path)]) == 0
    found = PostResult(tmp_path / "run.post.h5")
    s, time = found.s[found.complete["1"]], hot_scene.time[:, None]
    x, width = s + hot_scene.u1 * time, A * np.sqrt(1.0 - 0.75 * time / end)
    values = BULK[0] + rise(hot_scene, x, time, hot_scene.u1)
    mean = np.nanmean(np.where(np.abs(x) <= width, values, np.nan), axis=0)
    assert width[-1] == pytest.approx(0.5 * A) and len(s) > 50
    np.testing.assert_allclose(found.temperatures["1"].mean[found.complete["1"]], mean, atol=0.3)
    wide = np.nanmean(np.where(np.abs(x) <= A, values, np.nan), axis=0)
    assert np.abs(wide - mean).max() > 3.0


def test_missing_temperature_is_named(result, tmp_path, capsys):
    assert main([str(result(sides="2"))]) == 0
    assert 'list "temperature_1" in output.fields' in capsys.readouterr().err
    assert set(PostResult(tmp_path / "run.post.h5").temperatures) == {"2"}


def test_temperature_picture(result, tmp_path):
    main([str(result()), "--depths", "0", "0.5"])
    found = PostResult(tmp_path / "run.post.h5")
    labels = [axes.get_ylabel() for axes in damage_picture(found, "2").axes]
    assert sum(label.startswith("temperature") for label in labels) == 1
