"""Pages of the site, by readers, and their paths."""

from pathlib import Path

ROOT = Path(__file__).parents[2]  # of the checkout
FRONT = "README"
SECTIONS = {
    "User guide": (
        "cases/README",
        "cases/contact",
        "cases/heat",
        "cases/gears",
        "cases/life",
        "ehlpetsc/run/README",
        "ehlpetsc/results/README",
        "ehlpetsc/post/README",
        "cases/profiles/README",
    ),
    "Reference": ("cases/keys",),
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


def contents():
    """Table of contents of the site, in the syntax of Sphinx.

    Returns
    -------
    str
        Markdown text that is appended to the front page.
    """
    trees = []
    for caption, pages in SECTIONS.items():
        trees += ["```{toctree}", ":hidden:", f":caption: {caption}", "", *pages, "```", ""]
    return "\n" + "\n".join(trees)
