"""Post-processing of planes, against the line contact and against stresses of the half-space."""

import h5py
import numpy as np
import pytest
from support.made_loads import A, Scene, write
from support.made_planes import FRICTION, sphere, write_plane

from ehlpetsc.commands.post import main
from ehlpetsc.pictures import damage_maps as gallery
from ehlpetsc.post import damage, dang_van, stress_plane
from ehlpetsc.post.criteria import critical_plane
from ehlpetsc.post.criteria.critical_plane import count_on_planes
from ehlpetsc.post.criteria.dang_van import count_utilisation
from ehlpetsc.post.criteria.planes import Criteria
from ehlpetsc.post.fatigue.accumulate import count_damage
from ehlpetsc.post.fatigue.statistics import asperities
from ehlpetsc.post.fatigue.strain_life import Material
from ehlpetsc.post.loads import Loads, prepare
from ehlpetsc.post.run import Job, histories, run
from ehlpetsc.post.stresses import block_stress
from ehlpetsc.post.stresses.block_stress import ORDER, BlockStress
from ehlpetsc.post.stresses.body_stress import offset_weights
from ehlpetsc.results.post_result import PostResult

NU = 0.3


@pytest.mark.parametrize("periodic", [False, True])
def test_stresses_between_the_nodes(periodic):
    """Of a load smooth along x, against a mesh twenty times as fine; across both are linear."""
    nx, ny, fine, step = 41, 12, 20, 7
    y = 0.7 * np.arange(ny)
    depths = [0.0, 0.5, 3.0]

    def load(x):
        across = 2 * np.pi * np.arange(ny)[:, None] / ny
        jumps = np.random.default_rng(1).uniform(size=(ny, 1))
        return np.exp(-(((x - 20) / 5) ** 2)) * (jumps + 0.5 * np.cos(across + 1))

    x = np.arange((nx - 1) * fine + 1) / fine
    expected = stress_plane(x, y, depths, load(x), 0.2 * load(x), NU, periodic=periodic)
    block = BlockStress(ny, nx, 0.7, np.array(depths), NU, periodic)
    p = load(np.arange(nx))[None]
    for depth in range(3):
        weights = offset_weights(np.array([step / fine]))
        found = block(depth, block.transform(p, 0.2 * p), weights)[0, :, :, : nx - 1]
        for part, field in enumerate(found):
            assert field == pytest.approx(expected[ORDER[part]][depth][:, step::fine], abs=1e-4), part


@pytest.fixture(scope="module")
def scene():
    return Scene(per_width=12, ratio=0.5, travel=7.5, ripple=1e6)


def test_strip_of_ridges_is_the_line(scene, tmp_path):
    y = 0.1 * A * np.arange(3)
    p = np.repeat(scene.pressures[:, None], 3, axis=1)
    write(tmp_path / "line.h5", scene)
    write_plane(tmp_path / "strip.h5", scene, "strip", y, p)
    for name in ("line", "strip"):
        paths, shares = [str(tmp_path / f"{name}{end}") for end in (".h5", ".post.h5")], []
        run(Job(*paths, criteria=("dang-van",)), show=shares.append)
    assert 0.0 < shares[0] < 0.1 and shares[-1] == pytest.approx(1.0) and (np.diff(shares) > 0.0).all()
    line, strip = PostResult(tmp_path / "line.post.h5"), PostResult(tmp_path / "strip.post.h5")
    assert strip.y == pytest.approx(y) and strip.damage["1"].shape == (3, 3, line.s.size)
    for side in ("1", "2"):
        for row in range(3):
            criteria = (one.criteria["dang-van"][side] for one in (strip, line))
            for found, expected in ((strip.damage[side], line.damage[side]), criteria):
                assert found[:, row] == pytest.approx(expected, rel=2e-5, nan_ok=True)


