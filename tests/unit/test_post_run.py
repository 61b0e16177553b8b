"""The command post: its result file, faults, and outputs."""

import contextlib
import io
import os
import signal
import subprocess
import sys

import h5py
import numpy as np
import pytest
from scipy.stats import spearmanr
from support import ROOT, is_line_with, refused
from support.histories import history_at
from support.made_loads import Scene, write

from ehlpetsc.commands.post import main
from ehlpetsc.pictures import damage_maps as gallery
from ehlpetsc.post import dang_van
from ehlpetsc.post import run as runner
from ehlpetsc.post.fatigue.statistics import log_life, weibull_fit
from ehlpetsc.post.loads import Loads
from ehlpetsc.post.run import Job, run
from ehlpetsc.post.stresses.body_stress import QUANTA
from ehlpetsc.results.post_result import PostResult

sys.path.append(str(ROOT / "cases" / "paper"))
import damage as figures

pytestmark = pytest.mark.usefixtures("coarse_pictures")


@pytest.fixture(scope="module")
def scene():
    return Scene(per_width=40, ratio=0.5, travel=11.0)


@pytest.fixture
def result(scene, tmp_path):
    return write(tmp_path / "run.h5", scene)


@pytest.fixture(scope="module")
def processed(scene, tmp_path_factory):
    """A result that the command has processed, and what it printed."""
    path = write(tmp_path_factory.mktemp("processed") / "run.h5", scene)
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        assert main([str(path)]) == 0
    return path, printed.getvalue()


def test_result_has_the_fixed_names(processed, scene):
    result, printed = processed
    assert "ehlpetsc post: done" in printed and "weibull of surface 2: alpha=" in printed
    with h5py.File(result.with_name("run.post.h5")) as file:
        ns = file["damage/s"].size
        for name in ("damage/2", "damage/1", "damage/2_cycles", "damage/1_peak_range"):
            assert file[name].shape == (3, ns)
        assert list(file["damage/z_over_a"]) == [0.0, 0.05, 0.5]
        assert file.attrs["slide_roll_ratio"] == pytest.approx(0.5)
        peaks = file["asperities/2_s"].size
        assert peaks == file["asperities/2_height"].size > 9
        assert file["asperities/2_damage"].shape == (3, peaks)
        for name in ("weibull/2_alpha", "weibull/2_beta", "weibull/2_r_squared"):
            assert file[name].shape == (3,) and np.isfinite(file[name]).all()

        def described(name, item):
            assert not isinstance(item, h5py.Dataset) or {"units", "long_name"} <= set(item.attrs), name

        file.visititems(described)
        passed = file["damage/2_complete"][:].astype(bool)
        assert passed.any() and not passed.all()
        assert np.isnan(file["damage/2"][:, ~passed]).all() and np.isfinite(file["damage/2"][:, passed]).all()
        s = file["damage/s"][passed]
        assert s[-1] <= scene.x[0] + 1e-12 and s[0] + scene.u2 * scene.time[-1] >= scene.x[-1] - 1e-12


def arrays(path):
    with h5py.File(path) as file:
        return {name: file[name][:] for name in ("damage/2", "damage/1", "damage/2_cycles", "weibull/2_beta")}


def test_threads_and_memory_limit_do_not_change_results(result, tmp_path, monkeypatch):
    run(Job(str(result), str(tmp_path / "one.h5")))
    run(Job(str(result), str(tmp_path / "two.h5"), jobs=2))
    monkeypatch.setattr(runner, "MAX_HISTORY_NUMBERS", 5e4)  # some tens of histories at a time
    run(Job(str(result), str(tmp_path / "small.h5")))
    one = arrays(tmp_path / "one.h5")
    for other in ("two.h5", "small.h5"):
        for name, values in arrays(tmp_path / other).items():
            rtol = 1e-6 if other == "small.h5" else 0
            np.testing.assert_allclose(values, one[name], rtol=rtol, err_msg=name)


def test_result_of_a_killed_run_is_processed(scene, tmp_path):
    """A file left in SWMR state, its datasets flushed unequally."""
    path = write(tmp_path / "killed.h5", scene)
    code = f"""
import h5py, os
with h5py.File({str(path)!r}) as old, h5py.File({str(path) + ".new"!r}, "w", libver="latest") as new:
    new.attrs.update(old.attrs); new.attrs["status"] = "running"
    for name in old: old.copy(name, new)
    del new["time"]
    new.create_dataset("time", data=old["time"][:-5], maxshape=(None,), chunks=(64,))
    new.flush(); new.swmr_mode = True; new["time"].flush(); os._exit(9)
"""
    assert subprocess.run([sys.executable, "-c", code]).returncode == 9
    message = []
    run(Job(str(path) + ".new", str(tmp_path / "out.h5")), message.append)
    assert any("running" in line for line in message)
    run(Job(str(path), str(tmp_path / "whole.h5")))
    with h5py.File(tmp_path / "out.h5") as cut, h5py.File(tmp_path / "whole.h5") as whole:
        assert 0 < cut["damage/2_complete"][:].sum() < whole["damage/2_complete"][:].sum()


