"""Text of every key of a case file, from the table of keys: list and page; cases to begin with."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path

from ehlpetsc.base.command_parser import CommandParser, exit_status, put
from ehlpetsc.base.declarations import Key, KeyTable, plain
from ehlpetsc.base.errors import UsageError
from ehlpetsc.case.messages import nearest, value_text
from ehlpetsc.case.tables import CASE

EXAMPLES = ("roller", "gears")  # files beside this one
PAGE = """# Every key of a case file

`ehlpetsc keys` prints them too, `ehlpetsc keys fluid` those of one table, `ehlpetsc keys asperity_height` one
key; `ehlpetsc template roller` and `gears` print a case to begin with. Numbers are in SI units; a value may
also have its unit: `load = "350 N/mm"`, `viscosity = "15 mPa s"`. Unknown keys, values out of bounds, nan and
inf are rejected. A list of two is for surfaces 1 and 2.

| symbol | meaning | symbol | meaning |
|---|---|---|---|
| $a$, $p_0$ | half-width and maximum pressure by Hertz | $u_1$, $u_2$ | speeds of surfaces 1 and 2 |
| $E'$ | reduced modulus | $u_{\\max}$ | maximum of both |
| $h$ | film thickness | $X$, $z$ | abscissa and height of a profile |
| $p$, $p_c$ | pressure; pressure of the solids | $q$ | shear stress on a surface |
| $\\theta$ | void fraction | $N$ | cycles to failure |
| $\\eta$, $\\rho$ | viscosity, density | $\\Delta\\varepsilon$, $\\Delta\\sigma$ | strain and stress ranges |
| $\\eta_0$, $\\rho_0$ | at ambient pressure | $D$ | damage |
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


def tables() -> dict[str, KeyTable]:
    """Tables of a case file by name, "" for the keys at the top, in the order of the file."""
    return {"": CASE} | dict(_below(CASE, ""))


def _below(table: KeyTable, above: str) -> Iterator[tuple[str, KeyTable]]:
    for name, key in table.keys.items():
        if key.table:
            if _keys(key.table):
                yield above + name, key.table
            yield from _below(key.table, f"{above}{name}.")
        variants = key.variants or {}
        for variant in {id(one): one for one in variants.values()}.values():
            kinds = [kind for kind, one in variants.items() if one is variant]
            yield f"{above}{name} ({', '.join(kinds)})", variant


def _keys(table: KeyTable) -> dict[str, Key]:
    return {name: key for name, key in table.keys.items() if not key.table}


def _value(key: Key) -> str:
    return f"{value_text(key)}; needs {' and '.join(key.needs)}" if key.needs else value_text(key)


def _default(key: Key) -> str:
    if key.required:
        return "required" + (f" without {' or '.join(key.replaced_by)}" if key.replaced_by else "")
    return "" if key.default is None else json.dumps(key.default)


def keys(name: str | None = None) -> str:
    """Keys with meaning, allowed values and default, a line each, followed by the equation of the key.

    `name` is a table, as "fluid" or "surface.1", or a key or its symbol, as "asperity_height" or "alpha".
    """
    every, lines = tables(), []
    for place, table in every.items():
        if name is None or f"{place}.".startswith(f"{name}.") or place.startswith(f"{name} ("):
            same = place.replace("surface.2", "surface.1") if name is None else place
            lines += [f"[{place}]" if place else "top-level keys"]
            lines += [f"  as [{same}]"] if same != place else _lines("  ", _keys(table))
        elif not place.startswith("surface.2") or name.startswith("surface.2"):
            found = {f"{place}.{key}".lstrip("."): table.keys[key] for key in _keys(table)}
            chosen = [
                key for key in found if f".{key}".endswith(f".{name}") or f"`{name}`" in found[key].text
            ]
            lines += _lines("", {key: found[key] for key in chosen})
    if lines:
        return "\n".join(lines)
    above, _, last = name.rpartition(".")
    known = every[above].keys if above in every and above else {k for t in every.values() for k in t.keys}
    places = ", ".join(place for place in every if place and " " not in place)
    raise UsageError(f"{name}: no such table or key; {nearest(last, sorted(known)) or f'tables: {places}'}")


