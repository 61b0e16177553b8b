"""Configuration of Sphinx: all pages as one site, equations by Debian's MathJax without network.

Where that is missing, as with Sphinx from PyPI, browsers load the MathJax of Sphinx's default address.
"""

import shutil
from pathlib import Path

from ehlpetsc import __version__
from ehlpetsc.base.environment import missing

FRONT = "README"
SECTIONS = {
    "User guide": (
        "cases/two_minutes",
        "cases/README",
        "cases/surfaces",
        "cases/contact",
        "cases/rollers",
        "cases/heat",
        "cases/measured",
        "cases/gears",
        "cases/life",
        "cases/micropitting",
        "ehlpetsc/run/README",
        "cases/own_laws",
        "ehlpetsc/results/README",
        "ehlpetsc/post/README",
        "cases/profiles/README",
    ),
    "Reference": ("cases/keys", ".github/site/python"),
    "Theory": (
        "ehlpetsc/model",
        "ehlpetsc/nonlinear/README",
        "tests/benchmarks/ACCURACY",
        "tests/verification/README",
    ),
    "Reproduction": ("cases/paper", "ehlpetsc/post/PAPER"),
    "Developer's map": ("ehlpetsc/README", "tests/README", "tests/benchmarks/README"),
}
PAGES = (FRONT, *sum(SECTIONS.values(), ()))
MATHJAX = Path("/usr/share/javascript/mathjax")
MATHJAX_FILES = (
    "MathJax.js",
    "extensions",
    "jax/element",
    "jax/input/TeX",
    "jax/output/SVG/config.js",
    "jax/output/SVG/jax.js",
    "jax/output/SVG/autoload",
    "jax/output/SVG/fonts/TeX",
)  # glyphs as paths: no fonts, which a browser does not load from files everywhere

project, author, release = "ehlpetsc", "", __version__
html_title, html_theme, html_show_copyright, html_show_sphinx = f"ehlpetsc {release}", "furo", False, False
html_copy_source = html_show_sourcelink = False
extensions = ["myst_parser", "sphinx.ext.mathjax", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
autodoc_mock_imports = missing(("h5py", "mpi4py", "petsc4py", "matplotlib"))
autodoc_typehints, autodoc_member_order = "signature", "bysource"
root_doc = FRONT
include_patterns = [f"{page}.md" for page in PAGES]
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4  # levels with anchors, which have the names of Git hosts
if MATHJAX.exists():
    myst_update_mathjax = False  # for MathJax 3
    mathjax_path = "mathjax/MathJax.js"
    mathjax2_config = {
        "jax": ["input/TeX", "output/SVG"],
        "extensions": ["tex2jax.js"],
        "TeX": {"extensions": ["AMSmath.js", "AMSsymbols.js", "noErrors.js", "noUndefined.js"]},
        "tex2jax": {
            "inlineMath": [["\\(", "\\)"]],
            "displayMath": [["\\[", "\\]"]],
            "ignoreClass": ".*",
            "processClass": "math",
        },
        "showMathMenu": False,
        "messageStyle": "none",
        "SVG": {"font": "TeX"},  # at its own size, by which equation numbers are placed
    }
smartquotes = False
pygments_style, highlight_language = "friendly", "none"  # blocks without a language are terminals


def _with_contents(_app, page, source):
    if page == FRONT:
        for caption, pages in SECTIONS.items():
            source[0] += "\n".join(
                ["", "```{toctree}", ":hidden:", f":caption: {caption}", "", *pages, "```", ""]
            )


def _copy_site_files(app, failure):
    """Copy MathJax, and the front page to index.html."""
    if failure is None:
        shutil.copy(Path(app.outdir, f"{FRONT}.html"), Path(app.outdir, "index.html"))
        for name in MATHJAX_FILES if MATHJAX.exists() else ():
            target = Path(app.outdir, "_static", "mathjax", name)
            target.parent.mkdir(parents=True, exist_ok=True)
            if (MATHJAX / name).is_dir():
                shutil.copytree(MATHJAX / name, target, dirs_exist_ok=True)
            else:
                shutil.copy(MATHJAX / name, target)


def setup(app):
    """Connect the table of contents and further files of the site to Sphinx."""
    from sphinx.search.en import SearchEnglish

    class Words(SearchEnglish):
        """Indexes also the parts of a key: "hardness" finds `asperity_hardness`."""

        def split(self, input):
            words = super().split(input)
            return words + [part for word in words if "_" in word for part in word.split("_")]

    app.add_search_language(Words)
    app.connect("source-read", _with_contents)
    app.connect("build-finished", _copy_site_files)
