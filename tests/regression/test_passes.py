"""Repeated passes: files, index, restart within a pass, refused input."""

import json
import os

import numpy as np
import pytest
from support import CASES, is_line_with
from support.running import SCRIPT, called, command, run, settings

from ehlpetsc.case.loading import load
from ehlpetsc.results.output_guard import Lock
from ehlpetsc.results.reader import read_result
from ehlpetsc.run.simulation import Simulation

CASE = CASES / "running_in.toml"
SHORT = """mesh.points_per_half_width=20 time.travel=0.6 time.passes=2 time.pass_shift=0.0
contact.yield_pressure=0.95e9 output.every=1""".split()
BRIEF = settings(*SHORT)


def test_pass_index_is_locked_by_one_run(tmp_path):
    """A second run of passes names the first run."""
    lock = Lock(tmp_path / "running_in.passes.json")
    lock.acquire()
    second = run(CASE, *settings(*SHORT), "--overwrite", cwd=tmp_path)
    assert second.returncode == 2
    (message,) = second.stderr.splitlines()
    assert message.startswith("ehlpetsc: running_in.passes.json: ")
    assert f" process {os.getpid()} on " in message
    assert [path.name for path in tmp_path.iterdir()] == ["running_in.passes.json.lock"]
    lock.release()
    assert not list(tmp_path.iterdir())


def test_shifted_pass_offsets_one_profile():
    keys = [*SHORT, "time.pass_shift=50e-6"]
    first = Simulation(load(CASE, keys))
    list(first)
    shifted = Simulation(load(CASE, keys), after=first)
    for side, moved in (("1", 0.0), ("2", 50e-6)):
        one, other = (s.roughness.side(side) for s in (first, shifted))
        at = other.s[20:-200]
        inner = at[np.abs(at - other.s[-1]) > 0.2 * shifted.scales.a]
        np.testing.assert_allclose(other.height(inner), one.height(inner - moved), atol=1e-12)


def test_series_of_passes_is_refused(tmp_path):
    done = run(CASES / "fig1.toml", *settings("time.passes=2"), cwd=tmp_path)
    assert done.returncode == 2 and is_line_with(done.stderr, "fig1.toml: [series] and time.passes: ")


def test_body_displacement_below_the_profile_spacing(tmp_path):
    short = ("motion.slide_roll_ratio=1.99", "time.travel=0.1", "mesh.points_per_half_width=20")
    done = run(CASE, *settings("time.passes=1", *short, "contact.yield_pressure=1.1e9"), cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    with read_result(tmp_path / "running_in.h5") as result:
        assert result.attrs["status"] == "done"
        points = [result[f"surface/2/{name}"][:] for name in ("s", "z", "set")]
        assert [len(values) for values in points] == [2, 2, 2]
        moved = result.attrs["u2"] * result.steps("time")[-1]
        assert moved < np.diff(points[0])[0]


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory):
    """Folder of two passes of 24 steps each."""
    folder = tmp_path_factory.mktemp("passes")
    done = run(CASE, *BRIEF, cwd=folder)
    assert done.returncode == 0, done.stderr
    return folder


def test_every_pass_has_a_result_and_an_index_entry(tmp_path):
    longer = settings("mesh.points_per_half_width=40", "time.travel=1.2", "contact.yield_pressure=1.1e9")
    done = run(CASE, *BRIEF, *longer, cwd=tmp_path)
    assert done.returncode == 0 and "pass 2 of 2" in done.stdout, done.stderr
    rows = json.loads((tmp_path / "running_in.passes.json").read_text())["passes"]
    assert [row["file"] for row in rows] == ["running_in.pass1.h5", "running_in.pass2.h5"]
    assert rows[0]["added"] > 0.0 and rows[1]["added"] < 0.5 * rows[0]["added"]
    for row in rows:
        with read_result(tmp_path / row["file"]) as result:
            volumes = result.steps("set_volume")
            assert volumes[-1] == pytest.approx(row["set_volume"], rel=1e-12)
            laid = sum(
                (result[f"surface/{side}/set"][:] * np.gradient(result[f"surface/{side}/s"][:])).sum()
                for side in ("1", "2")
            )
            # its points reach as far as the profile does: the smooth surface ahead of it yields too
            assert 0.5 * volumes[-1] < laid < volumes[-1]
            assert row["1"]["deepest"] == result["surface/1/set"][:].max()
    assert volumes[0] == pytest.approx(rows[0]["set_volume"], rel=1e-12)  # the second begins with the first's


