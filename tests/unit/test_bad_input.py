"""Bad input: the messages of the command equal those of `load`, exit status, and no files left."""

import subprocess
import sys

import pytest
from support import CASES, ROOT

from ehlpetsc.case.loading import load
from ehlpetsc.errors import CaseError

SMOOTH = (CASES / "table1_smooth.toml").read_text()
SURFACE = "\n[surface.1]\nfile = 'p.csv'\n"
LEVEL = "".join(f"{k}e-6,0\n" for k in range(8))


@pytest.fixture
def run(tmp_path, monkeypatch):
    """Run a case text in an empty directory: exit status, output, and names of files written."""
    monkeypatch.setenv("PYTHONPATH", str(ROOT), prepend=":")
    monkeypatch.setenv("OMP_NUM_THREADS", "1")

    def go(text, *words, profile=None):
        (tmp_path / "my.toml").write_text(text)
        if profile is not None:
            (tmp_path / "p.csv").write_text(profile)
        before = set(tmp_path.iterdir())
        done = subprocess.run(
            [sys.executable, "-m", "ehlpetsc", "my.toml", *words],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            timeout=120,
            stdin=subprocess.DEVNULL,
        )
        return done, {path.name for path in set(tmp_path.iterdir()) - before}

    return go


def refused(run, text, profile=None):
    """Error output of a run that must be refused and leave nothing."""
    done, left = run(text, profile=profile)
    assert done.returncode == 2, done.stderr
    assert left == set()
    assert "Traceback" not in done.stderr
    assert done.stdout == ""
    return done.stderr.splitlines()


def test_all_faults_are_listed_together(run, tmp_path, monkeypatch):
    text = SMOOTH + SURFACE + "[surface.2]\nfile = 'nowhere.csv'\n"
    for old, new in (
        ("radius = 0.0191", "radius = -1"),
        ("viscosity = 0.005", "viscosity = inf"),
        ("load = 527e3", "laod = 527e3"),
        ("entrainment_speed = 5.0", "entrainment_speed = 0"),
        ("outlet = 1.5", "outlet = true"),
    ):
        assert text.count(old) == 1
        text = text.replace(old, new)
    message = refused(run, text, LEVEL + "7e-6,0\n")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(CaseError) as refusal:
        load("my.toml")
    assert message == refusal.value.faults
    for key in (
        "contact.radius =",
        "fluid.viscosity =",
        "contact.laod =",
        "contact.load ",
        "motion.entrainment_speed =",
        "mesh.outlet =",
        "surface.1.file =",
        "surface.2.file =",
    ):
        assert sum(line.startswith(f"my.toml: {key}") for line in message) == 1, key
    assert len(message) == 8


def test_mesh_too_coarse_for_the_profile_is_a_warning(run):
    rough = (CASES / "table1_rough.toml").read_text()
    rough = rough.replace("profiles/", f"{CASES}/profiles/")
    coarse = ("mesh.points_per_half_width=20", "mesh.inlet=-1.5", "time.travel=0.1")
    done, made = run(rough, *(word for key in coarse for word in ("-ehl_set", key)))
    assert done.returncode == 0, done.stderr
    warned = [line for line in done.stdout.splitlines() if line.startswith("warning: surface.")]
    assert len(warned) == 4
    assert all("time.travel = 0.1," in line for line in warned[:2])
    for side, line in zip(("1", "2"), warned[2:], strict=True):
        assert line.startswith(f"warning: surface.{side}: ") and "mesh" in line
        share = float(line.partition(" %")[0].split()[-1])
        needed = int(line.partition("half_width = ")[2].split()[0])
        assert 1 < share < 100 and 20 < needed < 1000
    assert made == {"my.h5"}