def test_history_of_a_body_point(scene, tmp_path):
    y, fine = scene.x[18:31] - scene.x[24], 20

    def load(x):
        return 1e9 * np.exp(-12 * ((x - A / 2) ** 2 + y[:, None] ** 2) / A**2)

    p = np.broadcast_to(load(scene.x), (scene.time.size, y.size, scene.x.size))
    path = write_plane(tmp_path / "point.h5", scene, "point", y, p)
    with Loads(path) as loads:
        motion = prepare(loads, ("2",), lambda text: None).motions["2"]
        block = BlockStress(y.size, scene.x.size, 1.0, np.array([0.0, 2.0]), NU, False)
        points = np.flatnonzero(motion.complete)[:2]
        found = histories(loads, "2", motion, block, points, 0.0, float)
    places = points[1] + motion.shift + motion.offset
    frame = np.argmin(np.abs(places - 33.4))  # by the edge of the contact
    sample = frame - motion.enter[points[1]] + 1
    x = scene.x[0] + scene.dx * (places[frame] + np.arange(-15 * fine, 15 * fine + 1) / fine)
    fields = stress_plane(x, y, [0.0, 2.0 * scene.dx], load(x), FRICTION * load(x), NU)
    for part in range(6):
        expected = fields[ORDER[part]][:, :, 15 * fine]
        assert found[:, 1, :, part, sample] == pytest.approx(expected, abs=2e-4 * 1e9), part
    assert not found[..., 0].any() and found.shape[-2] == 6


def test_command_on_a_point(scene, tmp_path, capsys):
    y = scene.x[14:35] - scene.x[24]
    p = np.broadcast_to(sphere(scene, y), (scene.time.size, y.size, scene.x.size))
    s = scene.profiles["1"][0]
    waves = {side: 1e-7 * np.cos(s / 1e-5) * np.cos(y[:, None] / 5e-5) for side in ("1", "2")}
    path = write_plane(tmp_path / "point.h5", scene, "point", y, p, waves, depths=(0.0, 0.1, 0.2, 0.3))
    assert main([str(path), "--surface", "1"]) == 0
    assert "ehlpetsc post: done" in capsys.readouterr().out
    with h5py.File(tmp_path / "point.post.h5") as file:
        values, passed = file["damage/1"][:], file["damage/1_complete"][:].astype(bool)
        assert values.shape == (4, y.size, file["damage/s"].size)
        assert np.isfinite(values[..., passed]).all() and np.isnan(values[..., ~passed]).all()
        shown = values[..., passed].mean(axis=-1)
        assert shown == pytest.approx(shown[:, ::-1], rel=1e-3)
        assert shown[1, 10] > 100 * shown[1, 0]
        assert [scale.label for scale in file["damage/1"].dims] == ["", "", ""]
        assert file["damage/1"].dims[1][0] == file["damage/y"]
        height, across = file["asperities/1_height"][:], file["asperities/1_y"][:]
        assert height.size == file["asperities/1_damage"].shape[1] > 9
        assert height == pytest.approx(np.full(height.size, 1e-7), rel=0.05)
        nearest = np.rint(across / (np.pi * 5e-5)) * np.pi * 5e-5
        assert across == pytest.approx(nearest, abs=0.51 * (y[1] - y[0]))


def test_temperatures_of_a_plane(scene, tmp_path):
    y = scene.x[20:29] - scene.x[24]
    p = np.broadcast_to(sphere(scene, y), (scene.time.size, y.size, scene.x.size))
    rise = np.arange(y.size)[:, None] * np.exp(-((scene.x / A) ** 2))
    heat = '[heat]\nbulk_temperature = [350.0, 360.0]\n[fluid]\nviscosity = 0.005\nlaw = "barus"\n'
    heat += 'pressure_viscosity = 11.1e-9\ndensity = "incompressible"\n'
    extra = {"temperature_1": np.broadcast_to(350.0 + rise, p.shape)}
    path = write_plane(tmp_path / "hot.h5", scene, "point", y, p, extra=extra, depths=(0.0,), post=heat)
    run(Job(str(path), str(tmp_path / "hot.post.h5"), ("1",)))
    result = PostResult(tmp_path / "hot.post.h5")
    flash = result.temperatures["1"].flash[:, result.complete["1"]]
    assert flash == pytest.approx(np.tile(np.arange(y.size)[:, None], flash.shape[1]), abs=0.05)
    section = result.section(y[3])
    assert section.temperatures["1"].flash[section.complete["1"]] == pytest.approx(flash[3])


