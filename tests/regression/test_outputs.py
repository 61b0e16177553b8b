"""Outputs: existing files are kept, locks, results removed during a run."""

import os
import re
import subprocess

import pytest
from support import ROOT, is_line_with
from support.running import BARE, SCRIPT, command, run, settings, wait_for

from ehlpetsc.results.reader import read_result

COARSE = ["mesh.inlet=-1.5", "mesh.points_per_half_width=20"]
CASE = [ROOT / "cases" / "table1_smooth.toml", *settings(*COARSE)]
SLIDING = """title = "sliding that grows"
contact = { radius = 0.02, load = 3e5, youngs_modulus = [207e9, 207e9], poisson_ratio = [0.3, 0.3] }
fluid = { viscosity = 0.05, law = "barus", pressure_viscosity = 2e-8, density = "incompressible" }
motion = { entrainment_speed = 1.0 }
operation = { time = [0.0, 4e-4], speed_1 = [1.0, 1.4], speed_2 = [1.0, 0.6] }
mesh = { inlet = -2.0, outlet = 1.4, points_per_half_width = 15 }
time = { travel = 1.0 }
"""
LONG = [ROOT / "cases" / "table1_rough.toml", *settings("mesh.points_per_half_width=40", "time.travel=500")]


@pytest.fixture
def done(tmp_path):
    """Folder with a complete result, table1_smooth.h5."""
    assert run(*CASE, cwd=tmp_path).returncode == 0
    return tmp_path


def test_same_case_overwrites_and_another_is_refused(done):
    path = done / "table1_smooth.h5"
    assert run(*CASE, cwd=done).returncode == 0
    before = path.read_bytes()
    other = [*CASE, *settings("fluid.viscosity=0.004")]
    refused = run(*other, cwd=done)
    assert refused.returncode == 2 and path.read_bytes() == before
    assert is_line_with(refused.stderr, "table1_smooth.h5: ", "another case", "--set", "-o", "--overwrite")
    assert "other --set: fluid.viscosity was 0.005, is 0.004; give" in refused.stderr
    assert run(*other, "--overwrite", cwd=done).returncode == 0
    with read_result(path) as result:
        assert "viscosity = 0.004" in result.attrs["case"]
    assert [p.name for p in done.iterdir()] == ["table1_smooth.h5"]


def test_stopped_result_is_not_overwritten(tmp_path):
    case = [*LONG, "--output", "r.h5"]
    stopped = run(*case, cwd=tmp_path, tampered=("SIGTERM", 0, 5))
    assert stopped.returncode == 4
    before = (tmp_path / "r.h5").read_bytes()
    other = [*case, *settings("fluid.viscosity=0.004")]
    refused = run(*other, cwd=tmp_path)
    assert refused.returncode == 2 and (tmp_path / "r.h5").read_bytes() == before
    assert is_line_with(refused.stderr, "r.h5: ", "another case")
    (tmp_path / "r.h5").unlink()
    refused = run(*other, cwd=tmp_path)
    assert refused.returncode == 2 and is_line_with(refused.stderr, "r.restart.h5: ", "another")