def test_steady_one_frame_and_short_travel_are_refused_and_thinned_frames_warned_of(scene, tmp_path, capsys):
    assert "[time]" in refused(capsys, main, write(tmp_path / "a.h5", scene, steady=True, frames=1))
    assert "output.every = 1" in refused(capsys, main, write(tmp_path / "b.h5", scene, frames=1))
    assert "raise time.travel" in refused(capsys, main, write(tmp_path / "c.h5", scene, frames=40))
    assert main([str(write(tmp_path / "a.h5", scene, every=4))]) == 0
    message = capsys.readouterr().err
    assert "output.every = 4: peaks between frames are lost" in message


def test_a_surface_at_rest_is_named_and_a_longer_travel_not_advised(tmp_path, capsys):
    assert main([str(write(tmp_path / "a.h5", Scene(per_width=10, travel=11.0, ratio=2.0)))]) == 0
    message = capsys.readouterr().err
    assert "surface 2 is where it began: none of its points passed" in message
    assert "time.travel" not in message


def test_surface_that_did_not_pass_is_nan(scene, tmp_path, capsys):
    frames = int(1.1 * 4 * 40 / 0.5)  # surface 1 has passed, the slow one not
    assert main([str(write(tmp_path / "a.h5", scene, frames=frames))]) == 0
    message = capsys.readouterr().err
    assert "surface 2 that passed the whole contact: 0;" in message and "raise time.travel" in message
    with h5py.File(tmp_path / "a.post.h5") as file:
        assert np.isnan(file["damage/2"]).all() and np.isfinite(file["damage/1"]).any()
        assert file.attrs["surface"] == "1"


@pytest.mark.slow
def test_pictures_of_one_result_and_of_two_slide_roll_ratios(tmp_path, monkeypatch):
    scenes = {r: Scene(per_width=20, ratio=r, travel=9.0) for r in (0.5, 0.7)}
    paths = [write(tmp_path / f"{r}.h5", scene, depths=(0.0, 0.1)) for r, scene in scenes.items()]
    monkeypatch.setattr(gallery, "FORMATS", ("svg",))
    assert main([str(paths[0]), "--pictures", str(tmp_path / "out")]) == main([str(paths[1])]) == 0
    kinds = ("damage_2", "damage_1", "exceedance", "stress")
    assert {path.name for path in (tmp_path / "out").iterdir()} == {f"0.5.{kind}.svg" for kind in kinds}
    figures.main([*map(str, tmp_path.glob("*.post.h5")), "-o", str(tmp_path / "paper")])
    drawn = {path.name for path in (tmp_path / "paper").iterdir()}
    assert drawn == {"damage_ratios.png", "exceedance_z0.png", "exceedance_z0.1.png"}


@pytest.fixture(scope="module")
def judged(scene, tmp_path_factory):
    """A result with all criteria, residual stress and a distance about the peaks, as the command makes it."""
    folder = tmp_path_factory.mktemp("judged")
    residual = "residual_stress = [[0.0, -4e8], [1.0, 0.0]]"
    path = write(folder / "a.h5", scene, depths=(0.0, 0.5), post=residual)
    argv = [str(path), "--criterion", "dang-van", "fatemi-socie"]
    pictures = gallery.pictures
    with pytest.MonkeyPatch.context() as patch:  # of the pictures that of the criteria alone
        patch.setattr(gallery, "pictures", lambda *one: (p for p in pictures(*one) if "criteria" in p[0]))
        assert main([*argv, "--surface", "2", "--pictures", str(folder)]) == 0
    assert (folder / "a.criteria_2.png").is_file()
    return folder / "a.post.h5"


