"""The pages as one site: every page is in it, equations are numbered one after the other, and it is built."""

import re
import runpy

import pytest
from support import ROOT

from ehlpetsc import docs
from ehlpetsc.environment import missing

CONFIGURATION = runpy.run_path(str(ROOT / "docs" / "conf.py"))
PAGES, LACKS = CONFIGURATION["PAGES"], missing(docs.NEEDED)
TEXTS = {page: (ROOT / f"{page}.md").read_text(encoding="utf-8") for page in PAGES}
needs_generator = pytest.mark.skipif(
    bool(LACKS) or not CONFIGURATION["MATHJAX"].exists(), reason="no Sphinx with its theme, or no MathJax"
)


def test_site_contains_every_page_once():
    paths = (path for path in ROOT.rglob("*.md") if not any(part.startswith(".") for part in path.parts))
    here = {str(path.relative_to(ROOT).with_suffix("")) for path in paths}
    assert sorted(PAGES) == sorted(here)


def test_theory_equations_are_numbered_consecutively():
    displayed = re.findall(r"\$\$(.*?)\$\$", TEXTS["ehlpetsc/model"], re.DOTALL)
    assert not re.search(r"\\[^a-zA-Z]", "".join(displayed))  # which Markdown would take for an escape
    numbers = [re.findall(r"\\tag\{(\d+)\}", equation) for equation in displayed]
    assert numbers == [[str(k)] for k in range(1, len(displayed) + 1)] and len(numbers) > 10


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    folder = tmp_path_factory.mktemp("site") / "new"
    assert docs.main([str(folder)]) == 0
    return folder


@needs_generator
@pytest.mark.slow
def test_site_has_search_and_equations_without_network(site):
    assert all((site / f"{page}.html").exists() for page in (*PAGES, "index", "search"))
    model = (site / "ehlpetsc" / "model.html").read_text(encoding="utf-8")
    assert model.count(r"\[") > 10 and r"\frac{\partial" in model
    assert (site / "_static" / "mathjax" / "MathJax.js").exists()
    assert "viscosity" in (site / "searchindex.js").read_text(encoding="utf-8")
    loaded = [
        address
        for page in site.rglob("*.html")
        for address in re.findall(
            r"<(?:script|link|img)\b[^>]*?(?:src|href)=\"(http[^\"]*)", page.read_text()
        )
    ]
    assert loaded == []
