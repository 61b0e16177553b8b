"""run_mpi.sh: what it refuses, what it hands on, and how, with a stand-in for mpirun's program."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
ECHO = """\
import os, sys
from mpi4py import MPI
world = MPI.COMM_WORLD
if world.rank == 0:
    print("ARGS", sys.argv[1:], "SIZE", world.size, "CWD", os.getcwd(), "PYTHON", sys.executable)
    print("OMP", os.environ["OMP_NUM_THREADS"], "HOME", os.environ.get("PYTHONHOME"))
sys.exit(int(os.environ.get("STATUS", "0")))
"""


@pytest.fixture
def script(tmp_path):
    """A copy of the script beside a stand-in for the package."""
    (tmp_path / "ehlpetsc").mkdir()
    (tmp_path / "ehlpetsc" / "__init__.py").touch()
    (tmp_path / "ehlpetsc" / "__main__.py").write_text(ECHO)
    shutil.copy(ROOT / "run_mpi.sh", tmp_path)
    (tmp_path / "elsewhere").mkdir()

    def run(*arguments, **environment):
        outside_mpi = {"PATH": "/usr/bin:/bin", **environment}  # these tests may themselves run under mpirun
        return subprocess.run(
            [tmp_path / "run_mpi.sh", *arguments],
            cwd=tmp_path / "elsewhere",
            env=outside_mpi,
            capture_output=True,
            text=True,
            timeout=120,
        )

    return run


def test_two_ranks_by_default_in_the_callers_folder_with_debians_python(script):
    done = script("my case.toml")
    assert done.returncode == 0
    assert "ARGS ['my case.toml'] SIZE 2" in done.stdout
    assert "/elsewhere PYTHON /usr/bin/python3" in done.stdout
    assert "OMP 1" in done.stdout
    assert done.stderr == ""


def test_options_after_the_case_are_petscs(script):
    options = ["-n", "7", "-h", "-snes_monitor", "-options_left", "-ehl_set", "title=two words"]
    done = script("-n", "1", "case.toml", *options)
    assert f"ARGS {['case.toml', *options]} SIZE 1" in done.stdout


def test_more_ranks_than_cores_run(script):
    ranks = len(os.sched_getaffinity(0)) + 1
    assert f"SIZE {ranks}" in script("-n", str(ranks), "case.toml").stdout


@pytest.mark.parametrize("status", [1, 2, 3, 4])
def test_the_exit_status_is_that_of_the_run_without_comment(script, status):
    done = script("case.toml", STATUS=str(status))
    assert done.returncode == status
    assert done.stderr == ""


def test_leftovers_of_another_python_do_not_matter(script):
    done = script(
        "case.toml",
        PYTHONHOME="/nowhere",
        PYTHONPATH="/nowhere",
        VIRTUAL_ENV="/nowhere",
        HOME="",
        PETSC_DIR="/nowhere",
        PETSC_ARCH="nothing",
    )
    assert done.returncode == 0
    assert "HOME None" in done.stdout


@pytest.mark.parametrize(
    "arguments", [["-n"], ["-n", "0", "c.toml"], ["-n", "two", "c.toml"], ["-v", "c.toml"]]
)
def test_bad_arguments_end_with_status_2(script, arguments):
    done = script(*arguments)
    assert done.returncode == 2
    assert done.stderr.startswith("run_mpi.sh: -")


def test_usage(script):
    assert script("-h").returncode == 0
    assert script().returncode == 2
    assert "./run_mpi.sh test" in script("--help").stdout == script().stdout


def test_a_user_is_shown_the_command_and_root_runs_it(script, tmp_path):
    tools = tmp_path / "tools"
    tools.mkdir()
    path = tmp_path / "run_mpi.sh"
    # a package no Debian has, and apt-get and id of our own before the system's
    text = path.read_text().replace('run_packages="', 'run_packages="python3-nonesuch ', 1)
    path.write_text(text.replace("PATH=/usr/sbin", f"PATH={tools}:/usr/sbin", 1))
    for name, body in (("apt-get", 'echo "$@" >>"$LOG"'), ("id", 'echo "$USER_ID"')):
        (tools / name).write_text(f"#!/bin/sh\n{body}\n")
        (tools / name).chmod(0o755)
    log = tmp_path / "log"
    user = script("case.toml", USER_ID="1000", LOG=str(log))
    assert user.returncode == 2
    install = "apt-get install -y --no-install-recommends python3-nonesuch"
    assert user.stdout == f"sudo apt-get update && sudo {install}\n"
    assert not log.exists()
    root = script("case.toml", USER_ID="0", LOG=str(log))
    assert log.read_text() == f"update\n{install.removeprefix('apt-get ')}\n"
    assert "installing python3-nonesuch" in root.stderr
