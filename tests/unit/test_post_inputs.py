"""Result files refused by post-processing: wrong units, another case, missing frames, non-numbers."""

import re

import h5py
import numpy as np
import pytest
from support import is_line_with
from support.made_loads import LOAD, A, Scene, write

from ehlpetsc.case.loading import load
from ehlpetsc.errors import OutputError, PostError
from ehlpetsc.physics.scales import Scales, hertz_line
from ehlpetsc.physics.variable_operation import operation_of
from ehlpetsc.post.inputs.loads import Loads
from ehlpetsc.post.prepare import prepare
from ehlpetsc.post.run import Job, run
from ehlpetsc.results.post_result import PostResult


@pytest.fixture(scope="module")
def scene():
    return Scene(per_width=20, ratio=0.5, travel=9.0)


def refused(path, surfaces=("2", "1")):
    """Why a file is refused before anything is computed."""
    with pytest.raises((PostError, OutputError)) as fault, Loads(path) as loads:
        prepare(loads, surfaces, print)
    return str(fault.value)


def scaled(*names, by):
    """An edit that multiplies datasets or root attributes."""

    def edit(file):
        for name in names:
            if name in file:
                file[name][...] = file[name][:] * by
            else:
                file.attrs[name] = file.attrs[name] * by

    return edit


def swapped(file):
    file.attrs["u1"], file.attrs["u2"] = file.attrs["u2"], file.attrs["u1"]


def replaced(name, change):
    """An edit that puts change(values) in the place of a dataset."""

    def edit(file):
        values = change(file[name][:])
        del file[name]
        file[name] = values

    return edit


@pytest.mark.parametrize(
    "edit, message",
    [
        (scaled("pressure", by=1e-6), r"^dataset pressure: .* frame 0 .* 0\.527, .* 527000 N/m"),
        (
            scaled("pressure", by=1 / 0.999455e9),
            r"^dataset pressure: .* 0\.000527\d*, .* 527000 N/m",
        ),
        (scaled("pressure", by=1.02), r"^dataset pressure: .* frame 0 .* 537540, .* 527000 N/m"),
        (scaled("pressure", by=-1.0), r"^dataset pressure: .* frame 0 .* -527000, .* 527000 N/m"),
        (scaled("a", by=1e3), r"^attribute a = 0\.335682: .* 0\.000335682 m"),
        (scaled("a", "x", by=1e3), r"^attribute a = 0\.335682: "),
        (scaled("x", by=1e3), r"^dataset x: .* -0\.839205 .* 0\.0167841, "),
        (scaled("p0", by=1e-9), r"^attribute p0 = 0\.999455: .* 9\.99455e\+08 Pa"),
        (scaled("u1", "u2", by=1e3), r"^attribute u1 = 31250: .* 31\.25 m/s"),
        (swapped, r"^attribute u1 = 18\.75: .* 31\.25 m/s"),
        (scaled("time", by=1e3), r"^dataset time: .* 0\.000269, .* 2\.69e-07 s"),
        (scaled("time", by=1e6), r"^dataset time: .* 0\.269, .* 2\.69e-07 s"),
        (scaled("time", by=1e-6), r"^dataset time: .* 2\.69e-13, .* 2\.69e-07 s"),
        (scaled("shear_stress_1", by=1e6), "^dataset shear_stress_1: "),
        (
            lambda file: file["pressure"].attrs.__setitem__("units", "MPa"),
            '^dataset pressure: .*"MPa", .*"Pa"$',
        ),
        (lambda file: file["time"].attrs.__setitem__("units", b"us"), '^dataset time: .*"us", .*"s"$'),
        (lambda file: file["surface/2"].attrs.__setitem__("speed", 3.0), "surface/2 = 3 m/s"),
        (lambda file: file["surface/1/z"].__setitem__(7, np.nan), "^dataset surface/1/z is nan .* 7$"),
        (replaced("surface/1/z", lambda z: z[:-1]), "^datasets surface/1/s and z: "),
        (replaced("pressure", lambda p: p.astype(complex)), r"a\.h5: damaged: pressure "),
        (replaced("pressure", lambda p: p[:, :-1]), "pressure has 80 nodes, x 81"),
        (replaced("pressure", lambda p: p[0]), 'no dataset pressure .*"pressure"'),
        (replaced("time", lambda t: np.stack([t, t])), "time has 361 nodes, x 81"),
        (replaced("step", lambda s: s[::-1]), r"a\.h5: damaged, .*steps"),
        (
            lambda file: file["pressure"].__setitem__((40, 30), -2e6),
            r"^dataset pressure: .* frame 40 .* -2e\+06, .* 0 or",
        ),
        (
            lambda file: file["pressure"].__setitem__((40, 30), 1e300),
            r"^dataset pressure: .* frame 40 .*e\+295, .* 527000 N/m",
        ),
    ],
)
def test_inconsistent_result_file_is_refused(edit, message, scene, tmp_path):
    assert re.search(message, refused(write(tmp_path / "a.h5", scene, edit=edit)))


