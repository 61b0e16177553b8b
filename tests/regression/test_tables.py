"""Tables of friction over conditions: the command, its files, refusals."""

import csv
import runpy

import h5py
import pytest
from support import CASES

from ehlpetsc.__main__ import main

ISOTHERMAL = ["--set", "series={}", "--set", "heat={}", "--set", "mesh.points_per_half_width=20"]
RANGES = ["--speed", "2", "8", "--slide-roll", "0.02", "0.2"]


@pytest.fixture(scope="module")
def target(tmp_path_factory):
    path = tmp_path_factory.mktemp("table") / "t.csv"
    assert main(["table", str(CASES / "traction.toml"), *ISOTHERMAL, *RANGES, "-o", str(path)]) == 0
    return path


def test_rows_are_those_of_single_runs(target, tmp_path):
    with open(target) as file:
        rows = list(csv.DictReader(file))
    row = rows[len(rows) // 2]
    conditions = {
        "motion.entrainment_speed": row["speed [m/s]"],
        "motion.slide_roll_ratio": row["slide_roll [1]"],
    }
    words = [word for key, value in conditions.items() for word in ("--set", f"{key}={value}")]
    assert main([str(CASES / "traction.toml"), *ISOTHERMAL, *words, "-o", str(tmp_path / "one.h5")]) == 0
    with h5py.File(tmp_path / "one.h5") as file:
        for name, unit in (("friction_coefficient", "1"), ("film_central", "m")):
            assert float(row[f"{name} [{unit}]"]) == pytest.approx(file["steps"][name][0], rel=1e-5)


def test_function_of_python_and_hdf5_have_the_values_of_the_rows(target):
    at = runpy.run_path(target.with_suffix(".py"))["at"]
    with open(target) as file:
        rows = list(csv.DictReader(file))
    for row in rows:
        found = at("friction_coefficient", float(row["speed [m/s]"]), float(row["slide_roll [1]"]))
        assert found == pytest.approx(float(row["friction_coefficient [1]"]), rel=1e-4)
    with h5py.File(target.with_suffix(".h5")) as file:
        friction = file["friction_coefficient"]
        assert friction.shape == (len(file["speed"]), len(file["slide_roll"])) and friction.size == len(rows)
        assert 0.0 < friction.attrs["error"] <= 0.03
        assert friction.dims[1][0] == file["slide_roll"]
        assert "heat" in file["limits"][-1, -1].decode()


def test_fits_state_their_conditions_and_misfit(target):
    with open(target.with_suffix(".fits.csv")) as file:
        rows = list(csv.DictReader(file))
    assert rows[0]["law"] == "traction" and rows[0]["at"] == "speed = 2"
    assert float(rows[0]["constants"].partition("misfit = ")[2]) < 0.05


@pytest.mark.parametrize(
    "words, message",
    [
        ([], "one or more of --pressure"),
        (["--speed", "5", "2"], "--speed 5 2: allowed: two that increase"),
        (["--speed", "1", "fast"], "--speed 1 fast: allowed: two numbers in m/s"),
        (["--speed", "1", "2", "--tolerance", "0"], "--tolerance 0: allowed"),
        (["--speed", "1", "2", "--set", "fluid={}", "--set", "heat={}"], "smooth surfaces with oil"),
    ],
)
def test_ranges_without_sense_end_in_a_sentence(words, message, capsys):
    assert main(["table", str(CASES / "traction.toml"), "--set", "series={}", *words]) == 2
    assert message in capsys.readouterr().err


@pytest.mark.parametrize(("case", "cure"), [("traction", "--set series="), ("ball", "--set surface=")])
def test_a_case_that_varies_or_is_rough_is_refused_with_what_to_leave_out(case, cure, capsys):
    assert main(["table", str(CASES / f"{case}.toml"), "--speed", "1", "2"]) == 2
    assert f"; to leave out the rest, add {cure}" in capsys.readouterr().err


def test_script_of_masta_is_the_function_and_a_property(target):
    script = target.with_name("t_masta.py").read_text()
    assert script.startswith(target.with_suffix(".py").read_text())
    assert 'at("friction_coefficient", speed, abs(mesh.sliding_velocity) / speed)' in script


def test_files_that_are_no_table_are_kept(tmp_path, capsys):
    (tmp_path / "t.csv").write_text("x,z\n0,0\n")
    words = ["table", str(CASES / "traction.toml"), *ISOTHERMAL, *RANGES, "-o", str(tmp_path / "t.csv")]
    assert main(words) == 2
    assert "its first line is not that of this table" in capsys.readouterr().err
