"""MathJax 2 of the machine, which draws the equations: where it is, what of it a site needs, its settings."""

from pathlib import Path

DEBIANS = Path("/usr/share/javascript/mathjax")
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
    "SVG": {"font": "TeX"},  # at its own size: numbers are placed by the width of that
}


def mathjax_folder():
    """Folder of Debian's MathJax; None where it is not installed."""
    return DEBIANS if (DEBIANS / "MathJax.js").exists() else None
