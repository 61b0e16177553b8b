"""Installed MathJax 2 for equations: folder, files required by the site, settings."""

from pathlib import Path

DEBIAN_FOLDER = Path("/usr/share/javascript/mathjax")
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
SETTINGS = {
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


def mathjax_folder():
    """Folder of Debian's MathJax; None if it is not installed."""
    return DEBIAN_FOLDER if (DEBIAN_FOLDER / "MathJax.js").exists() else None
