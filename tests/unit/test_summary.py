"""Tables of results as CSV: statistics, all steps, one frame."""

import csv

import h5py
import numpy as np
import pytest
from support.made_results import make_result

from ehlpetsc.analysis.summary import main, weighted_percentiles
from ehlpetsc.results.reader import read_result


@pytest.fixture
def path(tmp_path):
    return make_result(tmp_path / "r.h5", nodes=41, steps=11)


def rows_of(capsys, *words):
    assert main([str(word) for word in words]) == 0
    return list(csv.DictReader(capsys.readouterr().out.splitlines()))


def test_statistics_are_weighted_by_the_time_step(path, capsys):
    with h5py.File(path, "r+") as file:
        dt = file["steps/dt"][:] = np.linspace(0.0, 1.0, 11)
        load = file["steps/load"][:] = np.arange(11.0) ** 2
    other = make_result(path.with_name("a.h5"))
    (row,) = (
        row for row in rows_of(capsys, path, other) if (row["scalar"], row["result"]) == ("load", "r.h5")
    )
    assert float(row["mean"]) == pytest.approx(np.average(load, weights=dt), rel=1e-5)
    assert (row["unit"], row["min"], row["max"], row["steps"]) == ("N/m", "1", "100", "10")


def test_weighted_percentiles_are_those_of_repeated_values():
    values, weights = np.array([3.0, 1.0, 2.0]), np.array([1000.0, 3000.0, 1000.0])
    repeated = np.repeat(values, weights.astype(int))
    found = weighted_percentiles(values, weights, (30.0, 70.0, 90.0))
    assert found == pytest.approx(np.percentile(repeated, (30.0, 70.0, 90.0)), abs=0.3)


def test_steps_are_listed_over_time(path, capsys):
    rows = rows_of(capsys, path, "--steps")
    with read_result(path) as result:
        for name, unit in (("time", "s"), ("p_max", "Pa"), ("h_min", "m")):
            found = [float(row[f"{name} [{unit}]"]) for row in rows]
            np.testing.assert_allclose(found, result.steps(name), rtol=1e-8)


def test_one_frame_is_listed_over_the_nodes(path, capsys):
    rows = rows_of(capsys, path, "--frame", 7)
    with read_result(path) as result:
        assert set(rows[0]) == {"x [m]"} | {f"{n} [{result[n].attrs['units']}]" for n in result.fields}
        found = [float(row["pressure [Pa]"]) for row in rows]
        np.testing.assert_allclose(found, result.frame("pressure", 7), rtol=1e-8)


def test_scalars_of_the_steps_are_listed_in_python(path):
    with read_result(path) as result:
        lines = str(result.steps).splitlines()
    assert "(11,)" in lines[0] and any(line.split()[:2] == ["h_min", "m"] for line in lines)
