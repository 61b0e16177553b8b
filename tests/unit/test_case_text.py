"""Case files that are text of another kind than meant: nul, endless keys, byte order marks, dotted tables."""

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from support import CASES

from ehlpetsc.case.loading import load, stored_case
from ehlpetsc.errors import CaseError
from ehlpetsc.surfaces.text_columns import text_columns
from ehlpetsc.toml_file import toml_text

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


def test_control_characters_in_options_are_refused(tmp_path):
    assert "petsc = " in faults(tmp_path, CASE + '\n[petsc]\nsnes_atol = "1\\u00003"\n')


@pytest.mark.parametrize("where", ["top", "table", "heading", "spaced"])
def test_deeply_nested_keys_are_refused_quickly(tmp_path, where):
    chain = ".".join(["a"] * 20_000)
    text = {
        "top": f"{chain} = 1\n{CASE}",
        "table": CASE.replace("[contact]", f"[contact]\n{chain} = 1", 1),
        "heading": f"{CASE}\n[{chain}]\nb = 1\n",
        "spaced": f"{chain.replace('.', ' . ')} = 1\n{CASE}",
    }[where]
    assert "more than 50" in faults(tmp_path, text)
    assert "allowed: table.key=value" in faults(tmp_path, CASE, [f"{chain}=1"])


def test_key_of_megabytes_is_refused_in_one_line(tmp_path):
    assert "unknown" in faults(tmp_path, f"{'a' * 10_000_000} = 1\n{CASE}")


def test_long_arrays_and_dotted_comments_are_accepted(tmp_path):
    path = tmp_path / "case.toml"
    heights = ",\n".join("0." + "1" * 5 for _ in range(300))
    rows = f'\n[surface.2]\nspacing = 1e-6\nunit = "um"\nz = [\n{heights}\n]\n[time]\ntravel = 1.0\n'
    path.write_text("# " + "." * 500 + "\n# 1.2.3.4 and so on ...\n" + CASE + rows)
    assert len(load(path).surface.body_2.z) == 300


def test_byte_order_mark_of_a_case_is_ignored(tmp_path):
    path = tmp_path / "case.toml"
    path.write_text(MARK + CASE)
    assert load(path).text == CASE


@pytest.mark.parametrize("rest", ["", "# \xb5m\n"])
@pytest.mark.parametrize("marks", [1, 2])
def test_byte_order_mark_of_a_profile_keeps_its_first_point(tmp_path, rest, marks):
    path = tmp_path / "profile.csv"
    text = "".join(f"{k}e-6,{k % 3}e-7\n" for k in range(20))
    coding = "latin-1" if rest else "utf-8"
    path.write_bytes(MARK.encode() * (1 if rest else marks) + (text + rest).encode(coding))
    columns, _ = text_columns(path)
    assert columns.shape == (2, 20)


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


def test_numpy_warnings_are_hidden():
    """They are for developers: python3 -W default shows them."""
    code = "import sys; import numpy; from ehlpetsc import __main__ as command\n"
    code += "command._start = lambda words: numpy.log(numpy.zeros(1)) is None\n"
    code += "sys.exit(command.main([]))"
    warnings_shown = {}
    for words in ((), ("-W", "default")):
        done = subprocess.run(
            [sys.executable, *words, "-c", code], capture_output=True, text=True, timeout=60
        )
        assert done.returncode == 0
        warnings_shown[words] = done.stderr
    assert warnings_shown[()] == "" and "by zero" in warnings_shown["-W", "default"]