def with_steps(spoil):
    """An edit that adds the per-step figures as a run writes them, then spoils them."""

    def edit(file):
        dx = file["x"][1] - file["x"][0]
        figures = {
            "load": file["pressure"][:].sum(axis=1) * dx,
            "p_max": file["pressure"][:].max(axis=1),
            "friction": file["shear_stress_2"][:].sum(axis=1) * dx,
        }
        for name, values in figures.items():
            file[f"steps/{name}"] = values
        spoil(file)

    return edit


@pytest.mark.parametrize(
    "spoil, message",
    [
        (
            scaled("shear_stress_2", by=1e-6),
            r"^dataset shear_stress_2: .* frame 0 .* 0\.02635, .* 26350 .*steps/friction",
        ),
        (
            lambda file: file["pressure"].__setitem__((40, slice(30, 32)), [1.5e9, 0.0]),
            r"^dataset pressure: .* frame 40 .* 552176, .* 527000 N/m",
        ),
        (scaled("steps/p_max", by=1.001), "^dataset pressure: .* steps/p_max"),
    ],
)
def test_frames_must_agree_with_step_scalars(spoil, message, scene, tmp_path):
    prepare_whole = write(tmp_path / "whole.h5", scene, edit=with_steps(lambda file: None))
    with Loads(prepare_whole) as loads:
        prepare(loads, ("2",), print)
    assert re.search(message, refused(write(tmp_path / "a.h5", scene, edit=with_steps(spoil))))


def without(first, last, numbers=True):
    """An edit that takes frames first .. last-1 out; without `numbers` as if there had been no such steps."""

    def edit(file):
        for name in ("time", "step", "pressure", "shear_stress_2", "shear_stress_1"):
            replaced(name, lambda values: np.delete(values, slice(first, last), axis=0))(file)
        if not numbers:
            for name in ("step", "steps/step", "steps/time"):
                del file[name]
            file["step"] = file["steps/step"] = np.arange(file["time"].size)
            file["steps/time"] = file["time"][:]

    return edit


@pytest.mark.parametrize("numbers", [True, False], ids=["by step", "by time"])
def test_points_with_missing_frames_have_no_damage(numbers, tmp_path):
    scene = Scene(per_width=20, ratio=0.5, travel=14.0)
    whole, cut = tmp_path / "whole.h5", tmp_path / "cut.h5"
    write(whole, scene)
    frame = 60
    write(cut, scene, edit=without(frame, frame + 40, numbers))
    message = []
    for path in (whole, cut):
        run(Job(str(path), f"{path}.post", depths=(0.0, 0.5)), message.append)
    assert any(re.search(r"\b40 frames .* one place", line) for line in message)
    with h5py.File(f"{whole}.post") as a, h5py.File(f"{cut}.post") as b:
        for surface, speed in (("2", scene.u2), ("1", scene.u1)):
            passed, left = (file[f"damage/{surface}_complete"][:].astype(bool) for file in (a, b))
            place = b["damage/s"][:] + speed * scene.time[[frame - 1, frame + 40]][:, None]
            inside = (place[0] < scene.x[-1] - 1e-9) & (place[1] > scene.x[0] + 1e-9)
            assert (b[f"damage/{surface}_missed"][:] == 40 * inside).all()
            assert (left == passed & ~inside).all() and 0 < left.sum() < passed.sum()
            found = b[f"damage/{surface}"][:]
            assert np.isnan(found[:, ~left]).all()
            np.testing.assert_allclose(found[:, left], a[f"damage/{surface}"][:, left], rtol=1e-6)


def test_refused_if_every_point_misses_frames(scene, tmp_path):
    def every_tenth(file):
        keep = np.arange(scene.time.size) % 10 != 9
        for name in ("time", "step", "pressure", "shear_stress_2", "shear_stress_1"):
            replaced(name, lambda values: values[keep])(file)

    message = refused(write(tmp_path / "a.h5", scene, edit=every_tenth))
    count = (scene.time.size - 1) // 10
    assert is_line_with(message, f"{count} frames ", f" {count} places, ", " 8, ", "no damage")


