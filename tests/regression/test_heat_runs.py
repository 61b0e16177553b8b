"""Runs with heat through restart, a series and passes; a run without it imports none of it."""

import numpy as np
import pytest
from support import ROOT
from support.running import PYTHON, called, run, settings, whole_and_restarted

from ehlpetsc.results.reader import read_result

CASE = ROOT / "cases" / "table1_heat.toml"
MESH = "mesh.inlet=-1.4", "mesh.outlet=1.3", "mesh.points_per_half_width=50"
QUICK = (*MESH, "time.travel=0.6", "output.every=1")
FIELDS = ("pressure", "film_thickness", "film_temperature", "temperature_1", "heat_flux_2")


def test_restart_is_bitwise_identical(tmp_path):
    whole, parts = whole_and_restarted([CASE, *settings(*QUICK)], "table1_heat", 12, tmp_path)
    with read_result(whole) as one, read_result(parts) as other:
        assert len(one.time) == len(other.time) > 20
        for name in FIELDS:
            np.testing.assert_array_equal(one[name][:], other[name][:])


def test_temperature_rises_with_speed_in_a_series(tmp_path):
    series = ('series.key="motion.entrainment_speed"', "series.values=[5.0, 25.0]", "time.travel=0.1")
    done = run(CASE, *settings(*QUICK, *series), cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    rises = []
    for path in sorted(tmp_path.glob("*.h5"), key=lambda path: path.stat().st_mtime):
        with read_result(path) as result:
            rises.append(result.steps("film_temperature_max").max() - 363.0)
    assert len(rises) == 2
    assert min(rises) > 1.0 and max(rises) > 2.0 * min(rises)


def test_both_bodies_enter_every_pass_at_bulk_temperature(tmp_path):
    """Without plastic deformation or wear the second pass is the first one again."""
    done = run(CASE, *settings(*QUICK, "time.passes=2", "time.travel=0.3"), cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    with (
        read_result(tmp_path / "table1_heat.pass1.h5") as one,
        read_result(tmp_path / "table1_heat.pass2.h5") as other,
    ):
        for name in FIELDS:
            largest = np.abs(one[name][:]).max()
            np.testing.assert_allclose(other[name][:], one[name][:], rtol=0, atol=1e-9 * largest)


@pytest.mark.parametrize("name, heated", [("table1_mixed", False), ("table1_heat", True)])
def test_isothermal_run_imports_no_heat_module(name, heated, tmp_path):
    code = (
        "import sys; from ehlpetsc.case.loading import load; from ehlpetsc.run.simulation import Simulation;"
        f"list(Simulation(load({str(ROOT / 'cases' / name)!r} + '.toml',"
        f" [*{list(QUICK)!r}, 'time.travel=0.05'])));"
        "print(sorted(m for m in sys.modules if '.effects.heat.' in m))"
    )
    done = called([PYTHON, "-c", code], tmp_path)
    assert done.returncode == 0, done.stderr
    assert ("ehlpetsc.effects.heat.step" in done.stdout) == heated
