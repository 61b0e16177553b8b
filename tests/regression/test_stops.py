"""Failures, stops and restarts: files stay readable, and a restarted run equals an uninterrupted one."""

import json
import re

import numpy as np
import pytest
from support import ROOT, is_line_with
from support.running import SHORT, called, command, run, settings, summary

from ehlpetsc.analysis.compare import compare
from ehlpetsc.results.reader import read_result

CASE = [ROOT / "cases" / "table1_rough.toml", *settings(*SHORT)]
BRIEF = settings("mesh.points_per_half_width=8", "time.travel=0.5", "time.courant=0.4")
BALL = [ROOT / "cases" / "ball.toml", *BRIEF]


@pytest.fixture(scope="session")
def whole(tmp_path_factory):
    """Folder of an uninterrupted run; its output is in the file "log"."""
    folder = tmp_path_factory.mktemp("whole")
    done = run(*CASE, cwd=folder)
    assert done.returncode == 0, done.stderr
    (folder / "log").write_text(done.stdout)
    return folder


def assert_equal(one, other, rtol=1e-9):
    with read_result(one) as a, read_result(other) as b:
        assert len(a.time) == len(b.time)
        apart = [d.name for d in compare(a, b) if not d.same(rtol)]
        assert not apart
        np.testing.assert_array_equal(a.contact_count, b.contact_count)
        # the last digits, which depend on the ranks, may tip a residual over its tolerance
        assert np.abs(a.steps("newton") - b.steps("newton")).max() <= 1


def last_step(path):
    with read_result(path) as result:
        return int(result.steps("step")[-1]), result.attrs["status"]


@pytest.mark.slow
@pytest.mark.parametrize("name, ranks, others, step", [("SIGTERM", 2, 0, 10), ("SIGINT", 0, 0, 20)])
def test_run_stopped_by_a_signal_restarts_on_other_ranks(whole, tmp_path, name, ranks, others, step):
    stopped = run(*CASE, cwd=tmp_path, ranks=ranks, tampered=(name, max(ranks - 1, 0), step))
    assert stopped.returncode == 4, stopped.stderr
    assert f" step {step}; " in stopped.stdout
    assert " --restart table1_rough.restart.h5" in stopped.stdout
    assert last_step(tmp_path / "table1_rough.h5") == (step, "stopped")
    going_on = [*CASE, "--restart", "table1_rough.restart.h5"]
    done = run(*going_on, cwd=tmp_path, ranks=others)
    assert done.returncode == 0, done.stderr
    assert f"restart: table1_rough.restart.h5, step {step}, " in done.stdout
    assert_equal(whole / "table1_rough.h5", tmp_path / "table1_rough.h5")
    figures, expected = summary(done.stdout), summary((whole / "log").read_text())
    for figure, rtol in {"steps": 0, "newton": 0.02, "h_min": 1e-8, "p_max": 1e-8, "contacts": 0}.items():
        assert float(figures[figure]) == pytest.approx(float(expected[figure]), rel=rtol)
    with read_result(tmp_path / "table1_rough.h5") as result:
        assert result.attrs["restarts"] == 1
        assert result.attrs["ranks"] == max(others, 1)
        (earlier,) = json.loads(result.attrs["history"])
        assert earlier["ranks"] == max(ranks, 1) and earlier["up_to_step"] == step


def test_error_on_one_rank_aborts_all_with_its_traceback(tmp_path):
    done = run(*CASE, cwd=tmp_path, ranks=2, tampered=("raise", 1, 5))
    assert done.returncode == 1
    assert "ValueError: an accident" in done.stderr
    assert done.stderr.count("Traceback") == 1
    assert "tampered.py" in done.stderr


