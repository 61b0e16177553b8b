"""Bad input: messages, exit status, and no files left.

Messages of the command equal those of `load`, which is faster to call.
"""

import subprocess
import sys
from pathlib import Path

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


def replaced(old, new):
    assert SMOOTH.count(old) == 1, old
    return SMOOTH.replace(old, new)


def refused(run, text, profile=None):
    """Error output of a run that must be refused and leave nothing."""
    done, left = run(text, profile=profile)
    assert done.returncode == 2, done.stderr
    assert left == set()
    assert "Traceback" not in done.stderr
    assert done.stdout == ""
    return done.stderr.splitlines()


@pytest.fixture
def faults(tmp_path, monkeypatch):
    """Fault messages of a case text on loading."""
    monkeypatch.chdir(tmp_path)

    def of(text, profile=None):
        Path("my.toml").write_text(text)
        if profile is not None:
            Path("p.csv").write_text(profile)
        with pytest.raises(CaseError) as refusal:
            load("my.toml", ())
        return refusal.value.faults

    return of


@pytest.mark.parametrize(
    "text, words",
    [
        (
            replaced("radius = 0.0191", "radios = 0.0191"),
            ["contact.radius ", "missing", "contact.radios = 0.0191", '"radius"?'],
        ),
        (replaced("load = 527e3", "# "), ["contact.load ", "missing", ">= 0.001 and <= 1e+10 [N/m]"]),
        (
            replaced("radius = 0.0191", "radius = 'big'"),
            ['contact.radius = "big"', ">= 1e-09 and <= 100 [m]"],
        ),
        (
            replaced("viscosity = 0.005", "viscosity = nan"),
            ["fluid.viscosity = nan", ">= 1e-06 and <= 10000 [Pa s]"],
        ),
        (
            replaced("radius = 0.0191", "radius = -0.0191"),
            ["contact.radius = -0.0191", ">= 1e-09 and <= 100 [m]"],
        ),
        (
            replaced("entrainment_speed = 5.0", "entrainment_speed = 0.0"),
            ["motion.entrainment_speed = 0.0", ">= 1e-09 and <= 1000 [m/s]"],
        ),
    ],
    ids=["unknown key", "missing key", "wrong type", "nan", "negative radius", "zero entrainment"],
)
def test_bad_key_names_key_value_and_range(faults, text, words):
    message = "\n".join(faults(text))
    assert message.startswith("my.toml: ")
    for word in words:
        assert word in message


@pytest.mark.parametrize(
    "profile, words",
    [
        (None, "file: p.csv"),
        (LEVEL + "8e-6,high\n", "line 9: '8e-6,high'"),
        (LEVEL + "6.5e-6,0\n", "falls after x = 7e-06"),
        (LEVEL + "7e-6,1e-7\n", "x = 7e-06 appears twice"),
    ],
    ids=["missing", "text", "unsorted", "duplicate"],
)
def test_bad_profile_file_is_one_fault(faults, profile, words):
    message = faults(SMOOTH + SURFACE, profile)
    assert len(message) == 1
    assert message[0].startswith('my.toml: surface.1.file = "p.csv": ') and words in message[0]


def test_all_faults_are_listed_together(run, faults):
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
    assert message == faults(text)
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
