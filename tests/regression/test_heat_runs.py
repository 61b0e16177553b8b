"""Runs with heat through restart and passes; a run without it imports none of it."""

import numpy as np
from support import ROOT
from support.running import PYTHON, called, run, settings, whole_and_restarted

from ehlpetsc.effects.heat import step
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


def test_isothermal_run_imports_no_heat_module(tmp_path):
    code = (
        "import sys; from ehlpetsc.case.loading import load; from ehlpetsc.run.simulation import Simulation;"
        f"list(Simulation(load({str(ROOT / 'cases' / 'table1_mixed.toml')!r},"
        f" [*{list(QUICK)!r}, 'time.travel=0.05'])));"
        "print(sorted(m for m in sys.modules if '.effects.heat.' in m))"
    )
    done = called([PYTHON, "-c", code], tmp_path)
    assert done.returncode == 0, done.stderr
    assert step.__name__ not in done.stdout
