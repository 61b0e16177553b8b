"""Results compared, and as tables of CSV: statistics, all steps, one frame."""

import csv

import h5py
import numpy as np
import pytest
from support import is_line_with
from support.made_results import P0, A, make_result

from ehlpetsc.analysis.compare import compare
from ehlpetsc.analysis.summary import weighted_percentiles
from ehlpetsc.commands.compare import main
from ehlpetsc.commands.summary import main as summary
from ehlpetsc.results.reader import read_result


@pytest.fixture
def result(tmp_path):
    return make_result(tmp_path / "one.h5")


def differences(one, other):
    with read_result(one) as a, read_result(other) as b:
        return {d.name: d for d in compare(a, b)}


def run(capsys, *arguments):
    """Exit status, output and error output of the command."""
    status = main([str(a) for a in arguments])
    return status, *capsys.readouterr()


def test_equal_results_compare_bitwise_equal_and_a_nan_is_a_difference(tmp_path, result, capsys):
    status, text, _ = run(capsys, result, make_result(tmp_path / "two.h5"), "--rtol", 0)
    assert status == 0
    assert text.splitlines()[-1].startswith("same")
    assert "steps/load" in text and "DIFFERENT" not in text
    assert differences(result, result)["steps/friction"].max == 0
    status, text, _ = run(capsys, result, make_result(tmp_path / "two.h5", factor=np.nan), "--rtol", 1)
    assert status == 1
    assert "different: pressure;" in text


@pytest.mark.parametrize("rtol", ["nan", "-1", "1e3", "x"])
def test_tolerance_out_of_range_is_refused(result, capsys, rtol):
    with pytest.raises(SystemExit) as end:
        run(capsys, result, result, "--rtol", rtol)
    assert end.value.code == 2
    assert is_line_with(capsys.readouterr().err, f"--rtol: {rtol}: allowed: a number >= 0 and <= 1")


def test_difference_has_size_and_position(tmp_path, result, capsys):
    other = make_result(tmp_path / "two.h5", factor=1 + 1e-4)
    found = differences(result, other)
    pressure = found["pressure"]
    assert pressure.max / pressure.scale == pytest.approx(1e-4, rel=1e-3)
    assert pressure.scale == pytest.approx(1.4 * P0, rel=1e-2)
    assert abs(pressure.x) < 0.2 * A
    assert 0 < pressure.rms < pressure.max
    assert found["film_thickness"].max == 0
    status, text, _ = run(capsys, result, other)
    assert status == 1
    assert text.splitlines()[-1].startswith("different: pressure; steps/p_max")
    assert run(capsys, result, other, "--rtol", 2e-4)[0] == 0


def test_finer_mesh_and_time_step_are_compared_at_common_nodes(tmp_path):
    coarse = make_result(tmp_path / "one.h5", nodes=161, steps=41)
    found = differences(coarse, make_result(tmp_path / "two.h5", nodes=321, steps=81))
    for name in ("pressure", "film_thickness", "shear_stress_2", "void_fraction"):
        assert found[name].max <= 1e-12 * found[name].scale, name
    assert found["steps/load"].max == 0
    assert "in_contact" not in found and "steps/contacts" not in found  # numbers of the mesh


@pytest.fixture
def path(tmp_path):
    return make_result(tmp_path / "r.h5", nodes=41, steps=11)


def rows_of(capsys, *words):
    assert summary([str(word) for word in words]) == 0
    return list(csv.DictReader(capsys.readouterr().out.splitlines()))


def test_statistics_are_weighted_by_the_time_step(path, capsys):
    with h5py.File(path, "r+") as file:
        dt = file["steps/dt"][:] = np.linspace(0.0, 1.0, 11)
        load = file["steps/load"][:] = np.arange(11.0) ** 2
    other = make_result(path.with_name("a.h5"))
    rows = {(row["scalar"], row["result"]): row for row in rows_of(capsys, path, other)}
    row = rows["load", "r.h5"]
    assert float(row["mean"]) == pytest.approx(np.average(load, weights=dt), rel=1e-5)
    assert (row["unit"], row["min"], row["max"], row["steps"]) == ("N/m", "1", "100", "10")
    values, weights = np.array([3.0, 1.0, 2.0]), np.array([1000.0, 3000.0, 1000.0])
    repeated = np.repeat(values, weights.astype(int))
    found = weighted_percentiles(values, weights, (30.0, 70.0, 90.0))
    assert found == pytest.approx(np.percentile(repeated, (30.0, 70.0, 90.0)), abs=0.3)


def test_steps_frames_and_scalars_are_listed(path, capsys):
    rows = rows_of(capsys, path, "--steps")
    with read_result(path) as result:
        for name, unit in (("time", "s"), ("p_max", "Pa"), ("h_min", "m")):
            found = [float(row[f"{name} [{unit}]"]) for row in rows]
            np.testing.assert_allclose(found, result.steps(name), rtol=1e-8)
    rows = rows_of(capsys, path, "--frame", 7)
    with read_result(path) as result:
        assert set(rows[0]) == {"x [m]"} | {f"{n} [{result[n].attrs['units']}]" for n in result.fields}
        found = [float(row["pressure [Pa]"]) for row in rows]
        np.testing.assert_allclose(found, result.frame("pressure", 7), rtol=1e-8)
    with read_result(path) as result:
        lines = str(result.steps).splitlines()
    assert "(11,)" in lines[0] and any(line.split()[:2] == ["h_min", "m"] for line in lines)
