"""How much contact there is: which runs a study makes of it, observed orders and limits."""

from dataclasses import replace

import numpy as np
import pytest
from support import CASES

from ehlpetsc.case.loading import load
from ehlpetsc.study import contact
from ehlpetsc.study.contact import Measured, for_direct_contact, order, orders, output_of, settings, table
from ehlpetsc.study.runs import Outcome
from ehlpetsc.study.setting import FILM, MESH, MODEL, STEP, Setting

CHOSEN = Setting({MODEL: "mixed", MESH: 100, STEP: 0.5, FILM: 10e-9})
FOUND = Measured(0.05, 0.07, 0.09, 0.1, 0.2, 0.3, 8.0, 6.0, 5.5, 0, 1e-8, 3.0)


@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0])
def test_order_and_limit_of_a_power_law_error(exponent):
    values = [7.0 + 0.3 * 2.0 ** (-exponent * level) for level in range(3)]
    assert order(*values) == pytest.approx((exponent, 7.0))


@pytest.mark.parametrize("values", [(1.0, 2.0, 1.5), (1.0, 1.1, 1.3), (1.0, 1.0, 1.0)])
def test_divergent_values_have_no_limit(values):
    assert np.isnan(order(*values)).all()


def test_direct_contact_runs_once_for_all_boundary_films():
    chosen = list(settings(["direct", "mixed"], [100, 200], [0.5], [2e-9, 5e-9, 10e-9]))
    assert sum(s.values[MODEL] == "direct" for s in chosen) == 2
    assert sum(s.values[MODEL] == "mixed" for s in chosen) == 6


@pytest.mark.parametrize("name", ["table1_mixed", "resolved_mixed", "table1_rough"])
def test_direct_contact_drops_keys_of_mixed_contact(tmp_path, name):
    direct = Setting(CHOSEN.values | {MODEL: "direct"})
    overrides = ["contact.yield_pressure=5e9", "mesh.inlet=-1.5", *direct.overrides(), *output_of(direct)]
    path, kept = for_direct_contact(CASES / f"{name}.toml", overrides, tmp_path)
    case = load(path, kept)
    of = load(CASES / f"{name}.toml")
    assert case.contact.model == "direct" and case.contact.boundary_film is None
    assert case.mesh.inlet == -1.5 and case.fluid == of.fluid and case.contact.load == of.contact.load
    assert (path == CASES / f"{name}.toml") == (name == "table1_rough")


@pytest.mark.parametrize(
    ("mesh", "courant", "every"), [(100, 0.5, 2), (400, 0.5, 8), (200, 0.125, 16), (25, 4, 1)]
)
def test_study_frames_are_at_common_times(mesh, courant, every):
    setting = Setting(CHOSEN.values | {MESH: mesh, STEP: courant})
    assert f"output.every={every}" in output_of(setting)
    assert "output.every=1" in output_of(setting, damage=True)
    assert any("shear_stress_1" in override for override in output_of(setting, damage=True))


def test_study_table_has_a_row_per_run_with_failure_message(tmp_path, monkeypatch):
    def run(case, overrides, folder, limit):
        failed = "mesh.points_per_half_width=200" in overrides
        return Outcome(3, "step 4: no") if failed else Outcome(0, result=_touch(tmp_path / "run.h5"))

    monkeypatch.setattr(contact, "run", run)
    monkeypatch.setattr(contact, "measured", lambda path, film, seconds: FOUND)
    monkeypatch.setattr(contact, "greatest_damage", lambda path, surface, depths: np.array([0.5, 0.01]))
    message, csv = [], tmp_path / "table.csv"
    chosen = settings(["mixed"], [100, 200], [0.5], [10e-9])
    rows = table("case.toml", [], chosen, csv, tmp_path, 1.0, message.append, damage=True)
    assert rows[0][1] == replace(FOUND, damage_at_surface=0.5, damage_below=0.01)
    assert rows[1][1] is None and "step 4: no" in message[2]
    assert len(csv.read_text().splitlines()) == 3
    assert not (tmp_path / "run.h5").exists()


def _touch(path):
    path.touch()
    return path


def test_orders_are_given_for_doubled_meshes():
    lengths = {50: 0.07, 100: 0.06, 200: 0.055}
    rows = [(Setting(CHOSEN.values | {MESH: mesh}), replace(FOUND, length=v)) for mesh, v in lengths.items()]
    lines = list(orders(rows))
    assert len(lines) == len(contact.REPORTED_ORDERS)
    assert "length order 1.00, limit 0.05" in lines[0]
