"""Pages: links, modules, cases, output and keys shown are current; the site contains every page."""

import re
import runpy
import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest
from support import ROOT, refused

import ehlpetsc
from ehlpetsc.__main__ import main
from ehlpetsc.base.environment import missing
from ehlpetsc.base.errors import CaseError
from ehlpetsc.base.quantities import STEP_SCALARS
from ehlpetsc.case.keys import EXAMPLES, keys, template
from ehlpetsc.case.loading import load
from ehlpetsc.commands.surface import main as surface
from ehlpetsc.physics.oil.laws import density
from ehlpetsc.physics.scales import Scales
from ehlpetsc.run.forecast.cost import banner
from ehlpetsc.run.forecast.explain import explain
from ehlpetsc.surfaces.files.instruments import LAYOUT_KEYS
from ehlpetsc.surfaces.files.profiles import TEXT_ENDINGS
from ehlpetsc.surfaces.motion.roughness import Roughness

sys.path.append(str(ROOT / ".github" / "site"))
import key_page

PAGES = sorted(p for p in ROOT.rglob("*.md") if not any(part.startswith(".") for part in p.parts))
MAIN = (ROOT / "README.md").read_text(encoding="utf-8")


def anchors(page):
    """Names under which the headings of a page can be linked to."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(ROOT)))
def test_page_links_exist(page):
    dead = []
    for target in re.findall(r"\]\(([^)\s]+)\)", page.read_text(encoding="utf-8")):
        if target.startswith(("http://", "https://")):
            continue
        path, _, anchor = target.partition("#")
        file = page.parent / path if path else page
        if not file.exists() or (anchor and anchor not in anchors(file)):
            dead.append(target)
    assert dead == []


def test_files_and_functions_of_the_program_map_exist():
    package = ROOT / "ehlpetsc"
    text = (package / "README.md").read_text(encoding="utf-8")
    folder = package
    for name in re.findall(r"`([\w/]+\.py)`", text):
        if "/" in name:  # those after it lie beside it
            folder = (ROOT if name.startswith("tests/") else package) / Path(name).parent
        assert (folder / Path(name).name).exists() or (package / name).exists(), name
    package = ROOT / "ehlpetsc"
    sources = {path: path.read_text(encoding="utf-8") for path in package.rglob("*.py")}
    names = set(re.findall(r"`([\w.]+\.\w+)`", (package / "README.md").read_text(encoding="utf-8")))
    for name in {name for name in names if not name.endswith(".py")}:
        *_, home, last = name.split(".")
        homes = [text for path, text in sources.items() if path.stem == home or f"class {home}" in text]
        assert any(re.search(rf"\b(def|class) {last}\b", text) for text in homes), name


def test_every_case_is_described_with_its_picture():
    text, paper = ((ROOT / "cases" / page).read_text(encoding="utf-8") for page in ("README.md", "paper.md"))
    for case in sorted((ROOT / "cases").glob("*.toml")):
        if re.fullmatch(r"fig[1-7]", case.stem):
            assert f"(pictures/{case.stem}.png)" in paper, case.name
        else:
            (row,) = re.findall(rf"^\| `{case.name}` .*$", text, re.MULTILINE)
            assert re.search(r"\(pictures/\w+\.png\)", row), case.name
    shown = set(re.findall(r"pictures/([\w.]+\.png)\)", "".join(TEXTS.values())))
    assert {path.name for path in (ROOT / "cases" / "pictures").iterdir()} == shown


def test_keys_and_parameters_on_the_page_of_surfaces_are_current(capsys):
    table = TEXTS["cases/surfaces"]
    assert [key for key in LAYOUT_KEYS if f"`{key}" not in table] == []
    assert [ending for ending in TEXT_ENDINGS if f"`{ending}`" not in table] == []
    file = "cases/profiles/alicona_meander_profile.csv"
    assert surface([str(ROOT / file), "--no-picture"]) == 0
    _, *lines = capsys.readouterr().out.splitlines()
    assert len(lines) == 11 and all(line in TEXTS["cases/surfaces"] for line in lines)


def test_every_scalar_of_the_steps_is_on_the_page_of_results_or_of_heat():
    named = set(re.findall(r"`(\w+)`", TEXTS["ehlpetsc/results/README"] + TEXTS["cases/heat"]))
    endings = {name for name in named if name.startswith("_")}
    missing = {name for name in STEP_SCALARS if not name.endswith(tuple(endings)) and name not in named}
    assert missing == set()


def test_case_file_and_output_on_the_page_are_current(tmp_path):
    shown = re.search(r"```toml\n(.*?)```", MAIN, re.DOTALL)[1]
    path = tmp_path / "shown.toml"
    path.write_text(shown.replace("profiles/", f"{ROOT}/cases/profiles/"))
    case = load(path, ())
    assert (case.mesh.points_per_half_width, case.time.travel) == (100, 6.0)
    assert case.contact.model == "mixed" and "100 nodes per half-width" in MAIN
    case = load(ROOT / "cases" / "mixed.toml", ())
    scales = Scales.of(case)
    lines = banner(case, scales, Roughness.of(case, scales), 1)
    shown = re.search(r"```\n(ehlpetsc .*?)\n    step", MAIN, re.DOTALL)[1].splitlines()
    assert shown[0] == lines[0] and len(shown) >= 4
    for line in shown:
        assert any(now.startswith(line.removesuffix(" ...")) for now in lines), line


CONFIGURATION = runpy.run_path(str(ROOT / ".github" / "site" / "conf.py"))
SITE = CONFIGURATION["PAGES"]
LACKS = missing(("sphinx", "myst_parser", "furo", "matplotlib", "plotly", "xarray", "h5netcdf"))
TEXTS = {page: (ROOT / f"{page}.md").read_text(encoding="utf-8") for page in SITE}
LACKS = LACKS or not CONFIGURATION["MATHJAX"].exists()
needs_generator = pytest.mark.skipif(bool(LACKS), reason="no Sphinx with its theme, or no MathJax")


def test_site_contains_every_page_once_numbered_equations_and_a_mathjax():
    paths = (path for path in ROOT.rglob("*.md") if not any(part.startswith(".") for part in path.parts))
    here = {str(path.relative_to(ROOT).with_suffix("")) for path in paths}
    assert sorted(page for page in SITE if not page.startswith(".")) == sorted(here)
    displayed = re.findall(r"\$\$(.*?)\$\$", TEXTS["ehlpetsc/model"], re.DOTALL)
    assert not re.search(r"\\[^a-zA-Z]", "".join(displayed))  # which Markdown would take for an escape
    numbers = [re.findall(r"\\tag\{(\d+)\}", equation) for equation in displayed]
    assert numbers == [[str(k)] for k in range(1, len(displayed) + 1)] and len(numbers) > 10
    path = ROOT / ".github" / "site" / "conf.py"
    text = path.read_text(encoding="utf-8").replace('"/usr/share/javascript/mathjax"', '"/none"')
    found: dict = {}
    exec(compile(text, path, "exec"), found)
    assert "/none" in str(found["MATHJAX"]) and not {"mathjax_path", "mathjax2_config"} & found.keys()


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    folder = tmp_path_factory.mktemp("site") / "new"
    subprocess.run([ROOT / "run_mpi.sh", "docs", folder], check=True)
    return folder


@needs_generator
@pytest.mark.slow
def test_site_has_search_and_equations_without_network(site):
    assert all((site / f"{page}.html").exists() for page in (*SITE, "index", "search"))
    model = (site / "ehlpetsc" / "model.html").read_text(encoding="utf-8")
    assert model.count(r"\[") > 10 and r"\frac{\partial" in model
    assert (site / "_static" / "mathjax" / "MathJax.js").exists()
    index = (site / "searchindex.js").read_text(encoding="utf-8")
    assert "viscosity" in index and re.search(r"\btorsion\b", index)  # part of the key torsion_limit
    from_net = re.compile(r"<(?:script|link|img)\b[^>]*?(?:src|href)=\"(http[^\"]*)")
    assert [page for page in site.rglob("*.html") if from_net.search(page.read_text())] == []


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
        ("contact.load", "of a point contact and a roller its load [N]"),
        ("output", "RESULT.xdmf"),
        ("grade", r"^[fluid.grade]\n  v40: .*\n  density: "),
        ("synthetic", r"[surface.1.synthetic \(ground\)]\n.*[surface.1.synthetic \(self-affine\)]"),
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


@pytest.mark.parametrize("kind", ["line", "roller", "gears"])
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


def test_commands_print_keys_and_a_template_that_shows_contact(capsys):
    steps = ehlpetsc.solve(load(tomllib.loads(template("line")))).steps
    assert 0.1 < steps.contact_share[0] < 0.3 and 0.03 < steps.friction_coefficient[0] < 0.05
    for words, text in ((["keys"], keys()), (["keys", "mesh"], keys("mesh"))):
        assert main(words) == 0 and capsys.readouterr().out == text + "\n"
    assert main(["template"]) == 0 and capsys.readouterr().out == template()
    assert "mush: " in refused(capsys, main, "keys", "mush")
