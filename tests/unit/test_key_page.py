"""Every key as text: complete, equal to the page, and a template that is a case."""

import re
import subprocess
import sys

import numpy as np
import pytest
from support import ROOT

from ehlpetsc.case import key_page
from ehlpetsc.case.loading import load
from ehlpetsc.case.schema.equations import EQUATIONS
from ehlpetsc.errors import CaseError, UsageError
from ehlpetsc.physics.laws import density


def test_key_page_equals_the_schema():
    assert (ROOT / "cases" / "keys.md").read_text(encoding="utf-8") == key_page.page()


def test_every_key_of_the_cases_is_listed():
    listed = key_page.keys()
    for path in (ROOT / "cases").glob("*.toml"):
        text = path.read_text(encoding="utf-8").partition("[petsc]")[0]
        for key in re.findall(r"^(\w+) *=", text, re.MULTILINE):
            assert f"\n  {key}: " in listed, (path.name, key)


def test_keys_of_one_table_have_units_bounds_and_defaults():
    listed = key_page.keys("motion").splitlines()
    assert listed[0] == "[motion]" and len(listed) == 5
    assert listed[1].startswith("  entrainment_speed: ") and ">= 1e-09 and <= 1000 [m/s]" in listed[1]
    assert listed[2] == "      u = (u1 + u2)/2"
    assert listed[3].endswith("default: 0.0")
    assert "[surface.1.synthetic (ridge)]" in key_page.keys("surface.1")
    assert "[surface.2]" in key_page.keys("surface")
    with pytest.raises(UsageError, match="keys fluids: .*tables: contact, fluid"):
        key_page.keys("fluids")
    with pytest.raises(UsageError, match=r"keys contact\.laod: "):
        key_page.keys("contact.laod")
    (line, equation) = key_page.keys("contact.load").splitlines()
    assert line.startswith("  load: a number >= 0.001") and "a = sqrt" in equation
    assert "\n  keys: a list " in key_page.keys("series")


def test_equations_belong_to_existing_keys():
    models = {model.__name__: model for model in key_page.tables().values()}
    for name, equation in EQUATIONS.items():
        model, key = name.split(".")
        assert key in [field.alias for field in models[model].__fields__.values()], name
        assert equation in key_page.keys(), name


def test_refused_density_constants_explain_the_textbook_form(tmp_path):
    """1 + 0.6e-9 p/(1 + 1.7e-9 p) is the program's law with the sum of both as gamma."""
    case = ROOT / "cases" / "table1_smooth.toml"
    with pytest.raises(CaseError, match=r"1 \+ 0.6e-9 p/\(1 \+ 1.7e-9 p\) .* gamma = 2.3e-9"):
        load(case, ["fluid.gamma=0.6e-9", "fluid.lambda=1.7e-9"])
    fluid = load(case, ["fluid.gamma=2.3e-9", "fluid.lambda=1.7e-9"]).fluid
    p = np.linspace(0.0, 3e9, 7)
    np.testing.assert_allclose(density(p, fluid)[0], 1 + 0.6e-9 * p / (1 + 1.7e-9 * p), rtol=1e-14)


def test_template_is_a_case_and_its_comments_are_keys(tmp_path):
    path = tmp_path / "mine.toml"
    path.write_text(key_page.template())
    case = load(path)
    assert case.fluid.viscosity == 0.005 and case.time.travel == 6.0
    commented = re.findall(r"^# (\w+) = ", key_page.template(), re.MULTILINE)
    assert {"minimum_film", "inlet_film", "file", "short_cutoff", "courant", "every"} <= set(commented)


def test_commands_print_keys_and_template(tmp_path):
    def run(*words):
        command = [sys.executable, "-m", "ehlpetsc", *words]
        return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, timeout=60)

    assert run("keys").stdout == key_page.keys() + "\n"
    assert run("keys", "mesh").stdout == key_page.keys("mesh") + "\n"
    assert run("template").stdout == key_page.template()
    wrong = run("keys", "mush")
    assert (wrong.returncode, wrong.stdout) == (2, "") and "keys mush: " in wrong.stderr
