"""Packaging: content of the wheel, and commands that work in any folder."""

import email
import re
import subprocess
import zipfile
from pathlib import Path

import h5py
import numpy as np
import pytest
from support import ROOT
from support.running import PYTHON, called

from ehlpetsc.results.reader import read_result


def pip(*words):
    done = called([PYTHON, "-m", "pip", *words], ROOT, {"PIP_CONFIG_FILE": "/dev/null"})
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


@pytest.fixture(scope="module")
def source(tmp_path_factory):
    """A copy of what git has, in which a build leaves its traces; with a folder that is no part of it."""
    folder = tmp_path_factory.mktemp("source")
    names = ["ehlpetsc", "pyproject.toml", "README.md", "LICENSE", "run_mpi.sh", "cases", "tests"]
    subprocess.run(["cp", "-r", *names, folder], cwd=ROOT, check=True)
    stale = folder / "build" / "lib" / "ehlpetsc" / "gone.py"  # of an earlier build
    stale.parent.mkdir(parents=True)
    stale.touch()
    return folder


@pytest.fixture(scope="module")
def wheel(source, tmp_path_factory):
    folder = tmp_path_factory.mktemp("wheel")
    pip("wheel", "--no-deps", "--no-index", "--no-build-isolation", "-w", folder, source)
    (made,) = folder.iterdir()
    return made


@pytest.fixture(scope="module")
def environment(wheel, tmp_path_factory):
    """A virtual environment on the system's packages with the wheel in it, nothing fetched."""
    folder = tmp_path_factory.mktemp("environment")
    words = [PYTHON, "-m", "venv", "--system-site-packages", "--without-pip", folder]
    subprocess.run(words, check=True)
    pip("--python", folder / "bin" / "python", "install", "--no-index", wheel)
    return folder


def test_wheel_contains_the_package_only_and_petsc_is_of_the_solver_extra(wheel):
    parts = {".py", ".html", ".css", ".js", ".toml"}
    inside = [path for path in (ROOT / "ehlpetsc").rglob("*") if path.suffix in parts]
    modules = {str(path.relative_to(ROOT)) for path in inside}
    with zipfile.ZipFile(wheel) as archive:
        names = {name for name in archive.namelist() if ".dist-info/" not in name}
        about = {Path(name).name for name in archive.namelist()} - {Path(name).name for name in names}
    assert names == modules
    assert about <= {"METADATA", "WHEEL", "RECORD", "LICENSE", "entry_points.txt", "top_level.txt"}
    assert wheel.stat().st_size < 850_000
    with zipfile.ZipFile(wheel) as archive:
        (name,) = [name for name in archive.namelist() if name.endswith("/METADATA")]
        needed = email.message_from_bytes(archive.read(name)).get_all("Requires-Dist")
    always = {re.split(r"[ (>]", line)[0] for line in needed if ";" not in line}
    assert always == {"numpy", "scipy", "numba"}
    for module in ("petsc4py", "mpi4py"):
        assert [line for line in needed if line.startswith(module) and "solver" in line]
        assert not [line for line in needed if line.startswith(module) and "solver" not in line]


@pytest.mark.slow
def test_installed_commands_work_in_any_folder(environment, tmp_path):
    def call(*words):  # to compile takes longer than these few steps
        done = called([environment / "bin" / "ehlpetsc", *words], tmp_path, {"NUMBA_DISABLE_JIT": "1"})
        assert done.returncode == 0, done.stderr
        return done.stdout

    case = ROOT / "cases" / "ridge.toml"
    short = "points_per_half_width=10 inlet=-1.3 outlet=1.2".split()
    short = [*(f"mesh.{key}" for key in short), "time.travel=3.2", "time.courant=2"]
    message = call(case, *(word for key in short for word in ("--set", key)))
    assert message.splitlines()[-1].startswith("ehlpetsc: done steps=")
    assert "ridge.post.h5" in call("post", "ridge.h5", "--depths", "0.1")
    assert call("plot", "ridge.h5") == "ridge.png\n"
    assert "same" in call("compare", "ridge.h5", "ridge.h5")
    with read_result(tmp_path / "ridge.h5") as result:
        assert result.attrs["status"] == "done" and len(result.steps("dt")) > 10
    with h5py.File(tmp_path / "ridge.post.h5") as post:
        assert np.nanmax(post["damage/1"]) > 0.0
    assert (tmp_path / "ridge.png").read_bytes().startswith(b"\x89PNG")