def test_history_contains_every_sample_of_every_point(scene, tmp_path):
    """As many as the sweep counts, also where a frame finds the point at the first node but for rounding."""
    from ehlpetsc.post.stresses.body_stress import history_at

    path = write(tmp_path / "a.h5", scene)
    run(Job(str(path), str(tmp_path / "o.h5"), surfaces=("2",), depths=(0.0,)))
    result = PostResult(tmp_path / "o.h5")
    with Loads(path) as loads:
        motion = prepare(loads, ("2",), print).motions["2"]
        for j in np.flatnonzero(result.complete["2"])[::9]:
            time, values = history_at(loads, "2", result.s[j], 0.0)
            assert time.size == motion.leave[j] - motion.enter[j] + 1 == values.shape[1] - 2
            assert time[0] == loads.time[motion.enter[j]]


def test_picture_point_must_have_passed(scene, tmp_path):
    from ehlpetsc.pictures.damage import history_picture

    path = write(tmp_path / "a.h5", scene)
    run(Job(str(path), str(tmp_path / "o.h5"), depths=(0.0,)))
    result = PostResult(tmp_path / "o.h5")
    allowed = result.s[result.complete[result.main]] / A
    history_picture(path, result, (allowed[-1], 0.0))
    for s in (0.0, allowed[-1] + 0.1, allowed[0] - 0.1):  # began inside the contact, did not go through it
        with pytest.raises(PostError, match=f"--point s/a = .* {allowed[0]:.6g} to {allowed[-1]:.6g} "):
            history_picture(path, result, (s, 0.0))


def of_fixed_length(file):
    """As the solver writes: texts of a fixed length, check sums, what a pass has left on a surface."""
    for name, value in file.attrs.items():
        if isinstance(value, str):
            file.attrs[name] = np.bytes_(value.encode())
    for name in ("pressure", "shear_stress_2"):
        values = file[name][:]
        del file[name]
        file.create_dataset(name, data=values, chunks=(8, values.shape[1]), fletcher32=True)
        file[name].attrs["units"] = np.bytes_(b"Pa")
    file["surface/2/set"] = 1e-9 * np.ones(file["surface/2/z"].shape)


def test_text_types_and_checksums_are_read(scene, tmp_path):
    paths = [write(tmp_path / f"{k}.h5", scene, edit=edit) for k, edit in enumerate((None, of_fixed_length))]
    digests = []
    for path in paths:
        with Loads(path) as loads:
            assert loads.title == "made up" and loads.status == "done"
            digests.append(prepare(loads, ("2",), print).digest)
    assert digests[0] == digests[1]
    with h5py.File(paths[1], "r+") as file:
        file["pressure"].attrs["units"] = np.bytes_(b"MPa")
    assert is_line_with(refused(paths[1]), "dataset pressure: ", '"MPa"', '"Pa"')


@pytest.mark.parametrize("table", ["file", "columns"])
def test_points_follow_surface_positions_under_changing_speeds(table, scene, tmp_path):
    """Damage is of the positions alone: the same frames at other times give the same."""
    count = scene.time.size
    warped = scene.time[-1] * (scene.time / scene.time[-1]) ** 1.3
    file_text = 'file = "elsewhere.csv"'
    columns = (
        f"time = {warped[[0, count // 2, -1]].tolist()}\nload = [{LOAD}, {LOAD}, {LOAD}]\n"
        f"speed_1 = [{scene.u1}, {scene.u1}, {scene.u1}]\nspeed_2 = [{scene.u2}, {scene.u2}, {scene.u2}]"
    )

    def edit(file):
        case = file.attrs["case"].replace("load = 527e3\n", "")
        case = case.replace(case[case.index("[motion]") : case.index("[mesh]")], "")
        operation = file_text if table == "file" else columns
        file.attrs["case"] = f"{case}\n[operation]\n{operation}\n"
        for name in ("time", "steps/time"):
            file[name][...] = warped
        for name, speed in (("displacement_1", scene.u1), ("displacement_2", scene.u2)):
            file[f"steps/{name}"] = speed * scene.time
        file["steps/load_given"] = np.full(count, LOAD)

    paths = [write(tmp_path / "a.h5", scene), write(tmp_path / "b.h5", scene, edit=edit)]
    found = []
    for path in paths:
        run(Job(str(path), f"{path}.post", depths=(0.0, 0.5)))
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
        pressure.append(p * now.load / (p.sum() * scales.dx))
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
    run(Job(str(tmp_path / "a.h5"), str(tmp_path / "o.h5"), depths=(0.5,)))
    found = PostResult(tmp_path / "o.h5")
    for side in found.surfaces:
        damage = found.passed(side)
        assert damage.shape[1] * scales.dx > 0.9 * abs(ways[-1]).min() and np.isfinite(damage).all()
        assert damage.max() > 1e-9
