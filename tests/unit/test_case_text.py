"""Case files that are text of another kind than meant: nul, endless keys, byte order marks, dotted tables."""

import tomllib
from pathlib import Path

import pytest
from support import CASES

from ehlpetsc.base.errors import CaseError
from ehlpetsc.base.toml_file import toml_text
from ehlpetsc.case.loading import load, stored_case

CASE = (Path(__file__).parents[2] / "cases" / "table1_smooth.toml").read_text()
MARK = "\ufeff"


def faults(tmp_path, text, overrides=()):
    path = tmp_path / "case.toml"
    path.write_text(text)
    with pytest.raises(CaseError) as error:
        load(path, overrides)
    assert all(len(fault) < 1000 and "\n" not in fault for fault in error.value.faults)
    return " ".join(error.value.faults)


@pytest.mark.parametrize("sign", ["\\u0000", "\\u0007", "\\n", "\\u007f"])
def test_control_characters_in_a_title_are_refused(tmp_path, sign):
    assert "title = " in faults(tmp_path, CASE.replace('title = "', f'title = "{sign}', 1))


def test_byte_order_mark_of_a_case_is_ignored(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(MARK + CASE)
    assert load(path).text == CASE


@pytest.mark.parametrize("path", sorted(CASES.glob("*.toml")), ids=lambda path: path.stem)
def test_written_toml_has_the_same_tables(path):
    tables = tomllib.loads(path.read_text())
    tables["petsc"] = {'a "b"': "tab\t, \\, \u00e9", "": [[1, 2.5e-17], [True]], "c": {"d": {"e": -0.0}}}
    assert tomllib.loads(toml_text(tables)) == tables


def test_stored_text_with_overrides_loads_to_the_same_case():
    sets = {"contact.load": "400 N/mm", "petsc.snes_atol": 1e-9, "output.every": 3, "title": 'a "b" \u00b5'}
    wave = {"kind": "sine", "amplitude": 2e-7, "wavelength": 1e-4}
    for path in CASES.glob("*.toml"):
        case = load(path, sets | {"surface.2": {"synthetic": wave}})
        assert stored_case(case.text) == case