def wave_map(ny, ns):
    s, y = np.arange(ns) * 1.0, np.arange(ny) * 1.0
    return s, np.sin(2 * np.pi * s / 20) * np.sin(2 * np.pi * (y[:, None] + 5) / 20)


@pytest.mark.parametrize("periodic, count", [(True, 20), (False, 15)])
def test_asperities_are_local_maxima(periodic, count):
    """Two a period along and across; that on row 0 counts across a period; ripples below 0.1 Rq do not."""
    s, z = wave_map(40, 120)
    z += 0.01 * np.cos(np.pi * s)
    grid = np.arange(-20.0, 140.0)
    peaks = asperities((s, z), grid, (grid > 9) & (grid < 111), np.ones(40, bool), periodic)
    assert peaks.s.size == count
    assert grid[peaks.point] == pytest.approx(peaks.s)
    assert z[peaks.row, peaks.s.astype(int)] == pytest.approx(peaks.height) and peaks.height.min() > 0.9


def random_histories(seed):
    line = np.random.default_rng(seed).normal(size=(4, 3, 40)) * 5e8
    sx, sz, txz = np.moveaxis(line, 1, 0)
    zero = np.zeros_like(sx)
    return line, np.stack([sx, sz, txz, NU * (sx + sz), zero, zero], axis=1)


def rotated(six, angle):
    """The same histories in axes turned about z."""
    sx, sz, txz, sy, txy, tyz = np.moveaxis(six, 1, 0)
    c, s = np.cos(angle), np.sin(angle)
    tensor = np.array([[sx, txy, txz], [txy, sy, tyz], [txz, tyz, sz]])
    turn = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    t = np.einsum("ia,jb,ab...->ij...", turn, turn, tensor)
    return np.stack([t[0, 0], t[2, 2], t[0, 2], t[1, 1], t[0, 1], t[1, 2]], axis=1)


@pytest.mark.parametrize("mean_stress", ["none", "goodman"])
def test_six_components_of_plane_strain_are_three(mean_stress):
    line, six = random_histories(1)
    steel = Material()
    expected = damage(*np.moveaxis(line, 1, 0), steel, mean_stress=mean_stress)
    found = count_damage(six, np.full(4, 40), 0.0, steel, mean_stress, "neuber", "repeat")
    assert found.T == pytest.approx(np.array(expected), rel=1e-6)


def test_criteria_of_six_components_are_those_of_three_in_any_axes():
    line, six = random_histories(2)
    expected = dang_van(*np.moveaxis(line, 1, 0), NU)
    for angle in (0.0, 0.4, np.pi / 2):
        turned = np.ascontiguousarray(rotated(six, angle))
        found = count_utilisation(turned, np.full(4, 40), 0.0, NU, Criteria())
        assert found[:, 0] == pytest.approx(expected, rel=1e-7)
    line, six = random_histories(3)
    constants = {"material": Material(), "constants": Criteria(), "strain": "neuber"}
    expected = count_on_planes(line, np.full(4, 40), 0.0, **constants)[:, 0]
    for angle in (0.0, 0.5):
        turned = np.ascontiguousarray(rotated(six, angle))
        found = count_on_planes(turned, np.full(4, 40), 0.0, **constants)[:, 0]
        assert found == pytest.approx(expected, rel=0.05)
    assert (expected > 0).all()