def test_same_command_continues_a_run(tmp_path):
    case = [*LONG[:-2], *settings("time.travel=0.2"), "--output", "r.h5"]
    assert run(*case, cwd=tmp_path, tampered=("SIGTERM", 0, 5)).returncode == 4
    done = run(*case, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "restart: r.restart.h5, step 5, " in done.stdout
    with read_result(tmp_path / "r.h5") as result:
        assert result.attrs["restarts"] == 1 and list(result.steps("step")) == list(range(9))
    again = run(*case, cwd=tmp_path)  # done by now: made again, whatever restart file is left
    assert again.returncode == 0 and "restart: " not in again.stdout


def test_run_killed_before_its_first_checkpoint_starts_again(tmp_path):
    case = [*LONG[:-2], *settings("time.travel=0.2"), "--output", "r.h5"]
    assert run(*case, cwd=tmp_path, tampered=("SIGKILL", 0, 5)).returncode == -9
    assert sorted(path.name for path in tmp_path.iterdir() if path.name.endswith(".h5")) == ["r.h5"]
    done = run(*case, cwd=tmp_path)
    assert done.returncode == 0 and "restart: " not in done.stdout
    with read_result(tmp_path / "r.h5") as result:
        assert result.attrs["status"] == "done"


def test_damaged_restart_file_is_refused_and_kept(tmp_path):
    case = [*LONG, "--output", "r.h5"]
    assert run(*case, cwd=tmp_path, tampered=("SIGTERM", 0, 5)).returncode == 4
    raw = bytearray((tmp_path / "r.restart.h5").read_bytes())
    raw[2000] ^= 1
    (tmp_path / "r.restart.h5").write_bytes(raw)
    refused = run(*case, cwd=tmp_path)
    assert refused.returncode == 2
    assert "r.restart.h5: damaged " in refused.stderr and "; remove it, " in refused.stderr
    assert (tmp_path / "r.restart.h5").read_bytes() == raw


def make_fifo(folder):
    os.mkfifo(folder / "there")


@pytest.mark.parametrize(
    "make, output, fault",
    [
        (lambda folder: (folder / "there").write_text("mine"), "there", "not a result"),
        (make_fifo, "there", "pipe"),
        (lambda folder: None, "/dev/null", "device"),
    ],
)
def test_foreign_file_is_refused_and_kept(tmp_path, make, output, fault):
    make(tmp_path)
    refused = run(*CASE, "--output", output, cwd=tmp_path)
    assert refused.returncode == 2 and is_line_with(refused.stderr, f"{output}: ", fault)
    assert len(refused.stderr.splitlines()) == 1
    names = [p.name for p in tmp_path.iterdir()]
    assert names in ([], ["there"])
    if (tmp_path / "there").is_file():
        assert (tmp_path / "there").read_text() == "mine"


@pytest.mark.parametrize("words", [[], ["--overwrite"]])
def test_input_is_never_an_output(tmp_path, words):
    case = (ROOT / "cases" / "table1_rough.toml").read_text().replace("profiles/", "")
    profile = (ROOT / "cases" / "profiles" / "alicona_meander_profile.csv").read_text()
    (tmp_path / "case.toml").write_text(case)
    (tmp_path / "alicona_meander_profile.csv").write_text(profile)
    os.link(tmp_path / "case.toml", tmp_path / "link.h5")
    for name in ("case.toml", "link.h5", "alicona_meander_profile.csv"):
        refused = run("case.toml", "--output", name, *words, cwd=tmp_path)
        assert refused.returncode == 2 and f"{name}: is read " in refused.stderr
    assert (tmp_path / "case.toml").read_text() == case
    assert (tmp_path / "alicona_meander_profile.csv").read_text() == profile


def running(folder, *more):
    """A long run whose result file exists."""
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    words = command(*LONG, "--output", "r.h5", *more)
    process = subprocess.Popen(words, cwd=folder, env=BARE | SCRIPT, **pipes)
    wait_for(folder / "r.h5", process)
    return process


@pytest.mark.slow
def test_output_lock_excludes_a_second_run_and_ends_with_its_process(tmp_path):
    process = running(tmp_path)
    try:
        second = run(*LONG, "--output", "r.h5", "--overwrite", cwd=tmp_path)
        assert second.returncode == 2
        assert is_line_with(second.stderr, "r.h5: ", f" process {process.pid} on ")
    finally:
        process.kill()
        process.communicate()
    (tmp_path / "r.h5").unlink()
    after = run(*CASE, "--output", "r.h5", cwd=tmp_path)
    assert after.returncode == 0, after.stderr
    assert [p.name for p in tmp_path.iterdir()] == ["r.h5"]


def test_limits_name_the_mean_friction_of_the_last_line(tmp_path):
    """Sliding grows: the last step alone has more friction than the mean."""
    (tmp_path / "case.toml").write_text(SLIDING)
    done = run("case.toml", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    mean = re.search(r" friction_coefficient=(\S+)", done.stdout.splitlines()[-1])[1]
    limit = re.search(r"^limit: friction: a coefficient of (\S+),", done.stdout, re.MULTILINE)[1]
    assert float(limit) == pytest.approx(float(mean), rel=0.01)