def _lines(indent: str, chosen: dict[str, Key]) -> list[str]:
    lines = []
    for name, key in chosen.items():
        default = _default(key)
        parts = [
            plain(key.text),
            _value(key),
            default if key.required or not default else f"default {default}",
        ]
        lines.append(f"{indent}{name}: {'; '.join(filter(None, parts))}")
        if key.equation:
            lines.append(f"{indent}    {plain(key.equation)}")
    return lines


def page() -> str:
    """Markdown page of all keys."""
    texts = [PAGE]
    for place, table in tables().items():
        if place.startswith("surface.2"):
            continue
        heading = f"`[{place}]`" if place else "Top-level keys"
        also = " and `[surface.2]`" if place == "surface.1" else ""
        texts.append(f"\n## {heading}{also}\n\n")
        texts.append(f"{table.text[:1].upper()}{table.text[1:]}.\n\n" if place else "")
        texts.append("| key | meaning | value | default |\n|---|---|---|---|\n")
        for name, key in _keys(table).items():
            cells = [_typeset(key.text), *(_escaped(cell) for cell in (_value(key), _default(key)))]
            texts.append(f"| `{name}` | {' | '.join(cells)} |\n")
        equations = {name: key.equation for name, key in _keys(table).items() if key.equation}
        texts += ["\n"] * bool(equations)
        texts += [f"- `{name}`: {_typeset(equation)}.\n" for name, equation in equations.items()]
    return "".join(texts)


def _typeset(text: str) -> str:
    """Text with its equations, which are in backticks, in TeX."""
    parts = text.split("`")
    return "".join(f"${tex(part)}$" if k % 2 else _escaped(part) for k, part in enumerate(parts))


def _escaped(cell: str) -> str:
    return cell.replace("|", r"\|").replace("*", r"\*")


def tex(equation: str) -> str:
    r"""TeX of an equation in the ASCII of the terminal.

    Examples
    --------
    >>> tex("p_c <= beta E* exp(-h_a/sigma)^(1/n')")
    "p_c \\le \\beta E^{\\ast} \\exp(-h_a/\\sigma)^{1/n'}"
    """
    for pattern, by in TEX:
        equation = re.sub(pattern, by, equation)
    equation = re.sub(r"(?<!\\)\b[A-Za-z]+(_[a-z_A-Z]+)?\d*", _symbol, equation)
    return re.sub(r"(mathtt{[^}]*}) (?=[a-zA-Z\\])", r"\1\\,", equation)


def _symbol(match: re.Match) -> str:
    """TeX of a word: function, Greek letter, symbol with its index, or the name of a key."""
    word = match[0]
    name, index = re.fullmatch(r"([A-Za-z]+?)_?((?<=_)\w+|\d*)", word).groups()
    if name in FUNCTIONS:
        return rf"\{name}"
    if name not in NAMES and len(name) > 1 and not re.fullmatch("d[a-z]", name):
        return rf"\mathtt{{{word.replace('_', chr(92) + '_')}}}"
    index = INDICES.get(index, index if len(index) < 3 else rf"\mathrm{{{index}}}")
    return NAMES.get(name, name) + (f"_{{{index}}}" if len(index) > 1 else f"_{index}" if index else "")


def main(words: list[str]) -> int:
    """Run the command ``ehlpetsc keys``; returns its exit status."""
    parser = CommandParser("keys", "Keys of a case file: meaning, unit, bounds, default.", "output overwrite")
    parser.add_argument(
        "key", nargs="?", metavar="TABLE or KEY", help="as fluid, contact.load or alpha (default: all)"
    )
    chosen = parser.parse_args(words)
    return exit_status("keys", lambda: put(keys(chosen.key), chosen))


def template(kind: str = EXAMPLES[0]) -> str:
    """Text of a case to begin with."""
    return Path(__file__).with_name(f"{kind}.toml").read_text()


def template_command(words: list[str]) -> int:
    """Run the command ``ehlpetsc template``; returns its exit status."""
    parser = CommandParser("template", "A commented case file to begin with.", "output overwrite")
    parser.add_argument("kind", nargs="?", choices=EXAMPLES, default=EXAMPLES[0])
    chosen = parser.parse_args(words)
    return exit_status("template", lambda: put(template(chosen.kind), chosen))


if __name__ == "__main__":
    print(page(), end="")