@pytest.mark.usefixtures("coarse_pictures")
def test_pictures_of_a_plane(scene, tmp_path, capsys, monkeypatch):
    figures, save = {}, gallery.style.save
    monkeypatch.setattr(
        gallery.style, "save", lambda of, *to: (figures.update({to[0].split(".")[-2]: of}), save(of, *to))
    )
    y = scene.x[18:31] - scene.x[24]
    p = np.broadcast_to(sphere(scene, y), (scene.time.size, y.size, scene.x.size))
    path = write_plane(tmp_path / "point.h5", scene, "point", y, p, depths=(0.0, 0.1, 0.2, 0.3))
    assert main([str(path), "--surface", "2", "--pictures", str(tmp_path), "--weibull"]) == 0
    drawn = {name.name for name in tmp_path.glob("*.png")}
    kinds = ("damage_map_2", "damage_2", "exceedance", "stress", "weibull")
    assert drawn == {f"point.{kind}.png" for kind in kinds}
    assert set(capsys.readouterr().out.split()) >= {str(tmp_path / name) for name in drawn}
    result = PostResult(tmp_path / "point.post.h5")
    for kind, figure in figures.items():
        assert figure._suptitle.get_text().startswith("made up\n"), kind
    for kind in ("damage_map_2", "weibull"):
        shown = [axes for axes in figures[kind].axes[:6] if axes.get_visible()]
        assert len(shown) in (4, 5)  # of four depths, with the heights
        for axes in shown[-3:]:  # the last of their columns
            assert axes.xaxis.get_major_ticks(1)[0].label1.get_visible(), kind
    section = result.section(result.worst_row("2"))
    assert np.nanmax(section.damage["2"]) == np.nanmax(result.damage["2"])
    assert section.worst_point("2") == result.worst_point("2")
    assert abs(section.section_y) < A / 4  # under the middle of the sphere


def test_planes_are_sought_where_the_damage_is_worst(scene, tmp_path, monkeypatch):
    """The worst hundredth of a rippled strip is that of a search everywhere; elsewhere is a lower bound."""
    monkeypatch.setattr(critical_plane, "MIN_SOUGHT", 1)
    y, rng = scene.dx * np.arange(12), np.random.default_rng(4)
    p = scene.pressures[:, None] * (1 + 0.3 * rng.uniform(-1, 1, size=(12, scene.x.size)))
    path = write_plane(tmp_path / "strip.h5", scene, "strip", y, p, depths=(0.05,))
    found = []
    for share in (0.01, 1.0):
        output = tmp_path / f"{share}.post.h5"
        run(Job(str(path), str(output), ("1",), criteria=("fatemi-socie",), share=share))
        result = PostResult(output)
        found.append(result.criteria["fatemi-socie"]["1"][0][:, result.complete["1"]].ravel())
    some, everywhere = found
    worst = np.argsort(everywhere)[-(everywhere.size // 100) :]
    assert worst.size > 3 and some[worst] == pytest.approx(everywhere[worst], rel=5e-3)
    assert np.count_nonzero(some < everywhere) > 0.3 * everywhere.size
    assert (some < 1.1 * everywhere).all() and np.median(some / everywhere) > 0.8


def test_far_kernels_are_those_of_the_cubics():
    """From eight elements on, nine hats on the nodes replace the 127 of a cubic."""
    reach, y = block_stress.HAT_REACH, np.arange(3.0)
    distance = np.arange(block_stress.NEAR_ELEMENTS, 20)
    wider = np.arange(distance[0] - reach, distance[-1] + reach + 1.0)
    for z, offset in ((0.0, 0.345), (4.0, 0.095)):
        found = block_stress._far(block_stress.hat_kernels(wider, y, z, NU), offset)
        expected = block_stress._near(distance, y, z, NU, offset)
        assert found == pytest.approx(expected, abs=5e-7)