@pytest.mark.slow
def test_killed_run_restarts_from_its_last_checkpoint(whole, tmp_path):
    often = [*CASE, *settings("output.checkpoint=1e-5")]
    killed = run(*often, cwd=tmp_path, tampered=("SIGKILL", 0, 11))
    assert killed.returncode not in (0, 4)
    assert last_step(tmp_path / "table1_rough.h5") == (10, "running")
    done = run(*often, "--restart", "table1_rough.restart.h5", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "step 10, " in done.stdout
    assert_equal(whole / "table1_rough.h5", tmp_path / "table1_rough.h5")
    assert [p.name for p in tmp_path.iterdir() if p.name.startswith(".tmp")] == []


@pytest.mark.parametrize(
    "case, ranks", [(CASE, 0), (BALL, 0), (CASE, 2)], ids=["line", "point", "line on two ranks"]
)
def test_time_limit_writes_a_restart_file(tmp_path, case, ranks):
    late = "late", max(ranks - 1, 0), 5
    done = run(*case, "--time-limit", "100", cwd=tmp_path, ranks=ranks, tampered=late)
    assert done.returncode == 4
    # the limit is long over in step 5, which is not waited for
    assert last_step(tmp_path / f"{case[0].stem}.h5") == (4, "stopped")
    assert (tmp_path / f"{case[0].stem}.restart.h5").exists()


@pytest.mark.parametrize("case, ranks", [(CASE, 2), (BALL, 0)], ids=["ranks", "point"])
def test_time_limit_ends_the_steady_start(tmp_path, case, ranks):
    done = run(*case, "--time-limit", "1e-6", cwd=tmp_path, ranks=ranks)
    assert done.returncode == 4, done.stderr
    assert done.stderr == ""
    message, last = done.stdout.splitlines()[-2:]
    assert "steady start, with no restart file; the same command begins anew" in message
    assert last.startswith("ehlpetsc: stopped steps=0 ")
    assert list(tmp_path.iterdir()) == []


@pytest.fixture(scope="session")
def stopped(tmp_path_factory):
    """Restart file of a run stopped after 10 steps."""
    folder = tmp_path_factory.mktemp("stopped")
    assert run(*CASE, cwd=folder, tampered=("SIGTERM", 0, 10)).returncode == 4
    return folder / "table1_rough.restart.h5"


def test_restart_with_another_viscosity_lists_the_change(stopped, tmp_path):
    changed = settings("fluid.viscosity=0.003", "time.travel=0.2", "output.every=2")
    done = run(*CASE, *changed, "--restart", stopped, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    message = [line for line in done.stdout.splitlines() if line.startswith("restart: ")][1:]
    assert message == ["restart: fluid.viscosity was 0.002, is 0.003", "restart: time.travel was 0.5, is 0.2"]
    with read_result(tmp_path / "table1_rough.h5") as result:
        h_min = result.steps("h_min")
        assert list(result.steps("step")) == [11, 12, 13, 14, 15, 16]
        assert np.all(np.diff(h_min) > 0)  # the thicker oil comes in


def test_diverged_step_is_named_and_leaves_a_restart_file(stopped, tmp_path):
    going_on = [*CASE, *settings("time.travel=0.2"), "--output", "f.h5", "--restart"]
    never = ["-snes_atol", 1e-30, "-snes_rtol", 1e-30, "-snes_max_it", 4]
    failed = run(*going_on, stopped, *never, cwd=tmp_path)
    assert failed.returncode == 3
    assert "ehlpetsc: not converged: step 11, " in failed.stderr
    assert "DIVERGED_MAX_IT" in failed.stderr
    assert ": f.restart.h5\n" in failed.stderr
    done = run(*going_on, "f.restart.h5", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert last_step(tmp_path / "f.h5") == (16, "done")


def test_restart_beyond_the_end_takes_no_step(whole, stopped, tmp_path):
    done = run(*CASE, *settings("time.travel=0.1"), "--restart", stopped, cwd=tmp_path)
    assert done.returncode == 0
    assert summary(done.stdout)["steps"] == "10"


@pytest.mark.slow
def test_full_disk_keeps_all_stored_steps(tmp_path):
    scene = [*CASE, *settings("mesh.points_per_half_width=70")]
    # stored before the disk is full, however quick
    often = settings("time.travel=100", "output.checkpoint=0.002")
    full = called(["prlimit", "--fsize=9000000", *command(*scene, *often)], tmp_path)
    assert full.returncode == 2
    same = "the same command continues from table1_rough.restart.h5"
    assert is_line_with(full.stderr, "table1_rough.h5: ", "File too large", same)
    with read_result(tmp_path / "table1_rough.h5") as result:
        step = result.step[-1]
        np.testing.assert_array_equal(result.steps("step"), range(step + 1))
        assert len(result.time) == step + 1 and result.attrs["status"] == "stopped"
        assert np.isfinite(result["pressure"][:]).all()
    going_on = [*settings(f"time.travel={(step + 2) / 140}"), "--restart", "table1_rough.restart.h5"]
    done = run(*scene, *going_on, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    begun = int(re.search(r"restart: table1_rough.restart.h5, step (\d+), ", done.stdout)[1])
    assert 0 < begun <= step
    assert last_step(tmp_path / "table1_rough.h5") == (step + 2, "done")
