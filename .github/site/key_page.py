"""The page cases/keys.md, from the table of keys, with equations in TeX.

To write it: ``PYTHONPATH=. python3 .github/site/key_page.py >cases/keys.md``.
"""

import re

from ehlpetsc.case.keys import default_of, own_keys, tables, value_of

PAGE = """# Every key of a case file

`ehlpetsc keys` prints them too, `ehlpetsc keys fluid` those of one table, `ehlpetsc keys asperity_height`
one key; `ehlpetsc template line`, `roller`, `gears`, `point` and `strip` print a case to begin with. Numbers
are in SI units; a value may also have its unit: `load = "350 N/mm"`, `viscosity = "15 mPa s"`. Unknown keys,
values out of bounds, nan and inf are rejected. A list of two is for surfaces 1 and 2. Defaults are bold; a
key without one may be left out unless it is required.

Symbols: $a$, $p_0$ half-width and maximum pressure by Hertz; $E'$ reduced modulus; $h$ film thickness; $p$,
$p_c$ pressure, and that of the solids; $\\theta$ void fraction; $\\eta$, $\\rho$ viscosity and density,
$\\eta_0$, $\\rho_0$ at ambient pressure; $u_1$, $u_2$ speeds of the surfaces, $u_{\\max}$ their maximum;
$X$, $z$ abscissa and height of a profile; $q$ shear stress on a surface; $N$ cycles to failure;
$\\Delta\\varepsilon$, $\\Delta\\sigma$ strain and stress ranges; $D$ damage.
"""

BRACKET = r"\(((?:[^()]|\([^()]*\))*)\)"  # with at most one more inside
TEX = (
    (r"(\d)e(-\d+)", r"\1\\cdot10^{\2}"),
    (f"sqrt{BRACKET}", r"\\sqrt{\1}"),
    (rf"\^{BRACKET}", r"^{\1}"),
    (r"\^(-?[\w.']+)", r"^{\1}"),
    (">=", r"\\ge"),
    ("<=", r"\\le"),
    (r"\|([^|]+)\|", r"\\lvert \1\\rvert"),
    (r"\*", r"^{\\ast}"),
)
FUNCTIONS = ("exp", "ln", "lg", "sinh", "cos", "max")
GREEK = "alpha beta gamma lambda eta theta nu xi pi rho sigma tau"
NAMES = {name: rf"\{name}" for name in GREEK.split()} | {
    "de": r"\Delta\varepsilon",
    "ds": r"\Delta\sigma",
    "dgamma": r"\Delta\gamma",
    "eps": r"\varepsilon",
    "erf": r"\operatorname{erf}",
}
INDICES = {"inf": r"\infty", "inf0": r"\infty 0", "max": r"\max"}


def page():
    """Markdown page of all keys."""
    texts = [PAGE]
    for place, table in tables().items():
        if place.startswith("surface.2"):
            continue
        heading = f"`[{place}]`" if place else "Top-level keys"
        also = " and `[surface.2]`" if place == "surface.1" else ""
        texts.append(f"\n## {heading}{also}\n\n")
        texts.append(f"{table.text[:1].upper()}{table.text[1:]}.\n\n" if place else "")
        texts.append("| key | meaning | value |\n|---|---|---|\n")
        for name, key in own_keys(table).items():
            value = "; ".join(filter(None, (_escaped(_short(value_of(key))), _default(key))))
            texts.append(f"| `{name}` | {_typeset(key.text)} | {value} |\n")
        equations = {name: key.equation for name, key in own_keys(table).items() if key.equation}
        texts += ["\n"] * bool(equations)
        texts += [f"- `{name}`: {_typeset(equation)}.\n" for name, equation in equations.items()]
    return "".join(texts)


def _short(value):
    """Allowed values in the words of a table: "0.1 to 2 [m]" for "a number >= 0.1 and <= 2 [m]"."""
    value = re.sub(r"a (whole )?number or a list of two (whole )?numbers", r"one or two \1numbers", value)
    value = value.replace("or a list of two of them", "or two")
    value = re.sub(r">= (\S+) and <= ([^ ,;]+)", r"\1 to \2", value)
    return re.sub(r"\b(?:a |a list of )?(whole )?numbers? (?=[\d<>-])|\b(?:one of|a list of) ", r"\1", value)


def _default(key):
    """Default of a key in bold, "all" for a list of everything allowed; "required", or "" without one."""
    default = "all" if key.default and key.default == list(key.choices or ()) else _escaped(default_of(key))
    return f"**{default}**" if default and not key.required else default


def _typeset(text):
    """Text with its equations, which are in backticks, in TeX."""
    parts = text.split("`")
    return "".join(f"${tex(part)}$" if k % 2 else _escaped(part) for k, part in enumerate(parts))


def _escaped(cell):
    return cell.replace("|", r"\|").replace("*", r"\*")


def tex(equation):
    """TeX of an equation in the ASCII of the terminal."""
    for pattern, by in TEX:
        equation = re.sub(pattern, by, equation)
    equation = re.sub(r"(?<!\\)\b[A-Za-z]+(_[a-z_A-Z]+)?\d*", _symbol, equation)
    return re.sub(r"(mathtt{[^}]*}) (?=[a-zA-Z\\])", r"\1\\,", equation)


def _symbol(match):
    """TeX of a word: function, Greek letter, symbol with its index, or the name of a key."""
    word = match[0]
    name, index = re.fullmatch(r"([A-Za-z]+?)_?((?<=_)\w+|\d*)", word).groups()
    if name in FUNCTIONS:
        return rf"\{name}"
    if name not in NAMES and len(name) > 1 and not re.fullmatch("d[a-z]", name):
        return rf"\mathtt{{{word.replace('_', chr(92) + '_')}}}"
    index = INDICES.get(index, index if len(index) < 3 else rf"\mathrm{{{index}}}")
    return NAMES.get(name, name) + (f"_{{{index}}}" if len(index) > 1 else f"_{index}" if index else "")


if __name__ == "__main__":
    print(page(), end="")