def assert_as_uninterrupted(folder, whole):
    one, other = (json.loads((place / "running_in.passes.json").read_text()) for place in (folder, whole))
    assert one["case"] == other["case"] and [row["pass"] for row in one["passes"]] == [1, 2]
    for row, expected in zip(one["passes"], other["passes"], strict=True):
        assert row["set_volume"] == pytest.approx(expected["set_volume"], rel=1e-9) and row["added"] > 0.0
        with read_result(folder / row["file"]) as a, read_result(whole / row["file"]) as b:
            np.testing.assert_allclose(a.pressure, b.pressure, rtol=0.0, atol=1e-9 * a.attrs["p0"])
            assert a.attrs["status"] == "done" and list(a.step) == list(b.step)


@pytest.mark.parametrize("accident", [("SIGKILL@2", 0, 3), ("SIGKILL@1", 0, 9), ("SIGTERM@2", 0, 9)])
def test_same_command_continues_interrupted_passes(tmp_path, uninterrupted, accident):
    often = settings("output.checkpoint=1e-5") if accident[0] == "SIGKILL@1" else []
    ended = run(CASE, *BRIEF, *often, cwd=tmp_path, tampered=accident)
    assert ended.returncode == (4 if accident[0][:7] != "SIGKILL" else -9)
    done = run(CASE, *BRIEF, *often, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    restarted = done.stdout.index("restart: running_in.pass")
    assert restarted < done.stdout.index("ehlpetsc: done")
    if not often:
        assert_as_uninterrupted(tmp_path, uninterrupted)


def copied(folder, place, *left_out):
    for path in folder.iterdir():
        if path.name not in left_out:
            (place / path.name).write_bytes(path.read_bytes())


def test_lost_pass_index_is_rewritten(tmp_path, uninterrupted):
    copied(uninterrupted, tmp_path, "running_in.passes.json")
    done = run(CASE, *BRIEF, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "restart: running_in.pass1.restart.h5, step 11, " in done.stdout
    assert_as_uninterrupted(tmp_path, uninterrupted)


def test_additional_passes_continue_from_the_last_one(tmp_path, uninterrupted):
    copied(uninterrupted, tmp_path)
    more = [*BRIEF, *settings("time.passes=3"), "--restart", "running_in.pass2.restart.h5"]
    done = run(CASE, *more, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    rows = json.loads((tmp_path / "running_in.passes.json").read_text())["passes"]
    assert [row["pass"] for row in rows] == [1, 2, 3]
    assert rows[2]["set_volume"] > rows[1]["set_volume"]


def test_passes_killed_while_writing_the_index_are_completed(tmp_path, uninterrupted):
    assert run(CASE, *BRIEF, cwd=tmp_path, tampered=("index", 0, 2)).returncode == -9
    assert [
        row["pass"] for row in json.loads((tmp_path / "running_in.passes.json").read_text())["passes"]
    ] == [1]
    assert [path for path in tmp_path.iterdir() if path.name.startswith(".tmp")]
    done = run(CASE, *BRIEF, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "pass 1 of 2" not in done.stdout
    assert_as_uninterrupted(tmp_path, uninterrupted)
    assert not [path.name for path in tmp_path.iterdir() if path.suffix == ".lock" or path.name[0] == "."]


@pytest.mark.parametrize("case", [CASE, CASES / "stribeck.toml"])
def test_read_only_folder_is_refused(tmp_path, case):
    """Root writes everywhere but without one capability; another user could not read a private clone."""
    (tmp_path / "out").mkdir(mode=0o500)
    as_user = ["setpriv", "--bounding-set", "-dac_override"] if os.getuid() == 0 else []
    words = [*settings("mesh.points_per_half_width=20", "time.travel=0.2"), "--output", "out/r.h5"]
    cache = {"NUMBA_CACHE_DIR": str(tmp_path)}
    done = called([*as_user, *command(case, *words)], tmp_path, SCRIPT | cache)
    assert done.returncode == 2 and "Permission denied" in done.stderr, done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert not list((tmp_path / "out").iterdir())
