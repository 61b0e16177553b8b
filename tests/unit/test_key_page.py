"""Every key as text: complete, equal to the page, and a template that is a case."""

import re
import sys
import tomllib

import numpy as np
import pytest
from support import ROOT, refused

import ehlpetsc
from ehlpetsc.__main__ import main
from ehlpetsc.base.errors import CaseError
from ehlpetsc.case.keys import EXAMPLES, keys, template
from ehlpetsc.case.loading import load
from ehlpetsc.physics.oil.laws import density
from ehlpetsc.run.forecast.explain import explain

sys.path.append(str(ROOT / ".github" / "site"))
import key_page


def test_key_page_equals_the_table_and_lists_every_key_of_the_cases():
    assert (ROOT / "cases" / "keys.md").read_text(encoding="utf-8") == key_page.page()
    tex = key_page.tex("p_c <= beta E* exp(-h_a/sigma)^(1/n')")
    assert tex == r"p_c \le \beta E^{\ast} \exp(-h_a/\sigma)^{1/n'}"
    listed = keys()
    for path in (ROOT / "cases").glob("*.toml"):
        text = path.read_text(encoding="utf-8").partition("[petsc]")[0]
        for key in re.findall(r"^(\w+) *=", text, re.MULTILINE):
            assert f"\n  {key}: " in listed, (path.name, key)


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("contact.load", "load: load per length of contact, w, .*; a number >= 0.001"),
        ("contact.load", "of a point contact its load [N]"),
        ("output", "RESULT.xdmf"),
        ("fluid.viscosity", "required without grade"),
        ("asperity_height", 'contact.asperity_height: rms .* needs contact.model = "mixed"'),
        ("density", "fluid.grade.density: .*\n *heat.density: "),
        ("alpha", "^fluid.pressure_viscosity: alpha; "),
    ],
)
def test_a_key_is_found_by_its_name(name, words):
    assert re.search(words.replace("[", r"\["), keys(name), re.DOTALL)


def test_refused_density_constants_explain_the_textbook_form(tmp_path):
    """1 + 0.6e-9 p/(1 + 1.7e-9 p) is the program's law with the sum of both as gamma."""
    case = ROOT / "cases" / "table1_smooth.toml"
    with pytest.raises(CaseError, match=r"1 \+ 0.6e-9 p/\(1 \+ 1.7e-9 p\) .* gamma = 2.3e-9"):
        load(case, ["fluid.gamma=0.6e-9", "fluid.lambda=1.7e-9"])
    fluid = load(case, ["fluid.gamma=2.3e-9", "fluid.lambda=1.7e-9"]).fluid
    p = np.linspace(0.0, 3e9, 7)
    np.testing.assert_allclose(density(p, fluid)[0], 1 + 0.6e-9 * p / (1 + 1.7e-9 * p), rtol=1e-14)


@pytest.mark.parametrize("kind", ["roller", "gears"])
def test_template_is_a_case(tmp_path, kind):
    path = tmp_path / "mine.toml"
    path.write_text(template(kind))
    case = load(path)
    assert case.fluid.viscosity < 0.03 and (case.conditions is None) == (kind != "gears")  # of hot oil


@pytest.mark.parametrize("kind", EXAMPLES)
def test_template_expects_contact_and_resolves_its_waves(kind):
    text = explain(load(tomllib.loads(template(kind))))
    assert 0.3 < float(re.search(r"Lambda ratio ([\d.]+)", text)[1]) < 1.3
    nodes = [float(number) for number in re.findall(r"([\d.]+) nodes to the shortest one", text)]
    assert len(nodes) == (kind in ("point", "strip")) and all(number > 16.0 for number in nodes)


def test_template_of_a_roller_shows_contact():
    steps = ehlpetsc.solve(load(tomllib.loads(template("roller")))).steps
    assert 0.1 < steps.contact_share[0] < 0.3 and 0.03 < steps.friction_coefficient[0] < 0.05


def test_commands_print_keys_and_template(capsys):
    for words, text in ((["keys"], keys()), (["keys", "mesh"], keys("mesh"))):
        assert main(words) == 0 and capsys.readouterr().out == text + "\n"
    assert main(["template"]) == 0 and capsys.readouterr().out == template()
    assert "mush: " in refused(capsys, main, "keys", "mush")
