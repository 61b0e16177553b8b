"""Configuration of Sphinx: Markdown pages, equations by the installed MathJax, no network."""

import shutil
from pathlib import Path

from ehlpetsc import __version__
from ehlpetsc.docs.mathjax import MATHJAX_FILES, SETTINGS, mathjax_folder
from ehlpetsc.docs.pages import FRONT, PAGES, contents

project, author, release = "ehlpetsc", "", __version__
html_title, html_theme, html_show_copyright, html_show_sphinx = f"ehlpetsc {release}", "furo", False, False
html_copy_source = html_show_sourcelink = False
extensions = ["myst_parser", "sphinx.ext.mathjax"]
root_doc = FRONT
include_patterns = [f"{page}.md" for page in PAGES]
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4  # levels with anchors, which have the names of Git hosts
myst_update_mathjax = False  # for MathJax 3
mathjax_path = "mathjax/MathJax.js"
mathjax2_config = SETTINGS
smartquotes = False
pygments_style, highlight_language = "friendly", "none"  # blocks without a language are terminals


def _with_contents(_app, page, source):
    if page == FRONT:
        source[0] += contents()


def _copy_site_files(app, failure):
    """Copy MathJax, and the front page to index.html."""
    if failure is None:
        shutil.copy(Path(app.outdir, f"{FRONT}.html"), Path(app.outdir, "index.html"))
        folder = mathjax_folder()
        for name in MATHJAX_FILES:
            target = Path(app.outdir, "_static", "mathjax", name)
            if not target.exists():
                (shutil.copytree if (folder / name).is_dir() else shutil.copy)(
                    folder / name, _with_parents(target)
                )


def _with_parents(path):
    path.parent.mkdir(parents=True, exist_ok=True)
    return path


def setup(app):
    """Connect the table of contents and further files of the site to Sphinx."""
    app.connect("source-read", _with_contents)
    app.connect("build-finished", _copy_site_files)