@pytest.mark.slow
def test_criteria_are_stored_beside_the_default_damage(judged, scene, tmp_path):
    plain = write(tmp_path / "a.h5", scene, depths=(0.0, 0.5))
    run(Job(str(plain), str(tmp_path / "plain.h5"), surfaces=("2",)))
    with h5py.File(judged) as file, h5py.File(tmp_path / "plain.h5") as other:
        np.testing.assert_array_equal(file["damage/2"], other["damage/2"])  # the paper's stays
        assert "criteria" not in other
        passed = file["damage/2_complete"][:].astype(bool)
        assert set(file["criteria"]) == {"fatemi_socie", "dang_van"}
        group = file["criteria/fatemi_socie"]
        assert (group["2_damage"][:, passed] > 0).all() and (group["2_tilt"][0, passed] > 40).all()
        assert np.isnan(group["2_damage"][:, ~passed]).all()
        assert spearmanr(file["damage/2"][0, passed], group["2_damage"][0, passed])[0] > 0.9
        assert group["2_damage"].dims[1][0] == file["damage/s"]
        use = file["criteria/dang_van/2_utilisation"][1]
        point = np.flatnonzero(passed)[10]
        with Loads(str(plain)) as loads:
            quantum = QUANTA["float32"] * loads.p0
            _, history = history_at(loads, "2", file["damage/s"][point], 0.5 * loads.a, quantum)
        assert use[point] == pytest.approx(dang_van(*history, 0.3, residual_stress=-2e8), rel=1e-6)
        assert file.attrs["residual_stress"].tolist() == [[0.0, -4e8], [1.0, 0.0]]


def test_residual_stress_without_a_mean_stress_term_is_a_note(scene, tmp_path, capsys):
    path = write(tmp_path / "a.h5", scene, depths=(0.5,), post="residual_stress = [[0.0, -4e8]]")
    assert main([str(path), "--surface", "1"]) == 0
    assert "note: residual_stress " in capsys.readouterr().err
    damages = []
    for post in ("", "residual_stress = [[0.0, 1e9], [1.0, 8e8]]"):
        path = write(tmp_path / "b.h5", scene, depths=(0.5,), post=post)
        assert main([str(path), "--surface", "1", "--mean-stress", "morrow", "--overwrite"]) == 0
        with h5py.File(tmp_path / "b.post.h5") as file:
            damages.append(np.nanmax(file["damage/1"][:]))
    assert damages[1] > 2 * damages[0] > 0


def test_pictures_use_the_body_abscissa(processed):
    """In mm from the point that was at the inlet at time 0, where a profile begins, and in um deep."""
    result, _ = processed
    found = PostResult(result.with_name("run.post.h5"))
    passed = found.s[found.complete["2"]]
    with h5py.File(result) as file:
        inlet, a = file["x"][0], file.attrs["a"]
    figure = gallery.damage_picture(found, "2")
    top, bottom, *_ = figure.axes
    assert bottom.get_xlim() == pytest.approx([1e3 * (inlet - passed[-1]), 1e3 * (inlet - passed[0])])
    (beside,) = bottom.child_axes
    assert [text.get_text() for text in beside.get_yticklabels()] == ["0", f"{5e4 * a:.3g}", f"{5e5 * a:.3g}"]
    s, z = found.worst_point("2")
    assert f"at {1e3 * (inlet - s):.4g} mm, z/a = {z:g}" in figure._suptitle.get_text()
    line = top.lines[-1].get_xydata()
    profile_s, profile_z = found.profiles["2"]
    np.testing.assert_allclose(line[:, 1], 1e6 * np.interp(inlet - 1e-3 * line[:, 0], profile_s, profile_z))
    found.attrs["speed_2"] = -1.0
    outlet = found.attrs["outlet"]
    assert gallery.along_body(found, "2", outlet + 2e-3) == pytest.approx(2.0)


def test_depth_of_the_largest_von_mises_stress_is_marked(processed):
    result, _ = processed
    found = PostResult(result.with_name("run.post.h5"))
    axes = next(a for a in gallery.field_picture(str(result), found).axes if "maximum" in a.get_title("left"))
    (mark,) = axes.lines
    (x,), (z,) = mark.get_data()
    assert 0 < z < 1.0 and abs(x) < 1.0 and f"{1e6 * z * found.a:.3g} µm deep" in axes.get_title("left")


def test_output_replaces_nothing_without_overwrite(result, scene, tmp_path, capsys):
    text = tmp_path / "notes.txt"
    text.write_text("mine")
    assert is_line_with(refused(capsys, main, result, "-o", text), f"{text}: exists", "--overwrite")
    assert is_line_with(refused(capsys, main, result, "-o", result), f"({result})", " -o")
    assert is_line_with(refused(capsys, main, result, "-o", tmp_path / "none" / "a.h5"), "folder")
    assert text.read_text() == "mine"
    assert main([str(result), "--depths", "0.5"]) == 0 and "already there" not in capsys.readouterr().err
    assert main([str(result), "--depths", "0.5"]) == 0 and "already there" in capsys.readouterr().err
    assert "--overwrite" in refused(capsys, main, result, "--depths", "0.3")
    assert main([str(result), "--depths", "0.3", "--overwrite"]) == 0
    assert PostResult(tmp_path / "run.post.h5").z.tolist() == [0.3]
    assert {path.name for path in tmp_path.iterdir()} == {"run.h5", "run.post.h5", "notes.txt"}


