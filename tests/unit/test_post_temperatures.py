"""Surface temperatures of body points from stored temperatures of known form."""

import numpy as np
import pytest
from support.made_loads import A, Scene, write

from ehlpetsc.pictures.damage_maps import damage_picture
from ehlpetsc.post.command import main
from ehlpetsc.results.post_result import PostResult

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
def scene():
    return Scene(per_width=40, ratio=0.5, travel=8.5)


def rise(scene, x, time, speed):
    """Warmer towards x = a/2, times a ripple of ten nodes that the body carries."""
    phase = 2 * np.pi * (x - speed * time) / (WAVE * scene.dx)
    return 80.0 * np.exp(-((x / A - 0.5) ** 2)) * (1.0 + SHARE * np.cos(phase))


def temperatures(scene, side):
    speed, bulk = (scene.u1, BULK[0]) if side == "1" else (scene.u2, BULK[1])
    return bulk + rise(scene, scene.x, scene.time[:, None], speed)


def heated(scene, sides="12"):
    """For `write`: add temperatures."""

    def edit(file):
        for side in sides:
            values = temperatures(scene, side)
            file.create_dataset(f"temperature_{side}", data=values, chunks=(8, scene.x.size))

    return edit


@pytest.fixture
def result(scene, tmp_path):
    def made(sides="12"):
        return write(tmp_path / "run.h5", scene, depths=(0.0,), post=HEAT, edit=heated(scene, sides))

    return made


def test_highest_mean_and_flash_temperature(scene, result, tmp_path, capsys):
    assert main([str(result())]) == 0
    output = capsys.readouterr()
    found = PostResult(tmp_path / "run.post.h5")
    for side, bulk in zip("12", BULK, strict=True):
        s, known = found.s[found.complete[side]], found.temperatures[side]
        carried = 1.0 + SHARE * np.cos(2 * np.pi * s / (WAVE * scene.dx))
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


def test_mean_temperature_is_that_in_the_contact_of_the_instant(scene, tmp_path):
    """A load that falls to a quarter halves the contact."""
    end = float(scene.time[-1])
    speeds = f"speed_1 = [{scene.u1}, {scene.u1}]\nspeed_2 = [{scene.u2}, {scene.u2}]"
    table = f"[operation]\ntime = [0.0, {end!r}]\nload = [527e3, 131.75e3]\n{speeds}\n"
    path = write(tmp_path / "run.h5", scene, depths=(0.0,), post=HEAT + table, edit=heated(scene))
    assert main([str(path)]) == 0
    found = PostResult(tmp_path / "run.post.h5")
    s, time = found.s[found.complete["1"]], scene.time[:, None]
    x, width = s + scene.u1 * time, A * np.sqrt(1.0 - 0.75 * time / end)
    values = BULK[0] + rise(scene, x, time, scene.u1)
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