def test_few_asperities_have_no_weibull_fit(tmp_path, capsys):
    path = write(tmp_path / "a.h5", Scene(per_width=20, ratio=0.5, travel=4.6), depths=(0.5,))
    assert main([str(path), "--surface", "1"]) == 0
    output, found = capsys.readouterr(), PostResult(tmp_path / "a.post.h5")
    assert 1 < found.height.size < 10 and np.isnan(found.fits[0].beta)
    assert f"note: {found.height.size} asperities " in output.err and "weibull" not in output.out


def drawn_lines(under, fit=None):
    fit = fit or weibull_fit(log_life(under))
    axes = gallery.draw_distributions([("z/a = 0", under, fit)], "made up").axes[0]
    dots, line = axes.lines
    return dots, line, axes


def test_weibull_lines_say_of_poor_fits_and_their_axis_spans_twelve_decades():
    good = 10.0 ** -np.random.default_rng(1).weibull(3.0, 60)
    _, line, _ = drawn_lines(good)
    assert line.get_label() == "z/a = 0" and line.get_linestyle() == "-"
    poor = np.concatenate([np.geomspace(1e-9, 1.01e-9, 20), np.geomspace(1e-2, 1.01e-2, 20)])
    fit = weibull_fit(log_life(poor))
    assert fit.r_squared < 0.9
    _, line, _ = drawn_lines(poor)
    assert line.get_label() == f"z/a = 0, $r^2$ = {fit.r_squared:.2f}" and line.get_linestyle() == "--"
    few = np.append(np.geomspace(1e-6, 1e-3, 9), np.zeros(50))
    _, line, _ = drawn_lines(few)
    assert line.get_label() == "z/a = 0, 9 with damage: no fit" and len(line.get_xdata()) == 0
    dots, _, axes = drawn_lines(np.append(np.geomspace(1e-6, 1e-3, 40), [1e-37, 1e-20]))
    assert axes.get_xlim()[0] >= 1e-15 and dots.get_xdata().min() == pytest.approx(1e-6)


def test_title_has_the_range_of_slide_roll_ratios_over_time(scene, tmp_path):
    end, (u1, u2) = float(scene.time[-1]), (scene.u1, scene.u2)
    table = f"[operation]\ntime = [0.0, {end!r}]\nspeed_1 = [{u1}, {u2}]\nspeed_2 = [{u2}, {u1}]\n"
    path = write(tmp_path / "a.h5", scene, depths=(0.0,), post=table)
    assert main([str(path)]) == 0
    ratio = 2.0 * (u1 - u2) / (u1 + u2)
    title = gallery._ratio(PostResult(tmp_path / "a.post.h5"))
    assert title == f"slide/roll ratio {-ratio:.3g} to {ratio:.3g}"


def test_interrupt_and_write_error_leave_nothing(result, tmp_path, monkeypatch, capsys):
    with monkeypatch.context() as patch, pytest.raises(KeyboardInterrupt):
        patch.setattr(runner, "solve", lambda *_: signal.raise_signal(signal.SIGINT))
        main([str(result)])
    assert [path.name for path in tmp_path.iterdir()] == ["run.h5"]
    monkeypatch.setattr(os, "fsync", lambda file: (_ for _ in ()).throw(OSError(28, "No space left")))
    message = refused(capsys, main, result, "--depths", "0.5")
    assert "run.post.h5: not written, No space left" in message
    assert [path.name for path in tmp_path.iterdir()] == ["run.h5"]


@pytest.mark.parametrize("setting", ["post.residual=half", "post.mean_stress=goodman"])
def test_counting_keys_change_damage_and_are_recorded(setting, scene, tmp_path):
    path, key, value = write(tmp_path / "run.h5", scene), *setting.removeprefix("post.").split("=")
    damages = []
    for settings in ((), (setting,)):
        run(Job(str(path), str(tmp_path / "o.h5"), ("2",), settings=("post.depths=[0.05]", *settings)))
        damages.append(np.nanmax(PostResult(tmp_path / "o.h5").damage["2"]))
    assert PostResult(tmp_path / "o.h5").attrs[key] == value
    assert 0.01 * damages[0] < damages[1] < 0.9 * damages[0]
